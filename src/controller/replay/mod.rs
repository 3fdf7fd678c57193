//! The controllers' own arithmetic on their files.

mod lookup;
mod model;
mod tables;

pub use tables::{Compensated, Replay};
