//! The context in which a file is read.

use crate::controller::manifest::{AssignedAxis, ControllerTarget, by_number};
use crate::machine::Machine;

/// The context in which a file is read.
pub struct ReadContext<'a> {
    pub target: &'a ControllerTarget,
    pub machine: &'a Machine,
    /// The axes in the controller's order.
    pub letters: Vec<AssignedAxis>,
    /// The axis to which the file belongs by its name.
    pub axis: Option<usize>,
    /// The mm of a unit of length in tables, and the deg of a unit of angle.
    pub units: [f64; 2],
}

impl ReadContext<'_> {
    /// The axis with one of the controller's letters.
    pub fn by_letter(&self, letter: &str) -> Option<usize> {
        self.letters.iter().find(|known| known.letter == letter).map(|known| known.axis)
    }

    /// The axis with one of the controller's numbers, from 1.
    pub fn by_number(&self, number: &str) -> Option<usize> {
        by_number(&self.letters, number.parse().ok()?).map(|known| known.axis)
    }
}
