//! What the controller does with its tables, in its own arithmetic.

mod tables;

pub use tables::{Compensated, Replay};
