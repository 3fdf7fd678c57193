//! Conversion: the same machine under other conventions (docs/conventions.md).
//!
//! Whatever the conventions, the walk from the workpiece to the tool is T = K0 X1 K1 ... Xn Kn: constants K
//! between motions X, each the nominal motion of an axis with its error motion beside it.
//!
//! 1. [`constants`](Constants) reads the K of a machine and regroups them as the new conventions want them: location
//!    errors, set-up of the workpiece, spindle.
//! 2. [`ComponentErrors`] gives the new six component errors of an axis, as a function of its position.
//! 3. [`shape()`] looks for a curve of the language that is this function.
//! 4. [`prove`] compares both machines, exact model, over travels and volume.
//!
//! Nothing is approximated in silence: an error that no curve can hold is a [`Misfit`], and the proof decides.

mod component;
mod constants;
mod conversion;
mod proof;
mod request;
mod shape;

pub use component::ComponentErrors;
pub use constants::Constants;
pub use conversion::{Change, Conversion, Misfit, changes, convert};
pub use proof::{Proof, prove};
pub use request::{ConversionRequest, ROUNDING};
use request::{TINY, changes_side, regroups, tolerance_refusal};
pub use shape::shape;
