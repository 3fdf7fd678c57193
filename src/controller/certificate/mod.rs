//! What is left after the controller has applied the files.

pub(super) mod judge;
