//! The façade: one function for each job, from a machine file to certified tables.
//!
//! Every function takes a [`MachineFile`] (or several), a plain struct of options with defaults, and a [`Run`], which
//! says where files are read and who hears of progress. It returns an [`Answer`]: the value, which serde can write in
//! the shape that docs/formats.md describes, and the warnings; or the [`Diagnostics`] that refuse the input.
//!
//! Nothing here prints, writes a file, reads the clock or the environment. What a job writes, it hands over as bytes or
//! into the sinks that the caller gave it.

mod machine_file;
mod run;
mod summary;

pub use machine_file::{LoadOptions, MachineFile, load, loads};
pub use run::{Answer, Monitor, Run};
pub use summary::{AxisSummary, ErrorCounts, MachineSummary, summary};
