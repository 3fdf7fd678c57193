//! Results without a grid: equations in the errors, interactions of errors, and the minimal set of location errors.

pub(super) mod equations;
pub(super) mod interactions;
pub(super) mod location_set;
