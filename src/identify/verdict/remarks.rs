//! Warnings of a fit: on its data, on how it went, and on its residuals.

use super::accused;
use super::fitted::FitDiagnosis;
use super::limits;
use super::resting;
use super::result::{KnownValue, place};
use super::runs;
use crate::diagnostic::{Diagnostic, Sources, codes};
use crate::identify::data::LEVER_MM;
use crate::identify::thresholds::*;
use crate::identify::{
    BasisFunction, DeviationUncertainty, Estimate, Measurement, Outlier, Parameter, ParameterTerm, Prediction, Reading,
    ReadingKind, Repeats, Residuals, largest_uncertainty, lever,
};
use crate::job::machine_file::ReadBackFailure;
use crate::job::poses::axes_text;
use crate::lower::{ErrorSite, Source};
use crate::machine::{Approach, Axis, Machine, largest};
use crate::units::{counted, significant};

pub(crate) fn all(fitted: &FitDiagnosis<'_>, sources: &Sources) -> Vec<Diagnostic> {
    let unsettled = || {
        let message = format!("the fit has not settled after {} steps", fitted.fit.steps);
        warning(codes::W0501, message, "fix what the data hardly see, or fit less at once")
    };
    let found = [
        (!fitted.fit.converged).then(unsettled),
        lack_of_fit(fitted),
        refuted(fitted),
        idle_type_b(fitted),
        resting::wandering(fitted),
        runs::turned(fitted),
        runs::relative(fitted),
        runs::alone(fitted),
        runs::cut_off(fitted),
        runs::copied(fitted),
        without_freedom(fitted),
        accused::noise(fitted),
        drifting(fitted),
        sizes(fitted).or_else(|| large_values(fitted)),
        missing_approaches(fitted),
        contradiction(fitted, sources),
        silent(fitted),
    ];
    found.into_iter().flatten().collect()
}

fn warning(code: codes::Code, message: String, help: &'static str) -> Diagnostic {
    Diagnostic::new(code, message).help(help)
}

/// Warns of as many readings as unknowns: nothing is left that would tell the noise.
fn without_freedom(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let count = fitted.rows();
    let message = format!("{} determine as many unknowns: no uncertainty is known", counted(count, "reading"));
    let help = "a wrong reading would pass unseen: measure more places, or each of them again";
    (fitted.solution.degrees_of_freedom == 0 && fitted.solution.rank == count && count > 0)
        .then(|| warning(codes::W0521, message, help))
}

/// Warns of readings that are left out because their errors are not fitted.
pub(crate) fn unused_readings(machine: &Machine, list: &[(Source, usize)]) -> Vec<Diagnostic> {
    let one = |(source, count): &(Source, usize)| {
        let error = source.error(machine)?;
        let message = format!("{} of {error} left out: it is not fitted", counted(*count, "reading"));
        Some(warning(codes::W0504, message, "fit it, too, or leave its column out"))
    };
    list.iter().filter_map(one).collect()
}

/// Warns of entries of the section `identify` without effect.
pub(crate) fn entries_without_effect(list: &[String]) -> Option<Diagnostic> {
    let message = format!("the section `identify` says what nothing takes up: {}", list.join(", "));
    let help = "name the error in `fit`, without a basis of its own, or with one that has knots";
    (!list.is_empty()).then(|| warning(codes::W0509, message, help))
}

/// Warns of uncertainties of type B that move no unknown.
fn idle_type_b(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let names: Vec<String> =
        fitted.solution.idle_common.iter().map(|k| format!("`{}`", fitted.type_b[*k].name)).collect();
    let message = format!("type B adds nothing to any fitted error: {}", names.join(", "));
    let help = "the readings are relative: their set-up takes what they share, and no uncertainty of an error has it";
    (!names.is_empty()).then(|| warning(codes::W0509, message, help))
}

fn um(mm: f64) -> String {
    significant(mm * 1e3, 3)
}

/// Warns of values known before the data that the readings contradict.
fn refuted(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let list = KnownValue::all(fitted).into_iter();
    let far = list.filter_map(|known| {
        let off = known.deviations.filter(|off| off.abs() > MAX_KNOWN_DEVIATIONS)?;
        let ([found, value], off) = ([known.found, known.value].map(|x| significant(x, 7)), significant(off.abs(), 2));
        Some(format!(
            "`{}` is {found} {} where {value} are known, {off} standard deviations off",
            known.name, known.unit
        ))
    });
    let far: Vec<String> = far.collect();
    let help = "compare names, value and uncertainty of the prior, and the readings that hold it";
    (!far.is_empty())
        .then(|| warning(codes::W0502, format!("the readings contradict a prior: {}", far.join("; ")), help))
}

/// Returns the residual standard deviation of readings of a kind.
fn scatter(fitted: &FitDiagnosis<'_>, kind: ReadingKind) -> f64 {
    let own = fitted.fit.scatter.iter().find(|s| s.of.is_none_or(|of| of == kind));
    own.map_or(fitted.solution.sigma, |s| s.sigma)
}

fn lack_of_fit(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let far = |r: &&Repeats| {
        r.degrees_of_freedom >= MIN_REPEAT_FREEDOM && scatter(fitted, r.of) > MAX_SCATTER_RATIO * r.sigma
    };
    let repeats = fitted.repeats.iter().find(far)?;
    let (left, sigma) = (um(scatter(fitted, repeats.of)), um(repeats.sigma));
    let message =
        format!("what is left ({left} um per reading) is far above the scatter of repeated poses ({sigma} um)");
    let help = "the fitted errors do not explain the data: fit more of them, or look at the outliers";
    Some(warning(codes::W0502, message, help))
}

fn drifting(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let drifting =
        fitted.residual_tests.iter().filter(|r| r.runs < MAX_NOISE_PROBABILITY && r.lag1 > MIN_DRIFT_CORRELATION);
    let names: Vec<String> = drifting.map(|r| r.of.clone()).collect();
    let message = format!("what is left of {} is not noise: neighbours in the file are alike", names.join(", "));
    let help =
        "drift of machine or instrument while measuring, or a shape that was not fitted; sigmas are too small then";
    (!names.is_empty()).then(|| warning(codes::W0503, message, help))
}

fn sizes(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let Residuals { typical, typical_turn, .. } = fitted.residuals;
    unlikely_sizes(typical, typical_turn)
}

/// Warns of sizes that speak of a wrong unit: medians of lengths (mm), and of rotations (mm at the lever of all
/// rotations).
pub(crate) fn unlikely_sizes(typical: f64, typical_turn: f64) -> Option<Diagnostic> {
    let unlikely = |size: f64| size > MAX_MEDIAN_MM || (0.0 < size && size < MIN_MEDIAN_MM);
    let off = match (unlikely(typical), unlikely(typical_turn)) {
        (true, _) => format!("half of the readings are {} um", um(typical)),
        (false, true) => format!("half of the rotations are {} urad", um(typical_turn / LEVER_MM * 1e3)),
        (false, false) => return None,
    };
    let message = format!("{off} or more off the machine as the file says it");
    let help = "compare the units in the header, the signs and zeros of the axes, and the frame (--frame)";
    Some(warning(codes::W0505, message, help))
}

/// Asks about location errors so large that one would see them by eye.
fn large_values(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let own = fitted.unknowns[..fitted.own].iter().zip(&fitted.solution.estimates);
    let large = own.filter(|(parameter, estimate)| match parameter.terms.first().map(|term| term.source) {
        Some(source) if matches!(source.place, ErrorSite::Location(_)) => {
            let most = if source.direction.is_rotation() { MAX_LIKELY_TURN } else { MAX_LIKELY_SHIFT_MM };
            // Above what a machine file takes, the file itself is refused.
            estimate.value.abs() > most && estimate.value.abs() <= largest(source.direction)
        }
        _ => false,
    });
    let said = |(parameter, estimate): (&Parameter, &Estimate)| {
        let value = significant(parameter.in_unit(estimate.value), 4);
        format!("{} = {value} {}", parameter.name, parameter.unit)
    };
    let list: Vec<String> = large.map(said).collect();
    let message = format!("the fit finds what one would see by eye: {}", list.join(", "));
    (!list.is_empty()).then(|| warning(codes::W0512, message, RAN_AWAY))
}

/// Warns of a reading that stands far out.
pub(crate) fn outlying(fitted: &FitDiagnosis<'_>, sources: &Sources) -> Option<Diagnostic> {
    let outliers = &fitted.residuals.outliers;
    let left = fitted.residuals.after * fitted.residuals.after * fitted.data.len() as f64;
    // A row that stands alone widens the scatter by which it is judged.
    let is_most = |of: &&Outlier| of.residual * of.residual > MAX_OUTLYING_SHARE * left;
    let worst = outliers.first().filter(|worst| worst.deviations > MAX_OUTLYING_DEVIATIONS || is_most(worst))?;
    let far = outliers.iter().filter(|of| of.deviations > MAX_OUTLYING_DEVIATIONS).count();
    let (place, size) = (place(fitted, sources, worst.row), significant(worst.deviations, 2));
    let others = if far > 1 { format!(", and {} more", far - 1) } else { String::new() };
    let message = format!("{place} is {size} standard deviations off what all readings say{others}");
    Some(warning(codes::W0507, message, "measure it again, leave the row out, or take `--robust`"))
}

/// Warns of curves for a direction of approach in which no reading was taken that they move.
fn missing_approaches(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let read = |p: &Parameter, t: &ParameterTerm| {
        let moves = |m: &Measurement| match m.reading {
            Reading::Error { source, .. } => p.terms.iter().any(|t| t.source == source),
            _ => true,
        };
        let from = |m: &Measurement| m.approach == t.approach || m.approach == Approach::Mean;
        fitted.data.iter().any(|m| from(m) && moves(m))
    };
    let unread = |p: &&Parameter| p.terms.iter().any(|t| t.approach != Approach::Mean && !read(p, t));
    let mut names: Vec<&str> =
        fitted.unknowns.iter().filter(unread).map(|p| p.name.split(':').next().unwrap_or_default()).collect();
    names.dedup();
    let message =
        format!("nothing was read in the direction of approach of {}: kept as the file says", names.join(", "));
    let help = "measure in both directions, or fit the curve without `+-`: it is then the same in both";
    (!names.is_empty()).then(|| warning(codes::W0506, message, help))
}

/// Warns of readings of one pose that contradict each other.
fn contradiction(fitted: &FitDiagnosis<'_>, sources: &Sources) -> Option<Diagnostic> {
    let repeats = fitted.repeats.iter().find(|r| r.contradict || r.opposed)?;
    let (a, b, difference) = repeats.worst;
    let places = format!("{} and {}", place(fitted, sources, a), place(fitted, sources, b));
    if repeats.opposed {
        let message = format!("poses that were measured again were read with the opposite sign: {places}, for one");
        return Some(warning(
            codes::W0507,
            message,
            "readings are actual minus nominal: turn the sign of one of the files",
        ));
    }
    let message = format!("readings of one pose contradict each other by {} um: {places}", um(difference));
    let help =
        "one of them may have another sign (actual minus nominal), unit, tool or set-up: correct it, or name a `run`";
    Some(warning(codes::W0507, message, help))
}

/// Refuses values of the machine whose uncertainty is larger than any error of a machine: constants, and curves
/// somewhere in the travel. Coefficients of a curve say nothing each by itself.
pub(crate) fn undetermined_values(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let n = |parameter: &Parameter, value: f64| significant(parameter.in_unit(value), 3);
    let words = |(p, estimate, sigma): (&Parameter, &Estimate, f64)| {
        format!("{} = {} \u{b1} {} {}", p.name, n(p, estimate.value), n(p, sigma), p.unit)
    };
    let wide: Vec<String> = wide_estimates(fitted).map(words).chain(wide_curves(fitted)).collect();
    let message = format!("the data do not determine {}", wide.join(", "));
    let help = "an axis that turns the other way needs another `sense` in the file, exchanged titles their places; \
                otherwise measure where these act, fit less or fix them (`--fixed`); `--accept undetermined` writes \
                the file all the same";
    (!wide.is_empty()).then(|| Diagnostic::new(codes::E0513, message).help(help))
}

/// Returns the constants of the machine that are more uncertain than any error is large, with their standard
/// uncertainty.
fn wide_estimates<'a>(fitted: &'a FitDiagnosis<'_>) -> impl Iterator<Item = (&'a Parameter, &'a Estimate, f64)> {
    let own = fitted.unknowns[..fitted.own].iter().zip(&fitted.solution.estimates);
    own.filter_map(|(parameter, estimate)| {
        let constant = parameter.terms.first().filter(|term| term.basis == BasisFunction::Constant)?;
        let direction = constant.source.direction;
        let limit = largest(direction) * lever(direction);
        let sigma = estimate.sigma.filter(|sigma| sigma * parameter.size > limit)?;
        Some((parameter, estimate, sigma))
    })
}

/// Returns the constants of the machine whose values are noise.
pub(crate) fn wide_constants<'a>(fitted: &FitDiagnosis<'a>) -> Vec<&'a Parameter> {
    let names: Vec<&str> = wide_estimates(fitted).map(|(parameter, ..)| parameter.name.as_str()).collect();
    fitted.unknowns.iter().filter(|p| names.contains(&p.name.as_str())).collect()
}

/// FitDiagnosis curves that are more uncertain somewhere in the travel than any error is large.
fn wide_curves(fitted: &FitDiagnosis<'_>) -> Vec<String> {
    let own = &fitted.unknowns[..fitted.own];
    let mut sources: Vec<Source> = Vec::new();
    for term in own.iter().flat_map(|p| &p.terms) {
        if matches!(term.source.place, ErrorSite::Component(_)) && !sources.contains(&term.source) {
            sources.push(term.source);
        }
    }
    let one = |source: Source| {
        let ErrorSite::Component(axis) = source.place else { return None };
        let (sigma, at) = largest_uncertainty(fitted.machine, own, &fitted.solution, source)?;
        let (factor, unit) = source.direction.micro();
        let axis = &fitted.machine.axes()[axis];
        let error = source.error(fitted.machine)?;
        let words = || {
            let (size, at) = (significant(sigma * factor, 3), significant(at, 4));
            format!("{error} (\u{b1} {size} {unit} at {} = {at} {})", axis.name, axis.unit())
        };
        (sigma > largest(source.direction)).then(words)
    };
    sources.into_iter().filter_map(one).collect()
}

/// Refuses data in which the machine may grow or shrink without a reading that notices; `held` are parameters with
/// which, if their values are known, it may not.
pub(crate) fn shrinking(stretches: &[(String, Vec<String>)], held: Option<&str>) -> Option<Diagnostic> {
    let (words, names) = stretches.first()?;
    let message = format!("no reading holds a length: {words} with {}, and nothing notices", names.join(", "));
    let held = held.map(|list| format!("; or, if these values are known, `--fixed {list}`")).unwrap_or_default();
    let help = format!(
        "add a reading that holds a length: two balls or sockets at a known distance or a calibrated bar (`length \
         [mm]`), a laser along an axis (`EXX [um]`, `along [um]`), deviations (`dx [um]`); or known places or \
         distances (`--prior`){held}"
    );
    Some(Diagnostic::new(codes::E0514, message).help(help))
}

/// Describes a direction that changes no reading but the deviation.
pub(crate) fn of_readings(words: &str) -> String {
    let rest = [" changes nothing", " change nothing"].iter().find_map(|end| Some((words.strip_suffix(end)?, *end)));
    match rest {
        Some((rest, " change nothing")) => format!("{rest} change no reading, but that"),
        Some((rest, _)) => format!("{rest} changes no reading, but that"),
        None => format!("{words}, but on that"),
    }
}

/// Refuses a fit whose data do not determine the deviation over the volume.
pub(crate) fn uncertain_prediction(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    if limits::holds_prediction(fitted) {
        return None;
    }
    let Prediction { uncertainty, pose, deviation, .. } = &fitted.prediction;
    let at = axes_text(fitted.machine, pose) + &beyond_measured(fitted, pose);
    let message = match uncertainty {
        DeviationUncertainty::Free(words) => {
            format!("the data leave the deviation at {at} free: {}", of_readings(words))
        }
        DeviationUncertainty::Known(size) => format!(
            "the data do not hold the deviation at {at}: its standard uncertainty is {} um, and the largest deviation \
             predicted is {} um",
            um(*size),
            um(*deviation)
        ),
        DeviationUncertainty::Unknown => return None,
    };
    let range = if fitted.measured.iter().any(Option::is_some) {
        "judge and write only the range that was measured (`--range measured`), "
    } else {
        ""
    };
    let help = format!(
        "measure there, {range}fit less (fewer knots than measured places), or bound the curves (`slopes:`); \
         `--accept undetermined` writes the file all the same"
    );
    Some(Diagnostic::new(codes::E0515, message).help(help))
}

/// Returns the ranges of the axes that a pose takes beyond what was measured, such as ` (A was measured from -60 to 60
/// of -110 to 110 deg)`.
fn beyond_measured(fitted: &FitDiagnosis<'_>, pose: &[f64]) -> String {
    let one = |((axis, q), range): ((&Axis, &f64), &Option<(f64, f64)>)| {
        let (low, high) = (*range).filter(|(low, high)| q < low || q > high)?;
        let (min, max) = axis.travel.interval();
        let [low, high, min, max] = [low, high, min, max].map(|q| significant(q, 6));
        Some(format!("{} was measured from {low} to {high} of {min} to {max} {}", axis.name, axis.unit()))
    };
    let all: Vec<String> = fitted.machine.axes().iter().zip(pose).zip(&fitted.measured).filter_map(one).collect();
    if all.is_empty() { String::new() } else { format!(" ({})", all.join(", ")) }
}

/// Some parameters ran away: what to do.
const RAN_AWAY: &str = "some parameters ran away because the data hardly see them, or because poses, places and \
    directions of the readings are not those of this machine: compare these, fix those, or fit less";

/// Refuses a fitted machine file that the program would not take.
pub(crate) fn refusal_of_file(why: &ReadBackFailure) -> Diagnostic {
    Diagnostic::new(codes::E0504, format!("the fitted machine is refused: {why}")).help(RAN_AWAY)
}

/// Warns of the same where no file is asked for: the printed values must not be taken for a machine.
pub(crate) fn implausible(why: &ReadBackFailure) -> Diagnostic {
    warning(codes::W0512, format!("the fitted machine is not plausible: {why}"), RAN_AWAY)
}

/// Warns of combinations below noise that go to a machine file.
pub(crate) fn weak_directions_in_file(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let below_noise = &fitted.solution.below_noise;
    let first = below_noise.first().filter(|_| fitted.noise_hides_values())?;
    let count = counted(below_noise.len(), "combination");
    let message = format!("what is written holds {count} that noise hides, the first: {first}");
    let help = "fix what the data hardly tell (`--fixed`), or fit less: `abbe show` lists location errors that suffice";
    Some(warning(codes::W0510, message, help))
}

/// Warns if no fitted parameter has an effect on the readings.
fn silent(fitted: &FitDiagnosis<'_>) -> Option<Diagnostic> {
    let has_no_effect = |p: &Parameter| fitted.solution.without_effect.contains(&p.name);
    let message = "nothing of what is fitted has an effect on these data: the values are those of the file".to_owned();
    let help = "measure where the errors act (`--plan 20` proposes poses), or fit others";
    fitted.unknowns[..fitted.own].iter().all(has_no_effect).then(|| warning(codes::W0508, message, help))
}
