//! Analysis: what the errors of a machine come to over its volume.
//!
//! - [`map()`]: any [`Field`](crate::evaluate::Field) over a volume, and its statistics.
//! - [`mod@budget`]: tolerances to the volumetric error; [`enumerate`]: all arrangements of the axes.
//! - [`instrument`]: what a ball bar, an R-test or a laser along the diagonals would read.
//! - [`survey()`]: the same over any number of poses, without keeping them.
//! - [`Plane`]: a field over a plane of two linear axes, for drawing.
//! - [`inverse()`]: where the axes must be for a pose of the tool; [`compare()`] puts machines side by
//!   side on the same tool poses.
//! - [`Work`]: the tool poses that machines are given to do.
//! - [`Inverse`]: the same for the real machine over an algebra, by Newton's iteration.
//! - [`equations()`]: the closed forms, over an algebra of polynomials in symbols.
//! - [`interactions()`]: what errors do one by one and two by two, and what order 1 neglects.
//! - [`sources()`]: what each error alone does over the volume; [`body_diagonals`]: its four diagonals.
//! - [`levers`]: the lever arms that turn angles into displacements.
//! - [`LocationSet`]: the location errors this chain needs, and which of them are given.

mod closed_form;
mod design;
pub mod instrument;
mod inverse;
mod volume;

pub use closed_form::equations::{Equations, Meaning, Naming, Options, Symbol, equations};
pub use closed_form::interactions::{Calculation, Effect, Interactions, interactions};
pub use closed_form::location_set::{LocationSet, Status};
pub use design::compare::{Compared, Comparison, Missed, compare};
pub use design::contributions::{ErrorAlone, contributions};
pub use design::sources::{Source, sources};
pub use design::{budget, enumerate};
pub use inverse::{
    DIRECTION_TOLERANCE, Inverse, PLACE_TOLERANCE, ToolPose, Unreachable, inverse, place, rest, tool_pose,
};
pub use volume::diagonals::{Diagonal, body_diagonals, space_axes};
pub use volume::lever::{Lever, levers};
pub use volume::map::{MAX_POSES, Map, TooManyPoses, View, deviation_in, frame_rotation, map};
pub use volume::plane::Plane;
pub use volume::survey::{Block, MAX_SURVEYED, Survey, Task as SurveyTask, survey, survey_with_rows};
pub use volume::work::Work;
