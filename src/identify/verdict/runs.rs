//! Runs that were written down in another way than they were read.
//!
//! - [`turned`]: of two runs over the same places, such as those of a square and of the square turned over, one reads
//!   the opposite of the other or its double: in a handful of readings no likelihood tells it, but the eye does;
//! - [`relative`]: every run begins with zeros, as readings less the first do, in columns of whole deviations;
//! - [`alone`]: a run has one relative reading, which its set-up takes whole;
//! - [`cut_off`]: the last run of a file ends before the places of the others are through;
//! - [`copied`]: poses that were measured again read the same to the last digit.

use super::fitted::FitDiagnosis;
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::identify::thresholds::{
    MIN_COPIED_SCATTER_MM, MIN_SUSPECT_FREEDOM, MIN_TURNED_CORRELATION, MIN_TURNED_ROWS, TURNED_SLOPES,
};
use crate::identify::{COMPONENTS, Measurement, Reading, Repeats};
use crate::units::counted;
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

/// Asks about runs with a single relative reading of a component.
pub(crate) fn alone(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let is_relative = |m: &&&Measurement, k: usize| match &m.reading {
        Reading::Deviation { zero, .. } => zero[k].is_some() && m.reading_mask()[k],
        _ => false,
    };
    let runs = by_name(fitted);
    let one = |(name, rows): (&&str, &Vec<&Measurement>)| {
        let k = (0..3).find(|k| rows.iter().filter(|m| is_relative(m, *k)).count() == 1)?;
        let of = if name.is_empty() { String::new() } else { format!(" of run `{}`", shown(name)) };
        Some(format!("a single rel.{}{of}", COMPONENTS[k]))
    };
    let found = runs.iter().find_map(one)?;
    let help = "relative readings count from the first of their run, so that one says nothing: was the file cut off?";
    Some(Diagnostic::new(codes::W0520, format!("{found} is left of its run")).help(help))
}

/// Asks about the last run, if it has only the first places of the others, which all have the same.
pub(crate) fn cut_off(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let name = |m: &Measurement| m.run.clone().unwrap_or_default();
    let mut runs: Vec<(String, Vec<&Measurement>)> = Vec::new();
    for m in fitted.data {
        match runs.last_mut() {
            Some((last, rows)) if *last == name(m) => rows.push(m),
            _ => runs.push((name(m), vec![m])),
        }
    }
    let (last, others) = runs.split_last()?;
    let whole = &others.first()?.1;
    let alike = |of: &[&Measurement], by: &[&Measurement]| {
        of.iter().zip(by).all(|(a, b)| {
            a.pose == b.pose && a.tool == b.tool && a.kind() == b.kind() && a.reading_mask() == b.reading_mask()
        })
    };
    let same = others.iter().all(|(_, rows)| rows.len() == whole.len() && alike(rows, whole));
    let count = last.1.len();
    if !same || count >= whole.len() || whole.len() < MIN_TURNED_ROWS || !alike(&last.1, &whole[..count]) {
        return None;
    }
    let (name, all) = (shown(&last.0), whole.len());
    let first = shown(&others[0].0);
    let message = format!("run `{name}`, the last, ends after {count} of the {all} places of run `{first}`");
    let help = "was the file cut off? Otherwise measure the places that it lacks";
    Some(Diagnostic::new(codes::W0520, message).help(help))
}

/// Asks about poses that were measured again without any scatter, where the readings scatter otherwise.
pub(crate) fn copied(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let is_copy = |of: &&Repeats| {
        of.sigma == 0.0 && of.degrees_of_freedom >= MIN_TURNED_ROWS && fitted.solution.sigma > MIN_COPIED_SCATTER_MM
    };
    let found = fitted.repeats.iter().find(is_copy)?;
    let message = format!(
        "{} of poses measured before are the same to the last digit: are rows there twice?",
        counted(found.degrees_of_freedom, "reading")
    );
    let help = "rows that were copied make uncertainties too small: leave one of each out";
    Some(Diagnostic::new(codes::W0520, message).help(help))
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
