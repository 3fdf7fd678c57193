//! An R-test, or probing of a ball on the table: rotary axes turn while the linear axes hold the
//! functional point at a ball fixed to the workpiece; the readings are the actual place of the point.

use super::bounded::DrivenPath;
use super::path::PosePath;
use crate::analysis::inverse::{Unreachable, place, tool_pose};
use crate::lower::NominalPose;
use crate::machine::{AxisPositions, Machine, Pose, axis_positions};
use crate::standards::range;
use nalgebra::Vector3;

/// An R-test of rotary axes that turn together.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct RTest {
    /// The axes that turn, such as `C` or `A+C`.
    pub axis: String,
    /// Ranges of the readings along x, y, z, um.
    pub range_um: [f64; 3],
    /// Number of readings.
    pub count: usize,
    /// Number of positions that the other axes cannot follow.
    pub skipped: usize,
    /// The readings.
    pub readings: Vec<RTestReading>,
}

/// A reading of an R-test.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct RTestReading {
    /// Position of the first axis that turns, deg.
    pub position_deg: f64,
    /// The pose, mm and deg.
    pub axes: AxisPositions,
    /// Deviation of the functional point from the ball, tool relative to workpiece, minus that at the first position,
    /// um, machine frame.
    pub reading_um: [f64; 3],
}

/// Returns the readings of rotary axes at `points` positions, evenly from the beginning to the end of their intervals
/// in the volume, all at once. The ball is at the nominal functional point of the pose `at` (mm, deg). Positions that
/// the linear axes cannot follow are omitted; with fewer than three others the test fails with the reason.
pub fn r_test(machine: &Machine, at: &[f64], axes: &[usize], points: usize) -> Result<RTest, Unreachable> {
    let (poses, skipped) = turn(machine, at, axes, points)?;
    let path = PosePath { poses, closed: false };
    let in_machine = |(d, pose): (Vector3<f64>, &Pose)| NominalPose::at(machine, pose).r_work * d * 1e3;
    let seen: Vec<Vector3<f64>> = path.deviations(machine).into_iter().zip(&path.poses).map(in_machine).collect();
    let reading = |(pose, d): (&Pose, &Vector3<f64>)| RTestReading {
        position_deg: axes.first().map_or(0.0, |axis| pose[*axis]),
        axes: axis_positions(machine, pose),
        // Never -0.
        reading_um: (d - seen[0]).map(|x| x + 0.0).into(),
    };
    let readings: Vec<RTestReading> = path.poses.iter().zip(&seen).map(reading).collect();
    Ok(RTest {
        axis: joined(machine, axes),
        range_um: std::array::from_fn(|k| range(readings.iter().map(|reading| reading.reading_um[k]))),
        count: readings.len(),
        skipped,
        readings,
    })
}

/// Returns the turn of [`r_test`] with its ranges along x, y, z.
pub fn turn_path<'a>(
    machine: &Machine,
    at: &[f64],
    axes: &[usize],
    points: usize,
) -> Result<DrivenPath<'a>, Unreachable> {
    let (poses, _) = turn(machine, at, axes, points)?;
    let turns: Vec<_> = poses.iter().map(|pose| NominalPose::at(machine, pose).r_work).collect();
    let readings = move |deviations: &[Vector3<f64>]| {
        let seen: Vec<Vector3<f64>> = deviations.iter().zip(&turns).map(|(d, turn)| turn * d).collect();
        (0..3).map(|k| range(seen.iter().map(|d| d[k]))).collect()
    };
    let name = joined(machine, axes);
    let names = ["X", "Y", "Z"].map(|letter| format!("{name} {letter}")).to_vec();
    Ok(DrivenPath { names, poses, readings: Box::new(readings) })
}

fn joined(machine: &Machine, axes: &[usize]) -> String {
    axes.iter().map(|axis| machine.axes()[*axis].name.as_str()).collect::<Vec<_>>().join("+")
}

/// Returns the poses of a turn, with the number of those that are left out.
fn turn(machine: &Machine, at: &[f64], axes: &[usize], points: usize) -> Result<(Vec<Pose>, usize), Unreachable> {
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
    Ok((poses, skipped))
}
