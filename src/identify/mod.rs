//! Identification: from measured deviations to error parameters.
//!
//! 1. [`read_measurements`]: CSV files to [`Measurement`]s, and the unknowns of the instruments.
//! 2. [`with_command_line`], [`parameters`], [`slope_bounds`], [`unused_entries`]: the words of `--fit` or of the
//!    section `identify` to [`Parameter`]s.
//! 3. [`FitModel`]: the predicted readings of the machine with these parameters, exactly or to an order, and their
//!    derivatives.
//! 4. [`solve()`]: the weights of the readings, and with them [`fit()`]: weighted least squares by Levenberg-Marquardt.
//! 5. [`Solution`]: rank, null space in words, uncertainty; directions below noise.
//! 6. [`Residuals`], [`randomness()`], [`held_out`]: residuals, outliers, single orders, tests for noise, prediction of
//!    data not used.
//! 7. [`fitted_file()`]: the fitted machine as a self-contained machine file.
//! 8. `second`: a second measurement, with the compensation in force, against what was predicted.
//!
//! [`moore_penrose`] is the method of the papers, [`import`] reads single-axis measurements, [`import_touches`] touches
//! of balls, and [`plan()`] proposes
//! the poses of a measurement with its expected uncertainties. `thresholds` holds every number that decides what a fit
//! says.

mod balls;
mod data;
mod fitted_file;
mod lists;
mod model;
pub(crate) mod second;
mod solve;
mod suspect;
mod thresholds;
pub(crate) mod verdict;
mod words;

pub use balls::{BallCentre, OutlierTouch, ProbeLobing, TouchCoordinates, TouchImport, TouchRequest, import_touches};
pub(crate) use data::{AND, COMPONENTS, lever, taken_together};
pub use data::{
    Change, ChangeNames, DistanceEnd, Measurement, MeasurementSet, PlanInstrument, Reading, ReadingContext,
    ReadingKind, Repeats, Scope, ToolUse, TurnKind, groups, import, read_measurements, repeats,
};
pub use fitted_file::{FileNotes, fitted_file, largest_uncertainty};
pub use model::{
    BasisFunction, Clamping, FitModel, Gauge, Invariances, MonomialCoefficient, MonomialComponent, NEEDED, Parameter,
    ParameterTerm, PriorValue, Rms, SharedEffect, SlopeBound, TypeB, invariances, moore_penrose, parameters,
    parameters_for, parse_gauge, parse_prior, slope_bounds, type_b, unused_entries, with_command_line,
};
pub(crate) use solve::both_tails;
pub use solve::{
    Bend, DatumChange, DatumConditions, DeviationUncertainty, Estimate, FitInData, FormUncertainty, Outlier,
    ParameterFit, Prediction, ResidualTest, Residuals, RigidMotionRemoved, Scatter, Solution, common, expected, fit,
    form_uncertainty, held_out, in_datum, measured_ranges, plan, randomness, solve, typical_size, unheld,
};
pub use suspect::{Circumstances, Suspicion, suspect};
