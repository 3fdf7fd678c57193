//! A fitted machine as a machine file: self-contained, no `extends`, no tables outside.

use super::parameter::{Basis, Parameter};
use crate::lower::Place;
use crate::machine::{Approach, ComponentError, Curve, Direction, ErrorId, ErrorTerm, Machine, MachineParts, written};
use std::collections::BTreeMap;

/// The text of a machine file that says what `machine` says, the fitted parameters with their new values;
/// `provenance` are further entries of that section (single lines).
pub fn fitted_file(
    machine: &Machine,
    parameters: &[Parameter],
    theta: &[f64],
    provenance: &[(String, String)],
) -> String {
    let mut curves: BTreeMap<(Place, Direction), Directed> = BTreeMap::new();
    for (parameter, value) in parameters.iter().zip(theta) {
        for term in &parameter.terms {
            let sum = &mut curves.entry((term.source.place, term.source.direction)).or_default()[way(term.approach)];
            *sum = Some(join(sum.take(), &term.basis, value * term.factor));
        }
    }
    let mut parts = machine.to_parts();
    curves.into_iter().for_each(|((place, direction), curves)| put(&mut parts, place, direction, curves));
    written(&parts, provenance)
}

/// Curves of mean, forward and reverse approach, as far as they were fitted.
type Directed = [Option<Curve>; 3];

/// Where an approach stands in [`Directed`].
fn way(approach: Approach) -> usize {
    match approach {
        Approach::Mean => 0,
        Approach::Forward => 1,
        Approach::Reverse => 2,
    }
}

/// A fitted source in its place. A location error that was not given and comes out as 0 stays away.
fn put(parts: &mut MachineParts, place: Place, direction: Direction, curves: Directed) {
    let constant = curves[0].as_ref().map_or(0.0, |curve| curve.value(0.0));
    // What was said of the value before is not said of the fitted one.
    if let Place::Location(joint) | Place::Component(joint) = place {
        let axis = parts.axes.get(joint).map(|axis| &axis.name).or_else(|| parts.chain.spindle()).cloned();
        let id = |axis| ErrorId { axis, location: matches!(place, Place::Location(_)), direction };
        let _ = axis.and_then(|axis| parts.uncertainty.remove(&id(axis)));
    }
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
            let slot = &mut parts.errors[axis].component[index];
            *slot = Some(ErrorTerm::Component(component(slot.take(), curves)));
        }
    }
}

/// A fitted component error. A direction that was not fitted keeps what the file says.
fn component(known: Option<ErrorTerm>, [mean, forward, reverse]: Directed) -> ComponentError {
    let kept = match known {
        Some(ErrorTerm::Component(ComponentError::Single(curve))) => [curve.clone(), curve],
        Some(ErrorTerm::Component(ComponentError::Bidirectional { forward, reverse })) => [forward, reverse],
        _ => [Curve::Polynomial(vec![0.0]), Curve::Polynomial(vec![0.0])],
    };
    let [before, behind] = kept;
    match mean {
        Some(mean) => ComponentError::Single(mean),
        None => {
            ComponentError::Bidirectional { forward: forward.unwrap_or(before), reverse: reverse.unwrap_or(behind) }
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
    if let Curve::BSpline(one) = one {
        let before = if let Some(Curve::BSpline(known)) = &known { known.coefficients() } else { &[] };
        let sum = |(i, c): (usize, &f64)| before.get(i).unwrap_or(&0.0) + amount * c;
        return Curve::BSpline(Box::new(one.with_coefficients(one.coefficients().iter().enumerate().map(sum))));
    }
    let Some(knots) = one.knots() else { return one.clone() };
    let before = known.as_ref().and_then(Curve::knots);
    let value = |i: usize| before.map_or(0.0, |k| k.values()[i]) + amount * knots.values()[i];
    let points: Vec<(f64, f64)> = knots.positions().iter().enumerate().map(|(i, q)| (*q, value(i))).collect();
    let smooth = matches!(one, Curve::Cubic(..));
    let through = |knots| if smooth { Curve::cubic(knots) } else { Curve::Linear(knots) };
    crate::machine::Knots::new(&points, knots.period()).map_or_else(|_| one.clone(), through)
}
