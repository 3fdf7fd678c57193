//! `abbe diff`: how far two sets of compensation files are apart, in micrometres.

use crate::cli::how::SetArgs;
use crate::cli::output::session::Session;
use crate::cli::store::file_set;
use crate::cli::{Format, Outcome};
use abbe::DiffOptions;
use abbe::results::SetDifference;
use abbe::text::significant;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The machine file: its axes, and the volume over which the sets are compared.
    machine: PathBuf,
    /// A folder with compensation files.
    old: PathBuf,
    /// Another one.
    new: PathBuf,
    #[command(flatten)]
    set: SetArgs,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let file = session.load(&args.machine, args.set.tool.as_deref())?;
    for folder in [&args.old, &args.new] {
        file_set::settle(session, folder)?;
    }
    let (compensation, poses, seed) = (args.set.how.options(), args.set.poses as usize, args.set.seed);
    let options = DiffOptions { compensation, poses, seed };
    let answer = abbe::diff(&file, &args.old, &args.new, &options, session.run());
    let difference = session.take(answer)?;
    match session.format() {
        Format::Json => session.print_json(json!(difference)),
        Format::Csv => session.print(&csv(&difference)),
        Format::Text => session.print(&text(&difference)),
    }
    Ok(())
}

fn csv(difference: &SetDifference) -> String {
    let lines = difference.axes.iter().map(|a| format!("{},{},{},{}", a.name, a.unit, a.max, a.rms));
    std::iter::once("axis,unit,max,rms".to_owned()).chain(lines).collect::<Vec<_>>().join("\n")
}

fn text(difference: &SetDifference) -> String {
    let mut text = String::from("Second set less the first, over both directions of approach:\n");
    for a in &difference.axes {
        let [max, rms] = [a.max, a.rms].map(|x| significant(x, 4));
        text.push_str(&format!("  {:4} max {max} {unit}, rms {rms} {unit}\n", a.name, unit = a.unit));
    }
    let moved = &difference.position_um;
    let [max, p95, rms] = [moved.max, moved.p95, moved.rms].map(|x| significant(x, 4));
    text + &format!("The functional point moves by at most {max} um, 95 % {p95} um, rms {rms} um.\n")
}
