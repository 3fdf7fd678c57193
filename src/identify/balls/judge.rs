//! Touches that stand out from their ball, and logs that are not of this machine file.

use super::log::TouchSet;
use super::sphere::{SphereFit, algebraic};
use crate::diagnostic::{Diagnostic, Place, codes};
use crate::identify::thresholds::{
    MAX_EXPLAINED_SCATTER, MAX_PLACE_SCATTER_MM, MAX_TOUCH_DEVIATIONS, MAX_TOUCH_OUTLIERS, MIN_AXIS_SPREAD,
    MIN_MISS_MM, MIN_TOUCH_OUTLIER_MM, NORMAL_QUARTILE, SAME_BALL_MM,
};
use crate::machine::Machine;
use crate::units::{counted, length, significant};
use nalgebra::Vector3;

/// Maximum number of touches that a message lists.
const LISTED: usize = 12;

/// A touch that stands out.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outlier {
    pub set: usize,
    pub touch: usize,
    /// Distance (mm) outside the ball of the other touches.
    pub off: f64,
}

/// Finds touches that stand out, the farthest first, and returns the fit without them.
pub(super) fn outliers(sets: &[TouchSet], used: &mut [Vec<bool>], fit: SphereFit) -> (SphereFit, Vec<Outlier>) {
    let count: usize = used.iter().map(Vec::len).sum();
    let (mut fit, mut found): (SphereFit, Vec<Outlier>) = (fit, Vec::new());
    while (found.len() as f64) < (MAX_TOUCH_OUTLIERS * count as f64).max(1.0) {
        let all = || {
            let of_set = |(set, (sizes, used)): (usize, (&Vec<f64>, &Vec<bool>))| {
                let kept = sizes.iter().zip(used).enumerate().filter(|(_, (_, used))| **used);
                kept.map(|(touch, (size, _))| (size.abs(), set, touch)).collect::<Vec<_>>()
            };
            fit.standardised.iter().zip(used.iter()).enumerate().flat_map(of_set)
        };
        let mut sizes: Vec<f64> = all().map(|(size, ..)| size).collect();
        sizes.sort_by(f64::total_cmp);
        let quartile = sizes.get(sizes.len() * 3 / 4).copied().unwrap_or_default() / NORMAL_QUARTILE;
        let Some((size, set, touch)) = all().max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        if size < (MAX_TOUCH_DEVIATIONS * quartile).max(MIN_TOUCH_OUTLIER_MM) {
            break;
        }
        used[set][touch] = false;
        let Some(without) = SphereFit::of(sets, used) else {
            used[set][touch] = true;
            break;
        };
        fit = without;
        found.push(Outlier { set, touch, off: 0.0 });
    }
    found.iter_mut().for_each(|of| of.off = fit.residuals[of.set][of.touch]);
    (fit, found)
}

/// The diagnostic of touches that stand out, each with its line and what it may be.
pub(super) fn say_outliers(
    sets: &[TouchSet],
    found: &[Outlier],
    fit: &SphereFit,
    accepted: bool,
) -> Option<Diagnostic> {
    let first = found.first()?;
    let kind = |of: &Outlier| match of.off {
        off if off <= -MIN_MISS_MM => "inside the ball: a miss, where the probe stopped without a contact",
        off if off < 0.0 => "inside the ball: the contact came late, or the ball moved",
        _ => "outside the ball: the shaft touched, or dirt, or the ball moved",
    };
    let words = |of: &Outlier| {
        let (set, number) = (&sets[of.set], sets[of.set].contacts[of.touch].number);
        format!("touch {number} of {} is {} {}", set.name(), length(of.off.abs()), kind(of))
    };
    let sigma = significant(libm::sqrt(fit.variance()) * 1e3, 3);
    let more = if found.len() > 1 { format!(" ({} in all)", counted(found.len(), "outlier")) } else { String::new() };
    let code = if accepted { codes::W0520 } else { codes::E0543 };
    let help = format!(
        "the others scatter by {sigma} um: measure the ball again, or delete the line; `--accept suspect` takes the \
         touches as they are"
    );
    let diagnostic = Diagnostic::new(code, format!("{}{more}", words(first))).help(help);
    Some(found.iter().take(LISTED).fold(diagnostic, |diagnostic, of| {
        diagnostic.at(Some(sets[of.set].contacts[of.touch].place.clone()), words(of))
    }))
}

/// A warning of attempts that the program gave up.
pub(super) fn broken(places: &[Place]) -> Option<Diagnostic> {
    let message = format!("left out: {} that broke off and began again", counted(places.len(), "attempt"));
    let warning = Diagnostic::new(codes::W0504, message).help("nothing is missing: the later attempt counts");
    let at = |warning: Diagnostic, place: &Place| warning.at(Some(place.clone()), "");
    (!places.is_empty()).then(|| places.iter().take(LISTED).fold(warning, at))
}

/// Names balls that the log does not name by their places, in the order in which they come.
pub(super) fn name_balls(sets: &mut [TouchSet], fit: &SphereFit) {
    let mut places: Vec<Vector3<f64>> = Vec::new();
    for (set, centre) in sets.iter_mut().zip(&fit.centres).filter(|(set, _)| set.ball.is_empty()) {
        let known = places.iter().position(|place| (place - centre).norm() < SAME_BALL_MM);
        set.ball = (known.unwrap_or(places.len()) + 1).to_string();
        places.extend(known.is_none().then_some(*centre));
    }
}

/// Root mean square distance (mm) of places from the mean of their ball.
fn scatter(sets: &[TouchSet], places: &[Vector3<f64>]) -> f64 {
    let from_mean = beside_mean(sets, places);
    libm::sqrt(from_mean.iter().map(Vector3::norm_squared).sum::<f64>() / places.len().max(1) as f64)
}

/// Vectors, each less the mean of its ball.
fn beside_mean(sets: &[TouchSet], vectors: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let of = |set: &TouchSet| {
        let own = sets.iter().zip(vectors).filter(|(other, _)| other.ball == set.ball);
        let (sum, count) = own.fold((Vector3::zeros(), 0.0), |(sum, count), (_, v)| (sum + v, count + 1.0));
        sum / f64::max(count, 1.0)
    };
    sets.iter().zip(vectors).map(|(set, vector)| vector - of(set)).collect()
}

/// Says that the places of a ball differ by more than machines err, and what explains it.
pub(super) fn elsewhere(
    machine: &Machine,
    sets: &[TouchSet],
    fit: &SphereFit,
    is_named: bool,
    accepted: bool,
) -> Option<Diagnostic> {
    let found = scatter(sets, &fit.centres);
    // Balls without names that come once only are places that did not agree.
    let alone = sets.iter().filter(|set| sets.iter().filter(|other| other.ball == set.ball).count() == 1).count();
    let logged: Option<Vec<Vector3<f64>>> = sets
        .iter()
        .map(|set| Some(algebraic(&set.contacts.iter().map(|of| of.logged).collect::<Vec<_>>())?.xyz()))
        .collect();
    let mut one = sets.to_vec();
    let are_apart = !is_named && alone * 2 > sets.len() && sets.len() > 2;
    if are_apart {
        one.iter_mut().for_each(|set| set.ball.clear());
        let apart = logged.as_ref().map(|logged| SphereFit { centres: logged.clone(), ..fit.clone() });
        apart.iter().for_each(|apart| name_balls(&mut one, apart));
    }
    let nominal = scatter(&one, &fit.centres);
    let as_logged = logged.map_or(f64::MAX, |logged| scatter(&one, &logged));
    let code = if accepted { codes::W0520 } else { codes::E0543 };
    let place = sets.first().and_then(|set| set.contacts.first()).map(|contact| contact.place.clone());
    let say = |message: String, help: &str| Some(Diagnostic::new(code, message).at(place.clone(), "").help(help));
    if nominal > MAX_PLACE_SCATTER_MM && as_logged < MAX_EXPLAINED_SCATTER * nominal {
        let message = format!(
            "the log holds coordinates of the tip, not of the axes: a ball is in one place to {}, by the axes to {}",
            length(as_logged),
            length(nominal)
        );
        return say(
            message,
            "the correction off, they are read with `--coordinates tip`; else measure in identity kinematics",
        );
    }
    let other = "a machine file, tool, coordinates or names of balls other than those of the measurement";
    if are_apart {
        let message = format!("{} of {} are at balls of their own", alone, counted(sets.len(), "set"));
        return say(message, other);
    }
    if found <= MAX_PLACE_SCATTER_MM {
        return None;
    }
    let direction = Vector3::from(machine.tool().direction);
    let axes: Vec<Vector3<f64>> =
        sets.iter().map(|set| set.contacts.first().map_or(direction, |of| of.rotation * direction)).collect();
    let (apart, axes) = (beside_mean(sets, &fit.centres), beside_mean(sets, &axes));
    let spread = axes.iter().map(Vector3::norm_squared).sum::<f64>();
    let longer = apart.iter().zip(&axes).map(|(a, b)| a.dot(b)).sum::<f64>() / spread;
    let corrected: Vec<Vector3<f64>> = apart.iter().zip(&axes).map(|(a, b)| a - b * longer).collect();
    let left = scatter(sets, &corrected);
    if spread > MIN_AXIS_SPREAD * sets.len() as f64 && left < MAX_EXPLAINED_SCATTER * found {
        let word = if longer > 0.0 { "longer" } else { "shorter" };
        let message = format!(
            "with a stylus {} mm {word} than the tool of the machine file a ball is in one place to {}, without to {}",
            significant(longer.abs(), 3),
            length(left),
            length(found)
        );
        let help = "state its length to the middle of the stylus; where all rotary axes turn the table a wrong length \
                    is the same as a height of their lines, and needs a length reference";
        return say(message, help);
    }
    let message = format!("a ball is in one place to {} only", length(found));
    say(message, other)
}
