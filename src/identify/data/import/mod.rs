//! Single-axis measurements as instruments export them, to a table of error curves and the figures of ISO 230-2.
//!
//! 1. `header`: where the table begins, what its columns are, what stands before it.
//! 2. `gather`: rows to samples (error, position, direction, run); what is left out, and why.
//! 3. `order`: positions to targets, the order of the rows to passes and directions.
//! 4. `figures`: means by target and direction, reversal, repeatability, accuracy.
//! 5. [`Import::table`]: the table that a machine file takes.

mod figures;
mod gather;
mod header;
mod order;

pub use figures::Figures;
pub use header::Form;

use crate::diagnostic::{Diagnostic, Diagnostics, Place, codes, shown};
use crate::machine::{ErrorId, parse_error_name};
use crate::syntax::sheet::read_sheet;
use crate::syntax::{ColumnDirection, Files};
use std::path::Path;

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
    fn of(&self) -> String {
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
pub struct LeftOut {
    /// Where it stands.
    pub place: Place,
    /// Why.
    pub reason: String,
}

/// What a file holds.
#[derive(Debug, Clone)]
pub struct Import {
    /// How its table is laid out.
    pub form: Form,
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
    pub left_out: Vec<LeftOut>,
    /// Were directions read off the order of the rows?
    pub inferred: bool,
}

/// A table of error curves.
#[derive(Debug, Clone)]
pub struct ImportedTable {
    /// As it is written.
    pub text: String,
    /// How many positions it has.
    pub rows: usize,
    /// At which positions it has no row because something is missing there.
    pub missing: Vec<String>,
}

/// Most rows of a file.
const ROWS: usize = 200_000;

/// Reads an export; what cannot be understood as a whole is refused, single rows are left out.
pub fn import(path: &Path, wanted: &ImportRequest, files: &dyn Files, diagnostics: &mut Diagnostics) -> Option<Import> {
    let sheet = read_sheet(path, files, diagnostics)?;
    let lines = sheet.lines();
    let found = if lines.len() > ROWS {
        Err(Box::new(refusal(format!("the file has {} rows; the limit is {ROWS}", lines.len()), None)))
    } else {
        header::find(&lines, wanted).and_then(|header| gather::gather(&lines, header, wanted))
    };
    match found {
        Ok(import) => Some(import),
        Err(refused) => {
            diagnostics.push(*refused);
            None
        }
    }
}

/// A refusal of the file as a whole.
pub(crate) fn refusal(message: String, place: Option<Place>) -> Diagnostic {
    let help = "a table needs a header: a position column (`X [mm]`, `position [mm]`) and columns named by error (`EXX [um]`), \
                by run (with `--error EXX --unit um`), or `error`, `value` and `unit`";
    Diagnostic::new(codes::E0509, message).at(place, "").help(help)
}

/// An error of the axis by its ISO name, or the name that VDI 2617 gives it (`xtx`, `xrz`).
pub(crate) fn error_name(text: &str) -> Option<ErrorId> {
    let vdi = || {
        let mut letters = text.chars();
        let (axis, kind, about) = (letters.next()?, letters.next()?, letters.next()?);
        let k = ['x', 'y', 'z'].iter().position(|c| *c == about)?;
        let letter = match kind {
            't' => ["X", "Y", "Z"][k],
            'r' => ["A", "B", "C"][k],
            _ => return None,
        };
        let plain = letters.next().is_none() && ['x', 'y', 'z'].contains(&axis);
        plain.then(|| parse_error_name(&format!("E{letter}{}", axis.to_ascii_uppercase()))).flatten()
    };
    parse_error_name(text).or_else(vdi).filter(|error| !error.is_location())
}

impl Import {
    /// The figures of one error; `None` without readings.
    pub fn figures(&self, error: usize) -> Option<Figures> {
        let samples: Vec<&Sample> = self.samples.iter().filter(|s| s.error == error).collect();
        Figures::of(&samples)
    }

    /// The table as a machine file takes it, means over the runs.
    pub fn table(&self, continuous: bool) -> ImportedTable {
        let figures: Vec<Figures> = (0..self.errors.len()).filter_map(|k| self.figures(k)).collect();
        let unit = if self.rotary { "deg" } else { "mm" };
        let mut header = vec![format!("{} [{unit}]", self.axis)];
        for (error, figures) in self.errors.iter().zip(&figures) {
            let value = if error.direction.is_rotation() { "urad" } else { "um" };
            let ways: &[&str] = if figures.bidirectional() { &["+", "-"] } else { &[""] };
            header.extend(ways.iter().map(|way| format!("{error}{way} [{value}]")));
        }
        let mut positions: Vec<f64> = figures.iter().flat_map(|f| f.targets.iter().map(|t| t.position)).collect();
        positions.sort_by(f64::total_cmp);
        positions.dedup();
        let both: Vec<bool> = figures.iter().map(Figures::bidirectional).collect();
        let mut missing = Vec::new();
        let mut rows: Vec<(f64, Vec<f64>)> = Vec::new();
        for position in positions {
            match self.row(&figures, &both, position) {
                Some(values) => rows.push((position, values)),
                None => missing.push(format!("{}", position + 0.0)),
            }
        }
        if let (true, Some((first, values))) = (continuous, rows.first().cloned()) {
            rows.retain(|(position, _)| *position < first + 360.0);
            rows.push((first + 360.0, values));
        }
        let mut text = String::new();
        for (key, value) in &self.metadata {
            text += &format!("# {}: {}\n", shown(key), shown(value));
        }
        text += &format!("{}\n", header.join(", "));
        for (position, values) in &rows {
            let cells: Vec<String> = values.iter().map(|v| format!("{}", rounded(*v))).collect();
            text += &format!("{}, {}\n", position + 0.0, cells.join(", "));
        }
        ImportedTable { text, rows: rows.len(), missing }
    }

    /// The cells of one position, um and urad.
    fn row(&self, figures: &[Figures], both: &[bool], position: f64) -> Option<Vec<f64>> {
        let mut cells = Vec::new();
        for ((error, figures), both) in self.errors.iter().zip(figures).zip(both) {
            let factor = if error.direction.is_rotation() { 1e6 } else { 1e3 };
            let at = figures.targets.binary_search_by(|t| t.position.total_cmp(&position)).ok()?;
            let target = &figures.targets[at];
            let means = if *both { vec![target.forward?.mean, target.reverse?.mean] } else { vec![target.any()?.mean] };
            cells.extend(means.into_iter().map(|mean| mean * factor));
        }
        Some(cells)
    }
}

/// To a thousandth of a nanometre: no digits of mere arithmetic, never `-0`.
fn rounded(value: f64) -> f64 {
    let scaled = libm::round(value * 1e6) / 1e6;
    if scaled.is_finite() { scaled + 0.0 } else { value }
}
