//! `abbe targets`: the controllers, one a line; of one its mechanism and limits, and how sure its facts are; for a
//! machine what the files of each leave.

use crate::cli::Outcome;
use crate::cli::arguments::{JobArg, ToolArg, ToolPosesArg};
use crate::cli::how::work_of;
use crate::cli::output::session::Session;
use crate::cli::output::view::table;
use abbe::options::CertifiedWork;
use abbe::results::{ROUNDING_UM, TargetComparison, TargetResidual, TargetSummary};
use abbe::text::{fold, significant};
use abbe::{CompareTargetsOptions, compare_targets, headlines, target, targets};
use serde_json::json;
use std::path::Path;

#[derive(Debug, clap::Args)]
#[command(mut_arg("job", |option| option.requires("name").conflicts_with("tool_poses")))]
#[command(mut_arg("tool_poses", |option| option.requires("name")))]
#[command(mut_arg("path", |option| option.requires("name")))]
#[command(mut_arg("tool", |option| option.requires("name")))]
pub(crate) struct Args {
    /// A target of which everything is told, or a machine file: what the files of each target leave of its errors.
    #[arg(value_name = "NAME|MACHINE")]
    name: Option<String>,
    #[command(flatten)]
    tool_poses: ToolPosesArg,
    #[command(flatten)]
    job: JobArg,
    #[command(flatten)]
    tool: ToolArg,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    if let Some(name) = args.name.as_deref().filter(|name| is_file(name)) {
        return compare(session, args, name);
    }
    if work_of(&args.tool_poses, &args.job) != CertifiedWork::default() || args.tool.name().is_some() {
        return session.usage("targets are compared for a machine: name its file, `abbe targets MACHINE`");
    }
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

/// No name of a target has a point or a separator.
fn is_file(name: &str) -> bool {
    name.contains(['.', '/', '\\']) || Path::new(name).exists()
}

fn compare(session: &mut Session, args: &Args, machine: &str) -> Outcome {
    let file = session.load(Path::new(machine), args.tool.name())?;
    let work = work_of(&args.tool_poses, &args.job);
    let options = CompareTargetsOptions { work, ..CompareTargetsOptions::default() };
    let found = session.take(compare_targets(&file, &options, session.run()))?;
    session.show(&found, || compared_csv(&found), || compared(&found))
}

fn compared(of: &TargetComparison) -> String {
    let mut text = headlines::compare_targets(of);
    if let Some(first) = of.targets.first() {
        text += &first.over.text();
    }
    let mut rows = if of.is_measured() {
        table(&["target", "leaves, um", "instead of", "format"])
    } else {
        table(&["target", "corrects, once it is measured"])
    };
    let figure = |um: f64| if um < ROUNDING_UM { "below 0.001".to_owned() } else { significant(um, 4) };
    for found in &of.targets {
        let (before, after) = found.deciding_um();
        if of.is_measured() {
            rows.add_row([found.target.clone(), figure(after), figure(before), format_words(&found.syntax)]);
        } else if !found.target.contains('+') {
            rows.add_row([&found.target, &found.expresses]);
        }
    }
    text += &format!("{rows}\n");
    for found in of.targets.iter().filter(|found| of.is_measured() && !found.remarks.is_empty()) {
        text += &fold(&format!("{}: {}", found.target, found.remarks.join("; ")));
    }
    if !of.refused.is_empty() {
        text += "No files for this machine:\n";
    }
    of.refused.iter().for_each(|of| text += &fold(&format!("  {}: {} ({})", of.target, of.why, of.code)));
    text
}

/// Certainty of the format, of two in one word where it is the same.
fn format_words(syntax: &[&str]) -> String {
    let mut words = syntax.to_vec();
    words.dedup();
    words.join(", ")
}

fn compared_csv(of: &TargetComparison) -> String {
    let row = |of: &TargetResidual| {
        let (before, after) = of.deciding_um();
        format!("{},{after},{before},{}\n", of.target, of.syntax.join("+"))
    };
    format!("target,leaves [um],instead of [um],format\n{}", of.targets.iter().map(row).collect::<String>())
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
