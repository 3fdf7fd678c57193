//! `abbe equations`: the closed forms.

use crate::cli::arguments::{AlgebraArg, OrderArg, ToolArg};
use crate::cli::output::session::Session;
use crate::cli::{Format, Outcome};
use abbe::options::{Naming, Order};
use abbe::{EquationsOptions, equations};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    #[command(flatten)]
    order: OrderArg,
    #[command(flatten)]
    algebra: AlgebraArg,
    /// Names of the symbols.
    #[arg(long, value_enum, default_value = "iso")]
    symbols: Naming,
    /// Keep the length of the tool as the symbol L.
    #[arg(long)]
    tool_length: bool,
    /// Add the factors of each joint: nominal motion, error and location matrices.
    #[arg(long)]
    factors: bool,
    /// A LaTeX document instead of text.
    #[arg(long)]
    latex: bool,
    #[command(flatten)]
    tool: ToolArg,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    if session.format() == Format::Csv {
        return session.usage("`equations` has no csv form: it prints text, LaTeX or json");
    }
    let file = session.load(&args.machine, args.tool.name())?;
    let order = match args.order.order {
        None => None,
        Some(Order::Exact) => {
            return session.usage("equations are polynomials of an order: `--order 1` to `--order 6`");
        }
        Some(Order::Degree(degree)) => Some(degree),
    };
    let algebra = args.algebra.algebra.clone();
    let (symbols, tool_length, factors) = (args.symbols, args.tool_length, args.factors);
    let options = EquationsOptions { order, algebra, symbols, tool_length, factors };
    let result = session.take(equations(&file, &options, session.run()))?;
    let text = || if args.latex { result.latex() } else { result.text() };
    session.show(&result, text, text)
}
