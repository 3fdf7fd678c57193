//! `abbe equations`: the closed forms.

use crate::cli::output::session::Session;
use crate::cli::{Format, Outcome};
use abbe::options::Naming;
use abbe::{EquationsOptions, equations};
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    /// Highest degree in the errors, every error on its own.
    #[arg(long, value_parser = clap::value_parser!(u8).range(1..=6), conflicts_with = "algebra")]
    order: Option<u8>,
    /// The algebra of the errors instead: the machine file's, or one in the words of its section
    /// `algebra`, such as `degree: 3, generators: per-axis, vanish: [x1^2, x3*x4]`.
    #[arg(long, value_name = "ALGEBRA", num_args = 0..=1, default_missing_value = "")]
    algebra: Option<String>,
    /// Names of the symbols.
    #[arg(long, value_enum, default_value = "iso")]
    symbols: Symbols,
    /// Keep the length of the tool as the symbol L.
    #[arg(long)]
    tool_length: bool,
    /// A LaTeX document instead of text.
    #[arg(long)]
    latex: bool,
    /// Tool of the machine, by name [default: the first].
    #[arg(long)]
    tool: Option<String>,
}

/// Naming of the symbols.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Symbols {
    /// EBX, EC0Y.
    Iso,
    /// eyx, Sxy.
    Paper,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    if session.format() == Format::Csv {
        return session.usage("`equations` has no csv form: it prints text, LaTeX or json");
    }
    let file = session.load(&args.machine, args.tool.as_deref())?;
    let symbols = match args.symbols {
        Symbols::Iso => Naming::Iso,
        Symbols::Paper => Naming::Paper,
    };
    let (order, algebra) = (args.order, args.algebra.clone());
    let options = EquationsOptions { order, algebra, symbols, tool_length: args.tool_length };
    let answer = equations(&file, &options, session.run());
    let result = session.take(answer)?;
    match session.format() {
        Format::Json => session.print_json(json!(result)),
        _ if args.latex => session.print(&result.latex()),
        _ => session.print(&result.text()),
    }
    Ok(())
}
