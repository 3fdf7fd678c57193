//! Readings that accuse themselves: a change of the data, such as two columns exchanged, that explains what a fit
//! leaves.
//!
//! `change`: the changes that are tried. `screen`: a sample of the readings on which
//! they are judged by likelihood. [`suspect`]: the search over single changes and pairs, and the fit of the best one.

mod change;
mod screen;

use super::data::change::{Change, Scope};
use super::data::{Measurement, Repeats};
use super::model::FitModel;
use super::solve::{ParameterFit, Solution, solve};
use super::thresholds::*;
use nalgebra::Vector3;
use rayon::prelude::*;
use screen::{Judged, Posed, Screen};

/// Changes that explain what a fit leaves.
#[derive(Debug, Clone, PartialEq)]
pub struct Suspicion {
    /// One or two.
    pub changes: Vec<Change>,
    /// RMS of what is left with them, over rows (mm).
    pub left: f64,
    /// Changes that explain as much: the readings do not tell which it is.
    pub others: Vec<Vec<Change>>,
}

/// Changes with their likelihood.
struct Candidate {
    changes: Vec<Change>,
    likelihood: f64,
    /// Standard deviation of each quantity and component (mm).
    sigmas: Vec<f64>,
}

/// The circumstances of a fit.
pub struct Circumstances<'a> {
    /// Values of the unknowns.
    fit: &'a ParameterFit,
    /// Standard deviation of a reading that the fit leaves (mm).
    sigma: f64,
    /// RMS of what the fit leaves, over rows (mm).
    after: f64,
    /// Residual degrees of freedom.
    degrees_of_freedom: usize,
    /// Scatter of poses that were measured again.
    repeats: &'a [Repeats],
    /// Standard deviation of a reading as stated (mm).
    noise: Option<f64>,
    /// True if readings that stand out count less: they are no trouble then.
    robust: bool,
}

impl<'a> Circumstances<'a> {
    /// Returns those of a fit that leaves `after` (mm).
    pub fn of(
        fit: &'a ParameterFit,
        solution: &Solution,
        after: f64,
        repeats: &'a [Repeats],
        noise: Option<f64>,
        robust: bool,
    ) -> Self {
        let scatter = fit.scatter.iter().map(|scatter| scatter.sigma).reduce(f64::max);
        let sigma = scatter.unwrap_or(solution.sigma);
        Self { fit, sigma, after, degrees_of_freedom: solution.degrees_of_freedom, repeats, noise, robust }
    }

    /// True if nothing is left beyond the noise that is known.
    fn is_noise(&self) -> bool {
        let repeats = self.repeats.iter().filter(|r| r.degrees_of_freedom >= MIN_REPEAT_FREEDOM);
        let known = repeats.map(|r| r.sigma).chain(self.noise).reduce(f64::min);
        self.sigma <= MIN_SUSPECT_MM || known.is_some_and(|known| self.sigma < MIN_SUSPECT_RATIO * known)
    }
}

/// Looks for changes of the data that explain what the fit leaves.
pub fn suspect(model: &FitModel<'_>, data: &[Measurement], of: &Circumstances<'_>) -> Option<Suspicion> {
    let found = consistent(model, data, of);
    let nothing = || Suspicion { changes: Vec::new(), left: of.after, others: Vec::new() };
    let Suspicion { mut changes, left, others } = found.unwrap_or_else(nothing);
    // A factor of all readings is consistent: the noise alone tells it.
    let ratio = of.noise.filter(|_| of.after > 0.0).map(|noise| of.sigma * left / of.after / noise);
    let factor = |ratio: f64| {
        let too_large = UNIT_NOISE_RATIOS.contains(&ratio) && of.after > MIN_UNIT_LEFT_MM;
        // Of readings that are all smaller than their noise: data without noise scatter as little, about something.
        let too_small = UNIT_NOISE_RATIOS.contains(&(1.0 / ratio)) && of.noise > change::read_size(model, data);
        too_large.then_some(1e-3).or(too_small.then_some(1e3))
    };
    let unit = ratio.and_then(factor).map(change::of_all);
    let scale = unit.as_ref().map_or(1.0, |(_, factor)| *factor);
    changes.extend(unit.map(|(change, _)| change));
    (!changes.is_empty()).then_some(Suspicion { changes, left: left * scale, others })
}

/// Looks for changes with which the readings agree with each other.
fn consistent(model: &FitModel<'_>, data: &[Measurement], of: &Circumstances<'_>) -> Option<Suspicion> {
    if of.is_noise() || (of.degrees_of_freedom as f64) < MIN_SUSPECT_FREEDOM {
        return None;
    }
    let screen = Screen::new(model, data, &of.fit.theta, of.sigma)?;
    let here = screen.posed(&[])?;
    let null = screen.judge(&here, &[])?;
    let count = screen.rows.iter().map(|row| data[*row].readings()).sum::<usize>() as f64;
    let singles = change::all(model, data);
    let mut problems = vec![(Vec::new(), Some(here))];
    let mut found = evaluate(&screen, &mut problems, singles.iter().map(|change| vec![change.clone()]).collect());
    if !of.robust {
        found.extend(with_rows_left_out(&screen, &[]));
    }
    found.sort_by(|a, b| b.likelihood.total_cmp(&a.likelihood));
    // Of two troubles at least one explains a little by itself, but for a pose and a component.
    let explains = |best: &Candidate| best.likelihood - null.likelihood > count * libm::log(MIN_FIRST_GAIN);
    let beam = if found.first().is_some_and(explains) { SUSPECT_BEAM } else { 0 };
    let mut pairs = Vec::new();
    let mut beams = [0, 0];
    for first in found.iter().take(beam) {
        // What frees something, and poses after poses, take time: after the best ones only.
        let of_poses = first.changes.iter().any(Change::is_of_poses);
        beams[usize::from(of_poses)] += 1;
        let costs = |next: &Change| next.is_free() || (of_poses && next.is_of_poses());
        let tried =
            |next: &&Change| !first.changes.contains(next) && (beams[usize::from(of_poses)] <= 3 || !costs(next));
        pairs.extend(singles.iter().filter(tried).map(|next| both(first, next)));
    }
    // Neither a pose nor a component by itself may stand out where both are wrong.
    for first in singles.iter().filter(|change| change.is_of_poses()) {
        let of_all = |next: &&Change| matches!(next, Change::Values { scope: Scope::All, .. });
        pairs.extend(singles.iter().filter(of_all).map(|next| vec![first.clone(), next.clone()]));
    }
    let best: Vec<Vec<Change>> = found.iter().take(2).map(|one| one.changes.clone()).collect();
    found.extend(evaluate(&screen, &mut problems, pairs));
    if !of.robust {
        best.iter().for_each(|changes| found.extend(with_rows_left_out(&screen, changes)));
    }
    found.sort_by(|a, b| b.likelihood.total_cmp(&a.likelihood));
    let form = std::cell::OnceCell::new();
    let by_form = || *form.get_or_init(|| screen.gain_by_form(problems[0].1.as_ref()?));
    let explains = |best: &&Candidate| {
        let gain = best.likelihood - null.likelihood;
        // A trouble of one component is drowned by the others. In another unit all scatters are smaller.
        let rescales = best.changes.iter().any(Change::rescales);
        let mut sigmas = null.sigmas.iter().zip(&best.sigmas);
        let of_one = !rescales && sigmas.any(|(before, after)| *before > MIN_COMPONENT_GAIN * after);
        let enough = of_one || gain >= count * libm::log(least_gain(&best.changes, of));
        enough && gain >= MIN_SUSPECT_LIKELIHOOD && by_form().is_none_or(|form| gain >= form)
    };
    let exchanges = || found.iter().filter(|one| one.changes.iter().all(Change::is_exchange)).collect::<Vec<_>>();
    // What the sample promises the fit of all readings may not keep: then the next one.
    let whole = found.iter().collect::<Vec<_>>();
    let first = [simplest(&whole, count), simplest(&exchanges(), count)].into_iter().flatten();
    let mut candidates = first.chain(found.iter().take(SUSPECT_VERIFIED)).filter(explains);
    let (best, suspicion) = candidates.find_map(|best| Some((best, verified(&screen, best, of)?)))?;
    let alike = |one: &&Candidate| {
        one.changes != best.changes
            && one.changes.len() == best.changes.len()
            && best.likelihood - one.likelihood < MAX_ALIKE_LIKELIHOOD
    };
    let mut others: Vec<Vec<Change>> = Vec::new();
    for one in found.iter().filter(alike).filter(|one| one.changes.iter().any(|change| !best.changes.contains(change)))
    {
        if !others.iter().any(|other| other.iter().all(|change| one.changes.contains(change))) {
            others.push(one.changes.clone());
        }
    }
    others.truncate(MAX_ALTERNATIVES);
    Some(Suspicion { others, ..suspicion })
}

fn both(first: &Candidate, next: &Change) -> Vec<Change> {
    first.changes.iter().chain([next]).cloned().collect()
}

/// Linear problems by their changed poses, so that each is made once.
type Problems = Vec<(Vec<Change>, Option<Posed>)>;

fn poses(changes: &[Change]) -> Vec<Change> {
    changes.iter().filter(|change| change.is_of_poses()).cloned().collect()
}

/// Judges changes: those that free something, and the best of the others at a glance.
fn evaluate(screen: &Screen<'_>, problems: &mut Problems, list: Vec<Vec<Change>>) -> Vec<Candidate> {
    let mut missing: Vec<Vec<Change>> = Vec::new();
    for changes in &list {
        let poses = poses(changes);
        if !problems.iter().any(|(known, _)| *known == poses) && !missing.contains(&poses) {
            missing.push(poses);
        }
    }
    let made = missing.into_par_iter().map(|poses| {
        let problem = screen.posed(&poses);
        (poses, problem)
    });
    let made: Problems = made.collect();
    problems.extend(made);
    let problem = |changes: &[Change]| {
        let poses = poses(changes);
        problems.iter().find(|(known, _)| *known == poses)?.1.as_ref()
    };
    let (mut judged, fixed): (Vec<_>, Vec<_>) = list.into_iter().partition(|one| one.iter().any(Change::is_free));
    let glance = |changes: Vec<Change>| Some((screen.glance(problem(&changes)?, &changes), changes));
    let mut glances: Vec<(f64, Vec<Change>)> = fixed.into_par_iter().filter_map(glance).collect();
    glances.sort_by(|a, b| b.0.total_cmp(&a.0));
    judged.extend(glances.into_iter().take(SUSPECT_FINALISTS).map(|(_, changes)| changes));
    let judge = |changes: Vec<Change>| {
        let Judged { likelihood, sigmas, .. } = screen.judge(problem(&changes)?, &changes)?;
        Some(Candidate { changes, likelihood, sigmas })
    };
    judged.into_par_iter().filter_map(judge).collect()
}

fn with_rows_left_out(screen: &Screen<'_>, changes: &[Change]) -> Option<Candidate> {
    let problem = screen.posed(&poses(changes))?;
    let changes = [changes, &[screen.outlying(&problem, changes)?]].concat();
    let Judged { likelihood, sigmas, .. } = screen.judge(&problem, &changes)?;
    Some(Candidate { changes, likelihood, sigmas })
}

/// Returns the best one, or a part of it that explains almost as much.
fn simplest<'a>(found: &[&'a Candidate], count: f64) -> Option<&'a Candidate> {
    let best = *found.first()?;
    let enough = best.likelihood - count * libm::log(MIN_SECOND_GAIN);
    let simpler = |one: &&&Candidate| one.changes.len() < best.changes.len() && one.likelihood >= enough;
    found.iter().find(simpler).copied().or(Some(best))
}

/// Returns the ratio of what is left without and with changes from which on they are named.
fn least_gain(changes: &[Change], of: &Circumstances<'_>) -> f64 {
    // Rows that stand out are expected of a robust fit: what leaves them less far off is no exchange.
    let exchanged = !of.robust && changes.iter().all(Change::is_exchange);
    if exchanged { MIN_EXCHANGE_GAIN } else { MIN_SUSPECT_GAIN }
}

/// Fits the changed data as a whole; `None` if that leaves more than the sample promised.
fn verified(screen: &Screen<'_>, best: &Candidate, of: &Circumstances<'_>) -> Option<Suspicion> {
    let (model, changes) = (screen.model, &best.changes);
    let rescales = changes.iter().any(Change::rescales);
    let found = |left: f64| {
        // More than errors of a machine is a fit that ran away.
        let explains = (rescales || left * least_gain(changes, of) <= of.after) && left < SUSPECT_PRIOR_MM;
        explains.then(|| Suspicion { changes: changes.clone(), left, others: Vec::new() })
    };
    if changes.iter().any(Change::adds_unknowns) {
        return found(screen.judge(&screen.posed(&poses(changes))?, changes)?.left);
    }
    let changed = |row: usize| {
        let m = change::posed(changes, model, screen.data, row)?;
        if screen::is_left_out(changes, row, &m) {
            return None;
        }
        let base = model.prediction(&m, &of.fit.theta).x;
        let (values, _) = change::revalued(changes, model, &m, base);
        Some(change::with_values(m, values))
    };
    let data: Vec<Measurement> = (0..screen.data.len()).filter_map(changed).collect();
    let residuals: Vec<Vector3<f64>> = model.residuals(&data, &solve(model, &data, of.robust).theta);
    let squares: f64 = residuals.iter().map(|r| r.norm_squared()).sum();
    found(libm::sqrt(squares / residuals.len().max(1) as f64))
}
