//! The model of the measurements: its parameters, the readings that it predicts, and prior knowledge of the parameters.
//!
//! 1. [`with_command_line`], [`parameters`], [`slope_bounds`], [`unused_entries`]: the words of a request to
//!    [`Parameter`]s; `curves` holds the bases of error curves.
//! 2. [`FitModel`]: the predicted reading of a measurement and its derivatives; `observation` holds the kinds of
//!    reading.
//! 3. `Prior`: prior knowledge of the unknowns; [`TypeB`]: uncertainties that all readings share.
//! 4. [`moore_penrose`]: the linear method of Holub and others 2015.

mod curves;
mod gauge;
mod invariance;
mod known;
mod monomials;
mod observation;
mod parameter;
mod prediction;
mod prior;
mod refusal;
mod request;
mod type_b;
mod volume;

pub use gauge::{Gauge, parse_gauge};
pub use invariance::{Invariances, invariances};
pub use known::{PriorValue, parse_prior};
pub use monomials::{MonomialCoefficient, MonomialComponent, Rms, moore_penrose};
pub(super) use observation::{Observation, ReadingSubject, Slope, observe, single};
pub(super) use parameter::approach_weight;
pub(super) use parameter::sizes;
pub use parameter::{BasisFunction, Clamping, Parameter, ParameterTerm, SlopeBound};
pub(super) use prediction::zero_unread;
pub use prediction::{FitModel, RigidMotion};
pub(super) use prior::Prior;
pub use request::{NEEDED, parameters, parameters_for, slope_bounds, unused_entries, with_command_line};
pub(super) use type_b::OffsetChannel;
pub use type_b::{SharedEffect, TypeB, type_b};
pub(super) use volume::{Volume, middle, volume_poses};
