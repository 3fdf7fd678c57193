//! A fit as a value: parameters with their uncertainty, what the data do not determine, and the residuals.

use super::accused::{ResidualGroup, SuspectReadings};
use super::datum::{self, FittedError};
use super::fitted::{FitDiagnosis, FittedDatum};
use super::limits;
use crate::diagnostic::Sources;
use crate::identify::thresholds::MIN_KNOWN_SHARE;
use crate::identify::{
    Bend, DeviationUncertainty, Estimate, FormUncertainty, Gauge, Outlier, Parameter, Prediction, PriorValue,
    ReadingKind, Repeats, ResidualTest, Scatter, SharedEffect, TypeB,
};
use crate::job::poses::{AxisPositions, axis_positions};
use crate::machine::{AxisName, Machine, ResidualForm};
use crate::units::{counted, significant};
use serde::Serialize;

/// A picture with the name of its file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedSvg {
    /// Name such as `fit-xy.svg`.
    pub name: String,
    /// Text of the SVG file.
    pub svg: String,
}

/// A parameter with its value.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct FittedParameter {
    /// Name such as `EX0C`.
    pub name: String,
    /// Value, in `unit`.
    pub value: f64,
    /// False if the readings leave the value free: it is then what the datum makes of it, as a rule 0.
    pub determined: bool,
    /// Combined standard uncertainty, in `unit`; none if the data leave the value free or nothing scatters.
    pub sigma: Option<f64>,
    /// The part of it that the scatter of the readings makes, as if each were independent (type A).
    pub type_a: Option<f64>,
    /// The part of it that the form of the axes makes, which readings near each other share.
    pub lack_of_fit: f64,
    /// The part of it that all readings share, as the user states it (type B).
    pub type_b: f64,
    /// Unit of the value and of its uncertainties.
    pub unit: String,
    /// Standard uncertainties that a 95 % interval reaches to either side.
    pub coverage_factor_95: Option<f64>,
    /// Standard deviation of a reading over that of the parameter's effect on a usual reading; 0 if the value is free.
    #[serde(rename = "valuation")]
    pub observability: f64,
}

impl FittedParameter {
    fn of(parameter: &Parameter, estimate: &Estimate) -> Self {
        Self {
            name: parameter.name.clone(),
            value: parameter.in_unit(estimate.value) + 0.0,
            determined: estimate.observability > 0.0,
            sigma: estimate.sigma.map(|sigma| parameter.in_unit(sigma)),
            type_a: estimate.scatter.map(|sigma| parameter.in_unit(sigma)),
            lack_of_fit: parameter.in_unit(estimate.form),
            type_b: parameter.in_unit(estimate.common),
            unit: parameter.unit.clone(),
            coverage_factor_95: estimate.coverage,
            observability: estimate.observability,
        }
    }
}

/// Residual of a measurement after the fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReadingResidual {
    /// The kind of reading, such as `deviations`.
    pub kind: &'static str,
    /// Measured minus predicted, along x, y, z where the reading is of a point; the first number where it is one.
    pub residual: [f64; 3],
    /// Unit of the residual.
    pub unit: &'static str,
}

impl ReadingResidual {
    pub(crate) fn of(kind: ReadingKind, mm: [f64; 3]) -> Self {
        let (unit, factor) = kind.unit();
        Self { kind: kind.word(), residual: mm.map(|mm| mm * factor), unit }
    }
}

/// A value that was known before the data.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct KnownValue {
    /// Name of the unknown, or `distance` and two points.
    pub name: String,
    /// Value, in `unit`.
    pub value: f64,
    /// Standard uncertainty, in `unit`.
    pub sigma: f64,
    /// Value that the fit finds, in `unit`.
    pub found: f64,
    /// Found minus known value in standard deviations of that difference; none where the readings say nothing of it.
    pub deviations: Option<f64>,
    /// Unit of the value and of its uncertainties.
    pub unit: String,
}

impl KnownValue {
    pub(crate) fn all(fitted: &FitDiagnosis<'_>) -> Vec<Self> {
        let theta = fitted.solution.theta();
        let value = |known: &PriorValue| {
            let (parameter, found) = (&fitted.unknowns[known.unknown], theta[known.unknown]);
            let u = fitted.solution.uncertainty(&[(known.unknown, 1.0)]);
            Self {
                name: parameter.name.clone(),
                value: parameter.in_unit(known.value) + 0.0,
                sigma: parameter.in_unit(known.sigma),
                found: parameter.in_unit(found),
                deviations: deviations(found - known.value, known.sigma, u),
                unit: parameter.unit.clone(),
            }
        };
        let gauge = |gauge: &Gauge| {
            let (found, by) = gauge.found(&theta);
            let deviations = deviations(found - gauge.length, gauge.sigma, fitted.solution.uncertainty(&by));
            let (value, sigma, unit) = (gauge.length, gauge.sigma, "mm".to_owned());
            Self { name: gauge.name.clone(), value, sigma, found, deviations, unit }
        };
        fitted.known.iter().map(value).chain(fitted.gauges.iter().map(gauge)).collect()
    }
}

/// Returns a residual of a fit in its standard deviations: of what was known within `sigma`, and is known within `u`
/// with the readings.
fn deviations(residual: f64, sigma: f64, u: Option<f64>) -> Option<f64> {
    let variance = sigma * sigma - u? * u?;
    (variance > MIN_KNOWN_SHARE * sigma * sigma).then(|| residual / libm::sqrt(variance))
}

/// A standard uncertainty that all readings share (type B).
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct SharedUncertainty {
    /// Its name.
    pub name: String,
    /// Scale of all lengths, um/m.
    pub scale_um_per_m: Option<f64>,
    /// Offset of every component, um.
    pub offset_um: Option<f64>,
}

impl SharedUncertainty {
    fn of(of: &TypeB) -> Self {
        let (scale_um_per_m, offset_um) = match of.effect {
            SharedEffect::Scale(ratio) => (Some(ratio * 1e6), None),
            SharedEffect::Offset(size) => (None, Some(um(size))),
        };
        Self { name: of.name.clone(), scale_um_per_m, offset_um }
    }
}

/// The form of the axes that the fitted curves leave.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct LackOfFit {
    /// Probability that there is any, with odds of one to three before the data.
    pub probability: f64,
    /// The axes with their forms, if one is likelier than none.
    pub forms: Vec<FormOfAxis>,
    /// Errors that a richer curve would bend, the one first that takes most off the residuals.
    pub bends: Vec<BentError>,
    /// Errors with a form whose size is tied to those of the others: the readings do not tell it from them.
    pub tied: Vec<String>,
}

/// An error that a richer curve would bend.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct BentError {
    /// The error.
    pub error: String,
    /// Largest less smallest value of what the curve would add to it, over the positions measured, in `unit`.
    pub bend: f64,
    /// um or urad.
    pub unit: &'static str,
    /// Root mean square of the residuals that it would leave, over that of today.
    pub rms_ratio: f64,
    /// Word of `--fit` that fits the curve; none where `linear` holds the error straight.
    pub fit: Option<String>,
}

/// The form of an axis beside its fitted curves.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct FormOfAxis {
    /// The axis.
    pub axis: String,
    /// Standard deviation of what the fitted curves leave of a displacement, um, root mean square of the three; 0 if
    /// none is stated.
    pub size_um: f64,
    /// Standard deviation of what the fitted curves leave of a rotation, urad, root mean square of the three; 0 if none
    /// is stated.
    pub rotation_urad: f64,
    /// Standard deviation of each displacement, along X, Y and Z, um.
    pub sizes_um: [f64; 3],
    /// Standard deviation of each rotation, about X, Y and Z, urad.
    pub rotations_urad: [f64; 3],
    /// Correlation length, in `unit`.
    pub length: f64,
    /// mm or deg.
    pub unit: &'static str,
}

impl LackOfFit {
    fn of(machine: &Machine, found: &FormUncertainty) -> Self {
        let unit = |name: &AxisName| machine.axis_index(name.as_str()).map_or("mm", |i| machine.axes()[i].unit());
        let form = |form: &ResidualForm| FormOfAxis {
            axis: form.axis.to_string(),
            size_um: um(form.mean_size(false)),
            rotation_urad: form.mean_size(true) * 1e6,
            sizes_um: std::array::from_fn(|k| um(form.sizes[k])),
            rotations_urad: std::array::from_fn(|k| form.sizes[3 + k] * 1e6),
            length: form.length,
            unit: unit(&form.axis),
        };
        Self {
            probability: found.probability,
            forms: found.forms.iter().map(form).collect(),
            bends: found.bends.iter().map(bent_error).collect(),
            tied: found.tied.iter().map(ToString::to_string).collect(),
        }
    }
}

fn bent_error(bend: &Bend) -> BentError {
    let unit = if bend.error.direction.is_rotation() { "urad" } else { "um" };
    BentError {
        error: bend.error.to_string(),
        bend: bend.size * if unit == "um" { 1e3 } else { 1e6 },
        unit,
        rms_ratio: libm::sqrt((1.0 - bend.share).max(0.0)),
        fit: bend.is_free.then(|| format!("{}:{}", bend.error, bend.basis)),
    }
}

/// Root mean square of the readings, um.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RmsBeforeAfter {
    /// Against the machine file as it was.
    pub before: f64,
    /// Against the fitted machine.
    pub after: f64,
    /// Against fits without the readings that they predict, if asked for.
    pub held_out: Option<f64>,
}

/// Scatter of one kind of reading.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ScatterOfKind {
    /// Kind of reading, or `uncertainties given`.
    pub of: String,
    /// Standard deviation of a reading of weight 1, um.
    pub sigma_um: f64,
    /// The same in words, in the unit of the kind.
    #[serde(skip)]
    pub words: String,
}

/// Scatter of readings of one kind in poses that were measured again.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RepeatedReadings {
    /// Kind of reading.
    pub of: String,
    /// Standard deviation of a reading of weight 1, um.
    pub sigma_um: f64,
    /// Degrees of freedom behind it.
    pub degrees_of_freedom: usize,
}

/// Deviations by the order of the errors that make them, root mean square over the readings, um.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct OrderShares {
    /// First order.
    pub first: f64,
    /// Second order.
    pub second: f64,
    /// All higher orders.
    pub higher: f64,
    /// Residual of the model of order 1.
    pub left_by_first: f64,
    /// Residual of the model of order 2.
    pub left_by_second: f64,
}

/// Residual of one kind of reading.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct KindResidual {
    /// Kind of reading.
    pub kind: String,
    /// Number of readings.
    pub rows: usize,
    /// Root mean square of their residuals, um.
    pub rms_um: f64,
    /// The same in words, in the unit of the kind.
    #[serde(skip)]
    pub words: String,
}

/// A reading that stands out.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct OutlierPlace {
    /// File and line.
    pub place: String,
    /// Its residual, um.
    pub residual_um: f64,
    /// The same in standard deviations.
    pub deviations: f64,
}

/// The uncertainty of the deviation over the volume, after the best rigid motion of the workpiece frame.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct PredictedUncertainty {
    /// The largest standard uncertainty, um, along the direction in which it is largest; none if the data leave the
    /// deviation free, or nothing scatters.
    pub largest_um: Option<f64>,
    /// True if the data leave it free somewhere: the uncertainty is infinite.
    pub infinite: bool,
    /// A combination of parameters that changes the deviation and no reading, in words.
    pub combination: Option<String>,
    /// Pose at which it is largest, mm and deg.
    pub at: AxisPositions,
    /// The tool there.
    pub tool: String,
    /// The largest deviation predicted, um.
    pub deviation_um: f64,
    /// True if the data hold the prediction, so that a machine file is written.
    pub held: bool,
}

impl PredictedUncertainty {
    fn of(fitted: &FitDiagnosis<'_>) -> Self {
        let Prediction { uncertainty, pose, tool, deviation } = &fitted.prediction;
        let (largest_um, combination) = match uncertainty {
            DeviationUncertainty::Known(size) => (Some(um(*size)), None),
            DeviationUncertainty::Unknown => (None, None),
            DeviationUncertainty::Free(words) => (None, Some(words.clone())),
        };
        Self {
            largest_um,
            infinite: combination.is_some(),
            combination,
            at: axis_positions(fitted.machine, pose),
            tool: fitted.machine.tools().get(*tool).map_or_else(String::new, |tool| tool.name.clone()),
            deviation_um: um(*deviation),
            held: limits::holds_prediction(fitted),
        }
    }
}

/// A fit.
#[derive(Debug, Clone, Serialize, schemars::JsonSchema)]
pub struct IdentifyResult {
    /// Number of readings.
    pub rows: usize,
    /// Number of measurements.
    pub points: usize,
    /// The machine's parameters.
    pub parameters: Vec<FittedParameter>,
    /// Unknowns of the instruments, such as places of stations.
    pub instruments: Vec<FittedParameter>,
    /// Values that were known before the data.
    pub known: Vec<KnownValue>,
    /// Standard uncertainties that all readings share.
    pub type_b: Vec<SharedUncertainty>,
    /// The form of the axes beside the fitted curves; none if the readings cannot show it: fewer than 20 to spare, or
    /// no axis at six positions.
    pub lack_of_fit: Option<LackOfFit>,
    /// Numerical rank of the problem.
    pub rank: usize,
    /// The rank of the model to first order in the errors: what the readings show without products of errors.
    pub rank_first_order: usize,
    /// Number of unknowns.
    pub unknowns: usize,
    /// Number of independent combinations above the noise.
    pub well_determined: usize,
    /// Combinations without effect on the data, in words.
    pub null_space: Vec<String>,
    /// Combinations below the noise, in words.
    #[serde(rename = "drowned")]
    pub below_noise: Vec<String>,
    /// True if they leave values of the machine in doubt.
    #[serde(skip)]
    pub noise_hides_values: bool,
    /// Ratio of the largest singular value to the smallest that counts.
    pub condition: f64,
    /// Least observability of the machine's parameters that have a value.
    #[serde(rename = "valuation")]
    pub observability: f64,
    /// Singular values of the column-scaled problem.
    pub singular_values: Vec<f64>,
    /// Root mean square of the readings.
    pub rms_um: RmsBeforeAfter,
    /// Standard deviation of a reading of weight 1, um; none where kinds scatter differently.
    pub sigma_um: Option<f64>,
    /// Readings beyond the rank.
    pub degrees_of_freedom: usize,
    /// Scatter kind by kind, where kinds scatter differently.
    pub scatter: Vec<ScatterOfKind>,
    /// Scatter of repeated poses, um: that of the first kind.
    pub repeatability_um: Option<f64>,
    /// Scatter of repeated poses, kind by kind.
    pub repeats: Vec<RepeatedReadings>,
    /// Deviations by order.
    pub orders_um: OrderShares,
    /// Residuals kind by kind.
    pub kinds: Vec<KindResidual>,
    /// Tests of the residuals.
    pub residual_tests: Vec<ResidualTest>,
    /// What is left by component, axis, tool, run and station.
    pub residuals: Vec<ResidualGroup>,
    /// Changes of the data that explain what is left.
    pub suspect: Option<SuspectReadings>,
    /// Readings that stand out, farthest first.
    pub outliers: Vec<OutlierPlace>,
    /// Uncertainty of the fit's prediction over the volume.
    pub prediction: PredictedUncertainty,
    /// Rigid motions of the whole machine that no reading notices, such as `along X`.
    pub invariances: Vec<String>,
    /// The datum of the errors, where curves are fitted.
    pub datum: Option<FittedDatum>,
    /// Every fitted error of an axis over its travel.
    pub errors: Vec<FittedError>,
    /// Steps of the fit.
    pub steps: usize,
    /// False if the fit was stopped before it had settled.
    pub settled: bool,
    /// Name of the machine.
    #[serde(skip)]
    pub machine: String,
    /// Scatter of a reading, in words.
    #[serde(skip)]
    pub reading_scatter: String,
    /// Smallest and largest coverage factor of a 95 % interval.
    #[serde(skip)]
    pub coverage: Option<(f64, f64)>,
    /// Combinations without effect, in words for people: shortened.
    #[serde(skip)]
    pub free: Vec<String>,
    /// Covariance of `parameters` in their units, row by row; what is free has no part in it.
    #[serde(skip)]
    pub covariance: Vec<Vec<f64>>,
    /// Residuals of the measurements in their order.
    #[serde(skip)]
    pub reading_residuals: Vec<ReadingResidual>,
    /// Text of the fitted machine file, if asked for.
    #[serde(skip)]
    pub machine_file: Option<String>,
    /// Pictures of prediction and data, if asked for.
    #[serde(skip)]
    pub pictures: Vec<NamedSvg>,
}

fn um(mm: f64) -> f64 {
    mm * 1e3
}

/// A size (mm) in the unit of a kind of reading.
fn in_unit(kind: ReadingKind, mm: f64) -> String {
    let (unit, factor) = kind.unit();
    format!("{} {unit}", significant(mm * factor, 5))
}

/// File and line of a measurement.
pub(crate) fn place(fitted: &FitDiagnosis<'_>, sources: &Sources, row: usize) -> String {
    let place = &fitted.data[row].place;
    format!("{}:{}", sources.name(place.source), sources.line_column(place).0)
}

pub(crate) fn in_short(fitted: &FitDiagnosis<'_>) -> String {
    let (rank, unknowns, rows) = (fitted.solution.rank_first_order, fitted.unknowns.len(), fitted.rows());
    let [before, after] = [fitted.residuals.before, fitted.residuals.after].map(|rms| significant(um(rms), 5));
    let from = match fitted.known.len() + fitted.gauges.len() {
        0 => counted(rows, "reading"),
        known => format!("{} and {}", counted(rows, "reading"), counted(known, "known value")),
    };
    format!("rank {rank} of {unknowns} parameters from {from}; rms {before} um before, {after} um after")
}

impl IdentifyResult {
    pub(crate) fn of(fitted: &FitDiagnosis<'_>, sources: &Sources) -> Self {
        let (s, r) = (&fitted.solution, &fitted.residuals);
        let all: Vec<_> = fitted.unknowns.iter().zip(&s.estimates).map(|(p, e)| FittedParameter::of(p, e)).collect();
        let (parameters, instruments) = all.split_at(fitted.own);
        let outlier = |o: &Outlier| OutlierPlace {
            place: place(fitted, sources, o.row),
            residual_um: um(o.residual),
            deviations: o.deviations,
        };
        Self {
            rows: fitted.rows(),
            points: fitted.data.len(),
            parameters: parameters.to_vec(),
            instruments: instruments.to_vec(),
            known: KnownValue::all(fitted),
            type_b: fitted.type_b.iter().map(SharedUncertainty::of).collect(),
            lack_of_fit: fitted.form.as_ref().map(|form| LackOfFit::of(fitted.machine, form)),
            rank: s.rank,
            rank_first_order: s.rank_first_order,
            unknowns: fitted.unknowns.len(),
            well_determined: s.well_determined,
            null_space: s.null_space.clone(),
            below_noise: s.below_noise.clone(),
            noise_hides_values: fitted.noise_hides_values(),
            condition: s.condition,
            observability: s.observability,
            singular_values: s.singular_values.clone(),
            rms_um: RmsBeforeAfter { before: um(r.before), after: um(r.after), held_out: fitted.held_out.map(um) },
            sigma_um: fitted.fit.scatter.is_empty().then(|| um(s.sigma)),
            degrees_of_freedom: s.degrees_of_freedom,
            scatter: fitted.fit.scatter.iter().map(scatter_of_kind).collect(),
            repeatability_um: fitted.repeats.first().map(|r| um(r.sigma)),
            repeats: fitted.repeats.iter().map(repeated_readings).collect(),
            orders_um: OrderShares {
                first: um(r.parts[0]),
                second: um(r.parts[1]),
                higher: um(r.parts[2]),
                left_by_first: um(r.truncated[0]),
                left_by_second: um(r.truncated[1]),
            },
            kinds: r.kinds.iter().map(|(kind, rows, rms)| kind_residual(*kind, *rows, *rms)).collect(),
            residual_tests: fitted.residual_tests.clone(),
            residuals: Vec::new(),
            suspect: None,
            outliers: r.outliers.iter().map(outlier).collect(),
            prediction: PredictedUncertainty::of(fitted),
            invariances: fitted.motions.clone(),
            datum: fitted.datum.clone(),
            errors: datum::errors(fitted),
            steps: fitted.fit.steps,
            settled: fitted.fit.converged,
            machine: fitted.machine.name().to_owned(),
            reading_scatter: reading_scatter(fitted),
            coverage: s.coverage_range(),
            free: s.null_space_summary(),
            covariance: covariance(fitted),
            reading_residuals: Vec::new(),
            machine_file: None,
            pictures: Vec::new(),
        }
    }
}

fn covariance(fitted: &FitDiagnosis<'_>) -> Vec<Vec<f64>> {
    let factor = |k: usize| fitted.unknowns[k].factor;
    let rows = fitted.solution.covariance(fitted.own).into_iter().enumerate();
    let in_units =
        |(i, row): (usize, Vec<f64>)| row.iter().enumerate().map(|(j, v)| v * factor(i) * factor(j)).collect();
    rows.map(in_units).collect()
}

fn repeated_readings(repeats: &Repeats) -> RepeatedReadings {
    RepeatedReadings {
        of: repeats.of.word().to_owned(),
        sigma_um: um(repeats.sigma),
        degrees_of_freedom: repeats.degrees_of_freedom,
    }
}

fn kind_residual(kind: ReadingKind, rows: usize, rms: f64) -> KindResidual {
    KindResidual { kind: kind.word().to_owned(), rows, rms_um: um(rms), words: in_unit(kind, rms) }
}

fn times_given(sigma: f64) -> String {
    format!("{} times the uncertainty given", significant(um(sigma), 4))
}

fn scatter_of_kind(scatter: &Scatter) -> ScatterOfKind {
    let sigma = scatter.sigma;
    let (of, words) = match scatter.of {
        Some(kind) => (kind.word(), format!("{} of {}", in_unit(kind, sigma), kind.word())),
        None => ("uncertainties given", times_given(sigma)),
    };
    ScatterOfKind { of: of.to_owned(), sigma_um: um(sigma), words }
}

/// Scatter of a reading, in words, where all kinds scatter alike.
fn reading_scatter(fitted: &FitDiagnosis<'_>) -> String {
    let kind = match &fitted.residuals.kinds[..] {
        [(kind, ..)] => *kind,
        _ => ReadingKind::Deviation,
    };
    let sigma = fitted.solution.sigma;
    if fitted.data.iter().all(|m| m.has_uncertainty) { times_given(sigma) } else { in_unit(kind, sigma) }
}
