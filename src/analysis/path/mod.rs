//! Tool poses as one continuous path: the sequence of candidates with the fewest rewinds, then the least motion.
//!
//! 1. `CandidateSearch` lists the candidates of each row; at a row where an axis is free, those that keep the values of
//!    the best rows before are added.
//! 2. `solve` finds the best sequence by dynamic programming over all rows, start included.
//! 3. `settle` unwraps endless axes, places long ones within their travel, and spreads the turn of a free axis over the
//!    rows at which it is free.
//! 4. `events` lists what the path asks for: rewinds, pole crossings, reversals, motions.
//!
//! `steps` holds the rules between two rows: motion, and which steps are rewinds.
//!
//! The motion is the sum over rows and axes of the distance, 1 mm counted as 1 deg. Of equal sequences the one whose
//! start is nearest to the pose of zeros is taken.

mod events;
mod settle;
mod solve;
mod steps;

use super::inverse::{Miss, ToolPose, inverse_all};
use crate::machine::{Machine, Pose};

pub use events::{AxisMotion, PathEvents, PoleCrossing, Rewind, path_events};
pub use solve::solve_path;

/// Returns the poses (mm, deg) of a machine for tool poses in their order: of one path, or each by itself.
pub fn solve(machine: &Machine, targets: &[ToolPose], is_path: bool) -> Vec<Result<Pose, Miss>> {
    if is_path { solve_path(machine, targets) } else { inverse_all(machine, targets) }
}
