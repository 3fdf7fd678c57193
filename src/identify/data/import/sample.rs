//! An export as it was read: its samples, its unused rows, and the answers that the caller gives for what it leaves
//! open.

use super::channels::Mounting;
use super::columns::ColumnMap;
use super::form::TableForm;
use super::line::{ReferenceLine, StraightnessLine};
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
    /// Whether the file holds errors or corrections, which have the other sign; errors, where the layout says nothing.
    pub contents: Option<FileContents>,
    /// How runs without a direction were approached.
    pub approach: Option<RunApproach>,
    /// Which line is taken off a straightness.
    pub line: StraightnessLine,
    /// True if it is kept.
    pub keep_line: bool,
    /// The mounting of an instrument of six channels.
    pub mounting: Option<Mounting>,
    /// Titles of channels whose sign changes.
    pub flipped: Vec<String>,
    /// The columns by hand.
    pub columns: Option<ColumnMap>,
    /// The axis turns without end: positions are taken modulo 360 deg, and the table closes.
    pub continuous: bool,
}

/// The sign of the values of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FileContents {
    /// Actual minus nominal.
    Errors,
    /// Nominal minus actual.
    Corrections,
}

/// How runs without a direction were approached.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RunApproach {
    /// All from the same side.
    OneWay,
    /// The first forward, the second in reverse, and so on.
    Alternating,
}

impl ImportRequest {
    /// The factor of values.
    pub(super) fn sign(&self) -> f64 {
        if self.contents == Some(FileContents::Corrections) { -1.0 } else { 1.0 }
    }

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
    /// Columns, sections and entries that were not used.
    pub unused_columns: Vec<UnusedColumn>,
    /// Channels of a six-degree instrument.
    pub channels: Vec<NamedChannel>,
    /// Lines of straightness errors.
    pub lines: Vec<ReferenceLine>,
    /// Were directions read off the order of the rows?
    pub inferred: bool,
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
        }
    }
}

/// A refusal of the file as a whole.
pub(super) fn refusal(message: String, place: Option<Place>) -> Diagnostic {
    let help = "a table needs a header: a position column (`X [mm]`, `position [mm]`) and columns named by error \
                (`EXX [um]`), by run (`1+ [um]`, `1- [um]` ..., with `--error EXX`), or `error`, `value` and `unit`; \
                `--columns FILE` maps the columns of any other table";
    Diagnostic::new(codes::E0509, message).at(place, "").help(help)
}
