//! Error curves for controllers that have the ISO 230-1 model.
//!
//! Files of such controllers have a point of each rotary axis and none of the linear axes: the angular errors of these
//! turn about the zero of the machine coordinates. A turn eps about an origin o is one about zero and the translation
//! `-eps x o`, which goes into the curves of the translations: to first order the files then hold the same errors.

use super::nodes::{AxisCurves, ColumnValues};
use super::{AxisErrorCurve, TableRules};
use crate::machine::{AxisKind, Direction, ErrorFamily, ErrorId, ErrorTerm, LocationAction, Machine};
use nalgebra::Vector3;

/// The errors of the machine's axes, sampled: the six curves of an axis over the same positions. The mean
/// of forward and reverse, and nothing of the spindle: no such model knows either.
pub(super) fn error_curves(machine: &Machine, rules: &TableRules) -> Vec<AxisErrorCurve> {
    (0..machine.axes().len()).flat_map(|axis| ErrorSampler { machine, axis, rules }.all()).collect()
}

/// The curves of one axis.
struct ErrorSampler<'a> {
    machine: &'a Machine,
    axis: usize,
    rules: &'a TableRules,
}

impl ErrorSampler<'_> {
    fn all(&self) -> Vec<AxisErrorCurve> {
        [self.constants(), self.sample()].concat()
    }

    fn curve(&self, family: ErrorFamily, direction: Direction, positions: &[f64], values: &[f64]) -> AxisErrorCurve {
        let error = ErrorId { axis: self.machine.axes()[self.axis].name.clone(), family, direction };
        let values = values.iter().map(|value| self.rules.increment.error(*value, direction)).collect();
        AxisErrorCurve { error, positions: positions.to_vec(), values }
    }

    fn constants(&self) -> Vec<AxisErrorCurve> {
        let errors = self.machine.axis_errors(self.axis);
        let given = |direction: Direction| matches!(errors.location[direction.index()], Some(ErrorTerm::Constant(_)));
        let values = location_errors(self.machine, self.axis);
        let written = error_directions(point(self.machine, self.axis, ErrorFamily::Location), given);
        written
            .map(|direction| self.curve(ErrorFamily::Location, direction, &[], &[values[direction.index()]]))
            .collect()
    }

    fn sample(&self) -> Vec<AxisErrorCurve> {
        let errors = self.machine.axis_errors(self.axis);
        let given = |direction: Direction| matches!(errors.component[direction.index()], Some(ErrorTerm::Component(_)));
        let written: Vec<Direction> =
            error_directions(point(self.machine, self.axis, ErrorFamily::Component), given).collect();
        if written.is_empty() {
            return Vec::new();
        }
        let at = |q: f64| component(self.machine, self.axis, q);
        // Angles and lengths weigh alike at a metre of lever arm.
        let weighed = |q: f64| at(q).iter().enumerate().map(|(i, v)| if i < 3 { *v } else { 1000.0 * v }).collect();
        let positions = AxisCurves { machine: self.machine, axis: self.axis, counts: &given, sines: false }
            .positions(self.rules, &ColumnValues { value: &weighed, stored: &|x| x });
        let values =
            |direction: Direction| -> Vec<f64> { positions.iter().map(|q| at(*q)[direction.index()]).collect() };
        written
            .into_iter()
            .map(|direction| self.curve(ErrorFamily::Component, direction, &positions, &values(direction)))
            .collect()
    }
}

/// Returns the curves of a machine at the positions of given curves, as far as they are not zero.
pub(super) fn curves_like(machine: &Machine, layout: &[AxisErrorCurve]) -> Vec<AxisErrorCurve> {
    let like = |curve: &AxisErrorCurve| {
        let axis = machine.axis_index(curve.error.axis.as_str())?;
        let direction = curve.error.direction.index();
        let values: Vec<f64> = match curve.error.family {
            ErrorFamily::Location => vec![location_errors(machine, axis)[direction]],
            ErrorFamily::Component => curve.positions.iter().map(|q| component(machine, axis, *q)[direction]).collect(),
        };
        values.iter().any(|value| *value != 0.0).then(|| AxisErrorCurve { values, ..curve.clone() })
    };
    layout.iter().filter_map(like).collect()
}

/// Returns the point about which the errors of an axis turn and of which the files know nothing; zero if they do.
fn point(machine: &Machine, axis: usize, family: ErrorFamily) -> Vector3<f64> {
    let this = &machine.axes()[axis];
    let action = this.convention(machine.conventions()).location;
    let turns = family == ErrorFamily::Component || matches!(action, LocationAction::Factor(_));
    if this.kind == AxisKind::Linear && turns { this.origin.into() } else { Vector3::zeros() }
}

/// Returns the directions with an error of their own or of the translation that a turn about a point adds.
fn error_directions(point: Vector3<f64>, given: impl Fn(Direction) -> bool) -> impl Iterator<Item = Direction> {
    let turn = |i: usize| Vector3::from_fn(|k, _| f64::from(u8::from(k == i)));
    let moved: Vec<Vector3<f64>> =
        (0..3).filter(|i| given(Direction::ALL[3 + i])).map(|i| turn(i).cross(&point)).collect();
    let shifted =
        move |direction: &Direction| moved.iter().any(|span| span.get(direction.index()).is_some_and(|x| *x != 0.0));
    Direction::ALL.into_iter().filter(move |direction| given(*direction) || shifted(direction))
}

/// Returns the location errors of an axis (mm, rad) about the points that the files know.
fn location_errors(machine: &Machine, axis: usize) -> [f64; 6] {
    about_zero(machine.axis_errors(axis).location_values(), point(machine, axis, ErrorFamily::Location))
}

/// Returns the component errors of an axis at a position (mm, rad) about the points that the files know.
fn component(machine: &Machine, axis: usize, position: f64) -> [f64; 6] {
    about_zero(machine.component_values(axis, &position.into()), point(machine, axis, ErrorFamily::Component))
}

/// Refers errors about a point to the zero of the machine coordinates: `delta - eps x point`.
fn about_zero(six: [f64; 6], point: Vector3<f64>) -> [f64; 6] {
    let [dx, dy, dz, ex, ey, ez] = six;
    let moved = Vector3::new(dx, dy, dz) - Vector3::new(ex, ey, ez).cross(&point);
    [moved.x, moved.y, moved.z, ex, ey, ez]
}

impl AxisErrorCurve {
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
    let span = positions[high] - positions[low];
    let fraction = if span > 0.0 { (q - positions[low]) / span } else { 0.0 };
    values[low] * (1.0 - fraction) + values[high] * fraction
}
