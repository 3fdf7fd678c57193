//! Budgets as they stand in JSON, closed forms as text and LaTeX.

mod bounded;
mod budget;
pub mod equations;
mod positions;
mod properties;

pub use bounded::{BoundedFigures, BoundedLengths, LengthStatistics, RssDifference};
pub use budget::{
    ActingValues, BoundedContribution, BudgetFigures, DeviationBudget, DrawSettings, DrawnMachineFigures,
    PercentileInterval, Tightening, contributions, tolerance, tolerance_unit,
};
pub(super) use positions::pose_words;
pub use properties::{MachineDifference, PropertyDifference};
pub(crate) use properties::{describe, rotation_words};
