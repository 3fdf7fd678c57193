//! An export as it was read: its samples, its unused rows and columns.

use super::form::TableForm;
use super::suspicion::Finding;
use crate::diagnostic::{Diagnostic, Place, codes};
use crate::machine::ErrorId;
use crate::syntax::ColumnDirection;

/// One reading (mm or rad) at a position (mm or deg).
#[derive(Debug, Clone, PartialEq)]
pub struct AxisSample {
    /// Error, as an index in [`Import::errors`].
    pub error: usize,
    /// The target; modulo 360 deg on an axis that turns without end.
    pub position: f64,
    /// From which side, if the file says or shows it.
    pub direction: Option<ColumnDirection>,
    /// Name of the run; empty if there is only one.
    pub run: String,
    /// Actual minus nominal.
    pub value: f64,
    /// Its line in the file.
    pub place: Place,
}

/// A row that was not used.
#[derive(Debug, Clone, PartialEq)]
pub struct UnusedRow {
    /// Place in the file.
    pub place: Place,
    /// Why.
    pub reason: String,
}

/// A column that was not used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnusedColumn {
    /// Its title.
    pub title: String,
    /// Why.
    pub reason: String,
    /// False if no rule has its title.
    pub known: bool,
}

/// An error that a column shows by its name and the mounting of the instrument.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedChannel {
    /// The title of the column.
    pub title: String,
    /// The error.
    pub error: ErrorId,
    /// True if the error is minus what the column shows.
    pub negative: bool,
}

/// The line of one straightness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferenceLine {
    /// Error, as an index in [`Import::errors`].
    pub error: usize,
    /// Its slope (mm per mm).
    pub slope: f64,
    /// Its rise over the targets (mm).
    pub rise: f64,
    /// The distance between the outermost targets (mm).
    pub length: f64,
    /// True if it was taken off the readings.
    pub taken_off: bool,
}

/// Contents of a file.
#[derive(Debug, Clone)]
pub struct Import {
    /// Layout of its table.
    pub form: TableForm,
    /// The axis that moved.
    pub axis: String,
    /// True if it is rotary (positions in deg).
    pub rotary: bool,
    /// The errors found.
    pub errors: Vec<ErrorId>,
    /// All readings, in the order of the file.
    pub samples: Vec<AxisSample>,
    /// Entries before the table, `key: value`.
    pub metadata: Vec<(String, String)>,
    /// Rows that were not used.
    pub left_out: Vec<UnusedRow>,
    /// Columns, sections and entries that were not used.
    pub unused_columns: Vec<UnusedColumn>,
    /// Channels of a six-degree instrument.
    pub channels: Vec<NamedChannel>,
    /// Lines of straightness errors.
    pub lines: Vec<ReferenceLine>,
    /// Were directions read off the order of the rows?
    pub inferred: bool,
    /// Suspicions against the readings.
    pub findings: Vec<Finding>,
}

impl Import {
    /// Returns an import without readings.
    pub(super) fn empty(form: TableForm, axis: String, rotary: bool) -> Self {
        Self {
            form,
            axis,
            rotary,
            errors: Vec::new(),
            samples: Vec::new(),
            metadata: Vec::new(),
            left_out: Vec::new(),
            unused_columns: Vec::new(),
            channels: Vec::new(),
            lines: Vec::new(),
            inferred: false,
            findings: Vec::new(),
        }
    }
}

/// Returns a refusal of the file as a whole.
pub(super) fn refusal(message: String, place: Option<Place>) -> Diagnostic {
    let help = "a table needs a header: a position column (`X [mm]`, `position [mm]`) and columns named by error \
                (`EXX [um]`), by run (`1+ [um]`, `1- [um]` ..., with `--error EXX`), or `error`, `value` and `unit`; \
                `--columns FILE` maps the columns of any other table";
    Diagnostic::new(codes::E0509, message).at(place, "").help(help)
}
