//! The nominal inverse kinematics: candidates of the rotary axes, completed by the linear axes, and checked.

use super::arm::RotaryArm;
use super::bisection::bisect;
use super::linear;
use super::rotary::RotaryDirections;
use super::sweep::sweep_poses;
use super::tool_pose::{
    DIRECTION_TOLERANCE, Miss, PLACE_TOLERANCE, ToolPose, Unreachable, rest, unturned_tool_pose, within_travel,
};
use crate::machine::{AxisKind, Machine, Pose};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Returns the pose (mm, deg) within the travel at which the nominal machine takes a tool pose; of several the one
/// whose rotary axes, then linear axes, are nearest to `reference` (mm, deg). An axis on which the tool pose does not
/// depend stays at its reference. Fails with what is missing if there is no such pose.
///
/// Robots, whose linear axes do not place the tip, are solved by `Arm`: with finitely many branches at a spin the
/// pose nearest to `reference`, otherwise one with little motion from it.
pub fn inverse(machine: &Machine, target: &ToolPose, reference: &[f64]) -> Result<Pose, Miss> {
    inverse_with(machine, RotaryArm::of(machine).as_ref(), &target.to_unturned(machine), reference)
}

/// Returns what [`inverse()`] does for a machine with this arm, if it is one, and an unturned tool pose.
pub fn inverse_with(
    machine: &Machine,
    arm: Option<&RotaryArm<'_>>,
    target: &ToolPose,
    reference: &[f64],
) -> Result<Pose, Miss> {
    if let Some(arm) = arm.filter(|arm| arm.is_complete()) {
        return arm.inverse(target, reference);
    }
    let placed = by_linear_axes(machine, target, reference);
    placed.or_else(|miss| arm.and_then(|arm| arm.inverse(target, reference).ok()).ok_or(miss))
}

/// Returns the pose of a machine whose linear axes place the tip.
fn by_linear_axes(machine: &Machine, target: &ToolPose, reference: &[f64]) -> Result<Pose, Miss> {
    let axes = machine.axes();
    let reference: Pose =
        axes.iter().enumerate().map(|(i, a)| within_travel(a, reference.get(i).copied().unwrap_or(0.0))).collect();
    let directions = RotaryDirections::new(axes, Vector3::from(machine.tool().direction), &reference);
    let mut failure = Miss::new(Unreachable::Direction);
    let mut tried = |candidates: Vec<Pose>| {
        candidates.into_iter().find_map(|candidate| match reach(machine, target, candidate, &reference) {
            Ok(pose) => Some(pose),
            Err(miss) => {
                failure = miss.or_nearer(failure.clone(), axes);
                None
            }
        })
    };
    let near = directions.nearest(&target.direction);
    let mut found = tried(near.poses.clone());
    let mut exact = !near.more;
    if found.is_none() && !near.sweeps.is_empty() {
        let swept = sweep_poses(machine, &target.tip, &near.sweeps, &reference);
        exact |= swept.exact && near.sweeps.len() == 1 && directions.at_most_two();
        found = tried(swept.arcs).or_else(|| tried(swept.shortfalls));
    }
    if found.is_none() && !exact {
        let (others, sweeps) = directions.others(&target.direction);
        found = tried(others).or_else(|| tried(sweep_poses(machine, &target.tip, &sweeps, &reference).arcs));
    }
    // More linear axes than three share a place in more ways than `linear` tries.
    let mut is_proved = exact && axes.iter().filter(|axis| axis.kind == AxisKind::Linear).count() <= 3;
    if found.is_none() && !is_proved {
        let bisection = bisect(machine, &directions, target, &reference);
        found = tried(directions.around(&target.direction, &bisection.near));
        is_proved = bisection.is_out_of_reach;
    }
    let Some(pose) = found else {
        let turned = near.beyond_travel.map(|pose| {
            let completed = linear::complete(machine, &target.tip, pose.clone(), &reference);
            Miss::travel(completed.unwrap_or_else(|miss| miss.beyond.unwrap_or(pose)))
        });
        let miss = turned.into_iter().fold(failure, |failure, turned| failure.or_nearer(turned, axes));
        return Err(miss.proved(is_proved));
    };
    Ok(pose)
}

/// Returns the poses (mm, deg) of a machine for tool poses in their order, as [`inverse()`] does. The reference is the
/// pose of zeros; for robots without finitely many branches the pose before.
pub fn inverse_all(machine: &Machine, targets: &[ToolPose]) -> Vec<Result<Pose, Miss>> {
    let at_rest = rest(machine);
    let arm = RotaryArm::of(machine);
    let arm = arm.as_ref();
    if arm.is_none_or(RotaryArm::is_complete) {
        return targets
            .par_iter()
            .map(|target| inverse_with(machine, arm, &target.to_unturned(machine), &at_rest))
            .collect();
    }
    let mut before = at_rest;
    let follow = |target: &ToolPose| {
        let found = inverse_with(machine, arm, &target.to_unturned(machine), &before);
        if let Ok(pose) = &found {
            before.clone_from(pose);
        }
        found
    };
    targets.iter().map(follow).collect()
}

/// Returns the poses (mm, deg) of all branches within the travels that take a tool pose with its spin, nearest to the
/// reference first; empty for machines without finitely many branches.
pub fn branches(machine: &Machine, target: &ToolPose, reference: &[f64]) -> Vec<Pose> {
    RotaryArm::of(machine).map_or_else(Vec::new, |arm| arm.all(&target.to_unturned(machine), reference))
}

/// True for robots and other machines whose linear axes do not place the tip: their poses take longer to find.
pub fn rotary_axes_place_tip(machine: &Machine) -> bool {
    RotaryArm::of(machine).is_some()
}

/// Returns the pose (mm, deg) within the travel that brings the functional point to a place of the workpiece (from its
/// origin, mm) by the smallest motion of the linear axes; the rotary axes stay as in `pose`. Fails with what is missing
/// if there is none.
pub fn place(machine: &Machine, tip: &Vector3<f64>, pose: &[f64]) -> Result<Pose, Miss> {
    let tip = machine.workpiece_rotation().map_or(*tip, |rotation| rotation * tip);
    let placed = linear::complete(machine, &tip, pose.to_vec(), pose)?;
    at_place((unturned_tool_pose(machine, &placed).tip - tip).norm())?;
    Ok(placed)
}

/// Fails if the place is off by more than rounding (mm).
fn at_place(off_mm: f64) -> Result<(), Miss> {
    if off_mm <= PLACE_TOLERANCE { Ok(()) } else { Err(Miss::place(off_mm)) }
}

/// Returns a candidate completed by the linear axes, once it has been checked.
pub fn reach(machine: &Machine, target: &ToolPose, candidate: Pose, reference: &[f64]) -> Result<Pose, Miss> {
    let pose = linear::complete(machine, &target.tip, candidate, reference)?;
    let reached = unturned_tool_pose(machine, &pose);
    let held = (reached.direction - target.direction).norm() <= DIRECTION_TOLERANCE;
    if !held {
        return Err(Miss::new(Unreachable::Direction));
    }
    at_place((reached.tip - target.tip).norm())?;
    Ok(pose)
}
