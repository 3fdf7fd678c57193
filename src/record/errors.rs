//! Errors of a record: a row for every error in both states, and the curves.

use super::{ErrorCurve, ErrorRow, StateValue};
use crate::machine::{Approach, Axis, ComponentError, Curve, ErrorFamily, ErrorId, ErrorSizes, ErrorTerm, Machine};

/// Positions of a curve that is no table.
const SAMPLES: u32 = 20;

/// Longest table of a record, in rows; a longer one is sampled.
const MOST_ROWS: usize = 1000;

/// Returns a row for every error that either state gives, in the order of the machine as found.
pub(crate) fn rows(found: &Machine, left: Option<&Machine>) -> Vec<ErrorRow> {
    let ids = |machine: &Machine| machine.errors().map(|(id, _)| id).collect::<Vec<_>>();
    let mut all = ids(found);
    let more: Vec<ErrorId> = left.map(ids).unwrap_or_default().into_iter().filter(|id| !all.contains(id)).collect();
    all.extend(more);
    all.iter().map(|id| row(id, found, left)).collect()
}

fn row(id: &ErrorId, found: &Machine, left: Option<&Machine>) -> ErrorRow {
    let second = left.unwrap_or(found);
    let sizes = found.error_sizes(second, id);
    let [first, last] = [found, second];
    ErrorRow {
        error: id.to_string(),
        unit: id.direction.micro().1.to_owned(),
        found: state(first, id, &sizes, 0),
        left: left.and_then(|_| state(last, id, &sizes, 1)),
    }
}

fn state(machine: &Machine, id: &ErrorId, sizes: &ErrorSizes, i: usize) -> Option<StateValue> {
    let factor = id.direction.micro().0;
    let value = sizes.sizes[i]? * factor;
    let expanded_uncertainty = machine.uncertainty(id).map(|half| half * factor);
    Some(StateValue { value, bounded: sizes.bounded[i], expanded_uncertainty })
}

pub(crate) fn curves(machine: &Machine, state: &'static str) -> Vec<ErrorCurve> {
    let of = |(id, term): (ErrorId, &ErrorTerm)| {
        let axis = machine.axis_index(id.axis.as_str()).map(|i| &machine.axes()[i])?;
        match term {
            ErrorTerm::Component(component) if id.family == ErrorFamily::Component => {
                Some(curve(machine, state, &id, axis, component))
            }
            _ => None,
        }
    };
    machine.errors().filter_map(of).collect()
}

fn curve(machine: &Machine, state: &'static str, id: &ErrorId, axis: &Axis, component: &ComponentError) -> ErrorCurve {
    let (factor, unit) = id.direction.micro();
    let positions = positions(axis, component);
    let values = |from: Approach| positions.iter().map(|at| component.value(&from.at_position(*at)) * factor).collect();
    let reverse = match component {
        ComponentError::Single(_) => None,
        ComponentError::Bidirectional { .. } => Some(values(Approach::Reverse)),
    };
    ErrorCurve {
        state,
        error: id.to_string(),
        axis: axis.name.to_string(),
        unit,
        position_unit: axis.unit(),
        forward: values(Approach::Forward),
        reverse,
        expanded_uncertainty: machine.uncertainty(id).map(|half| half * factor),
        positions,
    }
}

/// The positions of the points of all its curves; 21 over the travel where they have none or too many, and where the
/// curves do not share them.
fn positions(axis: &Axis, component: &ComponentError) -> Vec<f64> {
    // The breaks of a B-spline are too few to show it.
    let table = |curve: &Curve| match curve {
        Curve::BSpline(_) => None,
        curve => curve.knots().map(|knots| knots.positions().to_vec()),
    };
    let mut tables = component.curves().map(table);
    let first = tables.next().flatten();
    let shared = first.filter(|first| first.len() <= MOST_ROWS && tables.all(|other| other.as_ref() == Some(first)));
    shared.unwrap_or_else(|| {
        let (low, high) = component
            .curves()
            .filter_map(Curve::domain)
            .fold(axis.travel.interval(), |(a, b), (c, d)| (a.max(c), b.min(d)));
        (0..=SAMPLES).map(|i| low + (high - low) * f64::from(i) / f64::from(SAMPLES)).collect()
    })
}
