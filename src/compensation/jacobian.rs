//! First-order motion of the nominal machine, and the one place where a deviation becomes a correction.

use super::scope::{Correction, Goal, Scope};
use crate::evaluate::Deviation;
use crate::lower::Chain;
use crate::machine::{AxisKind, Machine};
use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

/// The correction that takes a deviation away: **the only place where the sign changes**.
pub(super) fn against(deviation: &Deviation) -> ToolCorrection {
    ToolCorrection { displacement: -deviation.position, rotation: -deviation.rotation }
}

/// Motion of the tool that takes a deviation away.
#[derive(Debug, Clone, Copy)]
pub(super) struct ToolCorrection {
    /// Displacement of the functional point, mm.
    pub displacement: Vector3<f64>,
    /// Rotation of the tool, rad.
    pub rotation: Vector3<f64>,
}

/// Motion of the tool by each axis at a pose of the nominal machine, unturned workpiece frame.
#[derive(Debug, Clone)]
pub struct Jacobian {
    kinds: Vec<AxisKind>,
    /// Displacement of the functional point per mm or per rad.
    displacement: Vec<Vector3<f64>>,
    /// Rotation per rad, in the two directions across the tool axis; zero for linear axes.
    tilt: Vec<Vector2<f64>>,
    /// The two directions across the tool axis.
    across: [Vector3<f64>; 2],
}

impl Jacobian {
    /// At a pose (mm, deg).
    pub fn at(machine: &Machine, pose: &[f64]) -> Self {
        let chain = Chain::<f64>::nominal(machine, pose);
        let t_wt = chain.t_wt();
        let tip = t_wt.apply(&machine.tool().tip);
        let across = across(&(t_wt.linear * Vector3::from(machine.tool().direction)));
        let mut prefix = crate::algebra::Htm::identity();
        let mut columns = Vec::with_capacity(pose.len());
        for (axis, joint) in machine.axes().iter().zip(&chain.joints) {
            let direction = prefix.linear * Vector3::from(axis.direction) * axis.sign();
            columns.push(match axis.kind {
                AxisKind::Linear => (direction, Vector2::zeros()),
                AxisKind::Rotary => {
                    let arm = tip - prefix.apply(&axis.origin);
                    (direction.cross(&arm), Vector2::new(direction.dot(&across[0]), direction.dot(&across[1])))
                }
            });
            prefix = prefix.compose(joint);
        }
        let (displacement, tilt) = columns.into_iter().unzip();
        Self { kinds: machine.axes().iter().map(|axis| axis.kind).collect(), displacement, tilt, across }
    }

    /// Returns the correction that removes a deviation, to first order: a step from `so_far`, the correction of the
    /// rotary axes up to here.
    pub fn correction(&self, deviation: &Deviation, so_far: &Correction, scope: Scope) -> Correction {
        let mut step = vec![0.0; self.kinds.len()];
        let ToolCorrection { displacement: mut wanted, rotation } = against(deviation);
        let turns = match scope.goal {
            _ if !scope.rotary => Vec::new(),
            Goal::Pose => {
                let tilt = Vector2::new(rotation.dot(&self.across[0]), rotation.dot(&self.across[1]));
                self.turning_step(tilt, so_far, scope.damping)
            }
            Goal::Position => self.reaching_step(wanted, so_far),
        };
        for (axis, angle) in turns {
            wanted -= self.displacement[axis] * angle;
            step[axis] = angle.to_degrees();
        }
        for (axis, travel) in self.linear_step(wanted) {
            step[axis] = travel;
        }
        Correction(step)
    }

    /// Displacement of the functional point (mm, unturned workpiece frame) by a small motion of the axes.
    pub fn displacement(&self, motion: &Correction) -> Vector3<f64> {
        let part = |((kind, column), travel): ((&AxisKind, &Vector3<f64>), &f64)| match kind {
            AxisKind::Linear => column * *travel,
            AxisKind::Rotary => column * travel.to_radians(),
        };
        self.kinds.iter().zip(&self.displacement).zip(&motion.0).map(part).sum()
    }

    fn axes(&self, kind: AxisKind) -> impl Iterator<Item = usize> {
        self.kinds.iter().enumerate().filter(move |(_, k)| **k == kind).map(|(i, _)| i)
    }

    /// Damped least squares `min |J x - tilt|^2 + l^2 |x + so_far|^2`: near a singular pose (tool
    /// parallel to the last rotary axis) the damping l grows from 0 to the threshold and bounds x.
    fn turning_step(&self, tilt: Vector2<f64>, so_far: &Correction, threshold: f64) -> Vec<(usize, f64)> {
        let axes: Vec<usize> = self.axes(AxisKind::Rotary).collect();
        let gram: Matrix2<f64> = axes.iter().map(|i| self.tilt[*i] * self.tilt[*i].transpose()).sum();
        let square = damping(&gram, axes.len(), threshold);
        // x + so_far = J^T (J J^T + l^2)^-1 (tilt + J so_far): a 2x2 system however many axes there are.
        let total = |i: usize| so_far.0[i].to_radians();
        let goal: Vector2<f64> = tilt + axes.iter().map(|i| self.tilt[*i] * total(*i)).sum::<Vector2<f64>>();
        let damped = gram + Matrix2::identity() * (square + f64::EPSILON);
        let weights = solve2(&damped, &goal);
        axes.iter().map(|i| (*i, self.tilt[*i].dot(&weights) - total(*i))).collect()
    }

    /// Rotary motion towards where the linear axes cannot go (a lathe with C for a third axis).
    fn reaching_step(&self, wanted: Vector3<f64>, so_far: &Correction) -> Vec<(usize, f64)> {
        // mm per rad: far below any lever arm that is worth turning about.
        const SHORTEST_ARM: f64 = 0.1;
        let beyond = |v: Vector3<f64>| {
            v - self.linear_step(v).iter().map(|(i, travel)| self.displacement[*i] * *travel).sum::<Vector3<f64>>()
        };
        let axes: Vec<(usize, Vector3<f64>)> =
            self.axes(AxisKind::Rotary).map(|i| (i, beyond(self.displacement[i]))).collect();
        let total = |i: usize| so_far.0[i].to_radians();
        let goal: Vector3<f64> = beyond(wanted) + axes.iter().map(|(i, arm)| arm * total(*i)).sum::<Vector3<f64>>();
        let gram: Matrix3<f64> = axes.iter().map(|(_, arm)| arm * arm.transpose()).sum();
        let damped = gram + Matrix3::identity() * (SHORTEST_ARM * SHORTEST_ARM);
        let weights = damped.cholesky().map_or_else(Vector3::zeros, |c| c.solve(&goal));
        axes.iter().map(|(i, arm)| (*i, arm.dot(&weights) - total(*i))).collect()
    }

    /// Shortest motion of the linear axes that moves the functional point as wanted, as far as they can.
    fn linear_step(&self, wanted: Vector3<f64>) -> Vec<(usize, f64)> {
        let axes: Vec<usize> = self.axes(AxisKind::Linear).collect();
        let gram: Matrix3<f64> = axes.iter().map(|i| self.displacement[*i] * self.displacement[*i].transpose()).sum();
        // Directions no linear axis can move in get a vanishing weight instead of a division by zero.
        let regular = gram + Matrix3::identity() * 1e-12;
        let weights = regular.cholesky().map_or_else(Vector3::zeros, |c| c.solve(&wanted));
        axes.iter().map(|i| (*i, self.displacement[*i].dot(&weights))).collect()
    }
}

/// Square of the damping: 0 while the weakest direction is above the threshold.
fn damping(gram: &Matrix2<f64>, axes: usize, threshold: f64) -> f64 {
    let half_trace = 0.5 * gram.trace();
    let spread = libm::sqrt((half_trace * half_trace - gram.determinant()).max(0.0));
    let weakest = if axes < 2 { half_trace + spread } else { half_trace - spread };
    let ratio = (weakest.max(0.0) / (threshold * threshold)).min(1.0);
    threshold * threshold * (1.0 - ratio)
}

fn solve2(m: &Matrix2<f64>, right: &Vector2<f64>) -> Vector2<f64> {
    m.try_inverse().map_or_else(Vector2::zeros, |inverse| inverse * right)
}

/// Two unit vectors across a direction, chosen without a branch that could flip between poses nearby.
fn across(direction: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let sign = if direction.z < 0.0 { -1.0 } else { 1.0 };
    let a = -1.0 / (sign + direction.z);
    let b = direction.x * direction.y * a;
    [
        Vector3::new(1.0 + sign * direction.x * direction.x * a, sign * b, -sign * direction.x),
        Vector3::new(b, sign + direction.y * direction.y * a, -direction.y),
    ]
}
