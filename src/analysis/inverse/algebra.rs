//! Inverse kinematics of the actual machine over an algebra: the displacements of the axes that bring the
//! functional point and the tool axis to those of the nominal machine at a pose.
//!
//! The displacements are elements: their coefficient of a monomial is the correction of an interaction of errors.
//! Newton's iteration starts from the real solution and is exact after ceil(log2(n + 1)) steps. The errors are those at
//! the pose: their change along the displacement, of second order, is not followed.

use crate::algebra::{Algebra, Singular, Tangent, newton_step, newton_steps};
use crate::lower::{Chain, ErrorLift, ErrorValues, JointPosition, NominalPose};
use crate::machine::{AxisKind, Machine};
use nalgebra::{Vector2, Vector3};

/// A problem of inverse kinematics at a pose.
#[derive(Debug)]
pub struct Inverse<'a> {
    machine: &'a Machine,
    pose: &'a [f64],
    errors: &'a ErrorValues,
    /// Axes that move, as many as there are conditions.
    moved: Vec<usize>,
    /// Requested place of the functional point, mm.
    tip: Vector3<f64>,
    /// The two directions across the tool axis, if it is to be held too.
    across: Option<[Vector3<f64>; 2]>,
}

/// A pole: the rotary axes turn the tool axis in one direction only, so that the pose is no analytic function of the
/// errors there.
#[derive(Debug, Clone, PartialEq)]
pub struct Pole {
    /// Index of the rotary axis that does not turn the tool axis, or has the larger part in a turn of both that does
    /// not.
    pub free: usize,
    /// Unit vector (unturned workpiece frame) across the tool axis, into which no axis turns it.
    pub unreachable: Vector3<f64>,
}

/// Step of the differences by which a pole is found, deg; and the turn of the tool axis per turn of the axes below
/// which the pose counts as one.
const POLE_STEP_DEG: f64 = 1e-2;
const POLE: f64 = 1e-6;

/// Steps after which the real solution, if it is one, has been found.
const REAL_STEPS: usize = 12;

impl<'a> Inverse<'a> {
    /// Three linear axes hold the point; two rotary axes besides, if there are just two, the tool axis.
    pub fn new(machine: &'a Machine, pose: &'a [f64], errors: &'a ErrorValues) -> Self {
        let nominal = NominalPose::at(machine, pose).pose;
        let axes =
            |kind: AxisKind| machine.axes().iter().enumerate().filter(move |(_, a)| a.kind == kind).map(|(i, _)| i);
        let rotary: Vec<usize> = axes(AxisKind::Rotary).collect();
        let holds_axis = rotary.len() == 2;
        let moved = axes(AxisKind::Linear).chain(rotary.into_iter().filter(|_| holds_axis)).collect();
        let [x, y, _] = [0, 1, 2].map(|k| nominal.linear.column(k).into_owned());
        Self { machine, pose, errors, moved, tip: nominal.translation, across: holds_axis.then_some([x, y]) }
    }

    /// Returns the pole at which the pose is, if the tool axis is to be held.
    pub fn pole(&self) -> Option<Pole> {
        let across = self.across?;
        let direction = |axis: usize, by: f64| {
            let mut pose = self.pose.to_vec();
            pose[axis] += by;
            NominalPose::at(self.machine, &pose).pose.linear.column(2).into_owned()
        };
        let rotary: Vec<usize> = self.moved[3.min(self.moved.len())..].to_vec();
        let turn = |axis: &usize| {
            let by = direction(*axis, POLE_STEP_DEG) - direction(*axis, -POLE_STEP_DEG);
            Vector2::from(across.map(|across| by.dot(&across) / (2.0 * POLE_STEP_DEG.to_radians())))
        };
        let turns: Vec<Vector2<f64>> = rotary.iter().map(turn).collect();
        let [first, second] = turns[..] else { return None };
        // Where both turn the tool alike, the one that turns it less has the larger part in what does not.
        let (less, more, free) = match first.norm() < second.norm() {
            true => (first, second, rotary[0]),
            false => (second, first, rotary[1]),
        };
        let aside = Vector2::new(-more.y, more.x).try_normalize(POLE).unwrap_or_else(Vector2::x);
        let unreachable = across[0] * aside.x + across[1] * aside.y;
        (less.dot(&aside).abs() < POLE).then_some(Pole { free, unreachable })
    }

    /// Returns the same problem without the tool axis: the linear axes hold the point.
    pub fn of_position(self) -> Self {
        let moved = self.moved.into_iter().take(3).collect();
        Self { moved, across: None, ..self }
    }

    /// Returns the indices of the axes that move.
    pub fn moving_axes(&self) -> &[usize] {
        &self.moved
    }

    fn conditions(&self) -> usize {
        if self.across.is_some() { 5 } else { 3 }
    }

    /// Returns the residuals at displacements (mm, rad): of the point (mm), and of the tool axis.
    pub fn residual<S: Algebra>(&self, by: &[S], lift: &impl ErrorLift<S>) -> Vec<S> {
        let displacement =
            |axis: usize| self.moved.iter().position(|m| *m == axis).map_or(S::zero(), |k| by[k].clone());
        let axes = self.machine.axes().iter().zip(self.pose).enumerate();
        let at: Vec<JointPosition<S>> =
            axes.map(|(i, (axis, q))| JointPosition::displaced(axis, *q, &displacement(i))).collect();
        let real = Chain::actual_at(self.machine, &at, self.errors, lift).tool_in_workpiece(&self.machine.workpiece());
        let place = (0..3).map(|i| real.translation[i].clone() - S::from_real(self.tip[i]));
        let tilt = |across: &Vector3<f64>| {
            (0..3).map(|i| real.linear[(i, 2)].scaled(across[i])).fold(S::zero(), |sum, x| sum + x)
        };
        place.chain(self.across.iter().flatten().map(tilt)).collect()
    }

    /// Returns the displacements (mm, rad) after a number of Newton steps over the algebra. Fails if the axes do not
    /// match the conditions, or if their Jacobian is singular.
    pub fn after<S, L>(&self, lift: &L, steps: usize) -> Result<Vec<S>, Singular>
    where
        S: Algebra,
        L: ErrorLift<S>,
    {
        if self.moved.len() != self.conditions() {
            return Err(Singular { column: self.moved.len().min(self.conditions()) });
        }
        let mut by: Vec<S> = self.real(lift)?.into_iter().map(S::from_real).collect();
        for _ in 0..steps {
            by = newton_step(&by, |by| self.residual(by, &OnTangents(lift)))?;
        }
        Ok(by)
    }

    /// Returns the displacements (mm, rad), exact over an algebra of the given order. Fails as [`Self::after`] does.
    pub fn solve<S: Algebra, L: ErrorLift<S>>(&self, lift: &L, order: usize) -> Result<Vec<S>, Singular> {
        self.after(lift, newton_steps(order))
    }

    /// Returns the solution of the real part: zero, unless location errors count there.
    fn real<S: Algebra, L: ErrorLift<S>>(&self, lift: &L) -> Result<Vec<f64>, Singular> {
        let mut by = vec![0.0; self.moved.len()];
        let real_part = RealPart { lift, algebra: std::marker::PhantomData::<S> };
        for _ in 0..REAL_STEPS {
            if self.residual(&by, &real_part).iter().all(|r| r.abs() < 1e-13) {
                break;
            }
            by = newton_step(&by, |by| self.residual(by, &OnTangents(&real_part)))?;
        }
        Ok(by)
    }
}

/// Errors do not depend on the displacements.
struct OnTangents<'a, L>(&'a L);

impl<S: Algebra, L: ErrorLift<S>> ErrorLift<Tangent<S>> for OnTangents<'_, L> {
    fn lift(&self, source: crate::lower::Source, value: f64) -> Tangent<S> {
        Tangent::fixed(self.0.lift(source, value))
    }
}

/// The real parts of errors over an algebra.
struct RealPart<'a, S, L> {
    lift: &'a L,
    algebra: std::marker::PhantomData<S>,
}

impl<S: Algebra, L: ErrorLift<S>> ErrorLift<f64> for RealPart<'_, S, L> {
    fn lift(&self, source: crate::lower::Source, value: f64) -> f64 {
        self.lift.lift(source, value).real()
    }
}
