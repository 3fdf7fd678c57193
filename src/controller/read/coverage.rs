//! Tables that end before the axis does, as files do that were cut off where a line ends.

use crate::compensation::{CorrectionTable, CorrectionTables, Spacing};
use crate::controller::manifest::ControllerTarget;
use crate::controller::manifest::OutsideTable;
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::{AxisKind, Machine};
use crate::units::significant;

impl ControllerTarget {
    /// Warns of tables and curves whose points do not reach the ends of the volume (W0705).
    pub fn coverage_warnings(&self, machine: &Machine, tables: &CorrectionTables) -> Vec<Diagnostic> {
        let of_table = |table: &CorrectionTable| -> Vec<Diagnostic> {
            let rules = self.manifest.mechanism.rules(table);
            if rules.is_none_or(|rules| rules.spacing == Spacing::Line) {
                return Vec::new();
            }
            let outputs: Vec<&str> = table.corrected.iter().map(|axis| machine.axes()[*axis].name.as_str()).collect();
            let what = format!("the table that corrects {}", outputs.join(", "));
            let spans = table.axes.iter().zip(&table.nodes);
            spans.filter_map(|(axis, nodes)| self.short(machine, &what, *axis, nodes)).collect()
        };
        let of_curve = |curve: &crate::compensation::AxisErrorCurve| {
            let axis = machine.axis_index(curve.error.axis.as_str())?;
            self.short(machine, &format!("the curve of {}", curve.error), axis, &curve.positions)
        };
        let curves = tables.errors.iter().filter(|curve| !curve.positions.is_empty()).filter_map(of_curve);
        tables.tables.iter().flat_map(of_table).chain(curves).collect()
    }

    /// Warns of positions that end more than one of their steps before the volume does.
    fn short(&self, machine: &Machine, what: &str, axis: usize, nodes: &[f64]) -> Option<Diagnostic> {
        let (first, last) = (*nodes.first()?, *nodes.last()?);
        let (this, grid) = (&machine.axes()[axis], &machine.volume()[axis]);
        let outside = self.manifest.controller.outside;
        let (min, max) = if machine.is_continuous(axis) { (first, first + 360.0) } else { (grid.min, grid.max) };
        // A thousandth is rounding; where the table begins again, its last point is one step before the first.
        let slack = match (outside, machine.is_continuous(axis)) {
            (OutsideTable::RollOver, _) => nodes.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max) + 1e-3,
            _ => 1e-3 * if this.kind == AxisKind::Rotary { 10.0 } else { 1.0 },
        };
        if first <= min + slack && last >= max - slack {
            return None;
        }
        let number = |q: f64| format!("{} {}", significant(q, 7), this.unit());
        let beyond = match outside {
            OutsideTable::Hold => "the controller holds its end value",
            OutsideTable::Extrapolate => "its outermost straight lines go on",
            OutsideTable::Nothing => "the controller adds nothing",
            OutsideTable::RollOver => "the table begins again",
        };
        let message = format!(
            "{what} has points over {} from {} to {}, and the axis goes from {} to {}: beyond, {beyond}",
            this.name,
            number(first),
            number(last),
            number(min),
            number(max)
        );
        Some(
            Diagnostic::new(codes::W0705, message)
                .help("look whether the file was cut off; tables end with the volume"),
        )
    }
}
