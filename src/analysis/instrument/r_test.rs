//! An R-test, or probing of a ball on the table: rotary axes turn while the linear axes hold the
//! functional point at a ball fixed to the workpiece; the readings are the actual place of the point.

use super::path::PosePath;
use crate::analysis::inverse::{Unreachable, place, tool_pose};
use crate::lower::NominalPose;
use crate::machine::{Machine, Pose};
use crate::standards::range;
use nalgebra::Vector3;

/// Readings of rotary axes that turn together.
#[derive(Debug, Clone, PartialEq)]
pub struct RTest {
    /// Indices of the axes, at least one.
    pub axes: Vec<usize>,
    /// Positions of the first of them, deg.
    pub positions: Vec<f64>,
    /// The poses there (mm, deg).
    pub poses: Vec<Pose>,
    /// Deviation of the functional point from the ball, tool relative to workpiece, minus that at the
    /// first position; directions of the machine frame, um.
    pub readings: Vec<Vector3<f64>>,
    /// Ranges of the three components, um.
    pub range: [f64; 3],
    /// Number of positions that the other axes cannot follow.
    pub skipped: usize,
}

impl RTest {
    /// The axes that turn, such as `C` or `A+C`.
    pub fn name(&self, machine: &Machine) -> String {
        let names: Vec<&str> = self.axes.iter().map(|axis| machine.axes()[*axis].name.as_str()).collect();
        names.join("+")
    }
}

/// Returns the readings of rotary axes at `points` positions, evenly from the beginning to the end of their intervals
/// in the volume, all at once. The ball is at the nominal functional point of the pose `at` (mm, deg). Positions that
/// the linear axes cannot follow are omitted; with fewer than three others the test fails with the reason.
pub fn r_test(machine: &Machine, at: &[f64], axes: &[usize], points: usize) -> Result<RTest, Unreachable> {
    let ball = tool_pose(machine, at).tip;
    let last = points.max(2) - 1;
    let position = |axis: usize, i: usize| {
        let grid = &machine.volume()[axis];
        grid.min + (grid.max - grid.min) * (i as f64 / last as f64)
    };
    let mut failure = Unreachable::Direction;
    let follow = |i: usize| {
        let mut pose = at.to_vec();
        axes.iter().for_each(|axis| pose[*axis] = position(*axis, i));
        place(machine, &ball, &pose).map_err(|miss| failure = miss.why).ok()
    };
    let poses: Vec<Pose> = (0..=last).filter_map(follow).collect();
    if poses.len() < 3 {
        return Err(failure);
    }
    let skipped = last + 1 - poses.len();
    let path = PosePath { poses, closed: false };
    let in_machine = |(d, pose): (Vector3<f64>, &Pose)| NominalPose::at(machine, pose).r_work * d * 1e3;
    let seen: Vec<Vector3<f64>> = path.deviations(machine).into_iter().zip(&path.poses).map(in_machine).collect();
    let readings: Vec<Vector3<f64>> = seen.iter().map(|d| d - seen[0]).collect();
    Ok(RTest {
        positions: path.poses.iter().map(|pose| axes.first().map_or(0.0, |axis| pose[*axis])).collect(),
        axes: axes.to_vec(),
        range: std::array::from_fn(|k| range(readings.iter().map(|d| d[k]))),
        poses: path.poses,
        readings,
        skipped,
    })
}
