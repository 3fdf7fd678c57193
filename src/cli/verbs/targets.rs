//! `abbe targets`: the controllers, one a line; of one its mechanism and limits, and how sure its facts are.

use crate::cli::Outcome;
use crate::cli::output::session::Session;
use abbe::results::TargetSummary;
use abbe::{target, targets};
use serde_json::json;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// A target of which everything is told.
    name: Option<String>,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let targets = match &args.name {
        Some(name) => vec![target(name).or_else(|refusal| session.refuse(refusal))?],
        None => targets(),
    };
    let text = || match &args.name {
        Some(_) => targets.iter().map(TargetSummary::text).collect(),
        None => list(&targets),
    };
    session.show(&json!({"targets": targets}), || csv(&targets), text)
}

/// Names and titles in 80 columns.
fn list(targets: &[TargetSummary]) -> String {
    let width = targets.iter().map(|of| of.target.len()).max().unwrap_or(0);
    let line = |of: &TargetSummary| {
        let line = format!("{:width$}  {}", of.target, of.title);
        if line.chars().count() <= 80 { line + "\n" } else { line.chars().take(77).collect::<String>() + "...\n" }
    };
    let lines: String = targets.iter().map(line).collect();
    lines + "`abbe targets NAME` tells mechanism, limits and how sure the facts are.\n"
}

fn csv(targets: &[TargetSummary]) -> String {
    let row = |t: &TargetSummary| format!("{},{},{},{}", t.target, t.mechanism, t.syntax.level, t.sign.level);
    std::iter::once("target,mechanism,syntax,sign".to_owned())
        .chain(targets.iter().map(row))
        .collect::<Vec<_>>()
        .join("\n")
}
