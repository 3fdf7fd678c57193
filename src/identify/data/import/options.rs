//! Choices that a file leaves open.

/// A suspicion that a caller accepts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Acceptance {
    /// Readings that accuse themselves.
    Suspect,
}

/// The sign of the values of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum FileContents {
    /// Actual minus target.
    Errors,
    /// Target minus actual.
    Corrections,
}

/// Approach of runs without a direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum RunApproach {
    /// All from the same side.
    OneWay,
    /// The first forward, the second in reverse, and so on.
    Alternating,
}

/// Line of a straightness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum StraightnessLine {
    /// Line of least squares over the targets.
    #[default]
    LeastSquares,
    /// Through the first and the last target.
    EndPoints,
}
