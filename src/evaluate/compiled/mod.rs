//! The compiled evaluator: a machine, an order and a side of approach, compiled once and run over many poses.
//!
//! The general algebra of [`lower`](crate::lower) defines the result; a compiled model gives the same numbers at the
//! speed of the vector unit. Compilation goes once through the chain:
//!
//! 1. `chain`: geometry and conventions become joints with motions, and points about which errors turn;
//! 2. `curves`, `intervals`: the six curves of an axis become one table that is read row by row;
//! 3. `twist`, `steps`, `first` (order 1), `second` (order 2), `exact`: the joints become the walk of one order,
//!    constants folded; at order 1 the rows of neighbouring axes are summed.
//!
//! A run (`model`, `pass`) is a walk from the tool to the workpiece with a pose in every lane of a vector:
//!
//! 4. `simd` defines the operations of kernels on vectors (`vector`: three of them), `lanes`, `scalar` and `wasm`
//!    implement it for every `width`, and `trigonometry` adds sines and cosines;
//! 5. `lookup` computes for a chunk of poses the quantities that do not depend on the walk, such as positions in
//!    tables;
//! 6. `grid`, `grid_lines`, `affine`: on a tensor grid the outer joints are multiplied once per line;
//! 7. `frame` rotates deviations into other frames; `ends` finds the ends of columns of positions.
//!
//! Numbers do not depend on the vector width nor on the number of threads, to the bit. They agree with
//! [`evaluate`](super::evaluate()) up to rounding: order 1 to 1e-12 of the batch's largest deviation; the others to
//! 1e-12 of it plus the rounding of positions in the general algebra (about 1e-12 mm), which a compiled model avoids.
//! Nothing is approximated: cases that no kernel covers (orders above 2, location errors in the real part at order 1 or
//! 2, rotations beyond 0.3 rad) go pose by pose through the general algebra, behind the same interface.

#![allow(
    clippy::needless_range_loop,
    clippy::manual_map,
    reason = "closures lack the vector features of the function around them: kernels have plain loops and matches"
)]

mod affine;
pub(super) mod batch;
mod chain;
mod curves;
mod ends;
mod exact;
mod first;
mod frame;
mod grid;
mod grid_lines;
mod intervals;
pub(super) mod lanes;
mod lookup;
pub(super) mod model;
mod pass;
mod scalar;
mod second;
pub(super) mod simd;
mod steps;
mod trigonometry;
mod twist;
mod vector;
#[cfg(all(target_arch = "wasm32", target_feature = "relaxed-simd"))]
mod wasm;
pub(super) mod width;

pub use batch::{Batch, Columns, Output, PoseColumns};
pub use grid::CompiledGrid;
pub use model::CompiledModel;
pub use width::Width;
