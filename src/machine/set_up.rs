//! Errors of the set-up.

/// Set-up errors, in the real machine only.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SetUp {
    /// Displacement of the tip from its nominal place (mm).
    pub tool: [f64; 3],
    /// Displacement of the workpiece itself about its origin (mm, rad), in machine directions at the zero pose.
    pub workpiece: [f64; 6],
}
