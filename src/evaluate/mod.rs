//! Evaluation: the deviation of the actual machine from the nominal one, at one pose or at many.
//!
//! 1. `deviation`, `terms`: deviation, rotation and E_VE at a pose over the general algebra, which defines the result,
//!    and the parts of its monomials;
//! 2. [`compiled`]: a [`CompiledModel`] gives the same numbers at many poses, on the vector unit;
//! 3. `field`: a [`Field`] is anything that has a deviation at a pose, a bare machine or a compensated one;
//! 4. `poses`, `spread`: [`Poses`] over a volume are nodes of a grid, random, low-discrepancy, or listed;
//! 5. `statistics`, `tally`: [`Statistics`] of deviations kept in a list, or in a [`Tally`] that keeps none.

pub mod compiled;
mod deviation;
mod field;
mod poses;
mod spread;
mod statistics;
mod tally;
mod terms;

pub(crate) use compiled::lanes::run as run_kernel;
pub(crate) use compiled::simd::{Kernel, Lanes};
pub use compiled::{Batch, Columns, CompiledGrid, CompiledModel, Output, PoseColumns, Width};
pub use deviation::{
    Expansion, Frame, Order, UnknownOrder, command_deviation, evaluate, expand, expand_over, frame_rotation, response,
    rotation, unturned_deviation,
};
pub use field::{Bare, CompiledField, Field, OneDegree, commanded_deviation, error_by_error, tool_axis_tilt};
pub use poses::{Nodes, Poses, Random, node_count, node_positions, random_poses};
pub use spread::Spread;
pub(crate) use spread::radical_inverse;
pub use statistics::{Difference, Statistics, Summary, quantile_95, worst};
pub use tally::Tally;
pub use terms::{Deviation, Evaluation, Term};
