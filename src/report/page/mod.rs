//! The report: one self-contained HTML page for a design review.
//!
//! 1. [`PageData`] is everything the page shows, computed here: machine, statistics, sources of error, curves,
//!    the field of the 3D view, certificates, comparison;
//! 2. pictures are drawn as SVG by this module's neighbours;
//! 3. [`Page::html`] renders `page.html.j2` with them, escaped, and embeds the data as one JSON object, from
//!    which the page's scripts read every number they show.
//!
//! Style and scripts are files beside this one. The page loads nothing and a content security policy forbids
//! it to: only the style and the script with the hashes given there run.

mod comparison;
mod data;
mod drawn;
mod field;
mod given;
mod instruments;
mod render;

pub use comparison::ComparisonData;
pub use data::{MachineData, PageData};
pub use given::{MachineInput, TargetResult};
pub use instruments::Instruments;
pub(super) use render::style_hash;
pub use render::{Delivery, Page, Pictures, RenderedPage};

use super::pictures::rising;

/// The scale of colours, from no deviation to the largest.
pub fn colours() -> Vec<String> {
    (0..=10).map(|i| rising(f64::from(i) / 10.0)).collect()
}
