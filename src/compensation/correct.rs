//! Correction of a command: Newton's iteration on actual(q + c) = nominal(q).

use super::jacobian::Jacobian;
use super::scope::{Correction, Goal, Scope};
use crate::evaluate::{Deviation, command_deviation};
use crate::lower::NominalPose;
use crate::machine::{Machine, OperatingPoint};

/// The solution for one pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Corrected {
    /// Correction added to the command.
    pub correction: Correction,
    /// Deviation after the correction.
    pub residual: Deviation,
}

/// The chord iteration contracts by the relative size of the errors, about 1e-4 a step.
pub(super) const MAX_STEPS: usize = 12;

/// A step below this (mm, deg) is rounding.
pub(super) const SMALL_STEP: f64 = 1e-11;

/// Solves actual(q + c) = nominal(q) for the exact model at an operating point. The Jacobian is that of the nominal
/// machine at q: the chord form of Newton's iteration, whose contraction is the size of the errors. Where the axes are
/// too few, the solution is that of least squares; then, and near singular poses, a residual remains.
pub fn correct(machine: &Machine, at: &OperatingPoint<'_>, scope: Scope) -> Corrected {
    let mut correction = Correction::none(machine);
    let nominal = NominalPose::at(machine, at.axes).pose;
    let jacobian = Jacobian::at(machine, at.axes);
    let deviation = |correction: &Correction| {
        command_deviation(machine, &nominal, &at.conditions.at_pose(&correction.corrected_command(at.axes)))
    };
    let mut residual = deviation(&correction);
    for _ in 0..MAX_STEPS {
        let step = jacobian.correction(&residual, &correction, scope);
        correction.0.iter_mut().zip(&step.0).for_each(|(c, s)| *c += s);
        residual = deviation(&correction);
        if step.0.iter().all(|s| s.abs() < SMALL_STEP) || is_settled(&residual, scope) {
            break;
        }
    }
    Corrected { correction, residual }
}

/// True if the residual is far below any controller's increment in all that the scope corrects.
pub(super) fn is_settled(residual: &Deviation, scope: Scope) -> bool {
    scope.goal == Goal::Position && residual.position.amax() < 1e-10
}
