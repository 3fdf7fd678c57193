//! Analysis: what the errors of a machine come to over its volume.
//!
//! - [`Poses`]: where to look; grid nodes or seeded random poses, made by index.
//! - [`map()`]: any [`Field`](crate::evaluate::Field) over them, and its [`Statistics`].
//! - [`Plane`]: a field over a plane of two linear axes, for drawing.
//! - [`inverse()`]: where the axes must be for a pose of the tool; [`compare()`] puts machines side by
//!   side on the same tool poses.
//! - [`LocationSet`]: the location errors this chain needs, and which of them are given.

mod compare;
mod inverse;
mod location_set;
mod map;
mod plane;
mod poses;
mod statistics;

pub use compare::{Compared, Comparison, Missed, compare};
pub use inverse::{DIRECTION_TOLERANCE, PLACE_TOLERANCE, ToolPose, Unreachable, inverse, rest, tool_pose};
pub use location_set::{LocationSet, Status};
pub use map::{MOST_POSES, Map, TooManyPoses, View, deviation_in, map};
pub use plane::Plane;
pub use poses::{Nodes, Poses, Random, random_poses};
pub use statistics::{Difference, Statistics, Summary, worst};
