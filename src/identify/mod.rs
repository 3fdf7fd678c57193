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
mod lists;
mod model;
mod solve;
mod words;

pub use data::{
    DistanceEnd, InstrumentUnknown, Measurement, MeasurementSet, Reading, ReadingKind, Repeats, import,
    read_measurements, repeats,
};
pub use fitted_file::fitted_file;
pub use model::{
    Basis, Coefficient, Component, Model, Monomial, Parameter, SlopeBound, Term, moore_penrose, overruled, parameters,
    slope_bounds, unused,
};
pub use solve::{
    Estimate, Fit, MeasurementPlan, Outlier, Randomness, Residuals, Scatter, Solution, fit, held_out, plan, randomness,
    solve,
};
