//! Scales of drives: steps in a mm, or mm in a turn of the motor. An axis that moves too far needs fewer of the former
//! and more of the latter.
//!
//! A scale acts on the motor: on what all other tables have made of the command. It is a line of the axis over itself,
//! which counts against the value in force.

use super::tables::CorrectionTable;
use serde::Deserialize;

/// The number of a controller by which positions become motor steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DriveScale {
    /// Steps in one mm: Marlin's and RepRapFirmware's M92, Grbl's $100.
    StepsPerMm,
    /// mm in one turn: Klipper's `rotation_distance`.
    MmPerTurn,
}

impl DriveScale {
    /// Values in force below or above are none of a machine.
    pub const RANGE: [f64; 2] = [0.05, 1e6];

    /// Values that drives as a rule have: belts and screws on motors of 200 to 800 steps, with 16 to 64 parts a step.
    pub fn usual(self) -> [f64; 2] {
        match self {
            Self::StepsPerMm => [10.0, 2e4],
            Self::MmPerTurn => [0.5, 60.0],
        }
    }

    /// The number in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::StepsPerMm => "steps in a mm",
            Self::MmPerTurn => "mm in a turn of the motor",
        }
    }

    /// Returns the number that adds `slope` mm to each mm of the way, given the one in force.
    pub fn stored(self, in_force: f64, slope: f64) -> f64 {
        match self {
            Self::StepsPerMm => in_force * (1.0 + slope),
            Self::MmPerTurn => in_force / (1.0 + slope),
        }
    }

    /// Returns the mm that a number adds to each mm of the way, given the one in force.
    pub fn slope(self, in_force: f64, stored: f64) -> f64 {
        match self {
            Self::StepsPerMm => stored / in_force - 1.0,
            Self::MmPerTurn => in_force / stored - 1.0,
        }
    }
}

impl CorrectionTable {
    /// The correction for each mm of a line through position 0.
    pub fn slope_of_line(&self) -> f64 {
        let far = self.nodes[0].last().copied().unwrap_or(1.0);
        self.values.last().map_or(0.0, |value| value / far)
    }

    /// Sets the correction for each mm of a line through position 0.
    pub fn set_slope_of_line(&mut self, slope: f64) {
        self.values = self.nodes[0].iter().map(|q| q * slope).collect();
    }
}
