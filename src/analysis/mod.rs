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
//! - [`error_statistics()`]: what each error alone does over the volume; [`body_diagonals`]: its four diagonals.
//! - [`levers`]: the lever arms that turn angles into displacements.
//! - [`LocationSet`]: the location errors this chain needs, and which of them are given.

mod closed_form;
mod design;
pub mod instrument;
mod inverse;
mod volume;

pub use closed_form::{
    Calculation, Effect, Equations, Interactions, LocationSet, Meaning, Naming, Options, Quantity, Share, Status,
    Symbol, Twist, TwistMap, equations, interactions, twists,
};
pub use design::{
    Comparison, ErrorContribution, ErrorStatistics, MachineResult, UnreachableCount, budget, compare, contributions,
    enumerate, error_statistics,
};
pub use inverse::{
    DIRECTION_TOLERANCE, Inverse, PLACE_TOLERANCE, ToolPose, Unreachable, inverse, place, rest, tool_pose,
};
pub use volume::{
    Block, Diagonal, Lever, MAX_POSES, MAX_SURVEYED, Map, Plane, Survey, SurveyTask, TooManyPoses, View, Work,
    body_diagonals, deviation_in, frame_rotation, levers, map, space_axes, survey, survey_with_rows,
};
