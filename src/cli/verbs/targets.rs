//! `abbe targets`: what each controller can express, its limits, and how sure its facts are.

use crate::cli::output::session::Session;
use crate::cli::{Format, Outcome};
use crate::compensation::{KinematicsMechanism, ModuleContent, Spacing, TableRules};
use crate::controller::{ControllerTarget, NAMES};
use serde_json::json;

pub(crate) fn run(session: &Session) -> Outcome {
    let targets: Vec<ControllerTarget> = NAMES.iter().filter_map(|name| ControllerTarget::embedded(name)).collect();
    match session.format() {
        Format::Json => session.print_json(json!({"targets": targets.iter().map(json).collect::<Vec<_>>()})),
        Format::Csv => session.print(&csv(&targets)),
        Format::Text => session.print(&targets.iter().map(describe).collect::<Vec<_>>().join("\n")),
    }
    Ok(())
}

/// The long text of one target.
pub(crate) fn describe(target: &ControllerTarget) -> String {
    let m = &target.manifest;
    let mut text = format!("{}: {}\n  corrects: {}\n", m.target, m.title, m.expresses);
    m.cannot.iter().for_each(|line| text.push_str(&format!("  cannot correct: {line}\n")));
    text.push_str(&format!("  limits: {}\n", limits(target)));
    text.push_str(&format!("  syntax: {} ({})\n", m.certainty.syntax.level.word(), m.certainty.syntax.source));
    text.push_str(&format!("  sign: {} ({})\n", m.certainty.sign.level.word(), m.certainty.sign.source));
    text.push_str(&format!("  sign test: {}\n", m.sign_test.trim()));
    text
}

fn limits(target: &ControllerTarget) -> String {
    let mechanism = &target.manifest.mechanism;
    let pairs = mechanism.cross_axis.as_ref().map_or(0, |cross| cross.pairs.len());
    let tables = mechanism.iter().map(|(name, rules)| rule(name, rules, pairs));
    tables.chain(mechanism.kinematics.iter().map(kinematics_limits)).collect::<Vec<_>>().join("; ")
}

/// The limits of one mechanism in words.
fn rule(name: &str, rules: &TableRules, pairs: usize) -> String {
    let decimals = rules.increment.correction_decimals;
    let step = match (decimals, rules.increment.correction_scale.mm) {
        (_, 1.0) => format!("{decimals} decimals of a correction (mm, deg)"),
        (0, scale) => format!("whole numbers of 1/{scale} mm"),
        (_, scale) => format!("{decimals} decimals of 1/{scale} mm"),
    };
    match name {
        "own_axis" => format!("{} points per axis, {step}", rules.max_points),
        "lattice" => format!("{} nodes, {step}", rules.max_points),
        "error_curves" => format!("{} points per error, {decimals} decimals (mm, rad)", rules.max_points),
        _ if rules.spacing == Spacing::Line => {
            format!("one factor for each of {pairs} pairs of axes, {decimals} decimals of 1/1000")
        }
        _ => {
            let kind = name.replace('_', "-");
            let tables = if rules.max_tables == usize::MAX { String::new() } else { format!("{} ", rules.max_tables) };
            format!("{tables}{kind} tables of {} points, {step}", rules.max_points)
        }
    }
}

fn mechanism(target: &ControllerTarget) -> String {
    let mechanism = &target.manifest.mechanism;
    let tables = mechanism.iter().map(|(name, _)| name);
    tables.chain(mechanism.kinematics.iter().map(|_| "kinematics")).collect::<Vec<_>>().join(" ")
}

fn kinematics_limits(mechanism: &KinematicsMechanism) -> String {
    match mechanism.carries {
        ModuleContent::FullModel => {
            "as many axes as the nine words X Y Z A B C U V W can say; numbers as exact as the machine file's; the mean of forward and reverse".to_owned()
        }
        _ => format!("a few constants, {} decimals of each", mechanism.increment.correction_decimals),
    }
}

fn json(target: &ControllerTarget) -> serde_json::Value {
    let m = &target.manifest;
    let certainty = |c: &crate::controller::Certainty| json!({"level": c.level.word(), "source": c.source});
    json!({
        "target": m.target, "title": m.title, "mechanism": mechanism(target), "expresses": m.expresses,
        "cannot": m.cannot, "limits": limits(target), "sign_test": m.sign_test.trim(),
        "syntax": certainty(&m.certainty.syntax), "sign": certainty(&m.certainty.sign),
    })
}

fn csv(targets: &[ControllerTarget]) -> String {
    let row = |t: &ControllerTarget| {
        let m = &t.manifest;
        format!("{},{},{},{}", m.target, mechanism(t), m.certainty.syntax.level.word(), m.certainty.sign.level.word())
    };
    let rows = targets.iter().map(row);
    std::iter::once("target,mechanism,syntax,sign".to_owned()).chain(rows).collect::<Vec<_>>().join("\n")
}
