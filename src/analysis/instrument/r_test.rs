//! An R-test, or probing of a ball on the table: a rotary axis turns while the other axes hold the
//! functional point at a ball fixed to the workpiece; the readings are the actual place of the point.

use super::path::Path;
use crate::analysis::inverse::{Unreachable, place, tool_pose};
use crate::lower::NominalPose;
use crate::machine::{Machine, Pose};
use crate::standards::range;
use nalgebra::Vector3;

/// Readings of one rotary axis.
#[derive(Debug, Clone, PartialEq)]
pub struct RTest {
    /// Index of the axis.
    pub axis: usize,
    /// Its positions, deg.
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

/// Returns the readings of an axis at `points` positions over its interval in the volume. The ball is at the nominal
/// functional point of the pose `at` (mm, deg). Positions that the linear axes cannot follow are omitted; with fewer
/// than three others the test fails with the reason.
pub fn r_test(machine: &Machine, at: &[f64], axis: usize, points: usize) -> Result<RTest, Unreachable> {
    let ball = tool_pose(machine, at).tip;
    let grid = &machine.volume()[axis];
    let last = points.max(2) - 1;
    let position = |i: usize| grid.min + (grid.max - grid.min) * (i as f64 / last as f64);
    let mut failure = Unreachable::Direction;
    let follow = |i: usize| {
        let mut pose = at.to_vec();
        pose[axis] = position(i);
        place(machine, &ball, &pose).map_err(|miss| failure = miss.why).ok()
    };
    let poses: Vec<Pose> = (0..=last).filter_map(follow).collect();
    if poses.len() < 3 {
        return Err(failure);
    }
    let skipped = last + 1 - poses.len();
    let path = Path { poses, closed: false };
    let in_machine = |(d, pose): (Vector3<f64>, &Pose)| NominalPose::at(machine, pose).r_work * d * 1e3;
    let seen: Vec<Vector3<f64>> = path.driven(machine).into_iter().zip(&path.poses).map(in_machine).collect();
    let readings: Vec<Vector3<f64>> = seen.iter().map(|d| d - seen[0]).collect();
    Ok(RTest {
        axis,
        positions: path.poses.iter().map(|pose| pose[axis]).collect(),
        range: std::array::from_fn(|k| range(readings.iter().map(|d| d[k]))),
        poses: path.poses,
        readings,
        skipped,
    })
}
