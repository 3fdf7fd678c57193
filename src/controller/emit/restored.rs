//! Tables that take a set back: those that were in force before, and zeros where there were none.

use super::number::decimal_text;
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
            None => self.as_scaled(zero(table), &set.scales),
        };
        let mut tables: Vec<CorrectionTable> = set.tables.iter().map(back).collect();
        tables.extend(old.into_iter().cloned());
        let old = installed.map_or(&[][..], |tables| &tables.errors);
        let known = |curve: &&AxisErrorCurve| !old.iter().any(|old| old.error == curve.error);
        let zeros = set.errors.iter().filter(known).map(|curve| zero_curve(curve, old));
        let errors = old.iter().cloned().chain(zeros).collect();
        CorrectionTables { tables, errors, senses: Vec::new(), scales: set.scales.clone() }
    }

    /// A line that sets the scale of a drive to the one before, with the decimals that the controller has for it.
    fn as_scaled(&self, mut table: CorrectionTable, scales: &[(usize, f64)]) -> CorrectionTable {
        let mechanism = &self.manifest.mechanism;
        let before = scales.iter().find(|(axis, _)| table.axes[0] == *axis).filter(|_| table.is_own_axis());
        let Some(((own, scale), (_, before))) = mechanism.own_axis.as_ref().zip(mechanism.scale()).zip(before) else {
            return table;
        };
        let written = decimal_text(*before, own.table.increment.correction_decimals).parse();
        table.set_slope_of_line(written.map_or(0.0, |written: f64| scale.slope(*before, written)));
        table
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
