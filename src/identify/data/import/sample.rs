//! An export as it was read: its samples, its unused rows, and the answers that the caller gives for what it leaves
//! open.

use super::form::TableForm;
use crate::diagnostic::{Diagnostic, Place, codes, shown};
use crate::machine::ErrorId;
use crate::syntax::ColumnDirection;

/// What the file itself may leave open.
#[derive(Debug, Clone, Default)]
pub struct ImportRequest {
    /// The axis that moved.
    pub axis: Option<String>,
    /// The error whose runs the columns are.
    pub error: Option<String>,
    /// Unit of values that have none in the file.
    pub unit: Option<String>,
    /// The file holds corrections: errors with the other sign.
    pub correction: bool,
    /// The axis turns without end: positions are taken modulo 360 deg, and the table closes.
    pub continuous: bool,
}

impl ImportRequest {
    /// ` of EXX`, if one error is asked for.
    pub(super) fn of(&self) -> String {
        self.error.as_deref().map(|error| format!(" of `{}`", shown(error))).unwrap_or_default()
    }
}

/// One reading (mm or rad) at a position (mm or deg).
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Which error, as an index in [`Import::errors`].
    pub error: usize,
    /// The target; modulo 360 deg on an axis that turns without end.
    pub position: f64,
    /// From which side, if the file says or shows it.
    pub direction: Option<ColumnDirection>,
    /// Name of the run; empty if there is only one.
    pub run: String,
    /// Actual minus nominal.
    pub value: f64,
}

/// A row that was not used.
#[derive(Debug, Clone, PartialEq)]
pub struct UnusedRow {
    /// Where it stands.
    pub place: Place,
    /// Why.
    pub reason: String,
}

/// What a file holds.
#[derive(Debug, Clone)]
pub struct Import {
    /// How its table is laid out.
    pub form: TableForm,
    /// The axis that moved.
    pub axis: String,
    /// Is it rotary (positions in deg)?
    pub rotary: bool,
    /// The errors found.
    pub errors: Vec<ErrorId>,
    /// All readings, in the order of the file.
    pub samples: Vec<Sample>,
    /// What stands before the table, `key: value`.
    pub metadata: Vec<(String, String)>,
    /// Rows that were not used.
    pub left_out: Vec<UnusedRow>,
    /// Were directions read off the order of the rows?
    pub inferred: bool,
}

/// A refusal of the file as a whole.
pub(super) fn refusal(message: String, place: Option<Place>) -> Diagnostic {
    let help = "a table needs a header: a position column (`X [mm]`, `position [mm]`) and columns named by error \
     (`EXX [um]`), \
                by run (with `--error EXX --unit um`), or `error`, `value` and `unit`";
    Diagnostic::new(codes::E0509, message).at(place, "").help(help)
}
