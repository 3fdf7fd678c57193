//! Analysis: what the errors of a machine come to over its volume.
//!
//! - [`map()`]: any [`Field`](crate::evaluate::Field) over a volume, and its statistics.
//! - [`Plane`]: a field over a plane of two linear axes, for drawing.
//! - [`inverse()`]: where the axes must be for a pose of the tool; [`compare()`] puts machines side by
//!   side on the same tool poses.
//! - [`levers`]: the lever arms that turn angles into displacements.
//! - [`LocationSet`]: the location errors this chain needs, and which of them are given.

mod compare;
mod inverse;
mod lever;
mod location_set;
mod map;
mod plane;

pub use compare::{Compared, Comparison, Missed, compare};
pub use inverse::{DIRECTION_TOLERANCE, PLACE_TOLERANCE, ToolPose, Unreachable, inverse, rest, tool_pose};
pub use lever::{Lever, levers};
pub use location_set::{LocationSet, Status};
pub use map::{MOST_POSES, Map, TooManyPoses, View, deviation_in, map};
pub use plane::Plane;
