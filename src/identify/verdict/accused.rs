//! Readings that accuse themselves: residuals by what shops mix up, and changes of the data that explain them.

use super::fitted::FitDiagnosis;
use super::inputs::FitAcceptance;
use crate::diagnostic::{Diagnostic, Sources, codes};
use crate::identify::thresholds::{MAX_NOISE_PROBABILITY, MIN_GROUP_RATIO, MIN_GROUP_READINGS};
use crate::identify::{AND, COMPONENTS, Change, ChangeNames, Scope, both_tails, groups};
use crate::units::significant;
use nalgebra::Vector3;
use serde::Serialize;

/// A change of the data that explains what the fit leaves.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct SuspectReadings {
    /// The changes in words, such as `dx and dy exchanged`; one or two.
    pub changes: Vec<String>,
    /// Other changes that explain as much, in words: the readings do not tell which it is.
    pub others: Vec<String>,
    /// Root mean square of what is left with them, um.
    pub left_um: f64,
    /// What is left without, um.
    pub instead_um: f64,
    /// The remedies, one for each change.
    pub remedies: Vec<&'static str>,
    /// True if the caller takes the readings as they are.
    pub accepted: bool,
}

/// What is left of some of the readings.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ResidualGroup {
    /// `component`, `axis` (a third of what was measured of it), `tool`, `run` or `station`.
    pub by: &'static str,
    /// Name, such as `dz`, `X from 0 to 150`, `run 3`.
    pub of: String,
    /// Number of readings.
    pub readings: usize,
    /// Root mean square of what is left of a reading, um.
    pub rms_um: f64,
    /// True if that is far more than what is left of all.
    pub stands_out: bool,
}

fn instrument_name(fitted: &FitDiagnosis<'_>, index: usize) -> String {
    fitted.unknowns.get(fitted.own + index).map_or_else(String::new, |unknown| unknown.name.clone())
}

/// Returns the suspicion in words.
pub(crate) fn suspect(
    fitted: &FitDiagnosis<'_>,
    sources: &Sources,
    accept: &[FitAcceptance],
) -> Option<SuspectReadings> {
    let found = fitted.suspicion.as_ref()?;
    let instrument = |index: usize| instrument_name(fitted, index);
    let row = |row: usize| {
        let place = &fitted.data[row].place;
        format!("{}:{}", sources.name(place.source), sources.line_column(place).0)
    };
    let names = ChangeNames { machine: fitted.machine, instrument: &instrument, row: &row, components: COMPONENTS };
    let words = |change: &Change| change.words(&names);
    Some(SuspectReadings {
        changes: found.changes.iter().map(words).collect(),
        others: found.others.iter().map(|other| other.iter().map(words).collect::<Vec<_>>().join(AND)).collect(),
        left_um: found.left * 1e3,
        instead_um: fitted.residuals.after * 1e3,
        remedies: found.changes.iter().map(Change::remedy).collect(),
        accepted: accept.contains(&FitAcceptance::Suspect),
    })
}

impl SuspectReadings {
    /// Returns it in a sentence: `with dx and dy exchanged 3 um are left instead of 59`.
    pub(crate) fn words(&self) -> String {
        let [left, instead] = [self.left_um, self.instead_um].map(|um| significant(um, 3));
        format!("with {} {left} um are left instead of {instead}", self.changes.join(AND))
    }

    /// Returns a refusal, or a warning where nothing is written or the caller insists.
    pub(crate) fn diagnostic(&self, refuses: bool) -> Diagnostic {
        let code = if refuses { codes::E0543 } else { codes::W0520 };
        let others: String = self.others.iter().map(|other| format!("; or with {other}")).collect();
        let help = format!("{}{others}; `--accept suspect` takes the readings as they are", self.remedies.join("; "));
        Diagnostic::new(code, format!("the readings are suspect: {}", self.words())).help(help)
    }
}

/// Warns of a residual scatter that the stated noise does not explain, by chi-squared: real machines have form.
pub(crate) fn noise(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let (noise, sigma) = (fitted.noise?, fitted.solution.sigma);
    let freedom = fitted.solution.degrees_of_freedom as f64;
    let squares = freedom * sigma * sigma / (noise * noise);
    // Normal to its third root (Wilson and Hilferty 1931).
    let part = 2.0 / (9.0 * freedom.max(1.0));
    let z = (libm::cbrt(squares / freedom.max(1.0)) - 1.0 + part) / libm::sqrt(part);
    let far = both_tails(z) < MAX_NOISE_PROBABILITY;
    let [left, stated] = [sigma, noise].map(|mm| significant(mm * 1e3, 3));
    let message = format!(
        "{left} um per reading are left where {stated} um are stated: chi-squared is {} of {freedom} degrees of \
         freedom",
        significant(squares, 3)
    );
    let help = "form of the axes that no curve follows, a trouble of the readings, or another noise";
    (far && freedom > 0.0).then(|| Diagnostic::new(codes::W0502, message).help(help))
}

/// Refuses a fit that predicts readings that it did not use worse than the machine as the file has it.
pub(crate) fn worse_than_nothing(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let (held_out, before) = (fitted.held_out?, fitted.residuals.before);
    let [out, without] = [held_out, before].map(|mm| significant(mm * 1e3, 3));
    let message = format!(
        "the fit is worse than none: {out} um are left of readings that it did not use, {without} um without any fit"
    );
    let help = "fit less, measure more, or compare readings and poses; `--accept undetermined` writes the file all the \
                same";
    (held_out > before).then(|| Diagnostic::new(codes::E0515, message).help(help))
}

/// Returns what is left by component, axis, tool, run and station; `residuals` are those of all rows (mm).
pub(crate) fn residual_groups(fitted: &FitDiagnosis<'_>, residuals: &[Vector3<f64>]) -> Vec<ResidualGroup> {
    let data = fitted.data;
    let rms = |takes: &dyn Fn(usize, usize) -> bool| {
        let (mut count, mut squares) = (0_usize, 0.0);
        for (row, (m, r)) in data.iter().zip(residuals).enumerate() {
            for k in (0..3).filter(|k| m.reading_mask()[*k] && takes(row, *k)) {
                count += 1;
                squares += r[k] * r[k];
            }
        }
        (count, libm::sqrt(squares / count.max(1) as f64) * 1e3)
    };
    let (_, all) = rms(&|_, _| true);
    let mut list = Vec::new();
    let mut push = |by: &'static str, of: String, (readings, rms_um): (usize, f64)| {
        let stands_out = readings >= MIN_GROUP_READINGS && rms_um > MIN_GROUP_RATIO * all;
        list.extend((readings > 0).then_some(ResidualGroup { by, of, readings, rms_um, stands_out }));
    };
    for (k, name) in COMPONENTS.into_iter().enumerate() {
        push("component", name.to_owned(), rms(&|row, own| own == k && data[row].readings() + k > 1));
    }
    for (i, axis) in fitted.machine.axes().iter().enumerate() {
        let ends =
            data.iter().map(|m| m.pose[i]).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), q| (a.min(q), b.max(q)));
        let third = |q: f64| (3.0 * (q - ends.0) / (ends.1 - ends.0)).min(2.0) as usize;
        for part in (0..3).filter(|_| ends.1 > ends.0) {
            let at = |n: usize| significant(ends.0 + (ends.1 - ends.0) * n as f64 / 3.0, 4);
            let of = format!("{} from {} to {}", axis.name, at(part), at(part + 1));
            push("axis", of, rms(&|row, _| third(data[row].pose[i]) == part));
        }
    }
    let instrument = |index: usize| instrument_name(fitted, index);
    let row = |_: usize| String::new();
    let names = ChangeNames { machine: fitted.machine, instrument: &instrument, row: &row, components: COMPONENTS };
    for scope in groups(data) {
        let by = match scope {
            Scope::Run(_) => "run",
            Scope::Tool(_) => "tool",
            _ => "station",
        };
        let of = scope.words(&names);
        push(by, of, rms(&|row, _| scope.holds(&data[row])));
    }
    list
}
