//! The straight line in a straightness: how the instrument's line of reference lay to the axis. It is no error of the
//! machine unless that line was an artefact of the machine.

use super::channels::axis_direction;
use super::options::StraightnessLine;
use super::sample::{Import, ReferenceLine};
use crate::machine::ErrorId;

/// Looks for the lines in straightness errors of linear axes, and takes them off unless they are kept.
pub(super) fn straighten(import: &mut Import, rule: StraightnessLine, keep: bool) {
    if import.rotary {
        return;
    }
    for error in 0..import.errors.len() {
        let points = import.figures(error).map(|figures| figures.middle()).unwrap_or_default();
        let (Some(first), Some(last)) = (points.first(), points.last()) else { continue };
        if !is_straightness(&import.errors[error]) || first.0 == last.0 {
            continue;
        }
        let (slope, offset) = line(&points, rule);
        if !keep {
            let samples = import.samples.iter_mut().filter(|sample| sample.error == error);
            samples.for_each(|sample| sample.value -= offset + slope * sample.position);
        }
        let length = last.0 - first.0;
        import.lines.push(ReferenceLine { error, slope, rise: slope * length, length, taken_off: !keep });
    }
}

/// True for the two translations across the motion of an axis.
fn is_straightness(error: &ErrorId) -> bool {
    let along = axis_direction(&error.axis);
    !error.direction.is_rotation() && along.is_some_and(|along| along != error.direction.index())
}

/// Returns slope and value at 0.
pub(super) fn line(points: &[(f64, f64)], rule: StraightnessLine) -> (f64, f64) {
    let n = points.len() as f64;
    let (x, y) = match rule {
        StraightnessLine::LeastSquares => {
            (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n)
        }
        StraightnessLine::EndPoints => points[0],
    };
    let slope = match rule {
        StraightnessLine::LeastSquares => {
            let square: f64 = points.iter().map(|p| (p.0 - x) * (p.0 - x)).sum();
            points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / square
        }
        StraightnessLine::EndPoints => {
            let last = points[points.len() - 1];
            (last.1 - y) / (last.0 - x)
        }
    };
    (slope, y - slope * x)
}
