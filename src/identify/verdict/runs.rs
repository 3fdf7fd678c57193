//! Runs that were written down in another way than they were read.
//!
//! - [`turned`]: of two runs over the same places, such as those of a square and of the square turned over, one reads
//!   the opposite of the other or its double: in a handful of readings no likelihood tells it, but the eye does;
//! - [`relative`]: every run begins with zeros, as readings less the first do, in columns of whole deviations.

use super::fitted::FitDiagnosis;
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::identify::thresholds::{MIN_SUSPECT_FREEDOM, MIN_TURNED_CORRELATION, MIN_TURNED_ROWS, TURNED_SLOPES};
use crate::identify::{COMPONENTS, Measurement, Reading};
use std::collections::BTreeMap;

const OPPOSITE: &str = "a square that is turned over changes the sign of its readings: was it written down so? If it \
                        was, the square is out by more than the machine";
const TWICE: &str = "is one of them a full indicator reading, or in another unit? If both are right, a square is out \
                     by a quarter of what the machine is, or more";

/// Asks about the first pair of runs of which one is the other with another sign, or doubled.
pub(crate) fn turned(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    if fitted.solution.degrees_of_freedom as f64 >= MIN_SUSPECT_FREEDOM {
        return None;
    }
    let runs = by_name(fitted);
    let names: Vec<&str> = runs.keys().copied().collect();
    let pairs =
        names.iter().enumerate().flat_map(|(i, first)| names[i + 1..].iter().map(move |second| (*first, *second)));
    let found = pairs.flat_map(|(first, second)| (0..3).map(move |k| (first, second, k)));
    found.into_iter().find_map(|(first, second, k)| {
        let slope = slope(&runs[first], &runs[second], k)?;
        let [opposite, twice] = TURNED_SLOPES;
        let (what, help) = match slope {
            slope if opposite.contains(&slope) => ("the opposite of", OPPOSITE),
            slope if twice.contains(&slope) => ("about twice", TWICE),
            slope if twice.contains(&(1.0 / slope)) => ("about half", TWICE),
            _ => return None,
        };
        let (component, first, second) = (COMPONENTS[k], shown(first), shown(second));
        let message = format!("{component} of run `{second}` is {what} that of run `{first}`, place by place");
        Some(Diagnostic::new(codes::W0520, message).help(help))
    })
}

/// Returns the rows of each run, in the order of the data; those without a name are one run.
fn by_name<'a>(fitted: &'a FitDiagnosis<'_>) -> BTreeMap<&'a str, Vec<&'a Measurement>> {
    let mut runs: BTreeMap<&str, Vec<&Measurement>> = BTreeMap::new();
    for m in fitted.data {
        runs.entry(m.run.as_deref().unwrap_or_default()).or_default().push(m);
    }
    runs
}

/// Asks about whole deviations that all runs begin with zeros.
pub(crate) fn relative(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let is_whole = |m: &&&Measurement| matches!(m.reading, Reading::Deviation { zero: [None, None, None], .. });
    let runs = by_name(fitted);
    let mut zeros = 0;
    for rows in runs.values() {
        let whole: Vec<&&Measurement> = rows.iter().filter(is_whole).collect();
        let (first, rest) = whole.split_first()?;
        let read = first.reading_mask();
        let begins = (0..3).filter(|k| read[*k]).all(|k| first.values()[k] == 0.0);
        let goes_on = rest.iter().filter(|m| m.values() != nalgebra::Vector3::zeros()).count();
        if !begins || goes_on + 1 < MIN_TURNED_ROWS {
            return None;
        }
        zeros += read.iter().filter(|read| **read).count();
    }
    let message = format!(
        "{} with zeros: are the readings less the first of their run?",
        if runs.len() == 1 { "the readings begin" } else { "every run begins" }
    );
    let help = "such readings are `rel.dx [um]`; `dx [um]` is actual minus nominal of every reading by itself";
    // A single zero is a rounded reading.
    (zeros > 1).then(|| Diagnostic::new(codes::W0520, message).help(help))
}

/// Returns how much a component of one run rises where that of another rises by one; `None` unless both were read at
/// the same places and go with each other.
fn slope(first: &[&Measurement], second: &[&Measurement], k: usize) -> Option<f64> {
    let is_read = |m: &&&Measurement| m.reading_mask()[k] && !m.kind().is_angle();
    let same = |a: &Measurement, b: &Measurement| a.tool == b.tool && a.pose == b.pose;
    let pair =
        |a: &&Measurement| Some((a.values()[k], second.iter().filter(is_read).find(|b| same(a, b))?.values()[k]));
    let both: Vec<(f64, f64)> = first.iter().filter(is_read).filter_map(pair).collect();
    if both.len() < MIN_TURNED_ROWS || both.len() < first.len() || both.len() < second.len() {
        return None;
    }
    let count = both.len() as f64;
    let mean = both.iter().fold((0.0, 0.0), |sum, (a, b)| (sum.0 + a / count, sum.1 + b / count));
    let sums = both
        .iter()
        .map(|(a, b)| (a - mean.0, b - mean.1))
        .fold([0.0; 3], |sums, (a, b)| [sums[0] + a * a, sums[1] + a * b, sums[2] + b * b]);
    let correlation = sums[1] / libm::sqrt(sums[0] * sums[2]);
    (correlation.abs() >= MIN_TURNED_CORRELATION).then(|| sums[1] / sums[0])
}
