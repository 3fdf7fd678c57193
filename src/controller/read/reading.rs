//! The context in which a file is read.

use crate::controller::manifest::ControllerTarget;
use crate::machine::Machine;

/// The context in which a file is read.
pub struct Reading<'a> {
    pub target: &'a ControllerTarget,
    pub machine: &'a Machine,
    /// (index of the axis, letter) in the controller's order.
    pub letters: Vec<(usize, String)>,
    /// The axis to which the file belongs by its name.
    pub axis: Option<usize>,
}

impl Reading<'_> {
    /// The axis with one of the controller's letters.
    pub fn by_letter(&self, letter: &str) -> Option<usize> {
        self.letters.iter().find(|(_, known)| known == letter).map(|(axis, _)| *axis)
    }

    /// The axis with one of the controller's numbers, from 1.
    pub fn by_number(&self, number: &str) -> Option<usize> {
        let number: usize = number.parse().ok()?;
        self.letters.get(number.checked_sub(1)?).map(|(axis, _)| *axis)
    }
}
