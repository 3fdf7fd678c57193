//! Figures of a machine over poses, without and with files, by the general algebra.

use crate::evaluate::{Deviation, Field, Statistics, Summary, tool_axis_tilt};
use crate::machine::{Approach, AxisKind, Machine, OperatingConditions, Pose};
use rayon::prelude::*;

/// Figures of a certificate: statistics of a field over poses.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, schemars::JsonSchema)]
#[schemars(rename = "CertifiedFigures")]
pub struct Figures {
    /// Deviation of the functional point, um.
    pub position_um: Summary,
    /// Rotation of the tool, urad.
    pub rotation_urad: Summary,
    /// Tilt of the tool axis, urad.
    pub tool_axis_urad: Summary,
}

impl Figures {
    /// Returns position and orientation as the statistics over `poses` poses.
    pub fn statistics(&self, poses: usize) -> Statistics {
        Statistics { poses, position_um: self.position_um, rotation_urad: self.rotation_urad }
    }
}

/// A figure of the position deviation that the files raise.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct RaisedFigure {
    /// The side of approach.
    #[serde(rename = "direction")]
    pub approach: Approach,
    /// Name of the figure.
    pub figure: &'static str,
    /// Its value without the files, um.
    pub before_um: f64,
    /// Its value with the files, um.
    pub after_um: f64,
}

/// A deviation (um) below which comparisons are rounding.
pub const ROUNDING_UM: f64 = 1e-3;

/// True if a deviation (um) is larger than another one by more than rounding.
pub(crate) fn is_worse(before: f64, after: f64) -> bool {
    after > before * 1.001 + ROUNDING_UM
}

/// Returns the figures of the position deviation that a set raises, approached from one side.
pub(crate) fn raised_figures(approach: Approach, before: &Figures, after: &Figures) -> Vec<RaisedFigure> {
    let (before, after) = (before.position_um, after.position_um);
    let figures = [("95 %", before.p95, after.p95), ("rms", before.rms, after.rms), ("max", before.max, after.max)];
    let worse = figures.into_iter().filter(|(_, before, after)| is_worse(*before, *after));
    worse.map(|(figure, before_um, after_um)| RaisedFigure { approach, figure, before_um, after_um }).collect()
}

/// Figures without and with a set of files, in the direction of approach that is worse with them, and the figures that
/// they raise in either.
#[derive(Debug, Clone)]
pub struct Judgement {
    /// The direction of approach that is worse with the files.
    pub approach: Approach,
    /// Figures without the files.
    pub uncompensated: Figures,
    /// Figures with the files.
    pub compensated: Figures,
    /// Figures that they raise.
    pub raised: Vec<RaisedFigure>,
}

/// Compares a machine without and with files over poses.
pub(crate) fn judge(bare: &dyn Field, with: &dyn Field, poses: &[Pose]) -> Judgement {
    judge_by(bare.machine(), &|approach| [bare, with].map(|field| figures(field, poses, approach.into())))
}

/// Compares figures without and with files, which `by` gives for a direction of approach.
pub fn judge_by(machine: &Machine, by: &dyn Fn(Approach) -> [Figures; 2]) -> Judgement {
    let one = |approach: Approach| {
        let [uncompensated, compensated] = by(approach);
        Judgement {
            approach,
            raised: raised_figures(approach, &uncompensated, &compensated),
            uncompensated,
            compensated,
        }
    };
    let p95 = |judgement: &Judgement| judgement.compensated.position_um.p95;
    let (mut worse, mut raised) = (None, Vec::new());
    for mut judgement in approaches(machine).iter().map(|approach| one(*approach)) {
        raised.append(&mut judgement.raised);
        if worse.as_ref().is_none_or(|known| p95(&judgement) > p95(known)) {
            worse = Some(judgement);
        }
    }
    Judgement { raised, ..worse.unwrap_or_else(|| one(Approach::Mean)) }
}

/// Returns the directions of approach that can differ.
pub(crate) fn approaches(machine: &Machine) -> &'static [Approach] {
    if machine.is_bidirectional() { &[Approach::Forward, Approach::Reverse] } else { &[Approach::Mean] }
}

/// Returns the deviations at poses, one by one and in their order: no evaluator of many poses at once, which tables may
/// have been filled with.
pub(crate) fn deviations(field: &dyn Field, poses: &[Pose], conditions: OperatingConditions) -> Vec<Deviation> {
    poses.par_iter().map(|pose| field.deviation(&conditions.at_pose(pose))).collect()
}

/// Returns the figures of a field at poses (mm, deg).
pub fn figures(field: &dyn Field, poses: &[Pose], conditions: OperatingConditions) -> Figures {
    figures_of(field.machine(), poses, &deviations(field, poses, conditions))
}

pub(crate) fn figures_of(machine: &Machine, poses: &[Pose], deviations: &[Deviation]) -> Figures {
    let tilt = |(pose, d): (&Pose, &Deviation)| tool_axis_tilt(machine, pose, &d.rotation) * 1e6;
    let tilts: Vec<_> = poses.iter().zip(deviations).map(tilt).collect();
    let Statistics { position_um, rotation_urad, .. } = Statistics::of(deviations);
    Figures { position_um, rotation_urad, tool_axis_urad: Summary::of(&tilts) }
}

/// Returns how many um are in a mm, or urad in a deg, and the name of the small unit.
pub fn micro(kind: AxisKind) -> (f64, &'static str) {
    match kind {
        AxisKind::Linear => (1e3, "um"),
        AxisKind::Rotary => (1f64.to_radians() * 1e6, "urad"),
    }
}
