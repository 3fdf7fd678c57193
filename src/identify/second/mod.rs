//! The second measurement: readings of the machine with its set in force, against what the certificate promises there;
//! and readings of the machine as it is, against its file.
//!
//! 1. `campaign`: the readings that the machine with its set should give, and what moves them: the set, the parts of
//!    the uncertainty of the errors, the set-up and the instruments of the second campaign, its type B.
//! 2. `judge`: measured less predicted without what the set-up explains, with the uncertainty of both by the same
//!    projection; E_n, the amount of the correction that is seen, the verdict.
//! 3. `result`: the verdict as a value and in words; `model`: that on a machine file without a set.

mod campaign;
mod judge;
mod model;
mod result;

pub(crate) use campaign::Additions;
pub use model::{ModelAlternative, ModelVerdict, PredictedKind, PredictedReadings};
pub use result::{
    JudgedReading, MeasuredKind, RmsInterval, SecondMeasurement, SecondVerdict, SeenCorrection, SetAlternative,
    SetUpValue,
};

use super::data::{Measurement, MeasurementSet, ReadingContext, ReadingKind, repeats};
use super::model::{TypeB, type_b};
use super::thresholds::MAX_SECOND_READINGS;
use super::verdict::problem::measurements;
use crate::job::machine_file::MachineFile;
use crate::run::{Call, Refused};
use crate::standards::Coverage;
use campaign::Campaign;
use result::JudgedCampaign;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The readings of a second campaign, taken with the set in force, from any face of the program.
pub(crate) struct SecondInputs<'a> {
    /// Files of measurements.
    pub paths: &'a [PathBuf],
    /// Texts by the names of such files.
    pub texts: &'a [(String, String)],
    pub context: ReadingContext,
    /// Standard uncertainties that all readings share, in words; one that the machine file names too counts once.
    pub type_b: &'a [String],
    /// Standard deviation (mm) of readings that do not state theirs.
    pub noise_mm: Option<f64>,
    /// Seed of the draws behind the share that chance explains.
    pub seed: u64,
}

/// Judges a set by readings of the machine that was driven with it; `added` are the motions that the set adds.
///
/// Fails if the readings cannot be read, and if nothing says how sure they are.
pub(crate) fn second_measurement(
    call: &mut Call,
    file: &MachineFile,
    inputs: &SecondInputs<'_>,
    added: Additions<'_>,
) -> Result<SecondMeasurement, Refused> {
    judged(call, file, inputs, Some(added), result::of)
}

/// Judges a machine file by readings of the machine as it is; nothing but the set-up is fitted.
///
/// Fails if the readings cannot be read, and if nothing says how sure they are.
pub(crate) fn predicted_readings(
    call: &mut Call,
    file: &MachineFile,
    inputs: &SecondInputs<'_>,
) -> Result<PredictedReadings, Refused> {
    judged(call, file, inputs, None, |of| model::of(file, of))
}

/// Judges a campaign, and returns what `result` makes of it.
fn judged<T>(
    call: &mut Call,
    file: &MachineFile,
    inputs: &SecondInputs<'_>,
    added: Option<Additions<'_>>,
    result: impl FnOnce(JudgedCampaign<'_>) -> T,
) -> Result<T, Refused> {
    let (data, own, counted_once) = readings(call, file, inputs)?;
    let campaign = Campaign::new(file, &data, added);
    let reduced = campaign.reduce(file, &data, &own);
    let judged = judge::judge(&reduced, inputs.seed);
    let sources = &call.diagnostics.sources;
    let of = JudgedCampaign { campaign: &campaign, reduced: &reduced, judged: &judged, counted_once, sources };
    let result = result(of);
    call.go_on()?;
    Ok(result)
}

/// Reads a campaign: its readings, each with how sure it is, its own type B, and the names of what counts once.
fn readings(
    call: &mut Call,
    file: &MachineFile,
    inputs: &SecondInputs<'_>,
) -> Result<(MeasurementSet, Vec<TypeB>, Vec<String>), Refused> {
    let (mut data, _) = measurements(call, file, inputs.paths, inputs.texts, &inputs.context)?;
    let count: usize = data.rows.iter().map(Measurement::readings).sum();
    if count > MAX_SECOND_READINGS {
        return call.usage(format!("a judgement takes {MAX_SECOND_READINGS} readings at most, not {count}"));
    }
    let (own, once) = uncertainties(call, file, inputs.type_b)?;
    if let Err(kind) = state_noise(&mut data, inputs.noise_mm) {
        return call.usage(format!(
            "nothing says how sure the readings are ({}): give a column `u [um]` (of angles `u [urad]`), or `--noise`",
            kind.word()
        ));
    }
    Ok((data, own, once))
}

/// Returns the type B of the second campaign that the machine file does not have, and the names of what it has.
fn uncertainties(call: &mut Call, file: &MachineFile, words: &[String]) -> Result<(Vec<TypeB>, Vec<String>), Refused> {
    let all: Result<Vec<TypeB>, _> = words.iter().map(|words| type_b(words)).collect();
    let all = all.or_else(|refusal| call.refuse(*refusal))?;
    let request = file.identify.iter().flat_map(|request| &request.type_b);
    let first: Vec<TypeB> = request.filter_map(|words| type_b(words).ok()).collect();
    let (common, own): (Vec<TypeB>, Vec<TypeB>) =
        all.into_iter().partition(|of| first.iter().any(|known| known.name == of.name));
    Ok((own, common.into_iter().map(|of| of.name).collect()))
}

/// Gives every reading without an uncertainty of its own the stated one, or that of repeated readings of its kind.
/// Fails with a kind of which neither is known.
fn state_noise(data: &mut MeasurementSet, noise_mm: Option<f64>) -> Result<(), ReadingKind> {
    let scatter = scatter(&data.rows);
    for m in data.rows.iter_mut().filter(|m| !m.has_uncertainty) {
        let kind = m.kind();
        let scatter = scatter.get(&kind).copied().filter(|sigma| *sigma > 0.0);
        let stated = noise_mm.filter(|_| !kind.is_angle());
        let sigma = stated.or(scatter).ok_or(kind)?;
        (m.weight, m.has_uncertainty) = (m.weight / (sigma * sigma * 1e6), true);
    }
    Ok(())
}

/// Returns the standard deviation (mm) of repeated readings by kind. Files are set-ups of their own: a pose repeats
/// within its file only.
fn scatter(rows: &[Measurement]) -> BTreeMap<ReadingKind, f64> {
    let mut sums: BTreeMap<ReadingKind, (f64, usize)> = BTreeMap::new();
    for file in rows.chunk_by(|a, b| a.place.source == b.place.source) {
        for of in repeats(file) {
            let (squares, freedom) = sums.entry(of.of).or_default();
            *squares += of.sigma * of.sigma * of.degrees_of_freedom as f64;
            *freedom += of.degrees_of_freedom;
        }
    }
    let mut student = Coverage::default();
    // Few repeats say little of their scatter.
    let sigma = |(kind, (squares, freedom)): (ReadingKind, (f64, usize))| {
        let freedom = freedom as f64;
        (kind, libm::sqrt(squares / freedom) * 0.5 * student.reach(freedom))
    };
    sums.into_iter().map(sigma).collect()
}
