//! A single-axis measurement as an instrument exports it, to a table of error curves.

use crate::diagnostic::{Diagnostic, Diagnostics, Sources, codes, shown};
use crate::identify::import::{self, Import, ImportRequest, ReferenceLine, Sample};
use crate::machine::ErrorId;
use crate::report::positioning::{
    AccuracyUncertainties, DrawnRuns, MeasuredTarget, OneWayBoth, contributors, drawn_runs,
};
use crate::report::{Picture, RunPanel};
use crate::run::{Answer, Call, Refused, Run};
use crate::standards::{self, AccuracyFigures, Contributor, Thermal};
use crate::syntax::ColumnDirection;
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
    /// Temperature and expansion of the machine's material, such as `22.5 degC x 11.5 um/m/K`: positions of a linear
    /// axis are brought to 20 deg C, about the first target.
    pub material: Option<String>,
    /// Contributors to the uncertainty of the figures (ISO 230-2 annex A), such as `device 0.5 um/m`,
    /// `misalignment 1 mm`, `temperature 0.7 K x 11.5 um/m/K`, `expansion 2 um/m/K x 5 K`, `drift 1.2 um`.
    pub uncertainty: Vec<String>,
    /// Refuses a file whose table would have no row.
    pub needs_table: bool,
}

/// A measurement with its figures after ISO 230-2.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ImportResult {
    /// Name of the axis.
    pub axis: String,
    /// Layout of the file, in words.
    pub form: &'static str,
    /// True if directions were read off the order of the rows.
    pub directions_inferred: bool,
    /// The errors with their figures.
    pub errors: Vec<ImportedError>,
    /// The material whose expansion was taken off the positions.
    pub material: Option<ReferenceMaterial>,
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
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
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
    /// Reversal B: the largest size of those of the targets; none without two directions.
    #[serde(rename = "B")]
    pub reversal: Option<f64>,
    /// Mean of the reversals of the targets, with its sign.
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
    /// Figures by direction.
    pub one_way: OneWayBoth,
    /// Expanded uncertainties, k = 2, where contributors are stated that count for this error.
    #[serde(rename = "U")]
    pub uncertainty: Option<AccuracyUncertainties>,
    /// In sentences what ISO 230-2 wants of targets and runs; not verified against its text.
    pub remarks: Vec<String>,
    /// The readings by target.
    pub at_targets: Vec<MeasuredTarget>,
    /// Every reading, in the unit of the figures: position, value, and whether it came from below.
    #[serde(skip)]
    pub(crate) readings: Vec<(f64, f64, Option<bool>)>,
}

/// The material of a machine at the time of a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ReferenceMaterial {
    /// Its temperature, deg C.
    pub temperature_deg_c: f64,
    /// Its coefficient of expansion, um/(m K).
    pub expansion_um_per_m_k: f64,
}

/// The straight line in a straightness, before it was taken off.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
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
    fn of(found: &Import, error: usize, f: &AccuracyFigures, contributors: &[Contributor]) -> Self {
        let line = found.lines.iter().find(|line| line.error == error);
        let uncertainty = AccuracyUncertainties::of_error(contributors, (found, error), f);
        let of_error = found.samples.iter().filter(|sample| sample.error == error);
        let error = &found.errors[error];
        let (factor, unit) = error.direction.micro();
        let (per, length) = if found.rotary { (1.0, "deg") } else { (1e3, "m") };
        let rising = |sample: &Sample| sample.direction.map(|from| from == ColumnDirection::Forward);
        let reading = |sample: &Sample| (sample.position, sample.value * factor, rising(sample));
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
            one_way: OneWayBoth::of(f, factor),
            uncertainty,
            remarks: standards::remarks(f, found.rotary),
            at_targets: MeasuredTarget::all(f, factor),
            readings: of_error.map(reading).collect(),
        }
    }
}

impl ImportResult {
    /// Returns a picture of the runs: every reading, and for each direction the mean with its band of 2 s.
    pub fn picture(&self) -> Picture {
        let panels: Vec<RunPanel> = self.errors.iter().map(ImportedError::panel).collect();
        let subtitle = format!("{} of {}", counted(self.readings, "reading"), counted(self.errors.len(), "error"));
        let slope_unit = self.errors.first().map(|error| error.slope_unit.as_str());
        drawn_runs(&self.axis, &subtitle, slope_unit, &panels)
    }
}

impl ImportedError {
    fn panel(&self) -> RunPanel {
        let figures = [Some(self.systematic), self.reversal, self.repeatability, self.accuracy];
        let (error, unit, targets, readings) = (&self.error, self.unit, &self.at_targets, &self.readings);
        DrawnRuns { error, unit, figures, targets, readings }.panel()
    }
}

/// A row that was not used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, schemars::JsonSchema)]
pub struct LeftOutRow {
    /// Its line.
    pub line: usize,
    /// The reason.
    pub reason: String,
}

/// A column that was not used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, schemars::JsonSchema)]
pub struct LeftOutColumn {
    /// Its title.
    pub column: String,
    /// The reason.
    pub reason: String,
}

/// A channel of a six-degree instrument.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, schemars::JsonSchema)]
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
        let contributors = match contributors(&options.uncertainty) {
            Ok(contributors) => contributors,
            Err(words) => {
                return call.usage(format!(
                    "`{}` is no uncertainty: write `device 0.5 um/m`, `misalignment 1 mm`, `temperature 0.7 K x 11.5 \
                     um/m/K`, `expansion 2 um/m/K x 5 K` or `drift 1.2 um`",
                    shown(words)
                ));
            }
        };
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
        let result = figures(&found, (&request, &contributors), &call.diagnostics.sources);
        Ok(ImportResult { table_rows: table.rows, table: table.text, ..result })
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
        material: material(call, options)?,
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

/// The material of the machine, in words.
fn material(call: &mut Call<'_>, options: &ImportOptions) -> Result<Option<Thermal>, Refused> {
    let Some(words) = &options.material else { return Ok(None) };
    let plausible = |of: &Thermal| of.temperature.abs() <= 100.0 && of.expansion.abs() <= 1e-3;
    match standards::thermal(words).filter(plausible) {
        Some(found) => Ok(Some(found)),
        None => call.usage(format!(
            "`{}` is no material: write its temperature times its expansion, such as `22.5 degC x 11.5 um/m/K`",
            shown(words)
        )),
    }
}

fn figures(
    found: &Import,
    (request, contributors): (&ImportRequest, &[Contributor]),
    sources: &Sources,
) -> ImportResult {
    let one = |error: usize| Some(ImportedError::of(found, error, &found.figures(error)?, contributors));
    let left = found
        .left_out
        .iter()
        .map(|row| LeftOutRow { line: sources.line_column(&row.place).0, reason: row.reason.clone() });
    ImportResult {
        axis: found.axis.clone(),
        form: found.form.word(),
        directions_inferred: found.inferred,
        errors: (0..found.errors.len()).filter_map(one).collect(),
        material: request.material.map(|of| ReferenceMaterial {
            temperature_deg_c: of.temperature,
            expansion_um_per_m_k: of.expansion * 1e6,
        }),
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
    let (count, used) = (found.left_out.len(), counted(found.samples.len(), "reading"));
    let message = format!("rows or readings left out: {count}; {used} used");
    let warning = Diagnostic::new(codes::W0504, message).help("correct the file, or accept what is left");
    let listed = found.left_out.iter().take(LISTED);
    (count > 0).then(|| listed.fold(warning, |warning, row| warning.at(Some(row.place.clone()), row.reason.clone())))
}

/// Columns that no rule has.
fn unknown_columns(found: &Import) -> Option<Diagnostic> {
    let unknown = found.unused_columns.iter().filter(|column| !column.known);
    let titles: Vec<&str> = unknown.map(|column| column.title.as_str()).collect();
    let help = "a reading among them is mapped by `--columns FILE`; `abbe explain W0511` shows such a file";
    columns_left_out(&titles, help)
}

/// A warning of columns that were not understood.
pub(crate) fn columns_left_out(titles: &[&str], help: &str) -> Option<Diagnostic> {
    let list: Vec<String> = titles.iter().take(LISTED).map(|title| format!("`{}`", shown(title))).collect();
    let more = if titles.len() > LISTED { " ..." } else { "" };
    let message = format!("{} left out, not understood: {}{more}", counted(titles.len(), "column"), list.join(", "));
    (!titles.is_empty()).then(|| Diagnostic::new(codes::W0511, message).help(help))
}

fn missing(positions: &[String]) -> Option<Diagnostic> {
    let list = positions.iter().take(LISTED).cloned().collect::<Vec<_>>().join(", ");
    let message = format!("the table has no row at {list}: an error or a direction was not measured there");
    let help = "measure the same targets in both directions";
    (!positions.is_empty()).then(|| Diagnostic::new(codes::W0504, message).help(help))
}
