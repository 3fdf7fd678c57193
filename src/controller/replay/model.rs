//! Controllers that have the model of ISO 230-1: from curves of errors to motions of the linear axes.
//!
//! Such a controller adds up what its errors do to the functional point, to first order, and moves the linear axes
//! against it. Its files have a point and a direction of each rotary axis and none of the linear axes: angular errors
//! of these turn about the zero of the machine coordinates.

use super::lookup::between;
use crate::compensation::AxisErrorCurve;
use crate::controller::manifest::OutsideTable;
use crate::lower::{NominalPose, sensitivities_to};
use crate::machine::{AxisKind, Direction, ErrorId, Machine};
use nalgebra::{Matrix3, Vector3};

/// Returns the motions of the linear axes that such a controller adds to a command (mm, deg; order of the walk).
pub(super) fn motion(machine: &Machine, command: &[f64], curves: &[AxisErrorCurve]) -> Vec<f64> {
    let mut added = vec![0.0; command.len()];
    let linear: Vec<usize> = (0..command.len()).filter(|axis| machine.axes()[*axis].kind == AxisKind::Linear).collect();
    let [x, y, z] = linear[..] else { return added };
    let columns = [x, y, z].map(|axis| linear_motion(machine, command, axis));
    // No three independent directions: the model has no answer.
    let Some(inverse) = Matrix3::from_columns(&columns).try_inverse() else { return added };
    let steps = inverse * displacement(machine, command, curves);
    // The controller subtracts.
    [x, y, z].into_iter().zip(steps.iter()).for_each(|(axis, step)| added[axis] = 0.0 - step);
    added
}

/// Returns the displacement of the functional point (mm, unturned workpiece frame) by all curves.
fn displacement(machine: &Machine, command: &[f64], curves: &[AxisErrorCurve]) -> Vector3<f64> {
    let terms: Vec<ModelTerm> = curves.iter().flat_map(|curve| terms(machine, command, curve)).collect();
    let errors: Vec<ErrorId> = terms.iter().map(|term| term.error.clone()).collect();
    let units = sensitivities_to(machine, command, &errors);
    units.iter().zip(&terms).map(|(unit, term)| unit.deviation * term.value).sum()
}

/// A value (mm or rad) of an error, about the origin of its axis.
struct ModelTerm {
    error: ErrorId,
    value: f64,
}

/// Returns the terms of a curve at a command: its own error and, of a turn about the machine's zero, the translation of
/// the axis's origin.
fn terms(machine: &Machine, command: &[f64], curve: &AxisErrorCurve) -> Vec<ModelTerm> {
    let Some(index) = machine.axis_index(curve.error.axis.as_str()) else { return Vec::new() };
    let axis = &machine.axes()[index];
    let value = look_up(curve, command[index], machine.is_continuous(index));
    let mut all = vec![ModelTerm { error: curve.error.clone(), value }];
    if axis.kind == AxisKind::Linear && curve.error.direction.is_rotation() {
        let turn = Vector3::from_fn(|i, _| if i == curve.error.direction.index() - 3 { value } else { 0.0 });
        let moved = turn.cross(&Vector3::from(axis.origin));
        let along = |(i, value): (usize, &f64)| {
            let error = ErrorId { direction: Direction::ALL[i], ..curve.error.clone() };
            ModelTerm { error, value: *value }
        };
        all.extend(moved.iter().enumerate().filter(|(_, value)| **value != 0.0).map(along));
    }
    all
}

/// Returns the value (mm or rad) of a curve at a position: straight lines, held at the ends, by whole turns on a
/// continuous axis.
fn look_up(curve: &AxisErrorCurve, position: f64, continuous: bool) -> f64 {
    let Some(first) = curve.positions.first() else { return curve.values.first().copied().unwrap_or(0.0) };
    let position = if continuous { first + (position - first).rem_euclid(360.0) } else { position };
    between(&curve.positions, &curve.values, position, OutsideTable::Hold)
}

/// Returns how far the functional point moves (mm, unturned workpiece frame) for each mm of a linear axis. The motion
/// is linear, so that a long step loses nothing but rounding.
fn linear_motion(machine: &Machine, command: &[f64], axis: usize) -> Vector3<f64> {
    const STEP_MM: f64 = 1024.0;
    let point = |by_mm: f64| {
        let mut command = command.to_vec();
        command[axis] += by_mm;
        NominalPose::at(machine, &command).pose.translation
    };
    (point(STEP_MM) - point(-STEP_MM)) / (2.0 * STEP_MM)
}
