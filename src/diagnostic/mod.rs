//! Diagnostics: faults of an input, their places, and their remedies.
//!
//! "Error" means a geometric error everywhere in this crate; a failure is a [`Diagnostic`].
//! A stage collects as many as it can into [`Diagnostics`] and goes on; the command line
//! renders them all at the end. Nothing here prints.

pub mod codes;
mod model;
mod record;
mod render;
mod sarif;
mod shown;
mod suggest;

pub use codes::{CODES, Code, info};
pub use model::{Diagnostic, Diagnostics, Label, Place, Reason, Severity, SourceId, Sources};
pub use record::{DiagnosticRecord, PlaceRecord, WarningRecord};
pub use render::{Rendering, render, summary};
pub use sarif::sarif;
pub(crate) use shown::is_layout;
pub use shown::shown;
pub use suggest::{did_you_mean, nearest};
