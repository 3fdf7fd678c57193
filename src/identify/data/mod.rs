//! Measurements: from files to rows and to the unknowns of instruments.
//!
//! 1. `columns`: the header of a file to columns.
//! 2. [`read_measurements`]: cells to [`Measurement`]s, by way of the rows of `draft`. `station` finds where a distance
//!    measurement stands. `tracker` has the exports of trackers, and the frame of their instrument. `touches` has the
//!    unknowns of features, `turns` readings of orientations. `coarse` looks for what was mixed up where readings are
//!    far off their poses.
//! 3. [`repeats()`]: poses that were measured more than once.
//! 4. `candidates`: tables of what an instrument could read, for a plan.
//!
//! `change`: what shops mix up, in words. [`import`] reads the single-axis exports of instruments; `error_name` are the
//! spellings of errors in files.

mod candidates;
pub(in crate::identify) mod change;
mod coarse;
mod columns;
mod draft;
mod error_name;
mod failure;
pub mod import;
mod measurement;
mod reader;
mod repeats;
mod station;
mod touches;
mod tracker;
mod turns;

pub use candidates::PlanInstrument;
pub(crate) use candidates::taken_together;
pub(crate) use change::{AND, COMPONENTS};
pub use change::{Change, ChangeNames, Scope, groups};
pub(super) use error_name::split_direction;
pub use measurement::{
    DistanceEnd, InstrumentUnknown, Measurement, MeasurementSet, Reading, ReadingKind, ToolUse, TurnKind,
};
pub(crate) use measurement::{LEVER_MM, lever};
pub use reader::{ReadingContext, read_measurements};
pub use repeats::{Repeats, repeats};
pub(super) use turns::{rotation_to, tool_axis, turn_effects};
