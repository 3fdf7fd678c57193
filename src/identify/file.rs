//! A fitted machine as a machine file: self-contained, no `extends`, no tables outside.

use super::parameter::{Basis, Parameter};
use crate::lower::Place;
use crate::machine::{ComponentError, Curve, Direction, ErrorTerm, Machine, MachineParts, written};
use std::collections::BTreeMap;

/// The text of a machine file that says what `machine` says, the fitted parameters with their new values;
/// `provenance` are further entries of that section (single lines).
pub fn fitted_file(
    machine: &Machine,
    parameters: &[Parameter],
    theta: &[f64],
    provenance: &[(String, String)],
) -> String {
    let mut curves: BTreeMap<(Place, Direction), Curve> = BTreeMap::new();
    for (parameter, value) in parameters.iter().zip(theta) {
        for term in &parameter.terms {
            let key = (term.source.place, term.source.direction);
            let sum = join(curves.remove(&key), &term.basis, value * term.factor);
            curves.insert(key, sum);
        }
    }
    let mut parts = machine.to_parts();
    curves.into_iter().for_each(|((place, direction), curve)| put(&mut parts, place, direction, curve));
    written(&parts, provenance)
}

/// A fitted source in its place. A location error that was not given and comes out as 0 stays away.
fn put(parts: &mut MachineParts, place: Place, direction: Direction, curve: Curve) {
    let constant = curve.value(0.0);
    let index = direction.index();
    match place {
        Place::Tool => parts.setup.tool[index % 3] = constant,
        Place::Workpiece => parts.setup.workpiece[index] = constant,
        Place::Location(joint) => {
            let slot = &mut parts.errors[joint].location[index];
            if slot.is_some() || constant != 0.0 {
                *slot = Some(ErrorTerm::Constant(constant));
            }
        }
        Place::Component(axis) => {
            parts.errors[axis].component[index] = Some(ErrorTerm::Component(ComponentError::Single(curve)));
        }
    }
}

/// A curve and `amount` of a basis function.
fn join(known: Option<Curve>, basis: &Basis, amount: f64) -> Curve {
    match basis {
        Basis::Constant => power(known, 0, amount),
        Basis::Power(k) => power(known, usize::from(*k), amount),
        Basis::Cosine(k) => harmonic(known, usize::from(*k), (amount, 0.0)),
        Basis::Sine(k) => harmonic(known, usize::from(*k), (0.0, amount)),
        Basis::Spline(curve) => spline(known, curve, amount),
    }
}

fn power(known: Option<Curve>, k: usize, amount: f64) -> Curve {
    let mut c = if let Some(Curve::Polynomial(c)) = known { c } else { Vec::new() };
    c.resize(c.len().max(k + 1), 0.0);
    c[k] += amount;
    Curve::Polynomial(c)
}

fn harmonic(known: Option<Curve>, k: usize, (cosine, sine): (f64, f64)) -> Curve {
    let mut orders = if let Some(Curve::Harmonics(orders)) = known { orders } else { Vec::new() };
    orders.resize(orders.len().max(k + 1), (0.0, 0.0));
    orders[k] = (orders[k].0 + cosine, orders[k].1 + sine);
    Curve::Harmonics(orders)
}

/// Splines through the same knots add up knot by knot.
fn spline(known: Option<Curve>, one: &Curve, amount: f64) -> Curve {
    let Some(knots) = one.knots() else { return one.clone() };
    let before = known.as_ref().and_then(Curve::knots);
    let value = |i: usize| before.map_or(0.0, |k| k.values()[i]) + amount * knots.values()[i];
    let points: Vec<(f64, f64)> = knots.positions().iter().enumerate().map(|(i, q)| (*q, value(i))).collect();
    crate::machine::Knots::new(&points, knots.period()).map_or_else(|_| one.clone(), Curve::cubic)
}
