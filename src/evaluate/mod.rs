//! Evaluation: what a machine does at a pose, compared with what it should do.
//!
//! A [`Field`] is anything that has a deviation at a pose: a bare machine, or a compensated one.
//! [`Poses`] say where to look, [`Statistics`] what it comes to over all of them, and a [`Tally`] the same without
//! keeping them. The general algebra defines the result; a [`CompiledModel`] is a machine compiled for many poses.

pub mod compiled;
mod deviation;
mod field;
mod poses;
mod spread;
mod statistics;
mod tally;

pub use compiled::{Batch, Columns, CompiledGrid, CompiledModel, NormalEquations, Output, PoseColumns, Unknown, Width};
pub use deviation::{
    Deviation, Evaluation, Frame, MAX_DUAL_ORDER, Order, Response, command_deviation, evaluate, evaluate_over,
    response, rotation,
};
pub use field::{Bare, CompiledField, Field, commanded_deviation, error_by_error, tool_axis_tilt};
pub use poses::{Nodes, Poses, Random, node_count, node_positions, random_poses};
pub use spread::Spread;
pub(crate) use spread::radical_inverse;
pub use statistics::{Difference, Statistics, Summary, quantile_95, worst};
pub use tally::Tally;
