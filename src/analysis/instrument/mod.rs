//! Virtual instruments: the readings of a ball bar, of a probe nest at a ball on the table (R-test), and of a laser
//! along the diagonals.
//!
//! A [`PosePath`] is a list of poses; [`PosePath::deviations`] evaluates it with the exact model. Every
//! axis is approached from the side it comes from, so that reversal shows where an axis turns round.

mod ball_bar;
mod bounded;
mod diagonal;
mod path;
mod r_test;

pub use ball_bar::{BallBar, Plane as CirclePlane, ball_bar, circle_path};
pub use bounded::{BoundedReading, BoundedRequest, DrivenPath};
pub use diagonal::{Diagonal, diagonal_paths, diagonals};
pub use path::{PosePath, within};
pub use r_test::{RTest, RTestReading, r_test, turn_path};
