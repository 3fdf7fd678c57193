//! Reports as text, LaTeX and JSON.

pub(super) mod budget;
pub mod equations;
pub(super) mod instruments;
