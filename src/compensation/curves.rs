//! Error curves for controllers that have the ISO 230-1 model, and what such a controller makes of them.

use super::nodes::{Columns, Curves};
use super::{Correction, ErrorCurve, Jacobian, Scope, TableRules};
use crate::evaluate::Deviation;
use crate::lower::sensitivities_to;
use crate::machine::{Approach, Direction, ErrorId, ErrorTerm, Machine};
use nalgebra::Vector3;

/// The errors of the machine's axes, sampled: the six curves of an axis over the same positions. The mean
/// of forward and reverse, and nothing of the spindle: no such model knows either.
pub(super) fn error_curves(machine: &Machine, rules: &TableRules) -> Vec<ErrorCurve> {
    (0..machine.axes().len()).flat_map(|axis| axis_curves(machine, axis, rules)).collect()
}

fn axis_curves(machine: &Machine, axis: usize, rules: &TableRules) -> Vec<ErrorCurve> {
    let errors = machine.axis_errors(axis);
    let id = |location, direction| ErrorId { axis: machine.axes()[axis].name.clone(), location, direction };
    let given = |direction: &Direction| matches!(errors.component[direction.index()], Some(ErrorTerm::Component(_)));
    let stored = |direction: Direction, value: f64| rules.increment.error(value, direction);
    let mut curves = Vec::new();
    for (location, direction, term) in errors.iter() {
        if let (true, ErrorTerm::Constant(value)) = (location, term) {
            let values = vec![stored(direction, *value)];
            curves.push(ErrorCurve { error: id(true, direction), positions: Vec::new(), values });
        }
    }
    let at = |q: f64| machine.component_values(axis, q, Approach::Mean);
    // Angles and lengths weigh alike at a metre of lever arm.
    let weighed = |q: f64| at(q).iter().enumerate().map(|(i, v)| if i < 3 { *v } else { 1000.0 * v }).collect();
    let wanted: Vec<Direction> = Direction::ALL.into_iter().filter(given).collect();
    if wanted.is_empty() {
        return curves;
    }
    let counts = |direction: Direction| wanted.contains(&direction);
    let positions = Curves { machine, axis, counts: &counts, sines: false }
        .positions(rules, &Columns { value: &weighed, stored: &|x| x });
    curves.extend(wanted.iter().map(|direction| {
        let values = positions.iter().map(|q| stored(*direction, at(*q)[direction.index()])).collect();
        ErrorCurve { error: id(false, *direction), positions: positions.clone(), values }
    }));
    curves
}

impl ErrorCurve {
    /// The error (mm or rad) at a position: straight lines, held at the ends; by whole turns on a
    /// continuous axis.
    pub fn value(&self, position: f64, continuous: bool) -> f64 {
        let Some(first) = self.positions.first() else { return self.values.first().copied().unwrap_or(0.0) };
        let q = if continuous { first + (position - first).rem_euclid(360.0) } else { position };
        straight(&self.positions, &self.values, q)
    }
}

/// Straight lines between rising positions, held at the ends.
pub(super) fn straight(positions: &[f64], values: &[f64], position: f64) -> f64 {
    let last = positions.len() - 1;
    let q = position.clamp(positions[0], positions[last]);
    let high = positions.partition_point(|p| *p <= q).min(last);
    let low = high.saturating_sub(1);
    let way = positions[high] - positions[low];
    let share = if way > 0.0 { (q - positions[low]) / way } else { 0.0 };
    values[low] * (1.0 - share) + values[high] * share
}

/// What a controller with the model adds to the linear axes: against the deviation of the functional
/// point to first order, in the frame and with the conventions of the machine.
pub fn model_correction(machine: &Machine, pose: &[f64], errors: &[ErrorCurve]) -> Correction {
    let ids: Vec<ErrorId> = errors.iter().map(|curve| curve.error.clone()).collect();
    let part = |(s, curve): (crate::lower::Sensitivity, &ErrorCurve)| {
        let axis = machine.axis_index(curve.error.axis.as_str());
        let position = axis.map_or(0.0, |axis| pose[axis]);
        s.deviation * curve.value(position, axis.is_some_and(|axis| machine.is_continuous(axis)))
    };
    let position: Vector3<f64> = sensitivities_to(machine, pose, &ids).into_iter().zip(errors).map(part).sum();
    let deviation = Deviation { position, rotation: Vector3::zeros() };
    Jacobian::at(machine, pose).correction(&deviation, &Correction::none(machine), Scope::POSITION)
}
