//! The step from one row of a path to the next: its motion, and whether the tool stays on the path.
//!
//! A step is a rewind if the tool has to leave the path. Between the rows the rotary axes move in proportion; at equal
//! parts of the step, at most [`PIECE_DEG`] of an axis long, the direction of the tool must not be further from that
//! of either row than the rows are from each other, and the linear axes must be able to follow the tip. An axis
//! that is free at one of the rows may turn there, before or after the step.

use crate::analysis::inverse::{
    CandidateSearch, RotaryDirections, ToolPose, attitude, complete, is_wound, rest, unturned_tool_pose,
};
use crate::lower::NominalPose;
use crate::machine::{AxisKind, Machine, Pose};
use nalgebra::Vector3;

/// Longest part of a step between two checks, deg.
const PIECE_DEG: f64 = 30.0;

/// Direction by which the tool may leave the path in any case, rad.
const OFF_RAD: f64 = 1e-5;

/// Distance by which the tip of an arm may leave the path in any case, mm.
const OFF_MM: f64 = 1e-3;

/// An axis whose direction is nearer to the tool axis than this (rad) is free.
const FREE_RAD: f64 = 1e-9;

/// Unit of motions, mm or deg: sums of whole numbers are the same in any order.
const MOTION_UNIT: f64 = 1e-6;

/// A row of a path with a pose that takes it.
#[derive(Debug, Clone, Copy)]
pub struct PathPose<'a> {
    /// The tool pose, unturned workpiece frame.
    pub target: &'a ToolPose,
    /// The pose, mm and deg.
    pub pose: &'a [f64],
    /// The axis that is free there.
    pub free: Option<usize>,
}

/// A row with the pose that is chosen for it.
#[derive(Debug, Clone)]
pub struct ChosenPose {
    /// Index of the row.
    pub row: usize,
    /// The tool pose, unturned workpiece frame.
    pub target: ToolPose,
    /// The pose, mm and deg.
    pub pose: Pose,
    /// The axis that is free there.
    pub free: Option<usize>,
}

/// The rules of steps on a machine.
pub struct Steps<'a> {
    machine: &'a Machine,
    directions: RotaryDirections,
    at_rest: Pose,
    /// Axis by axis, true for rotary ones.
    turns: Vec<bool>,
    /// Axis by axis, true for those that count but for whole turns.
    wound: Vec<bool>,
    is_arm: bool,
}

impl<'a> Steps<'a> {
    /// Returns the rules. Wound axes take the shorter way if `wrap` is set.
    pub fn new(machine: &'a Machine, search: &CandidateSearch<'a>, wrap: bool) -> Self {
        let at_rest = rest(machine);
        let directions = RotaryDirections::new(machine.axes(), Vector3::from(machine.tool().direction), &at_rest);
        let turns = machine.axes().iter().map(|axis| axis.kind == AxisKind::Rotary).collect();
        let wound = machine.axes().iter().map(|axis| wrap && is_wound(axis)).collect();
        Self { machine, directions, at_rest, turns, wound, is_arm: search.is_arm() }
    }

    /// Returns the motion of an axis (mm, deg) from one pose to another.
    pub fn by(&self, axis: usize, from: &[f64], to: &[f64]) -> f64 {
        let by = to[axis] - from[axis];
        if self.wound[axis] { by - 360.0 * (by / 360.0).round() } else { by }
    }

    /// Returns the motion of all axes but one, in millionths of a mm or deg.
    pub fn motion(&self, from: &[f64], to: &[f64], but: Option<usize>) -> u64 {
        let units = |axis: usize| (self.by(axis, from, to).abs() / MOTION_UNIT).round() as u64;
        (0..from.len()).filter(|axis| Some(*axis) != but).map(units).sum()
    }

    /// Returns the rotary axis that turns about the tool axis at a pose (mm, deg), if one does.
    pub fn free_axis(&self, pose: &[f64]) -> Option<usize> {
        if self.is_arm {
            return None;
        }
        let tool = self.directions.direction(pose);
        let axes = self.directions.turned_axes(pose);
        axes.into_iter().find(|(_, w)| w.cross(&tool).norm() < FREE_RAD).map(|(axis, _)| axis)
    }

    /// Returns the axis that is free at all poses, if one is.
    pub fn always_free(&self) -> Option<usize> {
        let pose: Pose = self.at_rest.iter().enumerate().map(|(k, q)| q + 37.0 + 11.0 * k as f64).collect();
        self.free_axis(&pose)
    }

    /// Returns the rotary axes by index, each with the angle (rad) between its line and the nearest direction of the
    /// tool on the shortest way from one row to another; none of an arm, whose poles are others.
    pub fn tilts(&self, from: &[f64], to: &[f64]) -> Vec<(usize, f64)> {
        if self.is_arm {
            return Vec::new();
        }
        let [a, b] = [from, to].map(|pose| self.directions.direction(pose));
        let ends = self.directions.turned_axes(from).into_iter().zip(self.directions.turned_axes(to));
        let tilt = |((axis, w), (_, w_to)): ((usize, Vector3<f64>), (usize, Vector3<f64>))| {
            (axis, arc_tilt(&a, &b, &w).min(tilt(&b, &w_to)))
        };
        ends.map(tilt).collect()
    }

    /// True if the tool stays on the path from one row to the next.
    pub fn is_continuous(&self, from: &PathPose<'_>, to: &PathPose<'_>) -> bool {
        if from.free == to.free {
            return self.follows(from, to);
        }
        if let Some(axis) = from.free {
            let mut turned = from.pose.to_vec();
            turned[axis] += self.by(axis, from.pose, to.pose);
            let between = PathPose { pose: &turned, ..*from };
            return self.follows(from, &between) && self.follows(&between, to);
        }
        let Some(axis) = to.free else { return self.follows(from, to) };
        let mut turned = to.pose.to_vec();
        turned[axis] = from.pose[axis];
        let between = PathPose { pose: &turned, ..*to };
        self.follows(from, &between) && self.follows(&between, to)
    }

    fn follows(&self, from: &PathPose<'_>, to: &PathPose<'_>) -> bool {
        let axes = 0..from.pose.len();
        let by: Vec<f64> = axes.map(|axis| self.by(axis, from.pose, to.pose)).collect();
        let most = by.iter().zip(&self.turns).filter(|(_, turns)| **turns).map(|(by, _)| by.abs()).fold(0.0, f64::max);
        if most < MOTION_UNIT {
            return true;
        }
        let pieces = (most / PIECE_DEG).ceil().max(2.0);
        let far = (from.target.direction - to.target.direction).norm() + OFF_RAD;
        let is_on = |k: i32| {
            let part = f64::from(k) / pieces;
            let pose: Pose = from.pose.iter().zip(&by).map(|(q, by)| q + part * by).collect();
            let direction = self.directions.direction(&pose);
            let turned = [from, to].iter().all(|end| (direction - end.target.direction).norm() <= far);
            turned && self.is_placed(from, to, part, pose, most > PIECE_DEG)
        };
        (1..pieces as i32).all(is_on)
    }

    /// True if the tip can follow at a part of a step.
    fn is_placed(&self, from: &PathPose<'_>, to: &PathPose<'_>, part: f64, pose: Pose, is_long: bool) -> bool {
        if self.is_arm {
            return self.is_near(from, to, &pose);
        }
        let tip = from.target.tip + (to.target.tip - from.target.tip) * part;
        !is_long || complete(self.machine, &tip, pose, &self.at_rest).is_ok()
    }

    /// True if an arm holds the tip, and the attitude of a tool whose spin is given, no further from either row than
    /// the rows are from each other.
    fn is_near(&self, from: &PathPose<'_>, to: &PathPose<'_>, pose: &[f64]) -> bool {
        let far = (from.target.tip - to.target.tip).norm() + OFF_MM;
        let tip = unturned_tool_pose(self.machine, pose).tip;
        let near = [from, to].iter().all(|end| (tip - end.target.tip).norm() <= far);
        let tool = Vector3::from(self.machine.tool().direction);
        let held = |end: &PathPose<'_>| end.target.spin_rad.map(|spin| attitude(&tool, &end.target.direction, spin));
        let (Some(a), Some(b)) = (held(from), held(to)) else { return near };
        let at = NominalPose::at(self.machine, pose).pose.linear;
        let far = (a - b).norm() + OFF_RAD;
        near && (at - a).norm() <= far && (at - b).norm() <= far
    }
}

/// Returns the angle (rad, to 90 deg) between a direction and a line.
fn tilt(direction: &Vector3<f64>, line: &Vector3<f64>) -> f64 {
    libm::atan2(direction.cross(line).norm(), direction.dot(line).abs())
}

/// Returns the least angle (rad) between a line and the directions of the shortest arc from a to b.
fn arc_tilt(a: &Vector3<f64>, b: &Vector3<f64>, line: &Vector3<f64>) -> f64 {
    let ends = tilt(a, line).min(tilt(b, line));
    let normal = a.cross(b);
    if normal.norm() < FREE_RAD {
        return ends;
    }
    let normal = normal.normalize();
    let foot = line - normal * line.dot(&normal);
    let within = |foot: &Vector3<f64>| a.cross(foot).dot(&normal) >= 0.0 && foot.cross(b).dot(&normal) >= 0.0;
    if within(&foot) || within(&-foot) { libm::asin(line.dot(&normal).abs().min(1.0)).min(ends) } else { ends }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_is_nearest_to_a_line_between_its_ends() {
        let at = |x: f64, y: f64| Vector3::new(x, y, 1.0).normalize();
        // The arc passes the Z axis at y = 0.1.
        let nearest = arc_tilt(&at(-1.0, 0.1), &at(1.0, 0.1), &Vector3::z());
        assert!((nearest - libm::atan(0.1)).abs() < 1e-12, "{nearest}");
        // Both ends on one side: the nearer end.
        let nearest = arc_tilt(&at(0.5, 0.0), &at(1.0, 0.3), &-Vector3::z());
        assert!((nearest - libm::atan(0.5)).abs() < 1e-12, "{nearest}");
    }
}
