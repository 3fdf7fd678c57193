//! Increments: the rounding of positions and corrections in a controller's files.

use crate::machine::{AxisKind, Direction};
use serde::Deserialize;

/// Stored units in one mm and in one deg (of error curves: in one rad).
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scale {
    /// Increment in mm.
    pub mm: f64,
    /// Increment in deg.
    pub deg: f64,
}

impl Scale {
    const PLAIN: Self = Self { mm: 1.0, deg: 1.0 };

    fn plain() -> Self {
        Self::PLAIN
    }

    /// Returns the increment for an axis of a kind.
    pub fn of(self, kind: AxisKind) -> f64 {
        if kind == AxisKind::Linear { self.mm } else { self.deg }
    }
}

/// Smallest increments of stored values.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Increment {
    /// Decimals of a position.
    pub position_decimals: u8,
    /// Decimals of a correction.
    pub correction_decimals: u8,
    /// Units of positions.
    #[serde(default = "Scale::plain")]
    pub position_scale: Scale,
    /// Units of corrections.
    #[serde(default = "Scale::plain")]
    pub correction_scale: Scale,
}

impl Increment {
    /// A position (mm or deg) as it will be stored.
    pub fn position(self, q: f64, kind: AxisKind) -> f64 {
        let scale = self.position_scale.of(kind);
        round(q * scale, self.position_decimals) / scale
    }

    /// A correction (mm or deg) as it will be stored.
    pub fn correction(self, c: f64, kind: AxisKind) -> f64 {
        let scale = self.correction_scale.of(kind);
        round(c * scale, self.correction_decimals) / scale
    }

    /// An error (mm or rad) as it will be stored.
    pub fn error(self, value: f64, direction: Direction) -> f64 {
        self.correction(value, if direction.is_rotation() { AxisKind::Rotary } else { AxisKind::Linear })
    }

    /// Positions as they will be stored; those that fall together are one.
    pub(super) fn distinct(self, positions: impl IntoIterator<Item = f64>, kind: AxisKind) -> Vec<f64> {
        let mut stored: Vec<f64> = positions.into_iter().map(|q| self.position(q, kind)).collect();
        stored.dedup();
        stored
    }

    /// Smallest step of a position (mm or deg).
    pub fn min_position(self, kind: AxisKind) -> f64 {
        libm::pow(10.0, -f64::from(self.position_decimals)) / self.position_scale.of(kind)
    }

    /// Half a last place of a correction (mm or deg).
    pub fn half_correction(self, kind: AxisKind) -> f64 {
        0.5 * libm::pow(10.0, -f64::from(self.correction_decimals)) / self.correction_scale.of(kind)
    }
}

/// Rounds to the nearest multiple of the last decimal; the result prints exactly with that many decimals.
pub fn round(value: f64, decimals: u8) -> f64 {
    let scale = libm::pow(10.0, f64::from(decimals));
    libm::round(value * scale) / scale + 0.0
}
