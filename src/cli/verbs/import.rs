//! `abbe import`: a single-axis measurement as an instrument exports it, to a table of error curves.

use crate::cli::arguments::help;
use crate::cli::output::session::Session;
use crate::cli::output::view::table;
use crate::cli::store::write;
use crate::cli::{Format, Outcome};
use abbe::options::{FileContents, RunApproach, StraightnessLine};
use abbe::results::{ImportResult, ImportedError};
use abbe::text::{counted, significant};
use abbe::{ImportOptions, import};
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The export: text, UTF-8 or UTF-16, comma, semicolon or tab.
    file: PathBuf,
    #[arg(long, value_name = "AXIS", help = help::AXIS, long_help = "The axis that moved, if the file does not say it")]
    axis: Option<String>,
    /// The error whose runs the columns are, such as `EXX`; of several errors the only one to take.
    #[arg(long, value_name = "NAME")]
    error: Option<String>,
    /// Unit of readings that have none in the file.
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// Meaning of the values: errors (actual minus target) or corrections [default: errors, where the layout does not
    /// leave it open].
    #[arg(long, value_enum, value_name = "WHAT")]
    holds: Option<ContentsArg>,
    /// The file holds corrections, not errors: short for `--holds corrections`.
    #[arg(long, conflicts_with = "holds")]
    correction: bool,
    /// Approach of runs without a direction.
    #[arg(long, value_enum, value_name = "HOW")]
    runs: Option<Runs>,
    /// Direction of the beam of a six-degree instrument, from the launch to the receiver, such as `+X`.
    #[arg(long, value_name = "DIRECTION", allow_hyphen_values = true, requires = "vertical")]
    beam: Option<String>,
    /// The machine's direction in which the vertical of that instrument points, such as `+Z`.
    #[arg(long, value_name = "DIRECTION", allow_hyphen_values = true, requires = "beam")]
    vertical: Option<String>,
    /// Change the sign of a channel of that instrument, by its title; may be repeated.
    #[arg(long, value_name = "TITLE", requires = "beam")]
    flip: Vec<String>,
    /// Map the columns by this file (YAML), instead of by their titles.
    #[arg(long, value_name = "FILE")]
    columns: Option<PathBuf>,
    /// The axis turns without end: positions modulo 360 deg, first row again at the end.
    #[arg(long)]
    continuous: bool,
    /// The line that is taken off a straightness.
    #[arg(long, value_enum, value_name = "RULE", default_value = "least-squares")]
    line: Line,
    /// Keep the line of a straightness: it was read against an artefact of the machine.
    #[arg(long, conflicts_with = "line")]
    keep_line: bool,
    #[arg(long, value_name = "PATH", help = help::OUT, long_help = "Write the table to this file")]
    out: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum ContentsArg {
    /// Actual minus target.
    Errors,
    /// Target minus actual.
    Corrections,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Runs {
    /// All from the same side.
    OneWay,
    /// The first forward, the second in reverse, and so on.
    Alternating,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Line {
    /// Line of least squares over the targets.
    LeastSquares,
    /// Through the first and the last target.
    EndPoints,
}

fn contents(args: &Args) -> Option<FileContents> {
    match args.holds {
        Some(ContentsArg::Errors) => Some(FileContents::Errors),
        Some(ContentsArg::Corrections) => Some(FileContents::Corrections),
        None => args.correction.then_some(FileContents::Corrections),
    }
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let options = ImportOptions {
        axis: args.axis.clone(),
        error: args.error.clone(),
        unit: args.unit.clone(),
        contents: contents(args),
        runs: args.runs.map(|runs| match runs {
            Runs::OneWay => RunApproach::OneWay,
            Runs::Alternating => RunApproach::Alternating,
        }),
        beam: args.beam.clone(),
        vertical: args.vertical.clone(),
        flip: args.flip.clone(),
        columns: args.columns.clone(),
        line: match args.line {
            Line::LeastSquares => StraightnessLine::LeastSquares,
            Line::EndPoints => StraightnessLine::EndPoints,
        },
        keep_line: args.keep_line,
        continuous: args.continuous,
        needs_table: args.out.is_some() || session.format() == Format::Csv,
    };
    write::refuse_outputs(&args.out, &session.files).or_else(|refusal| session.refuse(refusal))?;
    let answer = import(&args.file, &options, session.run());
    let result = session.take(answer)?;
    if let Some(out) = &args.out {
        write::write_whole(out, result.table.as_bytes(), &session.files).or_else(|refusal| session.refuse(refusal))?;
    }
    match session.format() {
        Format::Json => session.print_json(json!(result)),
        Format::Csv => session.print(&result.table),
        Format::Text => session.print(&text(&result)),
    }
    Ok(())
}

fn text(result: &ImportResult) -> String {
    let mut text = format!("axis {}: {}, {}", result.axis, result.form, counted(result.readings, "reading"));
    text += if result.directions_inferred { "; directions from the order of the rows\n" } else { "\n" };
    for (key, value) in &result.metadata {
        text += &format!("{key}: {value}\n");
    }
    for channel in &result.channels {
        text += &format!("{} = {}{}\n", channel.error, channel.sign, channel.column);
    }
    for column in &result.columns_left_out {
        text += &format!("left out: {} ({})\n", column.column, column.reason);
    }
    text.extend(result.errors.iter().filter_map(line));
    let mut rows = table(&["error", "unit", "targets", "runs", "E", "M", "B", "mean B", "R", "A", "slope"]);
    for error in &result.errors {
        let _ = rows.add_row(cells(error));
    }
    text += &format!("{rows}\n");
    text + "E systematic deviation, M mean deviation, B reversal, R repeatability, A accuracy: formed after ISO \
     230-2:2014\n"
}

/// A sentence on the line of a straightness.
fn line(error: &ImportedError) -> Option<String> {
    let line = error.line.as_ref()?;
    let n = |x: f64| significant(x, 3);
    let size = format!("{} um/m, {} um over {} mm", n(line.slope_um_per_m), n(line.rise_um), n(line.length_mm));
    let squareness = line.squareness.as_ref().zip(line.squareness_urad);
    let would =
        squareness.map_or_else(String::new, |(name, value)| format!(" (it would be {name} = {} urad)", n(value)));
    Some(if line.taken_off {
        format!(
            "{}: line of {size} taken off. It is how the optics stood, unless they were set to an artefact of the \
             machine{would}: --keep-line\n",
            error.error
        )
    } else {
        format!("{}: line of {size} kept{would}\n", error.error)
    })
}

fn cells(f: &ImportedError) -> Vec<String> {
    let n = |x: f64| significant(x, 4);
    let maybe = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), n);
    vec![
        f.error.clone(),
        f.unit.to_owned(),
        f.targets.to_string(),
        f.runs.to_string(),
        n(f.systematic),
        n(f.mean),
        maybe(f.reversal),
        maybe(f.mean_reversal),
        maybe(f.repeatability),
        maybe(f.accuracy),
        format!("{} {}", significant(f.slope, 3), f.slope_unit),
    ]
}
