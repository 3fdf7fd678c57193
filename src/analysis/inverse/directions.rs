//! The directions in which a machine can hold its tool, and a set of them.

use super::tool_pose::{rest, tool_pose};
use crate::evaluate::{Poses, Random};
use crate::lower::{NominalPose, Quantity, Twist, twists};
use crate::machine::{Axis, AxisKind, Machine, Pose};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{PI, TAU};

/// Turn of the tool axis below which an axis does not move it.
const STILL: f64 = 1e-9;

/// The kind of a set of directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DirectionKind {
    /// The tool axis at rest: the machine does not turn it.
    One,
    /// Equal angles of the axis that turns the tool axis, as far as they are on the hemisphere about that at rest.
    Circle,
    /// Each for an equal area of the hemisphere about the tool axis at rest.
    Hemisphere,
    /// Those of a job, one at each tip.
    Listed,
}

/// Directions of the tool (unit vectors from the tip to the holder, workpiece frame).
#[derive(Debug, Clone, PartialEq)]
pub struct ToolDirections {
    /// The part of the sphere over which they are spread.
    pub kind: DirectionKind,
    /// The tool axis at rest.
    pub about: Vector3<f64>,
    /// The directions.
    pub list: Vec<Vector3<f64>>,
}

impl ToolDirections {
    /// Returns `count` directions over what the machine's axes turn the tool axis over; on a circle the part of them
    /// that is within the hemisphere.
    pub fn of(machine: &Machine, count: usize) -> Self {
        let about = tool_pose(machine, &rest(machine)).direction;
        match freedom(machine) {
            0 => Self { kind: DirectionKind::One, about, list: vec![about] },
            1 => Self { kind: DirectionKind::Circle, about, list: circle(machine, &about, count) },
            _ => Self { kind: DirectionKind::Hemisphere, about, list: hemisphere(&about, count) },
        }
    }
}

/// Returns directions at equal turns of the first axis that turns the tool axis.
fn circle(machine: &Machine, about: &Vector3<f64>, count: usize) -> Vec<Vector3<f64>> {
    let turned = |axis: usize, degrees: f64| {
        let mut pose = rest(machine);
        pose[axis] += degrees;
        tool_pose(machine, &pose).direction
    };
    let rotary = |axis: &usize| machine.axes()[*axis].kind == AxisKind::Rotary;
    let turns = |axis: &usize| (turned(*axis, 90.0) - about).norm() > STILL;
    let Some(axis) = (0..machine.axes().len()).filter(rotary).find(turns) else { return vec![*about] };
    let all = (0..count).map(|k| turned(axis, 360.0 * k as f64 / count as f64));
    all.filter(|direction| direction.dot(about) > -STILL).collect()
}

/// Returns directions of a spiral over the hemisphere about a direction: heights at equal steps, and so equal areas;
/// each a golden angle from the one before.
fn hemisphere(about: &Vector3<f64>, count: usize) -> Vec<Vector3<f64>> {
    let letter = if about.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let first = (letter - about * about.dot(&letter)).normalize();
    let second = about.cross(&first);
    let golden = PI * (3.0 - libm::sqrt(5.0));
    let direction = |k: usize| {
        let height = 1.0 - (k as f64 + 0.5) / count as f64;
        let (sine, cosine) = libm::sincos((k as f64 * golden) % TAU);
        (about * height + (first * cosine + second * sine) * libm::sqrt(1.0 - height * height)).normalize()
    };
    (0..count).map(direction).collect()
}

/// Returns the number of directions in which the machine can turn its tool axis: 0, 1 or 2, at almost all poses.
pub fn freedom(machine: &Machine) -> usize {
    const POSES: usize = 4;
    const MIN_EIGENVALUE: f64 = 1e-9;
    let intervals = machine.axes().iter().map(|axis| axis.travel.interval()).collect();
    let at = |pose: Pose| {
        let direction = NominalPose::at(machine, &pose).pose.linear * Vector3::from(machine.tool().direction);
        let twists = twists(machine, &pose, Quantity::Rotation);
        let turn = |(axis, twist): (&Axis, &Twist)| {
            let u = axis.direction;
            let w = Vector3::from_fn(|i, _| (0..3).map(|k| twist.outer[i][k + 3] * u[k]).sum());
            w.cross(&direction)
        };
        let rotary = machine.axes().iter().zip(&twists).filter(|(axis, _)| axis.kind == AxisKind::Rotary);
        let gram = rotary.map(turn).fold(Matrix3::zeros(), |sum, w| sum + w * w.transpose());
        gram.symmetric_eigenvalues().iter().filter(|value| **value > MIN_EIGENVALUE).count()
    };
    Poses::Random(Random::new(intervals, POSES, 0)).iter().map(at).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_direction_stands_for_the_same_area() {
        let about = Vector3::new(0.6, 0.0, 0.8);
        let list = hemisphere(&about, 400);
        assert!(list.iter().all(|d| (d.norm() - 1.0).abs() < 1e-14 && d.dot(&about) > 0.0));
        // A cap of height h has the share h of the hemisphere.
        for share in [0.1, 0.25, 0.5, 0.9] {
            let within = list.iter().filter(|d| d.dot(&about) >= 1.0 - share).count();
            assert!((within as f64 / 400.0 - share).abs() < 0.0026, "{share}: {within}");
        }
        // So has a half, and the sum of the points across the axis vanishes.
        let sum = list.iter().sum::<Vector3<f64>>() / 400.0;
        assert!((sum - about * 0.5).norm() < 0.01, "{sum}");
    }
}
