//! The errors of one machine over its volume.
//!
//! - [`mod@map`] keeps every pose, [`mod@survey`] only the statistics;
//! - [`mod@plane`] is a section for drawing, [`mod@diagonals`] are the four space diagonals;
//! - [`mod@lever`]: the arms that turn angles into displacements;
//! - [`mod@work`]: the tool poses on which machines are compared.

pub(super) mod diagonals;
pub(super) mod lever;
pub(super) mod map;
pub(super) mod plane;
pub(super) mod survey;
pub(super) mod work;
