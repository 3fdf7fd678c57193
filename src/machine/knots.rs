//! Positions with values, from which curves are made.

use crate::units::FARTHEST;

/// Strictly increasing positions with their values.
#[derive(Debug, Clone, PartialEq)]
pub struct Knots {
    pub(super) positions: Vec<f64>,
    pub(super) values: Vec<f64>,
    /// Length of the period (360 deg) on a continuous axis.
    pub(super) period: Option<f64>,
}

/// The reason for which a list of points is not a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum KnotsFailure {
    /// No points at all.
    Empty,
    /// The point with this index is not above its predecessor.
    NotIncreasing(usize),
    /// The point with this index is nearer to its predecessor than [`Knots::NEAREST`].
    TooNear(usize),
    /// The position of the point with this index is beyond [`FARTHEST`].
    TooFar(usize),
    /// A periodic table must cover exactly one period.
    NotOnePeriod,
    /// The ends of a periodic table differ.
    EndsDiffer,
    /// A value or position is not finite.
    NotFinite(usize),
}

impl Knots {
    /// Least distance of two positions, mm or deg: slopes between them stay numbers that can be reckoned with.
    pub const NEAREST: f64 = 1e-12;
    /// Relative difference of the values at both ends of a turn that counts as none: `0.969 um` and `969 nm` are the
    /// same length and differ in the last bit.
    pub const CLOSED: f64 = 1e-12;

    /// Checks and keeps the points; `period` makes look-ups wrap.
    pub fn new(points: &[(f64, f64)], period: Option<f64>) -> Result<Self, KnotsFailure> {
        let (first, last) = points.first().zip(points.last()).ok_or(KnotsFailure::Empty)?;
        if let Some(i) = points.iter().position(|p| !(p.0.is_finite() && p.1.is_finite())) {
            return Err(KnotsFailure::NotFinite(i));
        }
        if let Some(i) = points.windows(2).position(|w| w[1].0 <= w[0].0) {
            return Err(KnotsFailure::NotIncreasing(i + 1));
        }
        if let Some(i) = points.windows(2).position(|w| w[1].0 - w[0].0 < Self::NEAREST) {
            return Err(KnotsFailure::TooNear(i + 1));
        }
        if let Some(i) = points.iter().position(|p| p.0.abs() > FARTHEST) {
            return Err(KnotsFailure::TooFar(i));
        }
        if let Some(period) = period {
            if last.0 - first.0 != period {
                return Err(KnotsFailure::NotOnePeriod);
            }
            if (last.1 - first.1).abs() > Self::CLOSED * f64::max(last.1.abs(), first.1.abs()) {
                return Err(KnotsFailure::EndsDiffer);
            }
        }
        let (positions, mut values): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        if let (Some(_), Some(last)) = (period, values.last_mut()) {
            *last = first.1;
        }
        Ok(Self { positions, values, period })
    }

    /// Positions, strictly increasing.
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// Values at the positions.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The period, on a continuous axis.
    pub fn period(&self) -> Option<f64> {
        self.period
    }

    /// The same positions with other values.
    pub(super) fn with_values(self, values: Vec<f64>) -> Self {
        Self { values, ..self }
    }

    /// Index of the interval and the position, wrapped or held at the ends.
    pub(super) fn locate(&self, position: f64) -> (usize, f64) {
        let first = self.positions[0];
        let last = self.positions[self.positions.len() - 1];
        let x = match self.period {
            Some(period) => first + (position - first).rem_euclid(period),
            None => position.clamp(first, last),
        };
        let above = self.positions.partition_point(|p| *p <= x);
        (above.saturating_sub(1).min(self.positions.len().saturating_sub(2)), x)
    }

    /// Interval length, and the weights of its right and left knot at `x`.
    fn weights(&self, i: usize, x: f64) -> (f64, f64, f64) {
        let h = self.positions[i + 1] - self.positions[i];
        let b = (x - self.positions[i]) / h;
        (h, 1.0 - b, b)
    }

    pub(super) fn linear(&self, position: f64) -> f64 {
        if self.values.len() == 1 {
            return self.values[0];
        }
        let (i, x) = self.locate(position);
        let (_, a, b) = self.weights(i, x);
        a * self.values[i] + b * self.values[i + 1]
    }

    pub(super) fn cubic(&self, second: &[f64], position: f64) -> f64 {
        if self.values.len() == 1 {
            return self.values[0];
        }
        let (i, x) = self.locate(position);
        let (h, a, b) = self.weights(i, x);
        let bend = (a * a * a - a) * second[i] + (b * b * b - b) * second[i + 1];
        a * self.values[i] + b * self.values[i + 1] + bend * h * h / 6.0
    }
}
