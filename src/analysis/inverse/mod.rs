//! Nominal inverse kinematics of any serial chain of the language: the positions of the axes that bring the functional
//! point to a place of the workpiece and the tool into a direction.
//!
//! 1. `rotary` finds the positions of the rotary axes that give the direction: all of them where
//!    two axes or fewer turn, in closed form; the nearest ones where there are more.
//! 2. `linear` finds those of the linear axes that give the place, moving them as little as it can.
//! 3. Where an axis is free, `sweep` gives the arcs of it that are in reach, in closed form.
//! 4. With three rotary axes and more, or several free ones, positions are tried, then `bisection` proves that none is
//!    in reach, gives others to try, or leaves it open.
//! 5. The first of the candidates, nearest to the reference first, that is within the travel is taken,
//!    and checked with the nominal machine (`nominal`).
//!
//! Chains whose linear axes do not place the tip, such as robots, are solved by `arm`.
//!
//! `candidates` lists all poses that a path chooses from.
//!
//! `directions` spreads directions over what the axes turn the tool over.
//!
//! `tool_pose` holds the poses of the tool, and the reasons why one is unreachable; `shortfall` what machines lack for
//! a work. `algebra` solves for the actual
//! machine over an algebra, by Newton's iteration.

mod algebra;
mod arm;
mod bisection;
mod candidates;
mod directions;
mod linear;
mod nominal;
mod rotary;
mod shortfall;
mod sweep;
mod tool_pose;

pub use algebra::{Inverse, Pole};
pub use candidates::{CandidateSearch, RowCandidates, is_same, is_wound};
pub use directions::{DirectionKind, ToolDirections, freedom};
pub use linear::complete;
pub use nominal::{branches, inverse, inverse_all, place, rotary_axes_place_tip};
pub use rotary::RotaryDirections;
pub use shortfall::{Needs, direction_gap};
pub use tool_pose::{Miss, ToolPose, TravelExcess, Unreachable, attitude, excess, rest, tool_pose, unturned_tool_pose};
