//! From a machine to files: tables are filled and rounded, checked against limits, and rendered.

pub(super) mod context;
pub(super) mod fill;
pub(super) mod installed;
pub(super) mod limits;
pub(super) mod lock;
pub(super) mod render;
pub(super) mod single_errors;
pub(super) mod stored;
pub(super) mod timed;
