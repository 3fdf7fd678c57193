//! Converts corrections (mm, deg) to the numbers that a controller stores, and back: unit, sign, meaning. The same
//! function rounds in both directions, so that the numbers read are those written.

use crate::compensation::{Stored, TableRules};
use crate::machine::AxisKind;

/// The column of a table: how the corrections of one axis are stored.
#[derive(Debug, Clone, Copy)]
pub struct StoredColumn<'a> {
    pub rules: &'a TableRules,
    pub kind: AxisKind,
    /// The factor by which the controller multiplies the numbers of the table.
    pub times: f64,
}

impl<'a> StoredColumn<'a> {
    pub fn new(rules: &'a TableRules, kind: AxisKind) -> Self {
        Self { rules, kind, times: 1.0 }
    }

    fn scale(self) -> f64 {
        self.rules.increment.correction_scale.of(self.kind)
    }

    /// The number stored for a correction. `position` is that of the corrected axis if it spans the table.
    pub fn to_stored(self, correction: f64, position: Option<f64>) -> f64 {
        let value = match self.rules.stored {
            Stored::Correction => correction,
            Stored::Error => -correction,
            Stored::Command => position.unwrap_or(0.0) + correction,
        };
        value * self.scale() / self.times
    }

    /// The correction that a stored number means.
    pub fn correction(self, stored: f64, position: Option<f64>) -> f64 {
        let value = stored * self.times / self.scale();
        let correction = match self.rules.stored {
            Stored::Correction => value,
            Stored::Error => -value,
            Stored::Command => value - position.unwrap_or(0.0),
        };
        self.rules.increment.correction(correction, self.kind)
    }

    /// The number stored for a factor without the sense of a correction.
    pub fn weight(self, factor: f64) -> f64 {
        factor * self.scale()
    }

    /// The factor that a number means which was read as a correction.
    pub fn as_weight(self, correction: f64) -> f64 {
        if self.rules.stored == Stored::Error { -correction } else { correction }
    }

    /// Decimals of stored numbers.
    pub fn decimals(self) -> u8 {
        self.rules.increment.correction_decimals
    }
}

/// The stored form of the positions of an axis.
#[derive(Debug, Clone, Copy)]
pub struct StoredPosition<'a> {
    pub rules: &'a TableRules,
    pub kind: AxisKind,
}

impl StoredPosition<'_> {
    /// The number stored for a position.
    pub fn stored(self, position: f64) -> f64 {
        position * self.rules.increment.position_scale.of(self.kind)
    }

    /// The position that a stored number means.
    pub fn position(self, stored: f64) -> f64 {
        self.rules.increment.position(stored / self.rules.increment.position_scale.of(self.kind), self.kind)
    }

    /// Decimals of stored numbers.
    pub fn decimals(self) -> u8 {
        self.rules.increment.position_decimals
    }
}

/// Differences of whole numbers, from the first to the last.
pub fn differences(absolute: &[f64]) -> Vec<f64> {
    absolute.windows(2).map(|w| libm::round(w[1]) - libm::round(w[0])).collect()
}
