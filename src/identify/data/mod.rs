//! Measurements: from files to rows and to the unknowns of instruments.
//!
//! 1. `columns`: the header of a file to columns.
//! 2. [`read_measurements`]: cells to [`Measurement`]s; `station` finds where a distance measurement stands.
//!    `tracker` has the exports of trackers, and the frame of their instrument.
//! 3. [`repeats()`]: poses that were measured more than once.
//!
//! [`import`] reads the single-axis exports of instruments; `error_name` are the spellings of errors in files.

mod columns;
mod error_name;
mod failure;
pub mod import;
mod measurement;
mod reader;
mod repeats;
mod station;
mod tracker;

pub(super) use error_name::split_direction;
pub use measurement::{DistanceEnd, InstrumentUnknown, Measurement, MeasurementSet, Reading, ReadingKind};
pub(crate) use measurement::{LEVER_MM, lever};
pub use reader::{ReadingContext, read_measurements};
pub use repeats::{Repeats, repeats};
