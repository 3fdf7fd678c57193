//! The verdict on a second measurement, as a value and in words.

use super::campaign::Campaign;
use super::judge::{Amount, Judged, Reduced, SetUpUnknown};
use crate::diagnostic::Sources;
use crate::identify::data::ReadingKind;
use crate::units::significant;
use nalgebra::DMatrix;
use serde::Serialize;
use std::path::Path;

/// The verdict on a set by a second measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SecondVerdict {
    /// The readings are what the certificate promises, and would not be without the set.
    Within,
    /// They are not.
    NotWithin,
    /// They are, and would be without the set, too.
    CannotTell,
}

/// A machine that the readings agree with in place of the one with the set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SetAlternative {
    /// Without the set.
    NotInForce,
    /// With every sign of the set reversed.
    Reversed,
    /// With half of every correction.
    Half,
}

impl SetAlternative {
    fn words(self) -> &'static str {
        match self {
            Self::NotInForce => "they are those of the machine without the set",
            Self::Reversed => "they are those of the machine with every sign of the set reversed",
            Self::Half => "they are those of the machine with half of every correction",
        }
    }
}

/// The amount of a correction that the readings see: 1 as predicted, 0 none, -1 reversed.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct SeenCorrection {
    /// The axis that is corrected; none for all together.
    pub axis: Option<String>,
    /// The amount.
    pub amount: f64,
    /// Its expanded uncertainty (k = 2), that of the prediction and of the readings in it.
    pub expanded_uncertainty: f64,
}

/// A root of mean squares with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RmsInterval {
    /// Over the places of a kind of reading, all components together.
    pub rms: f64,
    /// The interval in which that of the machine lies (k = 2).
    pub interval: [f64; 2],
}

/// Predicted and measured readings of one kind, without what the set-up explains.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct MeasuredKind {
    /// `deviations`, `lengths` ...
    pub kind: &'static str,
    /// `um` or `urad`.
    pub unit: &'static str,
    /// Number of rows.
    pub places: usize,
    /// Share of |E_n| <= 1.
    pub within: f64,
    /// By the machine file and the set; its uncertainty raises the figure, too.
    pub predicted: RmsInterval,
    /// By the readings, less their scatter.
    pub measured: RmsInterval,
}

/// A motion of the set-up, or an unknown of an instrument, by the readings.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct SetUpValue {
    /// Such as `part x`, `turn C`, `slope EYX`, `station.x`.
    pub name: String,
    /// Distance from where it starts.
    pub value: f64,
    /// `um` or `urad`.
    pub unit: &'static str,
    /// Standard uncertainty with which it was known before, in `unit`; none if it was free.
    pub known: Option<f64>,
}

/// A reading against its prediction, both less nominal and without what the set-up explains.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct JudgedReading {
    /// Name of the file, and line.
    pub place: String,
    /// Component of its row: 0, 1 or 2.
    pub component: usize,
    /// `um` or `urad`.
    pub unit: &'static str,
    /// Predicted.
    pub predicted: f64,
    /// Measured.
    pub measured: f64,
    /// Expanded uncertainty of the predicted one (k = 2).
    pub predicted_u: f64,
    /// Expanded uncertainty of the measured one (k = 2), the set-up's in it.
    pub measured_u: f64,
    /// Difference over the root of the sum of both squared; none where the reading holds nothing but the set-up.
    pub e_n: Option<f64>,
}

/// A set judged by readings that were taken with it in force.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct SecondMeasurement {
    /// The verdict.
    pub verdict: SecondVerdict,
    /// The verdict in words.
    pub words: String,
    /// Share of |E_n| <= 1.
    pub within: f64,
    /// The share expected, k = 2.
    pub within_expected: f64,
    /// The least share that 995 of 1000 good campaigns reach: what readings share makes it small.
    pub within_least: f64,
    /// The amount of the whole correction that is seen; none if the set does nothing at these places.
    pub correction: Option<SeenCorrection>,
    /// The same for what each axis adds, together.
    pub correction_by_axis: Vec<SeenCorrection>,
    /// A machine that the readings agree with, if not with the one with the set.
    pub instead: Option<SetAlternative>,
    /// True if the machine file states how sure its errors are.
    pub has_predicted_uncertainty: bool,
    /// Contributions of both campaigns that count once, by name.
    pub counted_once: Vec<String>,
    /// By kind of reading.
    pub kinds: Vec<MeasuredKind>,
    /// Set-up and instruments of the second campaign.
    pub set_up: Vec<SetUpValue>,
    /// Every reading.
    pub readings: Vec<JudgedReading>,
}

/// The share of |E_n| <= 1 that is expected, k = 2.
pub(super) const WITHIN_EXPECTED: f64 = 0.9545;

impl SeenCorrection {
    pub(super) fn of(axis: Option<String>, amount: &Amount) -> Self {
        Self { axis, amount: amount.value, expanded_uncertainty: 2.0 * amount.sigma }
    }
}

/// A campaign with its judgement.
pub(super) struct JudgedCampaign<'a> {
    pub campaign: &'a Campaign<'a>,
    pub reduced: &'a Reduced,
    pub judged: &'a Judged,
    /// Contributions that count once, by name.
    pub counted_once: Vec<String>,
    pub sources: &'a Sources,
}

impl JudgedCampaign<'_> {
    /// Returns the kinds of its readings, each once.
    pub fn kinds(&self) -> Vec<ReadingKind> {
        let mut kinds: Vec<ReadingKind> = self.campaign.rows.iter().map(|m| m.kind()).collect();
        kinds.sort_unstable();
        kinds.dedup();
        kinds
    }

    /// Returns set-up and instruments, by the readings.
    pub fn set_up(&self) -> Vec<SetUpValue> {
        let unknowns = self.reduced.readings.unknowns.iter().enumerate();
        unknowns.map(|(j, of)| set_up(self.reduced, j, of)).collect()
    }

    /// Returns every reading against its prediction.
    pub fn readings(&self) -> Vec<JudgedReading> {
        (0..self.campaign.numbers.len()).map(|i| self.reading(i)).collect()
    }

    fn reading(&self, i: usize) -> JudgedReading {
        let Self { campaign, reduced, judged, sources, .. } = self;
        let (row, component) = campaign.numbers[i];
        let m = &campaign.rows[row];
        let (unit, factor) = m.kind().unit();
        let scale = factor * reduced.readings.sigma[i];
        let [measured_u, predicted_u] = reduced.uncertainties(i).map(|u| 2.0 * u * scale);
        let predicted = reduced.predicted[i] * scale;
        // A record is the same wherever it is made.
        let file = Path::new(sources.name(m.place.source));
        let file = file.file_name().map_or(file, Path::new);
        JudgedReading {
            place: format!("{}:{}", file.display(), sources.line_column(&m.place).0),
            component,
            unit,
            predicted,
            measured: predicted + reduced.residual()[i] * scale,
            predicted_u,
            measured_u,
            e_n: judged.e_n[i],
        }
    }
}

/// Returns the verdict on a set.
pub(super) fn of(of: JudgedCampaign<'_>) -> SecondMeasurement {
    let JudgedCampaign { campaign, reduced, judged, .. } = of;
    let allowed = |of: &Amount| of.allows(1.0);
    let is_within = judged.within >= judged.least
        && judged.amount.as_ref().is_none_or(allowed)
        && judged.by_axis.iter().all(|(_, amount)| allowed(amount));
    let verdict = match &judged.amount {
        _ if !is_within => SecondVerdict::NotWithin,
        Some(amount) if !amount.allows(0.0) => SecondVerdict::Within,
        _ => SecondVerdict::CannotTell,
    };
    let instead = judged.instead.map(|amount| match amount {
        0.5 => SetAlternative::Half,
        0.0 => SetAlternative::NotInForce,
        _ => SetAlternative::Reversed,
    });
    let kinds = of.kinds().into_iter().map(|kind| of_kind(campaign, reduced, judged, kind)).collect();
    let seen = SeenCorrection::of;
    let mut result = SecondMeasurement {
        verdict,
        words: String::new(),
        within: judged.within,
        within_expected: WITHIN_EXPECTED,
        within_least: judged.least,
        correction: judged.amount.as_ref().map(|amount| seen(None, amount)),
        correction_by_axis: judged.by_axis.iter().map(|(axis, of)| seen(Some(campaign.axis(*axis)), of)).collect(),
        instead,
        has_predicted_uncertainty: reduced.parts.left.ncols() > 0,
        kinds,
        set_up: of.set_up(),
        readings: of.readings(),
        counted_once: of.counted_once,
    };
    let off = judged.by_axis.iter().zip(&result.correction_by_axis).filter(|((_, amount), _)| !allowed(amount));
    result.words = words(&result, &off.map(|(_, seen)| seen).collect::<Vec<_>>());
    result
}

fn set_up(reduced: &Reduced, j: usize, of: &SetUpUnknown) -> SetUpValue {
    let (unit, factor) = of.unit;
    let value = (reduced.step[j] + reduced.readings.away[j]) * factor;
    SetUpValue { name: of.name.clone(), value, unit, known: of.known.map(|known| known * factor) }
}

/// Returns the figures of a kind. The mean square of a normal vector x with covariance C has the expectation
/// |x|^2 + tr C and the variance 4 x^T C x + 2 tr C^2.
fn of_kind(campaign: &Campaign<'_>, reduced: &Reduced, judged: &Judged, kind: ReadingKind) -> MeasuredKind {
    let is_of = |row: usize| campaign.rows[row].kind() == kind;
    let of: Vec<usize> = (0..campaign.numbers.len()).filter(|i| is_of(campaign.numbers[*i].0)).collect();
    let (unit, factor) = kind.unit();
    let scale = |i: usize| factor * reduced.readings.sigma[i];
    let places = (0..campaign.rows.len()).filter(|row| is_of(*row)).count();
    let rows = |from: &DMatrix<f64>| DMatrix::from_fn(of.len(), from.ncols(), |k, j| from[(of[k], j)] * scale(of[k]));
    let predicted = of.iter().map(|i| reduced.predicted[*i] * scale(*i));
    let predicted = nalgebra::DVector::from_iterator(of.len(), predicted);
    let residual = of.iter().map(|i| reduced.residual()[*i] * scale(*i));
    let measured = &predicted + nalgebra::DVector::from_iterator(of.len(), residual);
    let noise = of.iter().map(|i| reduced.own[*i] * scale(*i) * scale(*i));
    let noise = nalgebra::DVector::from_iterator(of.len(), noise);
    let (parts, shared) = (rows(&reduced.parts.left), rows(&reduced.shared.left));
    let interval = |squares: f64, variance: f64| {
        let reach = 2.0 * libm::sqrt(variance.max(0.0));
        let root = |squares: f64| libm::sqrt(squares.max(0.0) / places as f64);
        RmsInterval { rms: root(squares), interval: [root(squares - reach), root(squares + reach)] }
    };
    let among = parts.tr_mul(&parts).norm_squared();
    let through = parts.tr_mul(&predicted).norm_squared();
    let expected = predicted.norm_squared() + parts.norm_squared();
    let square = noise.norm_squared() + shared.tr_mul(&shared).norm_squared();
    let seen = noise.dot(&measured.component_mul(&measured)) + shared.tr_mul(&measured).norm_squared();
    let left = measured.norm_squared() - noise.sum() - shared.norm_squared();
    // The readings hold their own scatter: 4 x^T C x counts tr C^2 twice more.
    let variance = (4.0 * seen - 2.0 * square).max(2.0 * square);
    let scores: Vec<f64> = of.iter().filter_map(|i| judged.e_n[*i]).collect();
    let inside = scores.iter().filter(|e_n| e_n.abs() <= 1.0).count();
    MeasuredKind {
        kind: kind.word(),
        unit,
        places,
        within: inside as f64 / scores.len().max(1) as f64,
        predicted: interval(expected, 4.0 * through + 2.0 * among),
        measured: interval(left, variance),
    }
}

/// Returns the verdict in words; `off` are the axes whose correction is not what was predicted.
fn words(of: &SecondMeasurement, off: &[&SeenCorrection]) -> String {
    let one = |figure: &RmsInterval| {
        // Below a nanometre it is rounding.
        let figures = [figure.rms, figure.interval[0], figure.interval[1]];
        let [rms, low, high] = figures.map(|x| significant(if x < 1e-3 { 0.0 } else { x }, 2));
        format!("{rms} ({low} to {high})")
    };
    let kind = |of: &MeasuredKind| {
        format!("{} predicted {}, measured {} {}", of.kind, one(&of.predicted), one(&of.measured), of.unit)
    };
    let kinds: Vec<String> = of.kinds.iter().map(kind).collect();
    let verdict = match (of.verdict, of.instead) {
        (SecondVerdict::Within, _) => "within".to_owned(),
        (SecondVerdict::NotWithin, None) if off.is_empty() => "NOT within".to_owned(),
        (SecondVerdict::NotWithin, None) => {
            let axis = |of: &&SeenCorrection| {
                format!("{:.2} of that of {}", of.amount, of.axis.as_deref().unwrap_or_default())
            };
            let axes: Vec<String> = off.iter().map(axis).collect();
            format!("NOT within; of the correction they see {}", axes.join(", "))
        }
        (SecondVerdict::NotWithin, Some(instead)) => format!("NOT within; {}", instead.words()),
        (SecondVerdict::CannotTell, _) => {
            "the measurement cannot tell: the machine without the set would pass as well".to_owned()
        }
    };
    format!("{}: {verdict}", kinds.join("; "))
}
