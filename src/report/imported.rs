//! An imported measurement as a value: its figures after ISO 230-2, and what was left out.

use super::positioning::{
    AccuracyUncertainties, DrawnRuns, MeasuredTarget, OneWayBoth, StatedContributors, drawn_runs,
};
use super::{Picture, RunPanel};
use crate::diagnostic::Sources;
use crate::identify::import::{AxisSample, Finding, FindingEffect, FindingKind, Import, ImportRequest, ReferenceLine};
use crate::machine::ErrorId;
use crate::standards::{self, AccuracyFigures, Contributor};
use crate::syntax::ColumnDirection;
use crate::units::counted;
use serde::Serialize;

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
    /// Suspicions against the readings.
    pub findings: Vec<ImportFinding>,
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
    /// Contributors that these uncertainties have and lack.
    pub contributors: Option<StatedContributors>,
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
        let (uncertainty, contributors) = AccuracyUncertainties::of_error(contributors, found, error, f).unzip();
        let of_error = found.samples.iter().filter(|sample| sample.error == error);
        let error = &found.errors[error];
        let (factor, unit) = error.direction.micro();
        let (per, length) = if found.rotary { (1.0, "deg") } else { (1e3, "m") };
        let rising = |sample: &AxisSample| sample.direction.map(|from| from == ColumnDirection::Forward);
        let reading = |sample: &AxisSample| (sample.position, sample.value * factor, rising(sample));
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
            contributors,
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

/// A suspicion against readings.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, schemars::JsonSchema)]
pub struct ImportFinding {
    /// The kind.
    pub kind: FindingKind,
    /// The error; none of the file as a whole.
    pub error: Option<String>,
    /// The lines, in the order of their weight.
    pub lines: Vec<usize>,
    /// In a sentence.
    pub message: String,
    /// The remedy.
    pub remedy: String,
    /// The use that was made of the readings.
    pub effect: FindingEffect,
}

impl ImportFinding {
    fn of(found: &Import, finding: &Finding, sources: &Sources) -> Self {
        Self {
            kind: finding.kind,
            error: finding.error.map(|error| found.errors[error].to_string()),
            lines: finding.places.iter().map(|place| sources.line_column(place).0).collect(),
            message: finding.message.clone(),
            remedy: finding.help.clone(),
            effect: finding.effect,
        }
    }
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

impl ImportResult {
    /// Returns the figures of a file, without the table.
    pub(crate) fn of(found: &Import, request: &ImportRequest, contributors: &[Contributor], sources: &Sources) -> Self {
        let one = |error: usize| Some(ImportedError::of(found, error, &found.figures(error)?, contributors));
        let left = found
            .left_out
            .iter()
            .map(|row| LeftOutRow { line: sources.line_column(&row.place).0, reason: row.reason.clone() });
        Self {
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
            findings: found.findings.iter().map(|finding| ImportFinding::of(found, finding, sources)).collect(),
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
}
