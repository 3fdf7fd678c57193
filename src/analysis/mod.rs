//! Analysis: what the errors of a machine come to over its volume.
//!
//! 1. [`Poses`]: where to look; grid nodes or seeded random poses, made by index.

mod poses;

pub use poses::{Nodes, Poses, Random, random_poses};
