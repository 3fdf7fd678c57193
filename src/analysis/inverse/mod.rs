//! Nominal inverse kinematics of any serial chain the language can say: where the axes must be for the
//! functional point to be at a place of the workpiece and the tool to point in a direction.
//!
//! 1. [`rotary`] finds the positions of the rotary axes that give the direction: all of them where
//!    two axes or fewer turn, in closed form; the nearest ones where there are more.
//! 2. [`linear`] finds those of the linear axes that give the place, moving them as little as it can.
//! 3. Where the linear axes span a plane only, [`turning`] brings the place into it by a rotary axis about the tool axis.
//! 4. The first of the candidates, nearest to the reference first, that is within the travel is taken,
//!    and the nominal machine is asked whether it gets there.

mod algebra;
mod linear;
mod rotary;
mod turning;

pub use algebra::Inverse;

use crate::lower::NominalPose;
use crate::machine::{Axis, Machine, Pose, Travel};
use nalgebra::Vector3;
use rotary::Directions;

/// How far the place reached may be from the one asked for, mm.
pub const PLACE_TOLERANCE: f64 = 1e-9;

/// How far the direction reached may be from the one asked for, rad.
pub const DIRECTION_TOLERANCE: f64 = 1e-12;

/// A pose of the tool in the workpiece frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToolPose {
    /// The functional point, from the workpiece origin, mm.
    pub tip: Vector3<f64>,
    /// Unit vector of the tool axis, from the tip towards the holder: (0, 0, 1) at the zero pose.
    pub direction: Vector3<f64>,
}

/// Why a machine cannot bring its tool somewhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unreachable {
    /// Its rotary axes cannot point the tool there.
    Direction,
    /// Its linear axes do not span the place.
    Place,
    /// An axis would have to leave its travel.
    Travel,
}

impl Unreachable {
    /// Why, in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Direction => "the tool cannot be held in this direction",
            Self::Place => "the linear axes do not span it",
            Self::Travel => "an axis would leave its travel",
        }
    }
}

/// Where the nominal machine holds its tool at a pose (mm, deg).
pub fn tool_pose(machine: &Machine, pose: &[f64]) -> ToolPose {
    let nominal = NominalPose::at(machine, pose).pose;
    ToolPose { tip: nominal.translation, direction: nominal.linear.column(2).into_owned() }
}

/// The pose of zeros, each held within its axis's travel (mm, deg).
pub fn rest(machine: &Machine) -> Pose {
    machine.axes().iter().map(|axis| held(axis, 0.0)).collect()
}

/// The pose (mm, deg) within the travel that brings the tool of the nominal machine there. Of several
/// the one whose rotary axes, then linear axes, are nearest to `reference`; an axis the tool pose does
/// not depend on stays at its reference.
pub fn inverse(machine: &Machine, target: &ToolPose, reference: &[f64]) -> Result<Pose, Unreachable> {
    let axes = machine.axes();
    let reference: Pose =
        axes.iter().enumerate().map(|(i, a)| held(a, reference.get(i).copied().unwrap_or(0.0))).collect();
    let directions = Directions::new(axes, &reference);
    let mut failure = Unreachable::Direction;
    let mut tried = |candidates: Vec<Pose>| {
        candidates.into_iter().find_map(|candidate| match reach(machine, target, candidate, &reference) {
            Ok(pose) => Some(pose),
            Err(reason) => {
                failure = failure.max(reason);
                None
            }
        })
    };
    let near = directions.nearest(&target.direction);
    let found = tried(near.poses.clone())
        .or_else(|| tried(turning::turned(machine, &target.tip, &near.poses, &reference)))
        .or_else(|| near.more.then(|| tried(directions.others(&target.direction))).flatten());
    found.ok_or(if near.beyond_travel { failure.max(Unreachable::Travel) } else { failure })
}

/// The pose within the travel that brings the functional point to a place of the workpiece (from its
/// origin, mm) by the linear axes alone, moved as little as can be; the rotary axes stay as they are.
pub fn place(machine: &Machine, tip: &Vector3<f64>, pose: &[f64]) -> Result<Pose, Unreachable> {
    let placed = linear::complete(machine, tip, pose.to_vec(), pose)?;
    if (tool_pose(machine, &placed).tip - tip).norm() <= PLACE_TOLERANCE { Ok(placed) } else { Err(Unreachable::Place) }
}

/// Completes a candidate by the linear axes, and checks it.
fn reach(machine: &Machine, target: &ToolPose, candidate: Pose, reference: &[f64]) -> Result<Pose, Unreachable> {
    let pose = linear::complete(machine, &target.tip, candidate, reference)?;
    let reached = tool_pose(machine, &pose);
    let near = |a: &Vector3<f64>, b: &Vector3<f64>, tolerance: f64| (a - b).norm() <= tolerance;
    if !near(&reached.direction, &target.direction, DIRECTION_TOLERANCE) {
        return Err(Unreachable::Direction);
    }
    if near(&reached.tip, &target.tip, PLACE_TOLERANCE) { Ok(pose) } else { Err(Unreachable::Place) }
}

/// A position within the travel.
fn held(axis: &Axis, position: f64) -> f64 {
    match axis.travel {
        Travel::Range(min, max) => position.clamp(min, max),
        Travel::Continuous => position,
    }
}
