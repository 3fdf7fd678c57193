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
mod spread;
mod student;
mod targets;

pub use annex_a::{AccuracyUncertainty, Contributor, LISTED, REFERENCE, Thermal, contributor, contributors, thermal};
pub use circle::{BothSenses, CircleFigures, LEAST_ARC, MIN_READINGS, RadialReading, Sense, arc};
pub use circle_causes::{Caused, CircleCauses, Spike, TurningPoint, causes};
pub use conformity::{Conformity, LimitSides, LimitedValue};
pub use drift::DriftFigures;
pub use positioning::{AccuracyFigures, OneWayFigures, Repeated, TargetReading, TargetReadings};
pub use readings::{ReadingsTable, TableUse};
pub use rotation::{AngleReading, ErrorMotion, LEAST_PLACES, rotating};
pub use spikes::FALSE_ALARM;
use spread::slope;
pub use spread::{NOT_VERIFIED, range};
pub(crate) use student::Coverage;
pub use targets::remarks;
