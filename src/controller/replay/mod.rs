//! What the controller does with the files, in its own arithmetic.

pub(super) mod effect;
pub(super) mod tables;
