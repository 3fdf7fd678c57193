//! The report: the page of the workbench in one file, with a report for print and appendices below it.
//!
//! 1. [`PageData`] is everything the appendices show, computed here: machine, statistics, sources of error, curves,
//!    the field of the 3D view, certificates, comparison;
//! 2. pictures are drawn as SVG by this module's neighbours;
//! 3. [`Page::html`] renders `appendices.html.j2` with them, escaped, and embeds the data as one JSON object,
//!    compressed, from which the scripts read every number they show;
//! 4. [`BenchPage`] puts this below the workbench, with what the workbench starts with and perhaps its engine.
//!
//! The page loads nothing and a content security policy forbids it to: scripts run by their hash, styles by a nonce.

mod bench;
mod comparison;
mod data;
mod drawn;
mod field;
mod given;
mod instruments;
mod render;

pub(crate) use bench::source_hash;
pub use bench::{BenchPage, EngineFile};
pub use comparison::ComparisonData;
pub use data::{MachineData, PageData};
pub use given::{MachineInput, TargetResult};
pub use instruments::Instruments;
pub(crate) use render::environment;
pub use render::{Page, PageFailure, Pictures, RenderedPage};

use super::pictures::rising;

/// The scale of colours, from no deviation to the largest.
pub fn colours() -> Vec<String> {
    (0..=10).map(|i| rising(f64::from(i) / 10.0)).collect()
}
