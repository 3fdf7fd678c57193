//! Least squares.
//!
//! 1. [`fit()`]: Levenberg-Marquardt with given weights; [`solve()`]: the same with weights by the scatter of the
//!    readings.
//! 2. [`Solution`]: rank, null space and uncertainty of a fit.
//!    [`form_uncertainty()`]: the uncertainty by the form of the axes beside the curves.
//! 3. [`FitInData`], [`Residuals`], [`held_out`], [`randomness()`]: checks of the fit against the data.
//! 4. [`plan()`]: poses worth measuring, before there are data.

mod bend;
mod checks;
mod common;
mod datum;
mod fit;
mod form;
mod form_sizes;
mod in_data;
mod lack_of_fit;
mod plan;
mod plausible;
mod randomness;
mod solution;
mod sums;
mod unheld;
mod volume;
mod weighing;

pub use bend::Bend;
pub use checks::{Outlier, Residuals, held_out, typical_size};
pub use common::common;
pub use datum::{DatumChange, DatumConditions, RigidMotionRemoved, in_datum, measured_ranges};
pub use fit::{ParameterFit, Scatter, fit};
pub use in_data::FitInData;
pub use lack_of_fit::{FormUncertainty, form_uncertainty};
pub use plan::{expected, plan};
pub(crate) use randomness::both_tails;
pub use randomness::{ResidualTest, randomness};
pub use solution::{Estimate, Solution};
pub use unheld::unheld;
pub use volume::{DeviationUncertainty, Prediction};
pub use weighing::solve;
