//! Machines of a budget that are drawn in parts, on other computers if need be, and put together.

use super::study::why;
use crate::analysis::budget::{Bound, DrawnSamples, Request, SAMPLE_LANES, draw_samples};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::run::{Call, Refused, sha256};
use crate::syntax::ReadFailure;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Part of the machines that a budget draws. Serialises as a state file holds it, docs/formats/designs.md.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BudgetShard {
    /// Version of the form.
    pub abbe_budget: String,
    /// SHA-256 of the machine and the options: parts with another one do not belong to the budget.
    pub fingerprint: String,
    /// Number of machines of the whole.
    pub samples: usize,
    /// Index of the first machine of this part.
    pub first: usize,
    /// The machines of this part, mm and rad.
    pub drawn: DrawnSamples,
    /// SHA-256 of the rest.
    sha256: String,
}

impl BudgetShard {
    fn new(fingerprint: String, samples: usize, first: usize, drawn: DrawnSamples) -> Self {
        let part = Self { abbe_budget: FORM.to_owned(), fingerprint, samples, first, drawn, sha256: String::new() };
        Self { sha256: part.checksum(), ..part }
    }

    fn checksum(&self) -> String {
        let Self { fingerprint, samples, first, drawn, .. } = self;
        sha256(serde_json::json!([fingerprint, samples, first, drawn]).to_string().as_bytes())
    }

    /// Returns the number of machines of this part.
    pub fn count(&self) -> usize {
        self.drawn.position.len()
    }

    /// Returns the part as the text of its state file; numbers are read back to the last bit.
    pub fn to_text(&self) -> String {
        serde_json::json!(self).to_string() + "\n"
    }
}

/// A budget whose machines are drawn in parts.
#[derive(Clone, Copy)]
pub(crate) struct Division<'a> {
    /// Part I of N; all by default.
    pub shard: Option<(usize, usize)>,
    /// Files of parts.
    pub merge: &'a [PathBuf],
    /// What the draws depend on besides the machine, the bounds and the poses.
    pub drawn_by: &'a dyn std::fmt::Debug,
}

const FORM: &str = "2";

/// Size of the largest file of a part: those of more machines take more parts.
const MAX_BYTES: u64 = 256 << 20;

/// Draws the part that the options ask for, unless a file to merge holds it.
pub(crate) fn draw_part(
    call: &mut Call<'_>,
    division: Division<'_>,
    request: Request<'_>,
) -> Result<BudgetShard, Refused> {
    let (part, parts) = division.shard.unwrap_or((1, 1));
    if !(1..=parts).contains(&part) {
        return call.usage("part I of N is 1 to N");
    }
    let samples = request.samples;
    let range = range(samples, part, parts);
    let first = range.start;
    let fingerprint = fingerprint(division, request);
    let expected = ExpectedPart { fingerprint: &fingerprint, samples, bounds: request.bounds.len() };
    match load_kept(call, division, expected, &range) {
        Ok(Some(part)) => return Ok(part),
        Ok(None) => {}
        Err(refusal) => return call.refuse(refusal),
    }
    let drawn = call.stage("machines drawn", 2 * range.len(), |advance| draw_samples(request, range, advance))?;
    Ok(BudgetShard::new(fingerprint, samples, first, drawn))
}

/// Returns the part that a file holds already, if there is such a file.
fn load_kept(
    call: &Call<'_>,
    division: Division<'_>,
    expected: ExpectedPart<'_>,
    range: &Range<usize>,
) -> Result<Option<BudgetShard>, Diagnostic> {
    for path in division.merge {
        if matches!(call.run.files.read_at_most(path, MAX_BYTES), Err(ReadFailure::NotFound)) {
            continue;
        }
        let part = read(call, path, expected)?;
        if (part.first, part.count()) == (range.start, range.len()) {
            return Ok(Some(part));
        }
        let end = part.first + part.count();
        let message = format!("`{}` holds the machines {} to {end} of this budget", path.display(), part.first + 1);
        let help = "name another file for this part: this one is unchanged";
        return Err(Diagnostic::new(codes::E0610, message).help(help));
    }
    Ok(None)
}

/// The machines of a part: whole chunks of those that are computed side by side.
fn range(samples: usize, part: usize, parts: usize) -> Range<usize> {
    let chunks = samples.div_ceil(SAMPLE_LANES) as u128;
    let end = |part: usize| {
        let chunk = chunks * part as u128 / parts as u128;
        usize::try_from(chunk).unwrap_or(usize::MAX).saturating_mul(SAMPLE_LANES).min(samples)
    };
    end(part - 1)..end(part)
}

/// Everything that drawn machines depend on.
fn fingerprint(division: Division<'_>, request: Request<'_>) -> String {
    let Request { machine, bounds, poses, reference, .. } = request;
    let (drawn, bounds) = (division.drawn_by, bounds.iter().map(Bound::canonical).collect::<String>());
    let taken_out = reference.map_or_else(String::new, |reference| format!("{reference:?}"));
    let (version, machine) = (env!("CARGO_PKG_VERSION"), machine.canonical());
    sha256(format!("{version}\n{machine}{bounds}{poses:?}\n{drawn:?}{taken_out}").as_bytes())
}

/// Returns the machines of the files to merge; none without files.
pub(crate) fn merge(
    call: &mut Call<'_>,
    division: Division<'_>,
    request: Request<'_>,
) -> Result<Option<DrawnSamples>, Refused> {
    if division.merge.is_empty() {
        return Ok(None);
    }
    together(call, division, request).map(Some).or_else(|refusal| call.refuse(refusal))
}

fn together(call: &Call<'_>, division: Division<'_>, request: Request<'_>) -> Result<DrawnSamples, Diagnostic> {
    let fingerprint = fingerprint(division, request);
    let expected = ExpectedPart { fingerprint: &fingerprint, samples: request.samples, bounds: request.bounds.len() };
    let mut parts = BTreeMap::new();
    for path in division.merge {
        let part = read(call, path, expected)?;
        if part.count() > 0 && parts.get(&part.first).is_some_and(|known| *known != part.drawn) {
            let message = format!("`{}` has other machines than a part before it", path.display());
            let help = "one of them was changed or made by another build: compute the parts again";
            return Err(Diagnostic::new(codes::E0611, message).help(help));
        }
        if part.count() > 0 {
            let _ = parts.insert(part.first, part.drawn);
        }
    }
    let mut whole = DrawnSamples::default();
    for (first, part) in parts {
        if first != whole.position.len() {
            return Err(incomplete(first.min(whole.position.len()), request.samples));
        }
        whole.position.extend(part.position);
        whole.rotation.extend(part.rotation);
    }
    if whole.position.len() == request.samples {
        Ok(whole)
    } else {
        Err(incomplete(whole.position.len(), request.samples))
    }
}

fn incomplete(count: usize, samples: usize) -> Diagnostic {
    let message = format!("the parts do not hold the {samples} machines of the budget: they are whole up to {count}");
    Diagnostic::new(codes::E0611, message).help("name all parts of one division, each `I/N` of the same N")
}

/// The settings that the parts of a budget have in common.
#[derive(Clone, Copy)]
struct ExpectedPart<'a> {
    fingerprint: &'a str,
    /// Number of machines of the whole.
    samples: usize,
    /// Number of bounds.
    bounds: usize,
}

/// Returns the part in a file, if it is of this budget.
fn read(call: &Call<'_>, path: &Path, expected: ExpectedPart<'_>) -> Result<BudgetShard, Diagnostic> {
    let ExpectedPart { fingerprint, samples, bounds } = expected;
    let name = path.display();
    let foreign = |message: String| {
        Diagnostic::new(codes::E0610, message).help("name another file, or remove this one; it is unchanged")
    };
    let bytes = call
        .run
        .files
        .read_at_most(path, MAX_BYTES)
        .map_err(|failure| foreign(format!("`{name}`: {}", why(&failure))))?;
    let part: BudgetShard = serde_json::from_slice(&bytes)
        .map_err(|failure| foreign(format!("`{name}` is not a state file: {}", shown(&failure.to_string()))))?;
    if part.abbe_budget != FORM || part.fingerprint != fingerprint {
        let message =
            format!("`{name}` belongs to another budget: the machine file, an option or the program has changed");
        return Err(foreign(message));
    }
    if part.sha256 != part.checksum() {
        return Err(foreign(format!("`{name}` was altered: its checksum is of other machines")));
    }
    if part.samples != samples || part.first.checked_add(part.count()).is_none_or(|end| end > samples) {
        return Err(foreign(format!(
            "`{name}` is not a state file: it has other machines than the {samples} of the budget"
        )));
    }
    let values = part.drawn.position.iter().chain(&part.drawn.rotation).map(|sample| sample.value);
    if values.into_iter().any(|value| !value.is_finite() || value < 0.0) {
        return Err(foreign(format!("`{name}` is not a state file: an error of a drawn machine is below zero")));
    }
    let all = || part.drawn.position.iter().chain(&part.drawn.rotation);
    if part.drawn.rotation.len() != part.count() || all().any(|sample| sample.parts.len() != bounds) {
        return Err(foreign(format!("`{name}` is not a state file: machines do not have {bounds} parts each")));
    }
    Ok(part)
}
