//! Errors of a record: a row for every error in both states, and the curves.

use super::{CovariedError, ErrorCurve, ErrorRow, RecordedCovariance, StateValue};
use crate::machine::{
    Approach, Axis, ComponentError, Curve, ErrorFamily, ErrorId, ErrorSizes, ErrorTerm, JointErrors, Machine,
    UncertainPart,
};

/// Positions of a curve that is no table.
const SAMPLES: u32 = 20;

/// Longest table of a record, in rows; a longer one is sampled.
const MOST_ROWS: usize = 1000;

/// Size (um, urad) up to which a value without uncertainty in a fitted file is a zero of its datum: these are written
/// with what rounding leaves of them, 1e-14 at most.
const HELD: f64 = 1e-9;

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
    let bounded = sizes.bounded[i];
    let expanded_uncertainty = machine.uncertainty(id).map(|half| half * factor);
    let joint = || machine.uncertain_parts().iter().any(|part| matches!(part, UncertainPart::Joint(_)));
    let held = !bounded && expanded_uncertainty.is_none() && value.abs() <= HELD && joint();
    Some(StateValue { value: if held { 0.0 } else { value }, bounded, expanded_uncertainty, held })
}

/// Returns the covariance of the values that a joint uncertainty moves; `None` where the machine file has none.
pub(crate) fn covariance(machine: &Machine, state: &'static str) -> Option<RecordedCovariance> {
    let joint = |part| if let UncertainPart::Joint(part) = part { Some(part) } else { None };
    let parts: Vec<_> = machine.uncertain_parts().into_iter().filter_map(joint).collect();
    let row = |(id, term): (ErrorId, &ErrorTerm)| {
        let factor = id.direction.micro().0;
        let position = largest_at(machine, &id, term);
        let at = Approach::Forward.at_position(position.unwrap_or_default());
        let own = |errors: &JointErrors| {
            let term = errors.six(id.family)[id.direction.index()].as_ref();
            term.map_or(0.0, |term| term.value(&at) * factor)
        };
        let moved: Vec<f64> = parts.iter().map(|part| part.errors.get(&id.axis).map_or(0.0, own)).collect();
        let known = !matches!(term, ErrorTerm::Tolerance(_)) && moved.iter().any(|by| by.abs() > HELD);
        let value = term.value(&at) * factor;
        known.then(|| (CovariedError { error: id.to_string(), position, value, unit: id.direction.micro().1 }, moved))
    };
    let (errors, moved): (Vec<CovariedError>, Vec<Vec<f64>>) = machine.errors().filter_map(row).unzip();
    let product = |a: &Vec<f64>, b: &Vec<f64>| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let covariance = moved.iter().map(|a| moved.iter().map(|b| product(a, b)).collect()).collect();
    (!errors.is_empty()).then_some(RecordedCovariance { state, errors, covariance })
}

/// The position at which a curve is largest; `None` of a location error.
fn largest_at(machine: &Machine, id: &ErrorId, term: &ErrorTerm) -> Option<f64> {
    let axis = machine.axis_index(id.axis.as_str()).map(|i| &machine.axes()[i])?;
    let ErrorTerm::Component(component) = term else { return None };
    let size = |at: &f64| component.value(&Approach::Forward.at_position(*at)).abs();
    positions(axis, component).into_iter().max_by(|a, b| size(a).total_cmp(&size(b)))
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
