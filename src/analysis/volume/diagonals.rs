//! The four body diagonals of the volume of three linear axes: a quick check of a machine (ISO 230-6).

use crate::evaluate::Field;
use crate::lower::NominalPose;
use crate::machine::{AxisKind, Machine, OperatingPoint, Pose};
use nalgebra::Vector3;

/// One diagonal, run from end to end with the other axes at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct DiagonalRun {
    /// Its direction by the signs of the three axes' motions: `ppp`, `npp`, `pnp`, `nnp`.
    pub name: String,
    /// Start and end (mm, deg).
    pub ends: [Pose; 2],
    /// Nominal length, mm.
    pub length: f64,
    /// Actual minus nominal displacement from the start along the diagonal, step by step, mm: the first is 0.
    pub deviations: Vec<f64>,
}

impl DiagonalRun {
    /// Returns the largest minus the smallest deviation, mm.
    pub fn range(&self) -> f64 {
        let (min, max) =
            self.deviations.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
        if max >= min { max - min } else { 0.0 }
    }
}

/// A diagonal by the senses in which the three axes move.
struct DiagonalSenses {
    name: &'static str,
    positive: [bool; 3],
}

/// The four diagonals; the last axis always moves in its positive sense.
const SENSES: [DiagonalSenses; 4] = [
    DiagonalSenses { name: "ppp", positive: [true, true, true] },
    DiagonalSenses { name: "npp", positive: [false, true, true] },
    DiagonalSenses { name: "pnp", positive: [true, false, true] },
    DiagonalSenses { name: "nnp", positive: [false, false, true] },
];

/// Returns the body diagonals over the volume of [`space_axes`], `steps` intervals each; none without three such axes.
/// `at` has the positions of the other axes.
pub fn body_diagonals(field: &dyn Field, at: &OperatingPoint<'_>, steps: usize) -> Vec<DiagonalRun> {
    let machine = field.machine();
    let Ok(axes) = <[usize; 3]>::try_from(space_axes(machine)) else { return Vec::new() };
    SENSES.iter().map(|sense| diagonal(field, at, steps.max(1), &axes, sense)).collect()
}

fn diagonal(
    field: &dyn Field,
    at: &OperatingPoint<'_>,
    steps: usize,
    axes: &[usize; 3],
    sense: &DiagonalSenses,
) -> DiagonalRun {
    let machine = field.machine();
    let pose = |fraction: f64| {
        let mut pose = at.axes.to_vec();
        for (axis, positive) in axes.iter().zip(&sense.positive) {
            let grid = machine.volume()[*axis];
            let (from, to) = if *positive { (grid.min, grid.max) } else { (grid.max, grid.min) };
            pose[*axis] = if fraction == 1.0 { to } else { from + (to - from) * fraction };
        }
        pose
    };
    let ends = [pose(0.0), pose(1.0)];
    let tip = |pose: &Pose| NominalPose::at(machine, pose).pose.translation;
    let travel = tip(&ends[1]) - tip(&ends[0]);
    let along: Vector3<f64> = travel.try_normalize(0.0).unwrap_or_default();
    let deviation = |pose: &Pose| field.deviation(&at.conditions.at_pose(pose)).position;
    let start = deviation(&ends[0]);
    let step = |i| (deviation(&pose(i as f64 / steps as f64)) - start).dot(&along);
    DiagonalRun {
        name: sense.name.to_owned(),
        ends,
        length: travel.norm(),
        deviations: (0..=steps).map(step).collect(),
    }
}

/// Returns up to three linear axes with an interval in the volume that span space, sorted by name; of several parallel
/// ones the first.
pub fn space_axes(machine: &Machine) -> Vec<usize> {
    let moves = |i: &usize| {
        let grid = machine.volume()[*i];
        machine.axes()[*i].kind == AxisKind::Linear && grid.max > grid.min
    };
    let mut candidates: Vec<usize> = (0..machine.axes().len()).filter(moves).collect();
    candidates.sort_by(|a, b| machine.axes()[*a].name.cmp(&machine.axes()[*b].name));
    let mut basis: Vec<Vector3<f64>> = Vec::new();
    let mut chosen = Vec::new();
    for axis in candidates {
        let direction = Vector3::from(machine.axes()[axis].direction);
        let remainder = basis.iter().fold(direction, |v, b| v - b * b.dot(&v));
        // Axes less than 3 deg apart count as parallel.
        if let Some(new) = remainder.try_normalize(0.05) {
            basis.push(new);
            chosen.push(axis);
        }
    }
    chosen
}
