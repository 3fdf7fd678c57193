//! `abbe targets`: mechanism and limits of each controller, and how sure its facts are.

use crate::cli::Outcome;
use crate::cli::output::session::Session;
use abbe::results::TargetSummary;
use abbe::targets;
use serde_json::json;

pub(crate) fn run(session: &Session) -> Outcome {
    let targets = targets();
    let text = || targets.iter().map(TargetSummary::text).collect::<Vec<_>>().join("\n");
    session.show(&json!({"targets": targets}), || csv(&targets), text)
}

fn csv(targets: &[TargetSummary]) -> String {
    let row = |t: &TargetSummary| format!("{},{},{},{}", t.target, t.mechanism, t.syntax.level, t.sign.level);
    std::iter::once("target,mechanism,syntax,sign".to_owned())
        .chain(targets.iter().map(row))
        .collect::<Vec<_>>()
        .join("\n")
}
