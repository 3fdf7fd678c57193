//! Own-axis tables: each axis corrects its own positioning error.

use super::jacobian::against;
use super::{OwnAxisCapability, OwnAxisTable, Spacing};
use crate::algebra::skew_vector;
use crate::lower::{JointElements, Position, joint};
use crate::machine::{Approach, AxisKind, Curve, Direction, ErrorTerm, Machine, Travel};
use nalgebra::Vector3;

/// How far an axis is from its command along (mm) or about (deg) its own direction: what its
/// encoder would have to read differently. Angular errors of a linear axis turn about its origin and
/// do not count here; location errors move the whole axis and do not count either.
pub fn own_axis_error(machine: &Machine, axis: usize, command: f64, wanted: f64, approach: Approach) -> f64 {
    let this = &machine.axes()[axis];
    let none = JointElements { location: None, component: None };
    let component = Some(machine.component_values(axis, command, approach));
    let at = |position| Position::at(this, position);
    let real = joint(this, machine.conventions(), &at(command), &JointElements { location: None, component });
    let ideal = joint(this, machine.conventions(), &at(wanted), &none);
    let direction = Vector3::from(this.direction) * this.sign();
    match this.kind {
        AxisKind::Linear => direction.dot(&(real.apply(&this.origin) - ideal.apply(&this.origin))),
        AxisKind::Rotary => direction.dot(&skew_vector(&(real.linear * ideal.linear.transpose()))).to_degrees(),
    }
}

/// A table for every axis, in the order of the axes.
pub fn own_axis_tables(machine: &Machine, capability: &OwnAxisCapability) -> Vec<OwnAxisTable> {
    (0..machine.axes().len()).map(|axis| table(machine, axis, capability)).collect()
}

fn table(machine: &Machine, axis: usize, capability: &OwnAxisCapability) -> OwnAxisTable {
    let positions = positions(machine, axis, capability);
    let column = |approach| positions.iter().map(|q| own_correction(machine, axis, *q, approach)).collect();
    let (forward, reverse) = if capability.bidirectional {
        (column(Approach::Forward), column(Approach::Reverse))
    } else {
        (column(Approach::Mean), column(Approach::Mean))
    };
    OwnAxisTable { axis, positions, forward, reverse }
}

/// Solves error(q + c) = 0 for c: the controller looks its table up at the command q.
fn own_correction(machine: &Machine, axis: usize, position: f64, approach: Approach) -> f64 {
    const STEPS: usize = 8;
    let mut correction = 0.0;
    for _ in 0..STEPS {
        correction += against(own_axis_error(machine, axis, position + correction, position, approach));
    }
    correction
}

fn interval(machine: &Machine, axis: usize, capability: &OwnAxisCapability) -> (f64, f64) {
    match machine.axes()[axis].travel {
        Travel::Continuous => capability.continuous,
        Travel::Range(min, max) => (min, max),
    }
}

/// Axes whose measured points do not fit into the tables, with how many there are: their curves are
/// resampled at equal distances.
pub fn resampled(machine: &Machine, capability: &OwnAxisCapability) -> Vec<(usize, usize)> {
    let count = |axis: usize| {
        let (min, max) = interval(machine, axis, capability);
        (axis, knots(machine, axis, min, max).len())
    };
    (0..machine.axes().len()).map(count).filter(|(_, n)| *n > capability.max_points).collect()
}

/// The knots of the curves that act along the axis where they fit, otherwise equal distances.
fn positions(machine: &Machine, axis: usize, capability: &OwnAxisCapability) -> Vec<f64> {
    let (min, max) = interval(machine, axis, capability);
    let knots = knots(machine, axis, min, max);
    let fits = (2..=capability.max_points).contains(&knots.len());
    let by_knots = capability.spacing == Spacing::Free && fits && all_by_knots(machine, axis);
    capability.increment.distinct(if by_knots { knots } else { equal(min, max, capability.max_points) })
}

fn equal(min: f64, max: f64, points: usize) -> Vec<f64> {
    let last = (points - 1) as f64;
    (0..points).map(|i| min + (max - min) * (i as f64 / last)).collect()
}

/// Curves of the errors along (or about) the axis itself.
fn own_curves(machine: &Machine, axis: usize) -> impl Iterator<Item = &Curve> {
    let this = &machine.axes()[axis];
    let own = move |direction: Direction| {
        let along = this.direction[direction.index() % 3].abs() > 1e-9;
        along && direction.is_rotation() == (this.kind == AxisKind::Rotary)
    };
    let terms = Direction::ALL.into_iter().filter(move |d| own(*d));
    terms.filter_map(move |d| machine.axis_errors(axis).component[d.index()].as_ref()).flat_map(|term| {
        let component = if let ErrorTerm::Component(component) = term { Some(component) } else { None };
        component.into_iter().flat_map(|c| c.curves())
    })
}

/// Are all of them straight between knots?
fn all_by_knots(machine: &Machine, axis: usize) -> bool {
    own_curves(machine, axis).all(|curve| matches!(curve, Curve::Linear(_)))
}

/// Knots of the own curves within an interval, ends included; periodic ones are repeated.
fn knots(machine: &Machine, axis: usize, min: f64, max: f64) -> Vec<f64> {
    let mut all = vec![min, max];
    for knots in own_curves(machine, axis).filter_map(Curve::knots) {
        let period = knots.period().unwrap_or(0.0);
        let turns = if period > 0.0 { libm::ceil((max - min) / period) as i32 + 1 } else { 0 };
        let shifted = |turn: i32| knots.positions().iter().map(move |q| q + f64::from(turn) * period);
        all.extend((-turns..=turns).flat_map(shifted).filter(|q| (min..=max).contains(q)));
    }
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}
