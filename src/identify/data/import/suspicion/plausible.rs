//! Readings that no axis has: a slope, a range or a scatter of another unit, and more from below than from above.

use super::finding::{ACCEPT, Finding, FindingEffect, FindingKind};
use super::repeats::{Repeats, least};
use crate::identify::data::import::sample::Import;
use crate::identify::data::import::unit::own_error;
use crate::identify::thresholds::{
    MAX_AXIS_ANGLE, MAX_AXIS_SLOPE, MIN_AXIS_LENGTH_MM, MIN_AXIS_RANGE, MIN_AXIS_RISE, MIN_AXIS_SIGMA,
    MIN_EXCHANGED_REVERSAL_MM, MIN_EXCHANGED_SHARE, MIN_JUDGED_TARGETS, MIN_WRITTEN_SIGMA, UNLIKELY_AXIS_ANGLE,
    UNLIKELY_AXIS_SLOPE,
};
use crate::standards::{AccuracyFigures, TargetReadings};
use crate::units::significant;

/// Judges the readings of an error as a whole; `sigma` is the scatter of one reading, where there are repeats.
pub(super) fn judge(import: &Import, error: usize, repeats: &Repeats, sigma: Option<f64>) -> Vec<Finding> {
    let Some(figures) = import.figures(error).filter(|_| repeats.targets.len() > 1) else { return Vec::new() };
    let unit = unit(import, error, &figures, sigma).map(|(message, effect)| {
        let help = format!(
            "compare the unit in the titles of readings and positions with the instrument's, and the two columns with \
             each other{}",
            if effect == FindingEffect::Refused { format!("; {ACCEPT}") } else { String::new() }
        );
        finding(import, error, repeats, FindingKind::Unit, message, help, effect)
    });
    unit.into_iter().chain(reversal(import, error, repeats, &figures)).collect()
}

fn finding(
    import: &Import,
    error: usize,
    repeats: &Repeats,
    kind: FindingKind,
    message: String,
    help: String,
    effect: FindingEffect,
) -> Finding {
    let first = repeats.readings.first().map(|reading| import.samples[reading.sample].place.clone());
    Finding { kind, error: Some(error), places: first.into_iter().collect(), message, help, effect }
}

/// Says why the readings cannot be in their unit, or are not likely to be.
fn unit(
    import: &Import,
    error: usize,
    figures: &AccuracyFigures,
    sigma: Option<f64>,
) -> Option<(String, FindingEffect)> {
    let (name, rotation) = (&import.errors[error], import.errors[error].direction.is_rotation());
    let (factor, micro) = name.direction.micro();
    let points = figures.middle();
    let length = points.last()?.0 - points.first()?.0;
    let range = figures.systematic;
    let shown = |value: f64| format!("{} {micro}", significant(value * factor, 3));
    let over = format!("over {} {}", significant(length, 4), if import.rotary { "deg" } else { "mm" });
    if rotation {
        let effect = if range > MAX_AXIS_ANGLE { FindingEffect::Refused } else { FindingEffect::Used };
        let message = format!("`{name}` turns by {} {over}, more than axes do", shown(range));
        return (range > UNLIKELY_AXIS_ANGLE).then_some((message, effect));
    }
    if import.rotary {
        return None;
    }
    let slope = if import.is_positioning(error) { figures.slope.abs() } else { range / length };
    let per_metre = || format!("{} um/m", significant(slope * 1e6, 3));
    if slope > MAX_AXIS_SLOPE && slope * length > MIN_AXIS_RISE {
        let (message, limit) = (per_metre(), significant(MAX_AXIS_SLOPE * 1e6, 3));
        return Some((
            format!("`{name}` has {message} {over}; no screw has more than {limit} um/m"),
            FindingEffect::Refused,
        ));
    }
    let unlikely = if length < MIN_AXIS_LENGTH_MM { MAX_AXIS_SLOPE } else { UNLIKELY_AXIS_SLOPE };
    let rises = length < MIN_AXIS_LENGTH_MM || slope * length > MIN_AXIS_RISE;
    if slope > unlikely && rises && figures.targets.len() >= MIN_JUDGED_TARGETS {
        let message =
            format!("`{name}` has {} {over}, more than a ball screw of grade 7 that is 20 K warm", per_metre());
        return Some((message, FindingEffect::Used));
    }
    let long = length >= MIN_AXIS_LENGTH_MM * 10.0;
    let all = import.samples.iter().filter(|sample| sample.error == error).map(|sample| sample.value);
    let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if long && high > low && high - low < MIN_AXIS_RANGE * length {
        let message =
            format!("all readings of `{name}` are within {} {over}: no instrument is that exact", shown(high - low));
        return Some((message, FindingEffect::Refused));
    }
    let fine = sigma.filter(|sigma| long && (MIN_WRITTEN_SIGMA..MIN_AXIS_SIGMA).contains(sigma));
    fine.map(|sigma| {
        let message = format!("readings of `{name}` repeat to {}: no instrument in air does", shown(sigma));
        (message, FindingEffect::Refused)
    })
}

/// Remarks on a position that reads more from below than from above: lost motion stops an axis short.
fn reversal(import: &Import, error: usize, repeats: &Repeats, figures: &AccuracyFigures) -> Option<Finding> {
    let own = own_error(&import.axis)? == import.errors[error];
    let mean = figures.mean_reversal.filter(|_| own && figures.targets.len() >= MIN_JUDGED_TARGETS)?;
    let reversals = || figures.targets.iter().filter_map(TargetReadings::reversal);
    let share = reversals().filter(|b| *b > 0.0).count() as f64 / reversals().count().max(1) as f64;
    if mean <= least(&import.errors[error], MIN_EXCHANGED_REVERSAL_MM) || share < MIN_EXCHANGED_SHARE {
        return None;
    }
    let (factor, micro) = import.errors[error].direction.micro();
    let message = format!(
        "`{}` reads {} {micro} more from below than from above; lost motion reads less: the directions are exchanged, \
         or the values are corrections",
        import.errors[error],
        significant(mean * factor, 3)
    );
    let help =
        "exchange the titles of the directions, or say `--holds corrections`; a control that compensates backlash \
                too much reads so, too"
            .to_owned();
    Some(finding(import, error, repeats, FindingKind::DirectionsExchanged, message, help, FindingEffect::Used))
}
