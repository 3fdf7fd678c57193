//! Identification: from measured deviations to error parameters.
//!
//! 1. [`read_measurements`]: CSV files to [`Measurement`]s, and the unknowns of the instruments.
//! 2. [`overruled`], [`parameters`], [`slope_bounds`], [`unused`]: the words of `--fit` or of the section `identify` to [`Parameter`]s.
//! 3. [`Model`]: what the machine with these parameters would be measured as, exactly or to an order, and its derivatives.
//! 4. [`solve()`]: what readings weigh, and with that [`fit()`]: weighted least squares by Levenberg-Marquardt.
//! 5. [`Solution`]: rank, null space in words, uncertainty; what the noise drowns.
//! 6. [`Residuals`], [`randomness()`], [`held_out`]: what is left, outliers, orders apart, is it noise, prediction of data
//!    not used.
//! 7. [`fitted_file()`]: the fitted machine as a self-contained machine file.
//!
//! [`moore_penrose`] is the papers' own way beside it, [`import`] reads single-axis measurements, and
//! [`plan()`] goes before all of them: which poses to measure, and what they will tell.

mod data;
mod fitted_file;
mod model;
mod solve;
mod words;

pub use data::import;
pub use data::measurement::{Data, End, Measurement, Reading, ReadingKind};
pub use data::reader::read_measurements;
pub use data::repeats::{Repeats, repeats};
pub use fitted_file::fitted_file;
pub use model::monomials::{Coefficient, Component, Monomial, moore_penrose};
pub use model::parameter::{Basis, Parameter, SlopeBound, Term};
pub use model::prediction::Model;
pub use model::request::{overruled, parameters, slope_bounds, unused};
pub use solve::checks::{Outlier, Residuals, held_out};
pub use solve::fit::{Fit, fit};
pub use solve::plan::{MeasurementPlan, plan};
pub use solve::randomness::{Randomness, randomness};
pub use solve::solution::{Estimate, Solution};
pub use solve::weighing::{Scatter, solve};
