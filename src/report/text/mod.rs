//! Results as text, LaTeX and JSON.

mod bounded;
mod budget;
pub mod equations;
mod instruments;
mod positions;
mod properties;

pub use bounded::{BoundedFigures, LengthDifference, RssDifference};
pub use budget::{BudgetReport, DrawSettings, budgets_json, tolerance, tolerance_unit};
pub use instruments::{circle_json, line_json, turn_json};
pub(super) use positions::pose_words;
pub use positions::positions;
pub use properties::{MachineDifference, PropertyDifference};
pub(crate) use properties::{described, rotation_words};
