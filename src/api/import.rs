//! A single-axis measurement as an instrument exports it, to a table of error curves.

use super::run::{Answer, Call, Refused, Run};
use crate::diagnostic::{Diagnostic, Diagnostics, Sources, codes, shown};
use crate::identify::import::{self, AccuracyFigures, Import, ImportRequest, ReferenceLine};
use crate::machine::ErrorId;
use crate::units::counted;
use serde::Serialize;
use std::path::{Path, PathBuf};

pub use crate::identify::import::{FileContents, RunApproach, StraightnessLine};

/// Options of [`import`](import()): facts that the file leaves open.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct ImportOptions {
    /// The axis that moved.
    pub axis: Option<String>,
    /// The error whose runs the columns are, such as `EXX`; of several errors the only one to take.
    pub error: Option<String>,
    /// Unit of readings that have none in the file.
    pub unit: Option<String>,
    /// Errors, or corrections, which have the other sign; errors by default. Must be given where the layout of the file
    /// leaves it open.
    pub contents: Option<FileContents>,
    /// Approach of runs without a direction.
    pub runs: Option<RunApproach>,
    /// Direction of the beam of a six-degree instrument, from the launch to the receiver, such as `+X`.
    pub beam: Option<String>,
    /// The machine's direction in which the vertical of that instrument points, such as `+Z`.
    pub vertical: Option<String>,
    /// Titles of its channels that change their sign.
    pub flip: Vec<String>,
    /// A file that maps the columns.
    pub columns: Option<PathBuf>,
    /// The line that is taken off a straightness.
    pub line: StraightnessLine,
    /// Keeps it: the straightness was read against an artefact of the machine.
    pub keep_line: bool,
    /// The axis turns without end: positions modulo 360 deg, first row again at the end.
    pub continuous: bool,
    /// Refuses a file whose table would have no row.
    pub needs_table: bool,
}

/// A measurement with its figures after ISO 230-2.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImportResult {
    /// Name of the axis.
    pub axis: String,
    /// Layout of the file, in words.
    pub form: &'static str,
    /// True if directions were read off the order of the rows.
    pub directions_inferred: bool,
    /// The errors with their figures.
    pub errors: Vec<ImportedError>,
    /// Number of readings.
    pub readings: usize,
    /// Rows that were not used.
    pub left_out: Vec<LeftOutRow>,
    /// Columns, blocks and runs that were not used.
    pub columns_left_out: Vec<LeftOutColumn>,
    /// The errors of the channels of a six-degree instrument.
    pub channels: Vec<ImportedChannel>,
    /// Entries before the table.
    pub metadata: Vec<(String, String)>,
    /// The table of error curves that a machine file takes, CSV.
    #[serde(skip)]
    pub table: String,
    /// Number of positions of the table.
    #[serde(skip)]
    pub table_rows: usize,
}

/// Figures of one error over the axis, after ISO 230-2:2014; lengths in um, angles in urad.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImportedError {
    /// Name of the error.
    pub error: String,
    /// Unit of the figures.
    pub unit: &'static str,
    /// Number of target positions.
    pub targets: usize,
    /// Least number of runs of a target in a direction.
    pub runs: usize,
    /// True if both directions were measured.
    pub bidirectional: bool,
    /// Systematic deviation E.
    #[serde(rename = "E")]
    pub systematic: f64,
    /// Mean deviation M.
    #[serde(rename = "M")]
    pub mean: f64,
    /// Reversal B of largest size, with its sign; none without two directions.
    #[serde(rename = "B")]
    pub reversal: Option<f64>,
    /// Mean reversal.
    #[serde(rename = "mean_B")]
    pub mean_reversal: Option<f64>,
    /// Repeatability R; none without repeated runs.
    #[serde(rename = "R")]
    pub repeatability: Option<f64>,
    /// Accuracy A; none without repeated runs.
    #[serde(rename = "A")]
    pub accuracy: Option<f64>,
    /// Slope of the line of best fit, in `slope_unit`.
    pub slope: f64,
    /// Unit of the slope, such as `um/m`.
    pub slope_unit: String,
    /// Line of the reference, of a straightness of a linear axis.
    pub line: Option<StraightnessReference>,
}

/// The straight line in a straightness, before it was taken off.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StraightnessReference {
    /// Its slope.
    pub slope_um_per_m: f64,
    /// Its rise over the targets.
    pub rise_um: f64,
    /// The distance between the outermost targets.
    pub length_mm: f64,
    /// True if it was taken off: all figures and the table are without it.
    pub taken_off: bool,
    /// The squareness that it would be if the reference was an artefact of the machine.
    pub squareness: Option<String>,
    /// The value of that squareness in urad.
    pub squareness_urad: Option<f64>,
}

impl StraightnessReference {
    fn of(error: &ErrorId, line: &ReferenceLine) -> Self {
        let squareness = error.squareness();
        let slope_um_per_m = line.slope * 1e6;
        Self {
            slope_um_per_m,
            rise_um: line.rise * 1e3,
            length_mm: line.length,
            taken_off: line.taken_off,
            squareness_urad: squareness.as_ref().map(|(_, sign)| sign * slope_um_per_m + 0.0),
            squareness: squareness.map(|(error, _)| error.to_string()),
        }
    }
}

impl ImportedError {
    fn of(error: &ErrorId, f: &AccuracyFigures, rotary: bool, line: Option<&ReferenceLine>) -> Self {
        let (factor, unit) = error.direction.micro();
        let (per, length) = if rotary { (1.0, "deg") } else { (1e3, "m") };
        let value = |x: Option<f64>| x.map(|x| x * factor + 0.0);
        Self {
            error: error.to_string(),
            unit,
            targets: f.targets.len(),
            runs: f.runs,
            bidirectional: f.bidirectional(),
            systematic: f.systematic * factor,
            mean: f.mean * factor,
            reversal: value(f.reversal),
            mean_reversal: value(f.mean_reversal),
            repeatability: value(f.repeatability),
            accuracy: value(f.accuracy),
            slope: f.slope * factor * per,
            slope_unit: format!("{unit}/{length}"),
            line: line.map(|line| StraightnessReference::of(error, line)),
        }
    }
}

/// A row that was not used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LeftOutRow {
    /// Its line.
    pub line: usize,
    /// The reason.
    pub reason: String,
}

/// A column that was not used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LeftOutColumn {
    /// Its title.
    pub column: String,
    /// The reason.
    pub reason: String,
}

/// A channel of a six-degree instrument.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ImportedChannel {
    /// Title of the column.
    pub column: String,
    /// The error that it shows.
    pub error: String,
    /// `+` or `-`: the error is the column's value times this sign.
    pub sign: &'static str,
}

/// Maximum number of left-out rows that a warning lists.
const LISTED: usize = 12;

/// Reads an export: text, UTF-8 or UTF-16, comma, semicolon or tab.
///
/// Fails if the file cannot be understood as a whole; single rows are left out with a warning.
pub fn import(path: impl AsRef<Path>, options: &ImportOptions, run: Run) -> Result<Answer<ImportResult>, Diagnostics> {
    Call::answer(run, &Sources::default(), |call| {
        let request = request(call, options)?;
        let found = import::import(path.as_ref(), &request, run.files, &mut call.diagnostics);
        call.checked()?;
        let found = found.ok_or(Refused)?;
        let table = found.table(options.continuous);
        call.extend(left_out(&found));
        call.extend(unknown_columns(&found));
        call.extend(missing(&table.missing));
        if table.rows == 0 && options.needs_table {
            let message = "the table has no row: at no position were all errors measured, from all sides";
            let help =
                "measure the same targets in both directions; without --out the figures of what there is are printed";
            return call.refuse(Diagnostic::new(codes::E0509, message).help(help));
        }
        Ok(ImportResult { table_rows: table.rows, table: table.text, ..figures(&found, &call.diagnostics.sources) })
    })
}

fn request(call: &mut Call<'_>, options: &ImportOptions) -> Result<ImportRequest, Refused> {
    let request = ImportRequest {
        axis: options.axis.clone(),
        error: options.error.clone(),
        unit: options.unit.clone(),
        contents: options.contents,
        approach: options.runs,
        line: options.line,
        keep_line: options.keep_line,
        continuous: options.continuous,
        flipped: options.flip.clone(),
        ..ImportRequest::default()
    };
    let request = match (&options.beam, &options.vertical) {
        (None, None) => request,
        (Some(beam), Some(vertical)) => match request.with_mounting(beam, vertical) {
            Some(request) => request,
            None => {
                return call.usage("`--beam` and `--vertical` are two directions across each other, such as +X and +Z");
            }
        },
        _ => return call.usage("`--beam` and `--vertical` need each other"),
    };
    let Some(file) = &options.columns else { return Ok(request) };
    let map = import::read_columns(file, call.run.files, &mut call.diagnostics);
    Ok(request.with_columns(map.ok_or(Refused)?))
}

fn figures(found: &Import, sources: &Sources) -> ImportResult {
    let one = |(k, error): (usize, &ErrorId)| {
        let line = found.lines.iter().find(|line| line.error == k);
        Some(ImportedError::of(error, &found.figures(k)?, found.rotary, line))
    };
    let left = found
        .left_out
        .iter()
        .map(|row| LeftOutRow { line: sources.line_column(&row.place).0, reason: row.reason.clone() });
    ImportResult {
        axis: found.axis.clone(),
        form: found.form.word(),
        directions_inferred: found.inferred,
        errors: found.errors.iter().enumerate().filter_map(one).collect(),
        readings: found.samples.len(),
        left_out: left.collect(),
        columns_left_out: found
            .unused_columns
            .iter()
            .map(|unused| LeftOutColumn { column: unused.title.clone(), reason: unused.reason.clone() })
            .collect(),
        channels: found
            .channels
            .iter()
            .map(|channel| ImportedChannel {
                column: channel.title.clone(),
                error: channel.error.to_string(),
                sign: if channel.negative { "-" } else { "+" },
            })
            .collect(),
        metadata: found.metadata.clone(),
        table: String::new(),
        table_rows: 0,
    }
}

fn left_out(found: &Import) -> Option<Diagnostic> {
    let (count, all) = (found.left_out.len(), found.left_out.len() + found.samples.len());
    let message = format!("{count} of {all} rows or readings were left out");
    let warning = Diagnostic::new(codes::W0504, message).help("correct the file, or accept what is left");
    let listed = found.left_out.iter().take(LISTED);
    (count > 0).then(|| listed.fold(warning, |warning, row| warning.at(Some(row.place.clone()), row.reason.clone())))
}

/// Columns that no rule has.
fn unknown_columns(found: &Import) -> Option<Diagnostic> {
    let unknown = found.unused_columns.iter().filter(|column| !column.known);
    let titles: Vec<String> = unknown.map(|column| format!("`{}`", shown(&column.title))).collect();
    let list = titles.iter().take(LISTED).cloned().collect::<Vec<_>>().join(", ");
    let more = if titles.len() > LISTED { " ..." } else { "" };
    let message = format!("{} left out, not understood: {list}{more}", counted(titles.len(), "column"));
    let help = "a reading among them is mapped by `--columns FILE`; `abbe explain W0511` shows such a file";
    (!titles.is_empty()).then(|| Diagnostic::new(codes::W0511, message).help(help))
}

fn missing(positions: &[String]) -> Option<Diagnostic> {
    let list = positions.iter().take(LISTED).cloned().collect::<Vec<_>>().join(", ");
    let message = format!("the table has no row at {list}: an error or a direction was not measured there");
    let help = "measure the same targets in both directions";
    (!positions.is_empty()).then(|| Diagnostic::new(codes::W0504, message).help(help))
}
