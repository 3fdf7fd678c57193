//! What a controller's compensation mechanism can hold: read from a target's manifest.

use super::Increment;

/// The mechanism of a target.
#[derive(Debug, Clone, PartialEq)]
pub enum Capability {
    /// One table per axis, correcting that axis as a function of its own position.
    OwnAxis(OwnAxisCapability),
    /// One lattice over any of the axes, correcting any of them.
    Lattice(LatticeCapability),
    /// No tables: the kinematics are replaced.
    Kinematics,
}

/// How the points of a table may lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Spacing {
    /// Anywhere, rising.
    Free,
    /// All at the same distance.
    Equal,
}

/// Own-axis tables.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnAxisCapability {
    /// At most so many points per axis.
    pub max_points: usize,
    /// How they may lie.
    pub spacing: Spacing,
    /// One value for each direction of approach?
    pub bidirectional: bool,
    /// Range of positions that tables of continuous axes cover, deg.
    pub continuous: (f64, f64),
    /// Least increments.
    pub increment: Increment,
}

/// A lattice.
#[derive(Debug, Clone, PartialEq)]
pub struct LatticeCapability {
    /// At most so many nodes.
    pub max_nodes: usize,
    /// Can rotary axes be corrected too?
    pub corrects_rotary: bool,
    /// Least increments.
    pub increment: Increment,
}
