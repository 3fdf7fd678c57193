//! Judges the numbers of a transformation that is in force: nothing is added to those of another machine, or to those
//! with other signs than a target's manifest takes for granted.

use super::parameters::Parameters;
use crate::compensation::ParameterVector;
use crate::controller::manifest::ControllerTarget;
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::Machine;
use crate::units::significant;

/// A line farther than this from the machine file's is said, mm: beyond the location errors of a machine in order.
const REMARKED_MM: f64 = 0.05;

/// Largest difference of the length of a direction from 1. Six decimals round to 1e-6; an inclined axis that is not
/// normalised is off by tenths.
const NO_UNIT: f64 = 1e-4;

/// A tilt counts by what it moves at this distance, mm.
const LEVER_MM: f64 = 200.0;

/// Distance of a line in force from that of the machine file.
struct Change {
    /// The line, in words.
    of: String,
    /// The larger of the shift across the line and of what its tilt moves, mm.
    mm: f64,
}

impl Parameters {
    /// Judges numbers (mm, components of unit vectors) that are in force on the controller. Returns a warning (W0762)
    /// for lines beside those of the machine file.
    ///
    /// Refusal: E0753, of a direction that is no unit vector, of signs other than the manifest's, and of lines farther
    /// than `max_change_mm` from those of the machine file. Sliding a point along its line is no change.
    pub fn judge_in_force(
        &self,
        machine: &Machine,
        target: &ControllerTarget,
        values: &[f64],
        max_change_mm: f64,
    ) -> Result<Vec<Diagnostic>, Diagnostic> {
        self.refuse_lengths(values)?;
        let changes = self.changes(machine, values);
        let far = changes.iter().filter(|change| change.mm > max_change_mm).max_by(|a, b| a.mm.total_cmp(&b.mm));
        let Some(far) = far else {
            let beside = changes.iter().filter(|change| change.mm > REMARKED_MM).map(|change| {
                let message = format!("in force, {} is {} mm beside the machine file's", change.of, text(change.mm));
                Diagnostic::new(codes::W0762, message).help("is `origin` the axis of this machine?")
            });
            return Ok(beside.collect());
        };
        if let Some(reversed) = self.reversed(machine, values, max_change_mm) {
            let sign = &target.manifest.certainty.sign;
            let message = format!("the numbers in force have the other sign: {}", reversed.join(", "));
            let help =
                format!("this refutes, for this control, the manifest's ({}): {}", sign.level.word(), sign.source);
            return Err(Diagnostic::new(codes::E0753, message).help(help));
        }
        let message = format!(
            "in force, {} is {} mm beside the machine file's, above the limit of {max_change_mm} mm",
            far.of,
            text(far.mm)
        );
        let help = "is it this machine's file, and `origin` its axis? if both are right, raise --max-change";
        Err(Diagnostic::new(codes::E0753, message).help(help))
    }

    fn refuse_lengths(&self, values: &[f64]) -> Result<(), Diagnostic> {
        let mut at = 0;
        for vector in &self.rules.parameters {
            let mut components = self.nominal.vector(vector);
            let named: Vec<(usize, &String)> =
                vector.names().iter().enumerate().filter_map(|(k, name)| Some((k, name.as_ref()?))).collect();
            for (k, _) in &named {
                components[*k] = values[at];
                at += 1;
            }
            let (length, first) = (components.norm(), named.first());
            if let (ParameterVector::Direction { .. }, Some((_, name))) = (vector, first)
                && (length - 1.0).abs() > NO_UNIT
            {
                let message = format!("in force, the vector from `{name}` on has the length {}, not 1", text(length));
                let help = "a direction is a unit vector: enter it so, or read the control's file anew";
                return Err(Diagnostic::new(codes::E0753, message).help(help));
            }
        }
        Ok(())
    }

    fn changes(&self, machine: &Machine, values: &[f64]) -> Vec<Change> {
        let placed = self.rules.transformation(&self.nominal, values);
        let lines = self.nominal.table.iter().chain(&self.nominal.head).zip(placed.table.iter().chain(&placed.head));
        let of_lines = lines.map(|(own, found)| {
            let shift = found.point - own.point;
            let across = shift - found.direction * found.direction.dot(&shift);
            let tilt = (found.direction - own.direction).norm() * LEVER_MM;
            Change { of: format!("the line of `{}`", machine.axes()[own.axis].name), mm: across.norm().max(tilt) }
        });
        let tool = (placed.tool - self.nominal.tool).norm() * LEVER_MM;
        of_lines.chain([Change { of: "the tool axis".to_owned(), mm: tool }]).collect()
    }

    /// Returns the names of the fewest vectors whose reversal leads to the lines of the machine file; `None` if no
    /// reversal does.
    fn reversed(&self, machine: &Machine, values: &[f64], max_change_mm: f64) -> Option<Vec<String>> {
        let widths = self.rules.parameters.iter().map(|vector| vector.names().iter().flatten().count());
        let of: Vec<usize> = widths.enumerate().flat_map(|(vector, width)| vec![vector; width]).collect();
        let mut sets: Vec<u32> = (1..1 << self.rules.parameters.len().min(8)).collect();
        sets.sort_by_key(|set| set.count_ones());
        let within = |set: &u32| {
            let turned: Vec<f64> =
                values.iter().zip(&of).map(|(x, vector)| if set >> vector & 1 == 1 { -x } else { *x }).collect();
            self.changes(machine, &turned).iter().all(|change| change.mm <= max_change_mm)
        };
        let set = sets.into_iter().find(within)?;
        let names = self.names().into_iter().zip(&of).zip(values);
        let turned = names.filter(|((_, vector), x)| set >> *vector & 1 == 1 && **x != 0.0);
        Some(turned.map(|((name, _), _)| format!("`{name}`")).collect())
    }
}

fn text(value: f64) -> String {
    significant(value, 4)
}
