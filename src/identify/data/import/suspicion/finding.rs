//! The suspicions against readings of a file.

use crate::diagnostic::Place;

/// The kind of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FindingKind {
    /// Rows that cannot be read are more than a share of the file.
    RowsLost,
    /// Two columns of the file are exchanged.
    ColumnsExchanged,
    /// A row or a reading is there twice.
    Twice,
    /// A reading is far from its repeats.
    Outlier,
    /// Readings do not repeat, many of them.
    Scatter,
    /// Readings move from run to run.
    Drift,
    /// Forward and reverse are exchanged.
    DirectionsExchanged,
    /// A run is in another unit than the others.
    UnitOfRun,
    /// A run has the other sign than the others.
    SignOfRun,
    /// All readings, or the positions, are in another unit.
    Unit,
}

/// The use that is made of the readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FindingEffect {
    /// They are used.
    Used,
    /// They are not used.
    LeftOut,
    /// The file is refused.
    Refused,
    /// They are used because the caller accepts them.
    Accepted,
}

/// One finding.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Its kind.
    pub kind: FindingKind,
    /// The error, as an index in [`super::Import::errors`]; `None` of the file as a whole.
    pub error: Option<usize>,
    /// The lines, the first one first; at least one unless the file is empty.
    pub places: Vec<Place>,
    /// In a sentence.
    pub message: String,
    /// The remedy.
    pub help: String,
    /// The use that is made of the readings.
    pub effect: FindingEffect,
}

/// The remedy where the caller may insist.
pub(super) const ACCEPT: &str = "`--accept suspect` takes the readings as they are";
