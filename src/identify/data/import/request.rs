//! The answers that the caller gives for what a file leaves open.

use super::channels::Mounting;
use super::columns::ColumnMap;
use super::options::{FileContents, RunApproach, StraightnessLine};
use crate::diagnostic::shown;
use crate::identify::data::error_name::parse_component_error;
use crate::machine::ErrorId;
use crate::standards::Thermal;

/// Facts that the file itself may leave open.
#[derive(Debug, Clone, Default)]
pub struct ImportRequest {
    /// The axis that moved.
    pub axis: Option<String>,
    /// The error whose runs the columns are.
    pub error: Option<String>,
    /// Unit of values that have none in the file.
    pub unit: Option<String>,
    /// Errors or corrections, which have the other sign; errors, where the layout states nothing.
    pub contents: Option<FileContents>,
    /// Approach of runs without a direction.
    pub approach: Option<RunApproach>,
    /// Line that is taken off a straightness.
    pub line: StraightnessLine,
    /// True if it is kept.
    pub keep_line: bool,
    /// Temperature (deg C) of the machine's material and its expansion: positions are brought to 20 deg C.
    pub material: Option<Thermal>,
    /// The mounting of an instrument of six channels.
    pub mounting: Option<Mounting>,
    /// Titles of channels whose sign changes.
    pub flipped: Vec<String>,
    /// The columns by hand.
    pub columns: Option<ColumnMap>,
    /// The axis turns without end: positions are taken modulo 360 deg, and the table closes.
    pub continuous: bool,
    /// The caller takes readings that accuse themselves.
    pub accepts_suspect: bool,
}

impl ImportRequest {
    pub(super) fn sign(&self) -> f64 {
        if self.contents == Some(FileContents::Corrections) { -1.0 } else { 1.0 }
    }

    /// Returns ` of EXX`, if one error is requested.
    pub(super) fn of(&self) -> String {
        self.error.as_deref().map(|error| format!(" of `{}`", shown(error))).unwrap_or_default()
    }

    pub(super) fn error_id(&self) -> Option<ErrorId> {
        self.error.as_deref().and_then(parse_component_error)
    }

    pub(super) fn excludes(&self, error: &ErrorId) -> bool {
        self.error_id().is_some_and(|wanted| wanted != *error)
    }

    /// Takes from the mapping what the caller did not say.
    pub fn with_columns(mut self, map: ColumnMap) -> Self {
        self.contents = self.contents.or(map.contents);
        self.approach = self.approach.or(map.approach);
        self.axis = self.axis.or(map.axis.clone());
        self.columns = Some(map);
        self
    }

    /// Takes the mounting of an instrument; `None` if the two are not directions across each other.
    pub fn with_mounting(mut self, beam: &str, vertical: &str) -> Option<Self> {
        self.mounting = Some(Mounting::new(beam, vertical)?);
        Some(self)
    }
}
