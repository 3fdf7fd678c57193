//! Results as text, LaTeX and JSON.

mod bounded;
mod budget;
pub mod equations;
mod instruments;
mod positions;

pub use bounded::{BoundedFigures, LengthDifference, RssDifference};
pub use budget::{BudgetReport, DrawSettings, budgets_json, tolerance, tolerance_unit};
pub use instruments::{circle_json, line_json, turn_json};
pub(super) use positions::pose_words;
pub use positions::positions;
