//! Circular tests (ISO 230-4): the path of a circle about a ball, in one sense or both.
//!
//! Angles run from the first direction of the plane to the second; deviations are length read minus nominal radius,
//! above zero outwards.

use crate::algebra::linear::Svd;
use crate::machine::sin_cos_degrees;
use nalgebra::{DMatrix, DVector};

/// Singular values of scaled columns below this share of the largest: the readings do not tell two causes apart.
const RANK: f64 = 1e-3;
/// Least arc (deg) on which a centre is found.
pub const LEAST_ARC: f64 = 180.0;

/// The sense of rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sense {
    /// With rising angle.
    CounterClockwise,
    /// With falling angle.
    Clockwise,
}

impl Sense {
    /// Both.
    pub const ALL: [Self; 2] = [Self::CounterClockwise, Self::Clockwise];

    fn sign(self) -> f64 {
        if self == Self::CounterClockwise { 1.0 } else { -1.0 }
    }
}

/// One reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RadialReading {
    /// Angle, deg.
    pub angle: f64,
    /// The sense in which it was read.
    pub sense: Sense,
    /// Length read minus nominal radius, um.
    pub deviation: f64,
}

/// Figures of a circle, um.
#[derive(Debug, Clone, PartialEq)]
pub struct CircleFigures {
    /// Centre of least squares of all readings, along both directions of the plane, from the nominal one.
    pub centre: [f64; 2],
    /// Readings about that centre and the nominal radius, in the order of the readings.
    pub centred: Vec<f64>,
    /// Circular deviation G about that centre, counter-clockwise and clockwise.
    pub deviation: [Option<f64>; 2],
    /// Bidirectional circular deviation G(b); `None` of one sense.
    pub bidirectional: Option<f64>,
    /// Mean bidirectional radial deviation D, about that centre; `None` of one sense.
    pub mean: Option<f64>,
    /// Radial deviations F about the nominal centre, largest and smallest, counter-clockwise and clockwise.
    pub extremes: [Option<[f64; 2]>; 2],
}

impl CircleFigures {
    /// Returns the figures. `None` where the readings are on less than half a circle, or fewer than the centre needs.
    pub fn of(readings: &[RadialReading]) -> Option<Self> {
        if readings.len() < 3 || arc(readings) < LEAST_ARC {
            return None;
        }
        let rows = DMatrix::from_fn(readings.len(), 3, |i, j| {
            let (sine, cosine) = sin_cos_degrees(readings[i].angle);
            [1.0, cosine, sine][j]
        });
        let fit = fitted(&rows, readings)?;
        let off = |r: &RadialReading| {
            let (sine, cosine) = sin_cos_degrees(r.angle);
            r.deviation - fit.values[1] * cosine - fit.values[2] * sine
        };
        let centred: Vec<f64> = readings.iter().map(off).collect();
        let of = |sense: Sense, values: &[f64]| {
            let mine = readings.iter().zip(values).filter(|(r, _)| r.sense == sense).map(|(_, x)| *x);
            mine.fold(None, |ends: Option<[f64; 2]>, x| Some(ends.map_or([x; 2], |[a, b]| [a.max(x), b.min(x)])))
        };
        let read: Vec<f64> = readings.iter().map(|r| r.deviation).collect();
        let ends = Sense::ALL.map(|sense| of(sense, &centred));
        let width = |ends: [f64; 2]| ends[0] - ends[1];
        Some(Self {
            centre: [fit.values[1], fit.values[2]],
            deviation: ends.map(|ends| ends.map(width)),
            bidirectional: ends[0].zip(ends[1]).map(|(a, b)| a[0].max(b[0]) - a[1].min(b[1])),
            mean: ends[0].and(ends[1]).map(|_| fit.values[0]),
            extremes: Sense::ALL.map(|sense| of(sense, &read)),
            centred,
        })
    }
}

/// The arc (deg) on which there are readings: a turn less the widest gap.
pub fn arc(readings: &[RadialReading]) -> f64 {
    let mut angles: Vec<f64> = readings.iter().map(|r| r.angle.rem_euclid(360.0)).collect();
    angles.sort_by(f64::total_cmp);
    angles.dedup();
    let Some(first) = angles.first().copied() else { return 0.0 };
    let next = angles.iter().skip(1).copied().chain([first + 360.0]);
    let gap = angles.iter().zip(next).map(|(a, b)| b - a).fold(0.0, f64::max);
    let usual = 360.0 / angles.len() as f64;
    // Even steps round the whole turn leave gaps of one step.
    if gap <= 2.0 * usual { 360.0 } else { 360.0 - gap }
}

/// A value with its standard uncertainty by the scatter that the causes leave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Caused {
    /// The value.
    pub value: f64,
    /// Standard uncertainty, type A; `None` without readings to spare.
    pub sigma: Option<f64>,
}

/// A circle taken apart into causes.
#[derive(Debug, Clone, PartialEq)]
pub struct CircleCauses {
    /// Angle between the directions of the plane minus 90 deg, urad. Of one sense servo mismatch is in it.
    pub squareness: Caused,
    /// Scale of the first direction minus scale of the second, um/m.
    pub scale_mismatch: Caused,
    /// Half the difference of counter-clockwise and clockwise at 45 deg, um: above zero the first axis lags more.
    /// `None` of one sense.
    pub servo: Option<Caused>,
    /// Reversal of both axes, um, signed as ISO 230-2 signs it: below zero is lost motion.
    pub reversal: [Caused; 2],
    /// Root mean square of what the causes leave, um.
    pub rest: f64,
}

/// Returns the causes of a circle of a nominal radius (mm). `None` where the readings do not tell them apart.
pub fn causes(readings: &[RadialReading], radius: f64) -> Option<CircleCauses> {
    let both = Sense::ALL.iter().all(|sense| readings.iter().any(|r| r.sense == *sense));
    let count = if both { 8 } else { 7 };
    let effects = readings.iter().flat_map(|reading| effects(reading, radius).into_iter().take(count));
    let rows = DMatrix::from_row_iterator(readings.len(), count, effects);
    let fit = fitted(&rows, readings)?;
    let caused = |j: usize| Caused { value: fit.values[j], sigma: fit.sigmas.as_ref().map(|s| s[j]) };
    Some(CircleCauses {
        squareness: caused(3),
        scale_mismatch: caused(4),
        reversal: [caused(5), caused(6)],
        servo: both.then(|| caused(7)),
        rest: fit.rest,
    })
}

/// Radial effects (um) of a unit of each cause: radius and centre, squareness (urad), scale (um/m), both reversals
/// and the servo mismatch (um).
fn effects(reading: &RadialReading, radius: f64) -> [f64; 8] {
    let (sine, cosine) = sin_cos_degrees(reading.angle);
    let (sine_2, cosine_2) = sin_cos_degrees(2.0 * reading.angle);
    let sense = reading.sense.sign();
    let half = 0.5e-3 * radius;
    // An axis that moves up is half its reversal above the middle.
    let up = |speed: f64| if speed == 0.0 { 0.0 } else { 0.5 * speed.signum() };
    let reversals = [cosine * up(-sense * sine), sine * up(sense * cosine)];
    [1.0, cosine, sine, -half * sine_2, half * cosine_2, reversals[0], reversals[1], sense * sine_2]
}

/// A fit of least squares.
struct Fitted {
    values: DVector<f64>,
    sigmas: Option<Vec<f64>>,
    /// Root mean square of what it leaves.
    rest: f64,
}

fn fitted(rows: &DMatrix<f64>, readings: &[RadialReading]) -> Option<Fitted> {
    let (count, unknowns) = rows.shape();
    let right = DVector::from_iterator(count, readings.iter().map(|r| r.deviation));
    let norms: Vec<f64> = rows.column_iter().map(|column| column.norm()).collect();
    if count < unknowns || norms.contains(&0.0) {
        return None;
    }
    let svd = Svd::new(&DMatrix::from_fn(count, unknowns, |i, j| rows[(i, j)] / norms[j]));
    if svd.rank(RANK) < unknowns {
        return None;
    }
    let scaled = svd.solve(&right, unknowns);
    let values = DVector::from_fn(unknowns, |j, _| scaled[j] / norms[j]);
    let squares = (&right - rows * &values).norm_squared();
    let spare = count - unknowns;
    let root = svd.root_covariance(unknowns);
    let sigma = |j: usize| root.row(j).norm() / norms[j] * libm::sqrt(squares / spare as f64);
    let sigmas = (spare > 0).then(|| (0..unknowns).map(sigma).collect());
    Some(Fitted { values, sigmas, rest: libm::sqrt(squares / count as f64) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(step: usize, of: impl Fn(f64, Sense) -> f64) -> Vec<RadialReading> {
        let at = |angle: f64, sense| RadialReading { angle, sense, deviation: of(angle.to_radians(), sense) };
        let angles = || (0..360).step_by(step).map(|i| i as f64 + 0.5);
        Sense::ALL.iter().flat_map(|sense| angles().map(|a| at(a, *sense)).collect::<Vec<_>>()).collect()
    }

    /// Each cause by a machine that has it: the path itself, not its first order.
    #[test]
    fn causes_are_told_apart() {
        let (radius, square, scale, lag, lost) = (100.0, 50e-6, 30e-6, 2e-3, [4e-3, 7e-3]);
        let readings = circle(5, |t, sense| {
            let s = sense.sign();
            // The first axis lags by 2 um of path more than the second; each axis falls short by half its lost motion.
            let (dx, dy) = (-libm::sin(t) * s, libm::cos(t) * s);
            let x = radius * libm::cos(t) * (1.0 + scale) - 0.5 * lost[0] * dx.signum() - lag * dx;
            let y = radius * libm::sin(t) - 0.5 * lost[1] * dy.signum();
            // An angle above 90 deg leans the second direction against the first.
            (libm::hypot(x - square * y, y) - radius) * 1e3 + 3.0 * libm::cos(t) - 1.0 * libm::sin(t)
        });
        let found = causes(&readings, radius).unwrap();
        let near =
            |found: Caused, expected: f64| assert!((found.value - expected).abs() < 0.02, "{found:?} {expected}");
        near(found.squareness, 50.0);
        near(found.scale_mismatch, 30.0);
        near(found.reversal[0], -4.0);
        near(found.reversal[1], -7.0);
        // Half the lag difference, outwards at 45 deg.
        near(found.servo.unwrap(), 1.0);
        assert!(found.rest < 0.01, "{}", found.rest);
    }

    /// 50 urad at 100 mm are 2.5 um inwards at 45 deg and outwards at 135 deg: G = c R.
    #[test]
    fn figures_of_a_squareness() {
        let readings = circle(1, |t, _| {
            (libm::hypot(100.0 * libm::cos(t) - 50e-6 * 100.0 * libm::sin(t), 100.0 * libm::sin(t)) - 100.0) * 1e3 + 2.0
        });
        let found = CircleFigures::of(&readings).unwrap();
        for g in [found.deviation[0], found.deviation[1], found.bidirectional] {
            assert!((g.unwrap() - 5.0).abs() < 2e-3, "{g:?}");
        }
        assert!((found.mean.unwrap() - 2.0).abs() < 1e-3);
        let [high, low] = found.extremes[0].unwrap();
        assert!((high - 4.5).abs() < 2e-3 && (low + 0.5).abs() < 2e-3, "{high} {low}");
    }

    /// On an arc sines and cosines are not orthogonal: the centre is that of least squares all the same.
    #[test]
    fn arcs_have_their_centre() {
        let part = |from: f64, to: f64| -> Vec<RadialReading> {
            let all = circle(2, |t, _| 3.0 * libm::cos(t) - 5.0 * libm::sin(t) + 1.0);
            all.into_iter().filter(|r| (from..=to).contains(&r.angle)).collect()
        };
        let found = CircleFigures::of(&part(0.0, 221.0)).unwrap();
        assert!((found.centre[0] - 3.0).abs() < 1e-9 && (found.centre[1] + 5.0).abs() < 1e-9);
        assert!(found.bidirectional.unwrap() < 1e-9 && (found.mean.unwrap() - 1.0).abs() < 1e-9);
        assert_eq!(CircleFigures::of(&part(0.0, 120.0)), None);
        assert!((arc(&part(0.0, 220.0)) - 218.0).abs() < 1e-9);
    }
}
