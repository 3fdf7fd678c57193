//! The model of the measurements: its parameters, the readings that it predicts, and prior knowledge of the parameters.
//!
//! 1. [`overruled`], [`parameters`], [`slope_bounds`], [`unused`]: the words of a request to [`Parameter`]s; `curves`
//!    holds
//!    the bases of error curves.
//! 2. [`Model`]: the predicted reading of a measurement and its derivatives; `observation` holds the kinds of reading.
//! 3. `Prior`: prior knowledge of the unknowns; [`TypeB`]: uncertainties that all readings share.
//! 4. [`moore_penrose`]: the method of the papers beside it.

mod curves;
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

pub use invariance::{Invariances, invariances};
pub use known::{Known, known};
pub use monomials::{Coefficient, Component, Monomial, moore_penrose};
pub(super) use parameter::share;
pub use parameter::{Basis, Parameter, SlopeBound, Term};
pub use prediction::Model;
pub(super) use prediction::masked;
pub(super) use prior::Prior;
pub use request::{overruled, parameters, slope_bounds, unused};
pub(super) use type_b::Channel;
pub use type_b::{SharedEffect, TypeB, type_b};
pub(super) use volume::{Volume, middle, volume_poses};
