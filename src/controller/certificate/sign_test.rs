//! The pose at which the sign of a set is best tested.

use super::figures::approaches;
use crate::compensation::{CorrectionTable, CorrectionTables};
use crate::machine::{Approach, Axis, AxisKind, Machine, OperatingPoint, Pose};

/// The pose where the sign is best tested: the largest motion of a linear axis (of any axis if there is none).
#[derive(Debug, Clone, PartialEq)]
pub struct Strongest {
    /// Index of the axis that is moved.
    pub axis: usize,
    /// The pose (mm, deg).
    pub at: Pose,
    /// The side of approach.
    pub approach: Approach,
    /// The motion that all files together add there (mm or deg).
    pub value: f64,
}

/// A motion below this (mm, deg) is rounding: a kinematics module computes where a table has zeros.
const ROUNDING: f64 = 1e-10;

/// Returns the largest motion over poses and directions of approach.
pub(super) fn strongest_of(
    machine: &Machine,
    poses: &[Pose],
    approaches: &[Approach],
    added: impl Fn(&OperatingPoint<'_>) -> Vec<f64>,
) -> Option<Strongest> {
    let linear = |axis: usize| machine.axes()[axis].kind == AxisKind::Linear;
    // Of equal ones the last is taken: one that is approached forward.
    let approaches = approaches.iter().rev();
    let entries =
        approaches.flat_map(|approach| poses.iter().map(|pose| (*approach, pose))).flat_map(|(approach, at)| {
            let values =
                added(&approach.at_pose(at)).into_iter().enumerate().filter(|(_, value)| value.abs() > ROUNDING);
            values.map(|(axis, value)| Strongest { axis, at: at.clone(), approach, value }).collect::<Vec<_>>()
        });
    let order = |s: &Strongest| (linear(s.axis), s.value.abs());
    entries.max_by(|a, b| order(a).0.cmp(&order(b).0).then(order(a).1.total_cmp(&order(b).1)))
}

/// Returns the largest motion that is not in tables: with the rotary axes at 0, where an instrument along a linear axis
/// reads it, or elsewhere if there is none.
pub(crate) fn strongest_at(
    machine: &Machine,
    poses: &[Pose],
    approaches: &[Approach],
    added: impl Fn(&OperatingPoint<'_>) -> Vec<f64>,
) -> Option<Strongest> {
    let linear = |axis: usize| machine.axes()[axis].kind == AxisKind::Linear;
    let level = |pose: &Pose| -> Pose {
        pose.iter().enumerate().map(|(axis, q)| if linear(axis) { *q } else { 0.0 }).collect()
    };
    let within = |pose: &Pose| machine.beyond_travel(pose).next().is_none();
    let with_linear = |found: &Strongest| linear(found.axis);
    let leveled: Vec<Pose> = poses.iter().map(level).filter(within).collect();
    let found = strongest_of(machine, &leveled, approaches, &added).filter(with_linear);
    found.or_else(|| strongest_of(machine, poses, approaches, &added))
}

/// Some axes at positions, the others at 0, or as near to them as they come: tables may reach beyond the travel.
fn pose_at(machine: &Machine, at: &[(usize, f64)]) -> Pose {
    let near = |(i, axis): (usize, &Axis)| {
        let wanted = at.iter().find(|(axis, _)| *axis == i).map_or(0.0, |(_, q)| *q);
        let (min, max) = axis.travel.interval();
        wanted.max(min).min(max)
    };
    machine.axes().iter().enumerate().map(near).collect()
}

/// Returns the poses at which each table has its largest correction, within the travels.
fn peaks(machine: &Machine, tables: &CorrectionTables) -> Vec<Pose> {
    let peak = |table: &CorrectionTable| {
        let width = table.corrected.len();
        let values = table.values.iter().chain(table.reverse.iter().flatten());
        let (at, _) = values.enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let node = table.node(at % table.values.len() / width);
        Some(pose_at(machine, &table.axes.iter().copied().zip(node).collect::<Vec<_>>()))
    };
    tables.tables.iter().filter_map(peak).collect()
}

/// Returns the best test of a set of tables; of error curves one at the poses given.
pub(super) fn strongest(
    machine: &Machine,
    tables: &CorrectionTables,
    poses: &[Pose],
    added: impl Fn(&OperatingPoint<'_>) -> Vec<f64>,
) -> Option<Strongest> {
    if tables.errors.is_empty() {
        strongest_of(machine, &peaks(machine, tables), approaches(machine), added)
    } else {
        strongest_at(machine, poses, approaches(machine), added)
    }
}
