//! The verdict on a machine file by readings of the machine, without a fit: as a value and in words.

use super::campaign::Campaign;
use super::result::{JudgedCampaign, JudgedReading, SeenCorrection, SetUpValue, WITHIN_EXPECTED};
use crate::identify::data::ReadingKind;
use crate::machine::Machine;
use crate::units::significant;
use serde::Serialize;

/// The verdict on a machine file by readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ModelVerdict {
    /// The readings are what the file predicts, and would not be without its errors.
    Within,
    /// They are not.
    NotWithin,
    /// They are, and would be without its errors, too.
    CannotTell,
}

/// A machine that the readings agree with in place of that of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ModelAlternative {
    /// Without errors.
    Nominal,
    /// With every error reversed.
    Reversed,
    /// With half of every error.
    Half,
}

impl ModelAlternative {
    fn words(self) -> &'static str {
        match self {
            Self::Nominal => "they are those of a machine without errors",
            Self::Reversed => "they are those of the machine with every sign reversed",
            Self::Half => "they are those of the machine with half of every error",
        }
    }
}

/// Readings of one kind against their prediction, without what the set-up explains; root mean squares over the places,
/// all components together.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct PredictedKind {
    /// `deviations`, `lengths` ...
    pub kind: &'static str,
    /// `um` or `urad`.
    pub unit: &'static str,
    /// Number of rows.
    pub places: usize,
    /// Share of |E_n| <= 1.
    pub within: f64,
    /// RMS of the readings.
    pub measured: f64,
    /// RMS of the prediction.
    pub predicted: f64,
    /// RMS of measured less predicted.
    pub left: f64,
}

/// Readings of a machine against the prediction of its file, without a fit.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct PredictedReadings {
    /// Name of the machine.
    pub machine: String,
    /// The verdict.
    pub verdict: ModelVerdict,
    /// The verdict in words.
    pub words: String,
    /// Share of |E_n| <= 1.
    pub within: f64,
    /// The share expected, k = 2.
    pub within_expected: f64,
    /// The least share that 995 of 1000 good campaigns reach: what readings share makes it small.
    pub within_least: f64,
    /// The amount of the errors of the file that is seen; none if they do nothing at these places.
    pub errors_seen: Option<SeenCorrection>,
    /// A machine that the readings agree with, if not with that of the file.
    pub instead: Option<ModelAlternative>,
    /// True if the machine file states how sure its errors are.
    pub has_predicted_uncertainty: bool,
    /// Contributions of the errors and of the readings that count once, by name.
    pub counted_once: Vec<String>,
    /// By kind of reading.
    pub kinds: Vec<PredictedKind>,
    /// Set-up and instruments, by the readings.
    pub set_up: Vec<SetUpValue>,
    /// Every reading.
    pub readings: Vec<JudgedReading>,
}

/// Returns the verdict on a machine by a campaign without a set.
pub(super) fn of(machine: &Machine, of: JudgedCampaign<'_>) -> PredictedReadings {
    let JudgedCampaign { campaign, reduced, judged, .. } = of;
    let is_within = judged.within >= judged.least && judged.amount.as_ref().is_none_or(|amount| amount.allows(1.0));
    let verdict = match &judged.amount {
        _ if !is_within => ModelVerdict::NotWithin,
        Some(amount) if !amount.allows(0.0) => ModelVerdict::Within,
        _ => ModelVerdict::CannotTell,
    };
    let instead = judged.instead.map(|amount| match amount {
        0.5 => ModelAlternative::Half,
        0.0 => ModelAlternative::Nominal,
        _ => ModelAlternative::Reversed,
    });
    let readings = of.readings();
    let kinds: Vec<PredictedKind> = of.kinds().into_iter().map(|kind| of_kind(campaign, &readings, kind)).collect();
    PredictedReadings {
        machine: machine.name().to_owned(),
        words: words(&kinds, verdict, instead),
        verdict,
        within: judged.within,
        within_expected: WITHIN_EXPECTED,
        within_least: judged.least,
        errors_seen: judged.amount.as_ref().map(|amount| SeenCorrection::of(None, amount)),
        instead,
        has_predicted_uncertainty: reduced.parts.left.ncols() > 0,
        kinds,
        set_up: of.set_up(),
        readings,
        counted_once: of.counted_once,
    }
}

fn of_kind(campaign: &Campaign<'_>, readings: &[JudgedReading], kind: ReadingKind) -> PredictedKind {
    let is_of = |row: usize| campaign.rows[row].kind() == kind;
    let of = || readings.iter().zip(&campaign.numbers).filter(|(_, (row, _))| is_of(*row)).map(|(reading, _)| reading);
    let places = (0..campaign.rows.len()).filter(|row| is_of(*row)).count();
    let rms = |value: fn(&JudgedReading) -> f64| {
        libm::sqrt(of().map(|reading| value(reading) * value(reading)).sum::<f64>() / places.max(1) as f64)
    };
    let scores = || of().filter_map(|reading| reading.e_n);
    let within = scores().filter(|e_n| e_n.abs() <= 1.0).count() as f64 / scores().count().max(1) as f64;
    PredictedKind {
        kind: kind.word(),
        unit: kind.unit().0,
        places,
        within,
        measured: rms(|of| of.measured),
        predicted: rms(|of| of.predicted),
        left: rms(|of| of.measured - of.predicted),
    }
}

fn words(kinds: &[PredictedKind], verdict: ModelVerdict, instead: Option<ModelAlternative>) -> String {
    let kind = |of: &PredictedKind| {
        let [measured, left] = [of.measured, of.left].map(|rms| significant(rms, 3));
        format!("{} {measured} {unit}, of which {left} {unit} are left", of.kind, unit = of.unit)
    };
    let kinds: Vec<String> = kinds.iter().map(kind).collect();
    let verdict = match (verdict, instead) {
        (ModelVerdict::Within, _) => "within both uncertainties".to_owned(),
        (ModelVerdict::NotWithin, None) => "NOT within both uncertainties".to_owned(),
        (ModelVerdict::NotWithin, Some(instead)) => format!("NOT within both uncertainties; {}", instead.words()),
        (ModelVerdict::CannotTell, _) => "the readings cannot tell the file from a machine without errors".to_owned(),
    };
    format!("{}: {verdict}", kinds.join("; "))
}
