//! A quantity: a number with its dimension.

/// Largest magnitude of a position or length that is believed, mm or deg: 1 km.
pub const FARTHEST: f64 = 1e6;

/// The powers of length and angle in a unit: `um` is (1, 0), `urad/mm` is (-1, 1).
///
/// A ratio of lengths (`um/m`, `0.02/500`) is (0, 0) and may be given in place of an angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dimension {
    /// Power of length.
    pub length: i8,
    /// Power of angle.
    pub angle: i8,
}

impl Dimension {
    /// A length.
    pub const LENGTH: Self = Self { length: 1, angle: 0 };
    /// An angle.
    pub const ANGLE: Self = Self { length: 0, angle: 1 };
    /// A ratio.
    pub const RATIO: Self = Self { length: 0, angle: 0 };

    /// The field's word for it, for messages.
    pub fn word(self) -> &'static str {
        match (self.length, self.angle) {
            (1, 0) => "a length",
            (0, 1) => "an angle",
            (0, 0) => "a ratio",
            _ => "a compound unit",
        }
    }
}

/// A number in mm and rad with its dimension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Value in mm^length rad^angle.
    pub value: f64,
    /// Its dimension.
    pub dimension: Dimension,
}

impl Quantity {
    /// The value if it is an angle (a ratio of lengths counts as one).
    pub fn as_angle(self) -> Option<f64> {
        matches!(self.dimension, Dimension::ANGLE | Dimension::RATIO).then_some(self.value)
    }

    /// The value if it is a length.
    pub fn as_length(self) -> Option<f64> {
        (self.dimension == Dimension::LENGTH).then_some(self.value)
    }
}
