//! The nominal inverse kinematics: candidates of the rotary axes, completed by the linear axes, and checked.

use super::rotary::Directions;
use super::tool_pose::{DIRECTION_TOLERANCE, PLACE_TOLERANCE, ToolPose, Unreachable, tool_pose, within_travel};
use super::{linear, turning};
use crate::machine::{Machine, Pose};
use nalgebra::Vector3;

/// Returns the pose (mm, deg) within the travel at which the nominal machine takes a tool pose; of several the one
/// whose rotary axes, then linear axes, are nearest to `reference` (mm, deg). An axis on which the tool pose does not
/// depend stays at its reference. Fails with the reason if there is no such pose.
pub fn inverse(machine: &Machine, target: &ToolPose, reference: &[f64]) -> Result<Pose, Unreachable> {
    let axes = machine.axes();
    let reference: Pose =
        axes.iter().enumerate().map(|(i, a)| within_travel(a, reference.get(i).copied().unwrap_or(0.0))).collect();
    let directions = Directions::new(axes, Vector3::from(machine.tool().direction), &reference);
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

/// Returns the pose (mm, deg) within the travel that brings the functional point to a place of the workpiece (from its
/// origin, mm) by the smallest motion of the linear axes; the rotary axes stay as in `pose`. Fails with the reason if
/// there is none.
pub fn place(machine: &Machine, tip: &Vector3<f64>, pose: &[f64]) -> Result<Pose, Unreachable> {
    let placed = linear::complete(machine, tip, pose.to_vec(), pose)?;
    if (tool_pose(machine, &placed).tip - tip).norm() <= PLACE_TOLERANCE { Ok(placed) } else { Err(Unreachable::Place) }
}

/// Returns a candidate completed by the linear axes, once it has been checked.
fn reach(machine: &Machine, target: &ToolPose, candidate: Pose, reference: &[f64]) -> Result<Pose, Unreachable> {
    let pose = linear::complete(machine, &target.tip, candidate, reference)?;
    let reached = tool_pose(machine, &pose);
    let near = |a: &Vector3<f64>, b: &Vector3<f64>, tolerance: f64| (a - b).norm() <= tolerance;
    if !near(&reached.direction, &target.direction, DIRECTION_TOLERANCE) {
        return Err(Unreachable::Direction);
    }
    if near(&reached.tip, &target.tip, PLACE_TOLERANCE) { Ok(pose) } else { Err(Unreachable::Place) }
}
