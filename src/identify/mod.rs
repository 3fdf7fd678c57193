//! Identification: from measured deviations to error parameters.
//!
//! 1. [`read_measurements`]: CSV files to [`Measurement`]s.
//! 2. [`parameters`]: the words of `--fit` or of the section `identify` to [`Parameter`]s.
//! 3. [`Model`]: what the machine with these parameters would be measured as, exactly, and its derivatives.
//! 4. [`fit()`], [`robust_fit`]: weighted least squares by Levenberg-Marquardt.
//! 5. [`Solution`]: rank, null space in words, uncertainty; what the noise drowns.
//! 6. [`Residuals`], [`held_out`]: what is left, outliers, orders apart, prediction of data not used.
//! 7. [`fitted_file`]: the fitted machine as a self-contained machine file.
//!
//! [`plan()`] goes before all of them: which poses to measure, and what they will tell.

mod checks;
mod columns;
mod curves;
mod file;
mod fit;
pub mod import;
mod measurement;
mod model;
mod parameter;
mod plan;
mod randomness;
mod reader;
mod request;
mod solution;
mod station;

pub use checks::{Outlier, Residuals, held_out, repeatability};
pub use file::fitted_file;
pub use fit::{Fit, fit, robust_fit};
pub use measurement::{Data, End, Kind, Measurement, Reading};
pub use model::Model;
pub use parameter::{Basis, Parameter, SlopeBound, Term};
pub use plan::{Plan, plan};
pub use randomness::{Randomness, randomness};
pub use reader::read_measurements;
pub use request::{parameters, slope_bounds};
pub use solution::{Estimate, Solution};
