//! The errors of one machine over its volume.
//!
//! - [`mod@map`] keeps every pose, [`mod@survey`] only the statistics;
//! - [`mod@plane`] is a section for drawing, [`mod@diagonals`] are the four space diagonals;
//! - [`mod@lever`]: the arms that turn angles into displacements;
//! - [`mod@work`]: the tool poses on which machines are compared.

mod diagonals;
mod lever;
mod map;
mod plane;
mod survey;
mod work;

pub use diagonals::{Diagonal, body_diagonals, space_axes};
pub use lever::{Lever, levers};
pub use map::{MAX_POSES, Map, TooManyPoses, View, deviation_in, frame_rotation, map};
pub use plane::Plane;
pub use survey::{Block, MAX_SURVEYED, Survey, SurveyTask, survey, survey_with_rows};
pub use work::Work;
