//! The meaning of coordinates in a log of touches.

/// The meaning of X, Y, Z in a log of touches.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum TouchCoordinates {
    /// Positions of the axes: identity kinematics, no tool length in force.
    #[default]
    Joints,
    /// The middle of the stylus in the frame that turns with the table, through a module's nominal kinematics: its
    /// correction off, the tool length in force.
    Tip,
}

impl TouchCoordinates {
    pub(super) const ALL: [Self; 2] = [Self::Joints, Self::Tip];

    /// Returns its word in a log.
    pub fn word(self) -> &'static str {
        match self {
            Self::Joints => "joints",
            Self::Tip => "tip",
        }
    }
}
