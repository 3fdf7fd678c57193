//! Suspicions against the readings of a file.
//!
//! `rows`: numbers that other programs group or write as degrees, minutes and seconds, rows there twice, rows lost,
//! columns exchanged. `repeats`: the passes of an error, and what a reading is off its repeats; `runs`: single
//! readings, trends, and runs of another unit, sign or direction. `plausible`: what no axis has. `finding`: results.
//!
//! Limits stand in [`thresholds`](crate::identify::thresholds), with their reasons.

mod finding;
mod plausible;
mod repeats;
pub(super) mod rows;
mod runs;

pub use finding::{Finding, FindingEffect, FindingKind};

use super::sample::{AxisSample, Import};
use repeats::Repeats;
use runs::Runs;

/// True if a finding refuses an error, or the file as a whole: what else is found would follow from that.
fn is_refused(import: &Import, error: Option<usize>) -> bool {
    import.findings.iter().any(|finding| finding.error == error && finding.effect == FindingEffect::Refused)
}

/// Judges the repeats of every error, and leaves out single readings far off unless the caller accepts them.
pub(super) fn judge_repeats(import: &mut Import, accepted: bool) {
    if is_refused(import, None) {
        return;
    }
    let mut dropped: Vec<usize> = Vec::new();
    let mut findings = Vec::new();
    for error in 0..import.errors.len() {
        let runs = Runs::of(import, error);
        let wrong = runs.wrong_runs();
        if !wrong.is_empty() {
            findings.extend(wrong);
            continue;
        }
        let (outliers, deviations) = runs.outliers();
        findings.extend(runs.drift(&deviations));
        for (sample, finding) in outliers {
            if finding.effect == FindingEffect::LeftOut && !accepted {
                dropped.push(sample);
            }
            findings.push(finding);
        }
    }
    import.findings.extend(findings);
    dropped.sort_unstable();
    let mut k = 0;
    import.samples.retain(|_: &AxisSample| {
        k += 1;
        dropped.binary_search(&(k - 1)).is_err()
    });
}

/// Judges every error as a whole, the lines of straightness errors taken off.
pub(super) fn judge_axes(import: &mut Import) {
    let mut findings = Vec::new();
    for error in 0..import.errors.len() {
        if is_refused(import, None) || is_refused(import, Some(error)) {
            continue;
        }
        let repeats = Repeats::of(&import.samples, error);
        let sigma = repeats.deviations(&vec![true; repeats.readings.len()]).measured;
        findings.extend(plausible::judge(import, error, &repeats, sigma));
    }
    import.findings.extend(findings);
}

/// Says of every finding that refuses or leaves out that the caller accepts it.
pub(super) fn accept(import: &mut Import) {
    import.findings.iter_mut().filter(|of| of.effect != FindingEffect::Used).for_each(|of| {
        of.effect = FindingEffect::Accepted;
    });
}
