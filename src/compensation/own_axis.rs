//! Own-axis tables: each axis corrects its own positioning error.

use super::jacobian::against;
use super::nodes::{AxisCurves, ColumnValues, interval};
use super::{CorrectionTable, CorrectionTables, TableRules};
use crate::algebra::skew_vector;
use crate::evaluate::Deviation;
use crate::lower::{JointElements, JointPosition, joint};
use crate::machine::{Approach, AxisKind, Direction, Machine, OperatingConditions};
use nalgebra::Vector3;

/// Positions of an axis (mm or deg): where it is sent, and where it should be.
#[derive(Debug, Clone, Copy)]
struct Sent {
    command: f64,
    nominal: f64,
}

/// Returns how far an axis is from where it should be, by its own joint alone. Angular errors of a linear axis turn
/// about its origin and do not count here; location errors move the whole axis and do not count either.
fn own_axis_deviation(machine: &Machine, axis: usize, sent: Sent, conditions: OperatingConditions) -> Deviation {
    let this = &machine.axes()[axis];
    let none = JointElements { location: None, component: None };
    let component = Some(machine.component_values(axis, &conditions.at_position(sent.command)));
    let at = |position| JointPosition::at(this, position);
    let actual = joint(this, machine.conventions(), &at(sent.command), &JointElements { location: None, component });
    let nominal = joint(this, machine.conventions(), &at(sent.nominal), &none);
    Deviation {
        position: actual.apply(&this.origin) - nominal.apply(&this.origin),
        rotation: skew_vector(&(actual.linear * nominal.linear.transpose())),
    }
}

/// Returns the motion of an axis along (mm) or about (deg) its own direction against its own error: the change of its
/// encoder's reading.
fn own_axis_step(machine: &Machine, axis: usize, sent: Sent, conditions: OperatingConditions) -> f64 {
    let this = &machine.axes()[axis];
    let direction = Vector3::from(this.direction) * this.sign();
    let wanted = against(&own_axis_deviation(machine, axis, sent, conditions));
    match this.kind {
        AxisKind::Linear => direction.dot(&wanted.displacement),
        AxisKind::Rotary => direction.dot(&wanted.rotation).to_degrees(),
    }
}

/// The table of an axis, at given positions or where the rules have its points.
pub fn own_axis_table(
    machine: &Machine,
    axis: usize,
    rules: &TableRules,
    positions: Option<Vec<f64>>,
) -> CorrectionTable {
    table_of(machine, axis, rules, positions, |_| 0.0)
}

/// The same of the corrections without a part of them.
fn table_of(
    machine: &Machine,
    axis: usize,
    rules: &TableRules,
    positions: Option<Vec<f64>>,
    without: impl Fn(f64) -> f64,
) -> CorrectionTable {
    let two_sided = rules.directions.is_bidirectional();
    let at = |q: f64, from: Approach| own_correction(machine, axis, q, from.into()) - without(q);
    let row = |q: f64| match two_sided {
        true => vec![at(q, Approach::Forward), at(q, Approach::Reverse)],
        false => vec![at(q, Approach::Mean)],
    };
    let counts = own(machine, axis);
    let curves = AxisCurves { machine, axis, counts: &counts, sines: false };
    let positions = positions.unwrap_or_else(|| {
        let kind = machine.axes()[axis].kind;
        let stored = |c: f64| rules.increment.correction(c, kind);
        curves.positions(rules, &ColumnValues { value: &row, stored: &stored })
    });
    let rows: Vec<Vec<f64>> = positions.iter().map(|q| row(*q)).collect();
    let values = rows.iter().map(|row| row[0]).collect();
    let reverse = two_sided.then(|| rows.iter().map(|row| row[1]).collect());
    CorrectionTable { reverse, ..CorrectionTable::curve(axis, positions, axis, values) }
}

/// The tables of all axes whose own error depends on the direction of approach, rounded: for a controller that holds
/// everything else by other means.
pub fn reversal_tables(machine: &Machine, rules: &TableRules) -> CorrectionTables {
    let two_sided = |axis: &usize| {
        let name = &machine.axes()[*axis].name;
        machine.filtered(|id| id.axis == *name).is_bidirectional()
    };
    let axes = (0..machine.axes().len()).filter(two_sided);
    let reversal = |axis: usize| {
        let mean = |q: f64| own_correction(machine, axis, q, Approach::Mean.into());
        table_of(machine, axis, rules, None, mean)
    };
    let tables = axes.map(reversal).collect();
    let mut all = CorrectionTables { tables, ..CorrectionTables::default() };
    all.quantise(machine, |_| Some(&rules.increment));
    let zero = |values: &Vec<f64>| values.iter().all(|c| *c == 0.0);
    all.tables.retain(|table| !(zero(&table.values) && table.reverse.as_ref().is_none_or(zero)));
    all.merge()
}

/// Solves actual(q + c) = nominal(q) for c: the controller looks its table up at the command q.
fn own_correction(machine: &Machine, axis: usize, position: f64, conditions: OperatingConditions) -> f64 {
    const STEPS: usize = 8;
    let mut correction = 0.0;
    for _ in 0..STEPS {
        let sent = Sent { command: position + correction, nominal: position };
        correction += own_axis_step(machine, axis, sent, conditions);
    }
    correction
}

/// Returns the axes whose measured points do not fit into the tables, with their number of points: the points that
/// matter most are kept.
pub fn thinned_axes(machine: &Machine, rules: &TableRules) -> Vec<(usize, usize)> {
    let count = |axis: usize| {
        let counts = own(machine, axis);
        let curves = AxisCurves { machine, axis, counts: &counts, sines: false };
        (axis, curves.knots(interval(machine, axis, rules)).len())
    };
    (0..machine.axes().len()).map(count).filter(|(_, n)| *n > rules.max_points).collect()
}

/// Errors along (or about) the axis itself.
fn own(machine: &Machine, axis: usize) -> impl Fn(Direction) -> bool {
    let this = &machine.axes()[axis];
    move |direction: Direction| {
        let along = this.direction[direction.index() % 3].abs() > 1e-9;
        along && direction.is_rotation() == (this.kind == AxisKind::Rotary)
    }
}
