//! Range and slope of values, and the note of figures that are not verified.

/// A note for figures whose formulas could not be compared with the text of their standard.
pub const NOT_VERIFIED: &str = "not verified against the text of the standard";

/// Returns the largest value minus the smallest; 0 without values.
pub fn range(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if high >= low { high - low } else { 0.0 }
}

/// Returns the slope of the line of least squares; 0 where all places are one.
pub(super) fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len().max(1) as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let sum = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>();
    let square = sum(&|p| (p.0 - x) * (p.0 - x));
    if square > 0.0 { sum(&|p| (p.0 - x) * (p.1 - y)) / square } else { 0.0 }
}
