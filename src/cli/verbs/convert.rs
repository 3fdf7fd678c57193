//! `abbe convert`: the same machine under other conventions, proved by comparing both.

use crate::cli::arguments::length;
use crate::cli::arguments::{ToolArg, help};
use crate::cli::output::session::Session;
use crate::cli::store::write;
use crate::cli::{Format, Outcome};
use abbe::results::ConvertResult;
use abbe::text::Reason;
use abbe::{ConvertOptions, MachineFile, convert};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file.
    machine: PathBuf,
    /// The new conventions: a preset, words such as `carried_body`, or `linear: before, rotary: rotating`; others stay
    /// as they are.
    #[arg(long, value_name = "CONVENTIONS", required_unless_present = "datum")]
    to: Option<String>,
    /// Let location errors count from the actual line of this axis instead of the machine frame (`axis_only`).
    #[arg(long, value_name = "AXIS")]
    datum: Option<String>,
    /// Accept a machine that differs by up to this length (above 0), rotations by this over a metre [default: only
    /// rounding is accepted].
    #[arg(long, value_name = "LENGTH", value_parser = distance)]
    within: Option<f64>,
    #[arg(long, value_name = "PATH", help = help::OUT, long_help = "Write the converted machine to this file")]
    out: Option<PathBuf>,
    #[command(flatten)]
    tool: ToolArg,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    if session.format() == Format::Csv {
        return session.usage("`convert` has no csv form: it prints text or json");
    }
    let file = session.load(&args.machine, args.tool.name())?;
    write::refuse_outputs(&args.out, &session.files).or_else(|refusal| session.refuse(refusal))?;
    let options = ConvertOptions { to: args.to.clone(), datum: args.datum.clone(), within_mm: args.within };
    let result = session.take(convert(&file, &options, session.run()))?;
    if let Some(out) = &args.out {
        write::write_whole(out, result.machine_file.as_bytes(), &session.files)
            .or_else(|refusal| session.refuse(refusal))?;
    }
    let text = || text(&file, &result, args.out.as_deref());
    session.show(&result, text, text)
}

/// A length of zero or more, such as `10 nm`.
fn distance(text: &str) -> Result<f64, Reason> {
    length(text, |mm| (0.0..=1.0).contains(&mm), "write a length up to 1 mm, such as `10 nm`")
}

fn text(old: &MachineFile, result: &ConvertResult, out: Option<&Path>) -> String {
    let mut text = format!("{}: {}\n", old.name(), result.changed.join("; "));
    for error in &result.errors {
        if let Some([before, after]) = &error.words {
            text += &format!("  {:<12} {before} -> {after}\n", error.name);
        }
    }
    let curves: Vec<&str> = result.errors.iter().filter(|e| e.curve).map(|e| e.name.as_str()).collect();
    if !curves.is_empty() {
        text += &format!("  new curves   {}\n", curves.join(", "));
    }
    let chain = result.machine.chain();
    if let Some(name) = chain.spindle().filter(|_| old.chain().spindle().is_none()) {
        text +=
            &format!("  chain        {chain} (spindle {name} holds the orientation of the tool on the last axis)\n");
    }
    let (bound, angle) = (result.proof.bound_mm, result.proof.bound_rad);
    text += &format!("proof          {}; bound {bound:.1e} mm and {angle:.1e} rad\n", result.proved);
    match out {
        Some(path) => text + &format!("written        {}\n", path.display()),
        None => text + "nothing written: give `--out FILE`\n",
    }
}
