//! The controllers: their mechanisms, their limits, and the certainty of these facts.

use crate::compensation::{KinematicsMechanism, ModuleContent, ParameterVector, Spacing, TableRules};
use crate::controller::{Certainty, ControllerTarget, NAMES, unknown_target};
use crate::diagnostic::Diagnostic;
use serde::Serialize;

/// A controller in short.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, schemars::JsonSchema)]
pub struct TargetSummary {
    /// Name for `compile`.
    pub target: String,
    /// The controller's own name.
    pub title: String,
    /// Mechanisms of compensation, separated by spaces.
    pub mechanism: String,
    /// Errors that it corrects, in words.
    pub expresses: String,
    /// Errors that it cannot correct, in words.
    pub cannot: Vec<String>,
    /// Limits of its tables, in words.
    pub limits: String,
    /// A test of the sign at the machine.
    pub sign_test: String,
    /// Certainty of the syntax.
    pub syntax: TargetCertainty,
    /// Certainty of the sign.
    pub sign: TargetCertainty,
    /// The frame of kinematic parameters, and its certainty; `None` of tables.
    pub frame: Option<TargetCertainty>,
}

/// Certainty of a fact, with its source.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, schemars::JsonSchema)]
pub struct TargetCertainty {
    /// Level in a word.
    pub level: &'static str,
    /// The source.
    pub source: String,
}

impl TargetCertainty {
    fn of(certainty: &Certainty) -> Self {
        Self { level: certainty.level.word(), source: certainty.source.clone() }
    }
}

/// Returns the controllers that are built in, in short; none without the feature `controllers`.
pub fn targets() -> Vec<TargetSummary> {
    if !cfg!(feature = "controllers") {
        return Vec::new();
    }
    NAMES.iter().filter_map(|name| target(name).ok()).collect()
}

/// Returns one of them in short. Fails for a name that none has.
pub fn target(name: &str) -> Result<TargetSummary, Diagnostic> {
    let found = ControllerTarget::builtin(name).map(|target| TargetSummary::of(&target));
    found.ok_or_else(|| unknown_target(name))
}

impl TargetSummary {
    fn of(target: &ControllerTarget) -> Self {
        let m = &target.manifest;
        Self {
            target: m.target.clone(),
            title: m.title.clone(),
            mechanism: mechanism(target),
            expresses: m.expresses.clone(),
            cannot: m.cannot.clone(),
            limits: limits(target),
            sign_test: m.sign_test.trim().to_owned(),
            syntax: TargetCertainty::of(&m.certainty.syntax),
            sign: TargetCertainty::of(&m.certainty.sign),
            frame: m.certainty.frame.as_ref().map(TargetCertainty::of),
        }
    }

    /// Returns the facts as text, one a line.
    pub fn text(&self) -> String {
        let mut text = format!("{}: {}\n  corrects: {}\n", self.target, self.title, self.expresses);
        self.cannot.iter().for_each(|line| text.push_str(&format!("  cannot correct: {line}\n")));
        text.push_str(&format!("  limits: {}\n", self.limits));
        text.push_str(&format!("  syntax: {} ({})\n", self.syntax.level, self.syntax.source));
        text.push_str(&format!("  sign: {} ({})\n", self.sign.level, self.sign.source));
        if let Some(frame) = &self.frame {
            text.push_str(&format!("  frame: {} ({})\n", frame.level, frame.source));
        }
        text.push_str(&format!("  sign test: {}\n", self.sign_test));
        text
    }
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
            "one axis for each of the nine words X Y Z A B C U V W; numbers as exact as the machine file's; the \
             mean of forward and reverse"
                .to_owned()
        }
        ModuleContent::KinematicParameters => parameter_limits(mechanism),
        _ => format!("a few constants, {} decimals of each", mechanism.increment.correction_decimals),
    }
}

fn parameter_limits(mechanism: &KinematicsMechanism) -> String {
    let directed = mechanism.machines.iter().flat_map(|rules| &rules.parameters);
    let directed = directed.into_iter().any(|vector| matches!(vector, ParameterVector::Direction { .. }));
    let increment = mechanism.increment;
    let directions = if directed {
        format!("; components of unit vectors, {} decimals", increment.correction_decimals)
    } else {
        "; no directions".to_owned()
    };
    let mut kinds: Vec<&str> = Vec::new();
    for rules in &mechanism.machines {
        if !kinds.contains(&rules.rotary.words()) {
            kinds.push(rules.rotary.words());
        }
    }
    format!("{}; offsets in mm, {} decimals{directions}", kinds.join(", or "), increment.position_decimals)
}
