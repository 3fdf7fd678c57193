//! The rounded tables of a target, filled from a machine, and the numbers in them that its manifest forbids.

use super::limits::steepest_along;
use super::stored::{StoredColumn, differences};
use crate::compensation::{
    CorrectionTable, CorrectionTables, Crowded, Encoding, LatticeRequest, TableRules, lacking, tables,
};
use crate::controller::manifest::ControllerTarget;
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::Machine;
use crate::units::significant;

impl ControllerTarget {
    /// Fills the tables of the target's mechanisms and rounds them to its increments. The request is for
    /// lattices over any axes; the others have nothing to choose.
    pub fn tables(&self, machine: &Machine, request: &LatticeRequest) -> CorrectionTables {
        tables(machine, &self.manifest.mechanism, request)
    }

    /// Returns the reason why the target cannot be used for a machine: E0708.
    pub fn refusal(&self, machine: &Machine) -> Option<Diagnostic> {
        let why = lacking(machine, &self.manifest.mechanism)?;
        let message = format!("the target `{}` cannot be used: {why}", self.manifest.target);
        Some(Diagnostic::new(codes::E0708, message).help("`abbe targets` lists what each controller can hold"))
    }

    /// Returns a refusal of everything in the tables that the controller does not take: E0709.
    pub fn violations(&self, machine: &Machine, tables: &CorrectionTables) -> Vec<Diagnostic> {
        let of = |table: &CorrectionTable| {
            let rules = self.manifest.mechanism.rules(table);
            rules.map_or_else(Vec::new, |rules| forbidden(machine, table, rules))
        };
        let mut all: Vec<Diagnostic> = tables.tables.iter().flat_map(of).collect();
        for (name, rules) in self.manifest.mechanism.iter() {
            let count = tables.tables.iter().filter(|t| self.manifest.mechanism.name_of(t) == Some(name)).count();
            if count > rules.max_tables {
                all.push(refusal(format!("{name}: {count} tables, the controller has {}", rules.max_tables)));
            }
        }
        if let Some(Crowded::Output(name, axis)) = self.manifest.mechanism.excess(tables) {
            let axis = &machine.axes()[axis].name;
            all.push(refusal(format!("{name}: more tables that correct `{axis}` than the controller has for an axis")));
        }
        let count = tables.tables.iter().map(|table| self.manifest.mechanism.count(table)).sum::<usize>();
        if let Some(max) = self.manifest.mechanism.tables.filter(|max| count > *max) {
            all.push(refusal(format!("{count} tables in all, the controller has {max}")));
        }
        all
    }
}

fn refusal(message: String) -> Diagnostic {
    Diagnostic::new(codes::E0709, message)
        .help("the controller would refuse or clip it: correct the machine mechanically, or look for a wrong unit")
}

/// Returns refusals of a table that is beyond its rules.
fn forbidden(machine: &Machine, table: &CorrectionTable, rules: &TableRules) -> Vec<Diagnostic> {
    let names: Vec<&str> = table.axes.iter().map(|axis| machine.axes()[*axis].name.as_str()).collect();
    let over = names.join(" and ");
    let mut all = Vec::new();
    let longest = table.nodes.iter().map(Vec::len).max().unwrap_or(0);
    if table.len() > rules.max_points || longest > rules.max_points_per_axis {
        let max = rules.max_points.min(rules.max_points_per_axis);
        all.push(refusal(format!("a table over {over} has {} points, the controller takes {max}", table.len())));
    }
    let times = rules.magnification_of(machine, table);
    let columns = std::iter::once(&table.values).chain(&table.reverse);
    for (values, (column, axis)) in columns.flat_map(|v| table.corrected.iter().enumerate().map(move |c| (v, c))) {
        let name = &machine.axes()[*axis].name;
        let kind = machine.axes()[*axis].kind;
        let stored =
            store_column(table, rules, values, column, StoredColumn { times, ..StoredColumn::new(rules, kind) });
        let largest = stored.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        if rules.largest.is_some_and(|max| largest > max) {
            let max = rules.largest.unwrap_or_default();
            all.push(refusal(format!(
                "`{name}` over {over}: the number {} is beyond the controller's {max}",
                significant(largest, 6)
            )));
        }
        let slope = (0..table.axes.len()).map(|place| steepest_along(table, values, place, column)).fold(0.0, f64::max);
        if rules.max_slope.is_some_and(|max| slope > max) {
            let max = rules.max_slope.unwrap_or_default();
            all.push(refusal(format!(
                "`{name}` over {over}: a slope of {} is beyond the controller's {max}",
                significant(slope, 4)
            )));
        }
    }
    all
}

fn store_column(
    table: &CorrectionTable,
    rules: &TableRules,
    values: &[f64],
    column: usize,
    cell: StoredColumn,
) -> Vec<f64> {
    let own = table.axes.iter().position(|axis| *axis == table.corrected[column]);
    let number = |node: usize| {
        let position = own.map(|place| table.node(node)[place]);
        cell.to_stored(values[node * table.corrected.len() + column], position)
    };
    let all: Vec<f64> = (0..table.len()).map(number).collect();
    if rules.encoding == Encoding::Difference { differences(&all) } else { all }
}
