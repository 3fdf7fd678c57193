//! Figures of the ISO 230 series from readings.
//!
//! `positioning`: ISO 230-2, with `annex_a`, its uncertainty, and `targets`, its choice of targets; `circle`: ISO
//! 230-4, with its causes (`circle_causes`) and reversal `spikes`; `rotation`: ISO 230-7; `drift`: ISO 230-3;
//! `readings`: their tables, and that of diagonals (ISO 230-6); `conformity`: decisions of ISO 14253-1; `student`:
//! quantiles. No text of a standard was at hand. The formulas of `positioning` agree with public measurements; the
//! others rest on general knowledge and are stated as not verified against the text.

mod annex_a;
mod circle;
mod circle_causes;
mod conformity;
mod drift;
mod positioning;
mod readings;
mod rotation;
mod spikes;
mod student;
mod targets;

pub use annex_a::{AccuracyUncertainty, Contributor, REFERENCE, Thermal, contributor, thermal};
pub use circle::{BothSenses, CircleFigures, LEAST_ARC, MIN_READINGS, RadialReading, Sense, arc};
pub use circle_causes::{Caused, CircleCauses, Spike, TurningPoint, causes};
pub use conformity::{Conformity, LimitSides, LimitedValue};
pub use drift::DriftFigures;
pub use positioning::{AccuracyFigures, OneWayFigures, Repeated, TargetReading, TargetReadings};
pub use readings::{ReadingsTable, TableUse};
pub use rotation::{AngleReading, ErrorMotion, LEAST_PLACES, rotating};
pub use spikes::FALSE_ALARM;
pub(crate) use student::Coverage;
pub use targets::remarks;

/// A note for figures whose formulas could not be compared with the text of their standard.
pub const NOT_VERIFIED: &str = "not verified against the text of the standard";

/// Returns the largest value minus the smallest; 0 without values.
pub fn range(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if high >= low { high - low } else { 0.0 }
}

/// Returns the slope of the line of least squares; 0 where all places are one.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len().max(1) as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let sum = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>();
    let square = sum(&|p| (p.0 - x) * (p.0 - x));
    if square > 0.0 { sum(&|p| (p.0 - x) * (p.1 - y)) / square } else { 0.0 }
}
