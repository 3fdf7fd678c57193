//! The verdict on a fit: its values as a result, the limits that they must keep, and the warnings.
//!
//! - [`problem`]: the parameters, their known values, and the readings; [`passes`]: those of the fit, to the file;
//! - [`diagnose`](mod@diagnose): the fit judged in its datum;
//! - [`fitted`]: a fit with all that is known of it;
//! - [`datum`]: the conditions of its datum, and every fitted error in it;
//! - [`accused`]: what is left by groups of readings, and changes of the data that explain it;
//! - [`limits`]: sizes of errors and uncertainties that follow from the readings;
//! - [`runs`]: runs of which one is the other with another sign, or doubled, and readings that are all relative;
//! - [`resting`]: a point of the machine file with which balls that rest would wander;
//! - [`result`]: the fit as a value; [`remarks`]: its warnings; [`advice`]: what may be fixed.

pub(crate) mod accused;
pub(crate) mod advice;
pub(crate) mod datum;
pub(crate) mod diagnose;
pub(crate) mod fitted;
pub(crate) mod inputs;
pub(crate) mod limits;
pub(crate) mod passes;
pub(crate) mod problem;
pub(crate) mod provenance;
pub(crate) mod remarks;
pub(crate) mod resting;
pub(crate) mod result;
pub(crate) mod runs;
