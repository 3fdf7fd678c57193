//! `abbe targets`: mechanism and limits of each controller, and how sure its facts are.

use crate::cli::output::session::Session;
use crate::cli::{Format, Outcome};
use abbe::results::TargetSummary;
use abbe::targets;
use serde_json::json;

pub(crate) fn run(session: &Session) -> Outcome {
    let targets = targets();
    match session.format() {
        Format::Json => session.print_json(json!({"targets": targets})),
        Format::Csv => session.print(&csv(&targets)),
        Format::Text => session.print(&targets.iter().map(TargetSummary::text).collect::<Vec<_>>().join("\n")),
    }
    Ok(())
}

fn csv(targets: &[TargetSummary]) -> String {
    let row = |t: &TargetSummary| format!("{},{},{},{}", t.target, t.mechanism, t.syntax.level, t.sign.level);
    std::iter::once("target,mechanism,syntax,sign".to_owned())
        .chain(targets.iter().map(row))
        .collect::<Vec<_>>()
        .join("\n")
}
