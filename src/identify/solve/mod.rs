//! Least squares: weights, the fit, its uncertainty, its residuals, and the plan of a measurement before there is one.

pub(super) mod checks;
pub(super) mod fit;
pub(super) mod plan;
pub(super) mod randomness;
pub(super) mod solution;
pub(super) mod student;
pub(super) mod weighing;
