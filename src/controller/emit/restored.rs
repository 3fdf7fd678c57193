//! Tables that take a set back: those that were in force before, and zeros where there were none.

use crate::compensation::{AxisErrorCurve, CorrectionTable, CorrectionTables};
use crate::controller::manifest::ControllerTarget;

impl ControllerTarget {
    /// Returns the tables that undo a set on the controller: `installed` as they were, and zeros for whatever the set
    /// holds besides. They take as many of the controller's tables as the set: none of its numbers stays in force.
    pub fn restored_tables(&self, set: &CorrectionTables, installed: Option<&CorrectionTables>) -> CorrectionTables {
        let mut old: Vec<&CorrectionTable> = installed.iter().flat_map(|tables| &tables.tables).collect();
        let same = |a: &CorrectionTable, b: &CorrectionTable| (&a.axes, &a.corrected) == (&b.axes, &b.corrected);
        let back = |table: &CorrectionTable| match old.iter().position(|old| same(old, table)) {
            Some(at) => with_room_of(old.remove(at), table),
            None => zero(table),
        };
        let mut tables: Vec<CorrectionTable> = set.tables.iter().map(back).collect();
        tables.extend(old.into_iter().cloned());
        let old = installed.map_or(&[][..], |tables| &tables.errors);
        let known = |curve: &&AxisErrorCurve| !old.iter().any(|old| old.error == curve.error);
        let zeros = set.errors.iter().filter(known).map(|curve| zero_curve(curve, old));
        let errors = old.iter().cloned().chain(zeros).collect();
        CorrectionTables { tables, errors, senses: Vec::new(), scales: set.scales.clone() }
    }
}

fn flat(numbers: &[f64]) -> Vec<f64> {
    vec![0.0; numbers.len()]
}

fn zero(table: &CorrectionTable) -> CorrectionTable {
    CorrectionTable {
        values: flat(&table.values),
        reverse: table.reverse.as_deref().map(flat),
        factors: table.factors.iter().map(|factors| factors.each_ref().map(|factor| flat(factor))).collect(),
        ..table.clone()
    }
}

/// An old table that takes as many of the controller's as the new one: one for each direction, and for each product.
fn with_room_of(old: &CorrectionTable, new: &CorrectionTable) -> CorrectionTable {
    let mut back = old.clone();
    if new.reverse.is_some() && back.reverse.is_none() {
        back.reverse = Some(back.values.clone());
    }
    if let Some(first) = old.factors.first() {
        let none = first.each_ref().map(|factor| flat(factor));
        back.factors.resize(old.factors.len().max(new.factors.len()), none);
    }
    back
}

/// A curve of zeros, at the positions of the others of its axis: they share a column.
fn zero_curve(curve: &AxisErrorCurve, old: &[AxisErrorCurve]) -> AxisErrorCurve {
    let beside = old.iter().find(|old| old.error.axis == curve.error.axis && !old.positions.is_empty());
    let positions = match beside {
        Some(beside) if !curve.positions.is_empty() => beside.positions.clone(),
        _ => curve.positions.clone(),
    };
    AxisErrorCurve { error: curve.error.clone(), values: vec![0.0; positions.len().max(1)], positions }
}
