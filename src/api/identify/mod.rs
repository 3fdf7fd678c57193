//! Measurements to error parameters, and a fitted machine file.
//!
//! - `fit`: the joint fit; `monomials`: each component for itself, the way of the papers;
//! - `plan`: poses worth measuring.
//! - `predict`: readings against a machine file, without a fit.

mod fit;
mod monomials;
mod plan;
mod predict;

pub use crate::identify::verdict::accused::{ResidualGroup, SuspectReadings};
pub use crate::identify::verdict::datum::FittedError;
pub use crate::identify::verdict::fitted::FittedDatum;
pub use crate::identify::verdict::result::{
    BentError, FittedParameter, FormOfAxis, IdentifyResult, KindResidual, KnownValue, LackOfFit, NamedSvg, OrderShares,
    OutlierPlace, PredictedUncertainty, ReadingResidual, RepeatedReadings, RmsBeforeAfter, ScatterOfKind,
    SharedUncertainty,
};
pub use crate::identify::{MonomialCoefficient, MonomialComponent, ResidualTest, Rms};
pub use fit::{IdentifyOptions, identify};
pub use monomials::{MonomialFit, fit_monomials};
pub use plan::{
    ExpectedParameter, ExpectedPrediction, MeasurementPlan, PlanGoal, PlanOptions, PlannedPose, plan_measurements,
};
pub use predict::{PredictOptions, predict};
