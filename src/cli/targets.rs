//! `abbe targets`: what each controller can express, its limits, and how sure its facts are.

use super::session::Session;
use super::{Format, Outcome};
use crate::target::{Carries, Mechanism, NAMES, Target};
use serde_json::json;

pub(super) fn run(session: &Session) -> Outcome {
    let targets: Vec<Target> = NAMES.iter().filter_map(|name| Target::embedded(name)).collect();
    match session.format() {
        Format::Json => session.print_json(json!({"targets": targets.iter().map(json).collect::<Vec<_>>()})),
        Format::Csv => session.print(&csv(&targets)),
        Format::Text => session.print(&targets.iter().map(describe).collect::<Vec<_>>().join("\n")),
    }
    Ok(())
}

/// The long text of one target.
pub(super) fn describe(target: &Target) -> String {
    let m = &target.manifest;
    let mut text = format!("{}: {}\n  corrects: {}\n", m.target, m.title, m.expresses);
    m.cannot.iter().for_each(|line| text.push_str(&format!("  cannot correct: {line}\n")));
    text.push_str(&format!("  limits: {}\n", limits(target)));
    text.push_str(&format!("  syntax: {} ({})\n", m.certainty.syntax.level, m.certainty.syntax.source));
    text.push_str(&format!("  sign: {} ({})\n", m.certainty.sign.level, m.certainty.sign.source));
    text.push_str(&format!("  sign test: {}\n", m.sign_test.trim()));
    text
}

fn limits(target: &Target) -> String {
    use crate::compensation::Capability;
    let increment = target.manifest.increment();
    let decimals = format!("{} decimals of a correction (mm, deg)", increment.correction_decimals);
    match target.manifest.capability() {
        Capability::OwnAxis(own) => format!("{} points per axis, {decimals}", own.max_points),
        Capability::Lattice(lattice) => format!("{} nodes, {decimals}", lattice.max_nodes),
        Capability::Kinematics => kinematics_limits(target, &decimals),
    }
}

fn mechanism(target: &Target) -> &'static str {
    match target.manifest.mechanism {
        Mechanism::OwnAxis(_) => "own_axis",
        Mechanism::Lattice(_) => "lattice",
        Mechanism::Kinematics(_) => "kinematics",
    }
}

fn kinematics_limits(target: &Target, decimals: &str) -> String {
    match target.manifest.kinematics().map(|mechanism| mechanism.carries) {
        Some(Carries::FullModel) => {
            "nine axes, numbers as exact as the machine file's; the mean of forward and reverse".to_owned()
        }
        _ => format!("a few constants, {}", decimals.replace("a correction (mm, deg)", "each")),
    }
}

fn json(target: &Target) -> serde_json::Value {
    let m = &target.manifest;
    let certainty = |c: &crate::target::Certainty| json!({"level": c.level, "source": c.source});
    json!({
        "target": m.target, "title": m.title, "mechanism": mechanism(target), "expresses": m.expresses,
        "cannot": m.cannot, "limits": limits(target), "sign_test": m.sign_test.trim(),
        "syntax": certainty(&m.certainty.syntax), "sign": certainty(&m.certainty.sign),
    })
}

fn csv(targets: &[Target]) -> String {
    let row = |t: &Target| {
        let m = &t.manifest;
        format!("{},{},{},{}", m.target, mechanism(t), m.certainty.syntax.level, m.certainty.sign.level)
    };
    let rows = targets.iter().map(row);
    std::iter::once("target,mechanism,syntax,sign".to_owned()).chain(rows).collect::<Vec<_>>().join("\n")
}
