//! A shift of the machine zero, for tables that must vanish at the reference position.

use super::figures::{deviations, is_worse};
use crate::algebra::rotation_vector;
use crate::evaluate::{Field, Summary, commanded_deviation};
use crate::lower::NominalPose;
use crate::machine::{AxisKind, Machine, OperatingConditions, OperatingPoint, Pose};
use nalgebra::{DMatrix, DVector, Vector3};
use rayon::prelude::*;

/// Tables that vanish at the reference position leave a constant part of the deviation: a shift of the
/// machine zero takes it away.
#[derive(Debug, Clone, PartialEq)]
pub struct ZeroShift {
    /// The amount to add to the zero of each axis (mm, deg).
    pub shift: Vec<f64>,
    /// Position deviation with the tables and the shift, um.
    pub position_um: Summary,
    /// Position deviation with the best shift alone, without tables, um.
    pub alone_um: Summary,
}

impl ZeroShift {
    /// True if the tables are worth having where the machine zero is set anew in any case.
    pub fn is_better(&self) -> bool {
        !is_worse(self.alone_um.rms, self.position_um.rms)
    }
}

/// A field whose axes' zeros are to be moved, and the motions that its controller adds to commands.
pub(super) struct Shiftable<'a> {
    /// The machine with its tables, or without any.
    pub field: &'a dyn Field,
    /// The motions (mm, deg) at an operating point.
    pub added: &'a (dyn Fn(&OperatingPoint<'_>) -> Vec<f64> + Sync),
}

impl Shiftable<'_> {
    /// Returns the best shift of the axes' zeros (mm, deg) and the residual position deviation (um). A rotary axis is
    /// moved against the mean of its own error; the linear axes then minimise the mean square of the position.
    pub fn best_shift(&self, poses: &[Pose], conditions: OperatingConditions) -> (Vec<f64>, Summary) {
        let machine = self.field.machine();
        let motions: Vec<Vec<AxisMotion>> = poses.par_iter().map(|pose| axis_motions(machine, pose)).collect();
        let rotary = |axis: usize| match machine.axes()[axis].kind {
            AxisKind::Rotary => 0.0 - self.mean_turn(axis, poses, &motions, conditions),
            AxisKind::Linear => 0.0,
        };
        let mut shift: Vec<f64> = (0..machine.axes().len()).map(rotary).collect();
        let moved = |of: &[AxisMotion], shift: &[f64]| -> Vector3<f64> {
            of.iter().zip(shift).map(|(motion, step)| motion.displacement * *step).sum()
        };
        let before = deviations(self.field, poses, conditions);
        let turned: Vec<Vector3<f64>> =
            before.iter().zip(&motions).map(|(d, of)| d.position + moved(of, &shift)).collect();
        let linear: Vec<usize> =
            (0..shift.len()).filter(|axis| machine.axes()[*axis].kind == AxisKind::Linear).collect();
        let steps = least_squares(&linear, &motions, &turned);
        linear.iter().zip(&steps).for_each(|(axis, step)| shift[*axis] = *step);
        let by_linear = |(rest, of): (&Vector3<f64>, &Vec<AxisMotion>)| {
            let steps = linear.iter().zip(&steps);
            rest + steps.map(|(axis, step)| of[*axis].displacement * *step).sum::<Vector3<f64>>()
        };
        let after: Vec<Vector3<f64>> = turned.iter().zip(&motions).map(|both| by_linear(both) * 1e3).collect();
        (shift, Summary::of(&after))
    }

    /// Returns the mean (deg) by which an axis turns too far by its own component errors, corrected as it is.
    fn mean_turn(
        &self,
        axis: usize,
        poses: &[Pose],
        motions: &[Vec<AxisMotion>],
        conditions: OperatingConditions,
    ) -> f64 {
        let machine = self.field.machine();
        let name = &machine.axes()[axis].name;
        let alone = machine.filtered(|id| id.axis == *name && !id.is_location());
        let turn = |(pose, motions): (&Pose, &Vec<AxisMotion>)| {
            let mut command = pose.clone();
            command[axis] += (self.added)(&conditions.at_pose(pose))[axis];
            let rotation = commanded_deviation(&alone, pose, &conditions.at_pose(&command)).rotation;
            rotation.dot(&motions[axis].direction).to_degrees()
        };
        let turns: Vec<f64> = poses.par_iter().zip(motions).map(turn).collect();
        turns.iter().sum::<f64>() / poses.len().max(1) as f64
    }
}

/// Motion of the nominal tool by one axis, unturned workpiece frame.
struct AxisMotion {
    /// Displacement of the functional point, mm for each mm or deg.
    displacement: Vector3<f64>,
    /// The direction that the axis turns about; zero of a linear axis.
    direction: Vector3<f64>,
}

/// Returns the motions by all axes at a pose, by central differences.
fn axis_motions(machine: &Machine, pose: &[f64]) -> Vec<AxisMotion> {
    // A linear axis loses nothing by a long step; for a turn, the third power of a milliradian is neglected.
    const STEPS: (f64, f64) = (1.0, 0.05);
    let motion = |axis: usize| {
        let step = if machine.axes()[axis].kind == AxisKind::Linear { STEPS.0 } else { STEPS.1 };
        let at = |by: f64| {
            let mut pose = pose.to_vec();
            pose[axis] += by;
            NominalPose::at(machine, &pose).pose
        };
        let (back, ahead) = (at(-step), at(step));
        let turn = rotation_vector(&(ahead.linear * back.linear.transpose()));
        AxisMotion {
            displacement: (ahead.translation - back.translation) / (2.0 * step),
            direction: turn.try_normalize(1e-9).unwrap_or_else(Vector3::zeros),
        }
    };
    (0..pose.len()).map(motion).collect()
}

/// Returns the steps of axes (mm), the same at all poses, that minimise the mean square of positions (mm).
fn least_squares(axes: &[usize], motions: &[Vec<AxisMotion>], positions: &[Vector3<f64>]) -> Vec<f64> {
    // Axes that move the tool alike share a step.
    const RIDGE: f64 = 1e-12;
    let count = positions.len().max(1) as f64;
    let mut gram = DMatrix::<f64>::identity(axes.len(), axes.len()) * (RIDGE * count);
    let mut right = DVector::<f64>::zeros(axes.len());
    for (of, position) in motions.iter().zip(positions) {
        for (row, i) in axes.iter().enumerate() {
            right[row] -= of[*i].displacement.dot(position);
            axes.iter().enumerate().for_each(|(c, j)| gram[(row, c)] += of[*i].displacement.dot(&of[*j].displacement));
        }
    }
    gram.cholesky().map_or_else(|| vec![0.0; axes.len()], |factor| factor.solve(&right).iter().copied().collect())
}
