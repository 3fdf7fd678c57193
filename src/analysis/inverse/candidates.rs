//! All candidates of a tool pose: what a path chooses from, row by row.
//!
//! With two rotary axes or fewer these are all solutions. Continua are represented by finitely many values:
//!
//! - of a free axis, or two parallel axes against each other: ends and middles of the arcs in reach, and the value at
//!   the reference; [`CandidateSearch::carried`] gives the pose that keeps the value of another row;
//! - of more than two rotary axes: every pair is solved with the others held, at the reference and at positions spread
//!   over their travels, the same for all rows;
//! - parallel linear axes share the motion from the reference, as for single poses;
//! - of an arm with an open spin: all branches at equal steps of the spin.

use super::arm::RotaryArm;
use super::nominal::{inverse_with, reach};
use super::rotary::{RotaryDirections, Sweep, nearness, wrapped};
use super::sweep::sweep_poses;
use super::tool_pose::{Miss, ToolPose, rest};
use crate::machine::{Axis, AxisKind, Machine, Pose, Travel};
use nalgebra::Vector3;

/// Maximum number of candidates of a tool pose: those nearest to the reference.
const MAX_CANDIDATES: usize = 200;

/// Travels over more turns count as endless: their turns are chosen afterwards.
const MAX_TURNS: f64 = 10.0;

/// Positions at which rotary axes beyond two are held, the reference among them.
const HELD: u64 = 9;

/// Candidates that differ by less (mm, deg) are one.
const SAME: f64 = 1e-9;

/// Candidates of one tool pose.
pub struct RowCandidates {
    /// Poses (mm, deg) within the travels, nearest to the reference first; at least one.
    pub poses: Vec<Pose>,
    /// The sweeps through them that keep the direction.
    pub sweeps: Vec<Sweep>,
}

/// The search for candidates on one machine; the reference is the pose of zeros.
pub struct CandidateSearch<'a> {
    machine: &'a Machine,
    arm: Option<RotaryArm<'a>>,
    directions: RotaryDirections,
    at_rest: Pose,
}

/// True for a rotary axis whose positions count but for whole turns: it is endless, or nearly so.
pub fn is_wound(axis: &Axis) -> bool {
    axis.kind == AxisKind::Rotary
        && match axis.travel {
            Travel::Continuous => true,
            Travel::Range(min, max) => max - min > 360.0 * MAX_TURNS,
        }
}

impl<'a> CandidateSearch<'a> {
    /// Prepares the search.
    pub fn new(machine: &'a Machine) -> Self {
        let at_rest = rest(machine);
        let directions = RotaryDirections::new(machine.axes(), Vector3::from(machine.tool().direction), &at_rest);
        Self { machine, arm: RotaryArm::of(machine), directions, at_rest }
    }

    /// True if poses can only be followed from one another: an arm without finitely many branches.
    pub fn only_follows(&self) -> bool {
        self.arm.as_ref().is_some_and(|arm| !arm.is_complete())
    }

    /// True if rotary axes place the tip.
    pub fn is_arm(&self) -> bool {
        self.arm.is_some()
    }

    /// Returns the candidates of a tool pose (unturned workpiece frame). Fails with what is missing, as the search for
    /// a single pose does.
    pub fn of(&self, target: &ToolPose) -> Result<RowCandidates, Miss> {
        let (mut poses, sweeps) = match &self.arm {
            Some(arm) => (arm.candidates(target, &self.at_rest), Vec::new()),
            None => self.by_linear_axes(target),
        };
        if poses.is_empty() {
            poses.push(inverse_with(self.machine, self.arm.as_ref(), target, &self.at_rest)?);
        }
        for axis in (0..self.at_rest.len()).filter(|i| self.machine.axes()[*i].kind == AxisKind::Rotary) {
            poses = poses.into_iter().flat_map(|pose| self.turns(axis, pose)).collect();
        }
        let key = |pose: &Pose| nearness(pose.iter().copied().zip(self.at_rest.iter().copied()));
        poses.sort_by_cached_key(key);
        poses.dedup_by(|a, b| is_same(a, b));
        poses.truncate(MAX_CANDIDATES);
        Ok(RowCandidates { poses, sweeps })
    }

    fn by_linear_axes(&self, target: &ToolPose) -> (Vec<Pose>, Vec<Sweep>) {
        let held = self.directions.held(&target.direction, HELD);
        let sweeps = if self.directions.at_most_two() { held.sweeps } else { Vec::new() };
        let arcs = sweep_poses(self.machine, &target.tip, &sweeps, &self.at_rest).arcs;
        let all = held.poses.into_iter().chain(arcs);
        (all.filter_map(|pose| self.completed(target, pose)).collect(), sweeps)
    }

    /// Returns a pose whose rotary axes point the tool in the direction, completed by the linear axes; `None` if they
    /// cannot.
    pub fn completed(&self, target: &ToolPose, pose: Pose) -> Option<Pose> {
        reach(self.machine, target, pose, &self.at_rest).ok()
    }

    /// Returns the poses of sweeps at which the first axis that turns stands as in another pose (mm, deg).
    pub fn carried<'s>(
        &'s self,
        target: &'s ToolPose,
        sweeps: &'s [Sweep],
        other: &'s [f64],
    ) -> impl Iterator<Item = Pose> + 's {
        let at = move |sweep: &Sweep| {
            let (first, rate) = *sweep.rates.first()?;
            let by = (other[first] - sweep.pose[first]) / rate;
            let mut pose = sweep.pose.clone();
            for (axis, rate) in &sweep.rates {
                let position = (pose[*axis] + rate * by).to_radians();
                pose[*axis] = wrapped(self.machine.axes()[*axis].travel, other[*axis], position)?;
            }
            pose[first] = other[first];
            self.completed(target, pose)
        };
        sweeps.iter().filter_map(at)
    }

    /// Returns a pose with one axis at all whole turns within its travel.
    fn turns(&self, axis: usize, pose: Pose) -> Vec<Pose> {
        let Travel::Range(min, max) = self.machine.axes()[axis].travel else { return vec![pose] };
        if is_wound(&self.machine.axes()[axis]) {
            return vec![pose];
        }
        let [first, last] = [((min - pose[axis]) / 360.0).ceil(), ((max - pose[axis]) / 360.0).floor()];
        let at = |turn: i32| {
            let mut pose = pose.clone();
            pose[axis] += 360.0 * f64::from(turn);
            pose
        };
        (first as i32..=last as i32).map(at).collect()
    }
}

/// True for poses that differ by rounding alone.
pub fn is_same(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < SAME)
}
