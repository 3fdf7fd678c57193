//! Options of every verb, and how a verb ends.

use clap::ValueEnum;
use std::path::PathBuf;

/// Heading of the options of every verb.
pub(crate) const GLOBAL: &str = "Global options";

/// Options of every verb.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct Global {
    /// Form of standard output; json, csv and sarif are the only thing there.
    #[arg(long, global = true, help_heading = GLOBAL, value_enum, default_value = "text")]
    pub(crate) format: FormatArg,
    /// No warnings, no progress.
    #[arg(long, global = true, help_heading = GLOBAL)]
    pub(crate) quiet: bool,
    /// Lines and tables of text as wide as they are, instead of 80 and 100 columns.
    #[arg(long, global = true, help_heading = GLOBAL)]
    pub(crate) wide: bool,
    /// Number of threads (1 to 1024) [default: RAYON_NUM_THREADS, or one for each processor]. Results do not depend on
    /// it.
    #[arg(long, global = true, help_heading = GLOBAL, value_name = "N",
        value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,
    /// Colour in diagnostics.
    #[arg(long, global = true, help_heading = GLOBAL, value_enum, default_value = "auto")]
    pub(crate) color: Color,
    /// Refuse the input on any of these (only `warnings`).
    #[arg(long, global = true, help_heading = GLOBAL, value_name = "WHAT", value_parser = ["warnings"])]
    pub(crate) deny: Option<String>,
    /// Read files in this folder and below it only: nothing outside, also not through links.
    #[arg(long, global = true, help_heading = GLOBAL, value_name = "DIR")]
    pub(crate) confined: Option<PathBuf>,
    /// Internal: marks the resource-limited child that renders user templates.
    #[arg(long, global = true, hide = true)]
    pub(crate) template_child: bool,
}

/// Form of the output, as an argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum FormatArg {
    /// Text for people.
    Text,
    /// JSON for programs; see the contracts in docs/formats/json.md.
    Json,
    /// CSV for spreadsheets.
    Csv,
    /// Diagnostics as SARIF 2.1.0, for annotations in reviews (only `check`).
    Sarif,
}

/// Form of the output of a verb.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    Text,
    Json,
    Csv,
}

/// Use of colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Color {
    /// Colour on a terminal.
    Auto,
    /// Colour always.
    Always,
    /// No colour.
    Never,
}

/// Reason why a verb did not finish; the session holds the messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Exit {
    /// The input is refused; the session holds the diagnostics.
    Refused,
    /// The command line makes no sense.
    Usage,
}

pub(crate) type Outcome = Result<(), Exit>;
