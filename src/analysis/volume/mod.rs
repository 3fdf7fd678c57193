//! The errors of one machine over its volume.
//!
//! - `map` keeps every pose, `survey` only the statistics;
//! - `plane` is a section for drawing, `diagonals` are the four body diagonals;
//! - `lever`: the arms that turn angles into displacements;
//! - `work`: the tool poses on which machines are compared; `reach`: those of a grid that a machine takes.

mod diagonals;
mod lever;
mod map;
mod plane;
mod reach;
mod survey;
mod work;

pub use diagonals::{DiagonalRun, body_diagonals, space_axes};
pub use lever::{Lever, arm_shares, levers};
pub(crate) use map::deviations;
pub use map::{MAX_POSES, Map, MapFailure, View, deviation_in, map};
pub use plane::{Plane, PlaneNodes};
pub use reach::{ReachGrid, reach};
pub use survey::{MAX_SURVEYED, Survey, SurveyBlock, SurveyTask, survey, survey_with_rows};
pub use work::Work;
