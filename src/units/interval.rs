//! A range of positions or values between two ends.

/// A closed interval, in the unit of what it bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub min: f64,
    /// Upper end.
    pub max: f64,
}

impl Interval {
    /// The interval between two ends.
    pub const fn new(min: f64, max: f64) -> Self {
        Self { min, max }
    }

    /// The interval between two ends in any order.
    pub fn between(a: f64, b: f64) -> Self {
        Self::new(a.min(b), a.max(b))
    }

    /// Returns the distance between the ends.
    pub fn span(self) -> f64 {
        self.max - self.min
    }

    /// True if a value lies between the ends or at one of them.
    pub fn contains(self, value: f64) -> bool {
        (self.min..=self.max).contains(&value)
    }
}
