//! What the controller does with the files, in its own arithmetic.

pub(super) mod effect;
mod lookup;
mod model;
pub(super) mod tables;
