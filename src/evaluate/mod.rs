//! Evaluation: what a machine does at a pose, compared with what it should do.
//!
//! A [`Field`] is anything that has a deviation at a pose: a bare machine, or a compensated one.

mod deviation;
mod field;

pub use deviation::{Deviation, Evaluation, Frame, MAX_DUAL_ORDER, Order, command_deviation, evaluate};
pub use field::{Bare, Field, commanded_deviation, error_by_error};
