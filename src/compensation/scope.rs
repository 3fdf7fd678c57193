//! A correction, and what is to be corrected with which axes.

use crate::machine::Machine;

/// What is added to a command: mm for linear axes, deg for rotary axes, in the order of
/// [`Machine::axes`].
#[derive(Debug, Clone, PartialEq)]
pub struct Correction(pub Vec<f64>);

impl Correction {
    /// Nothing is added.
    pub fn none(machine: &Machine) -> Self {
        Self(vec![0.0; machine.axes().len()])
    }

    /// The corrected command.
    pub fn applied(&self, pose: &[f64]) -> Vec<f64> {
        pose.iter().zip(&self.0).map(|(q, c)| q + c).collect()
    }
}

/// What is corrected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Goal {
    /// The position of the functional point.
    Position,
    /// The position and the direction of the tool axis; rotation about the tool axis is left.
    Pose,
}

/// What is corrected, and with which axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scope {
    /// What.
    pub goal: Goal,
    /// With the rotary axes too? They turn the tool, and move it where the linear axes cannot.
    pub rotary: bool,
    /// Rotary axes are trusted with the direction of the tool down to this sensitivity (sine of the
    /// angle from a singular pose); below it their correction is bounded instead of exact.
    pub damping: f64,
}

impl Scope {
    /// The position, with the linear axes.
    pub const POSITION: Self = Self { goal: Goal::Position, rotary: false, damping: 0.0 };
}
