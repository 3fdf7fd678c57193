//! The controllers' own arithmetic on their files.

pub(super) mod effect;
mod lookup;
mod model;
pub(super) mod tables;
