//! Which of the errors that act in a machine have a value, a bound, or neither; and bounds that stand in for the last.

use super::bounds::{Bound, adding, bounds, is_measured};
use super::staying::count_staying;
use crate::machine::{Class, Machine, classes};
use schemars::JsonSchema;
use serde::Serialize;

/// The class that stands in for errors of which nothing is known.
pub const STAND_IN_CLASS: &str = "production";

/// Counts of the known errors among those that act in a machine's own chain: six of each axis, and the location errors
/// that are no choice of coordinates.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Coverage {
    /// Number of errors with a value that no bound stands for.
    pub valued: usize,
    /// Number of errors that are bounded, by the file or by a class.
    pub bounded: usize,
    /// Names of the errors that have neither. None on a machine with measured values and no bounds: what it does not
    /// state is zero.
    pub missing: Vec<String>,
    /// The missing errors, with the bounds of [`STAND_IN_CLASS`].
    #[serde(skip)]
    open: Vec<Bound>,
}

impl Coverage {
    /// Returns the coverage of a machine by its values and by the bounds in force.
    pub fn of(machine: &Machine, in_force: &[Bound]) -> Self {
        let class = classes().remove(STAND_IN_CLASS);
        let is_whole = in_force.is_empty() && is_measured(machine);
        let open = if is_whole { Vec::new() } else { open(machine, in_force, class.as_ref()) };
        let missing = open.iter().map(Bound::to_string).collect();
        Self { valued: count_staying(machine, in_force), bounded: in_force.len(), missing, open }
    }

    /// Number of errors that act.
    pub fn acting(&self) -> usize {
        self.valued + self.bounded + self.missing.len()
    }

    /// Returns the bounds in force, and for each missing error the bound that the other machine has for the same
    /// direction of the same axis, or else that of the class; without a class it stays missing.
    pub fn fill(&self, machine: &Machine, in_force: &[Bound], other: &[Bound], class: Option<&Class>) -> Vec<Bound> {
        let of_class = class.map_or_else(Vec::new, |class| open(machine, in_force, Some(class)));
        let stand_in = |bound: &Bound| {
            let found = other.iter().chain(&of_class).find(|b| is_alike(b, bound))?;
            Some(Bound { tolerance: found.tolerance, ..bound.clone() })
        };
        in_force.iter().cloned().chain(self.open.iter().filter_map(stand_in)).collect()
    }
}

/// The errors that a class would bound and the bounds in force do not.
fn open(machine: &Machine, in_force: &[Bound], class: Option<&Class>) -> Vec<Bound> {
    let all = adding(machine, &bounds(machine, class)).into_iter().filter(|bound| bound.of_class);
    all.filter(|bound| !in_force.iter().any(|own| is_alike(own, bound))).collect()
}

fn is_alike(a: &Bound, b: &Bound) -> bool {
    a.error == b.error && a.role == b.role
}
