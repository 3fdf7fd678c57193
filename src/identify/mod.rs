//! Identification: from measured deviations to error parameters.
//!
//! 1. [`read_measurements`]: CSV files to [`Measurement`]s, and the unknowns of the instruments.
//! 2. [`overruled`], [`parameters`], [`slope_bounds`], [`unused`]: the words of `--fit` or of the section `identify`
//!    to [`Parameter`]s.
//! 3. [`Model`]: the predicted readings of the machine with these parameters, exactly or to an order, and their
//!    derivatives.
//! 4. [`solve()`]: the weights of the readings, and with them [`fit()`]: weighted least squares by Levenberg-Marquardt.
//! 5. [`Solution`]: rank, null space in words, uncertainty; directions that the noise hides.
//! 6. [`Residuals`], [`randomness()`], [`held_out`]: residuals, outliers, single orders, tests for noise, prediction
//!    of data
//!    not used.
//! 7. [`fitted_file()`]: the fitted machine as a self-contained machine file.
//!
//! [`moore_penrose`] is the method of the papers, [`import`] reads single-axis measurements, and [`plan()`] proposes
//! the poses
//! of a measurement with its expected uncertainties.

mod data;
mod fitted_file;
mod lists;
mod model;
mod solve;
pub(crate) mod verdict;
mod words;

pub(crate) use data::lever;
pub use data::{
    DistanceEnd, Measurement, MeasurementSet, Reading, ReadingContext, ReadingKind, Repeats, import, read_measurements,
    repeats,
};
pub use fitted_file::{FileNotes, fitted_file, largest_uncertainty};
pub use model::{
    Basis, Coefficient, Component, Invariances, Known, Model, Monomial, Parameter, SharedEffect, SlopeBound, Term,
    TypeB, invariances, known, moore_penrose, overruled, parameters, slope_bounds, type_b, unused,
};
pub use solve::{
    Conditions, Estimate, Fit, Misfit, Moved, Outlier, Prediction, Randomness, Residuals, Scatter, Solution, Spread,
    common, fit, held_out, in_datum, misfit, plan, randomness, solve,
};
