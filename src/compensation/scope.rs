//! A correction, and the goal and the axes of correcting.

use crate::machine::Machine;

/// Correction of a command: mm for linear axes, deg for rotary axes, in the order of [`Machine::axes`].
#[derive(Debug, Clone, PartialEq)]
pub struct Correction(pub Vec<f64>);

impl Correction {
    /// Returns the zero correction.
    pub fn none(machine: &Machine) -> Self {
        Self(vec![0.0; machine.axes().len()])
    }

    /// The corrected command.
    pub fn corrected_command(&self, pose: &[f64]) -> Vec<f64> {
        pose.iter().zip(&self.0).map(|(q, c)| q + c).collect()
    }
}

/// Goal of the correction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Goal {
    /// The position of the functional point.
    Position,
    /// The position and the direction of the tool axis; rotation about the tool axis is not corrected.
    Pose,
}

/// Goal and axes of the correction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scope {
    /// Goal.
    pub goal: Goal,
    /// True if the rotary axes correct too. They turn the tool, and move it where the linear axes cannot.
    pub rotary: bool,
    /// Rotary axes are trusted with the direction of the tool down to this sensitivity (sine of the
    /// angle from a singular pose); below it their correction is bounded instead of exact.
    pub damping: f64,
}

impl Scope {
    /// The position, with the linear axes.
    pub const POSITION: Self = Self { goal: Goal::Position, rotary: false, damping: 0.0 };
}
