//! Circular tests (ISO 230-4): the path of a circle about a ball, in one sense or both.
//!
//! Angles run from the first direction of the plane to the second; deviations are length read minus nominal radius,
//! above zero outwards.

use super::spread::range;
use crate::algebra::linear::Svd;
use crate::machine::sin_cos_degrees;
use nalgebra::{DMatrix, DVector};

/// Singular values of scaled columns below this share of the largest: the readings do not tell two causes apart.
const RANK: f64 = 1e-3;
/// Least arc (deg) on which a centre is found.
pub const LEAST_ARC: f64 = 180.0;
/// Least number of readings: three of them lie on some circle whatever they are.
pub const MIN_READINGS: usize = 4;
/// Positions of a sense from which on gaps of one step leave nothing out.
const MIN_OF_TURN: usize = 12;
/// A turn, deg.
const TURN: f64 = 360.0;

/// Figures of each sense of rotation.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct BothSenses<T> {
    /// With rising angle.
    pub counter_clockwise: T,
    /// With falling angle.
    pub clockwise: T,
}

impl<T> BothSenses<T> {
    /// Returns the figures, counter-clockwise first.
    pub fn new([counter_clockwise, clockwise]: [T; 2]) -> Self {
        Self { counter_clockwise, clockwise }
    }
}

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

    pub(super) fn sign(self) -> f64 {
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
    /// Circular deviation G of each path, about its own centre of least squares, counter-clockwise and clockwise.
    pub deviation: [Option<f64>; 2],
    /// Bidirectional circular deviation G(b); `None` of one sense.
    pub bidirectional: Option<f64>,
    /// Mean bidirectional radial deviation D, about that centre; `None` of one sense.
    pub mean: Option<f64>,
    /// Radial deviations F about the nominal centre, largest and smallest, counter-clockwise and clockwise.
    pub extremes: [Option<[f64; 2]>; 2],
}

impl CircleFigures {
    /// Returns the figures. `None` where the readings of a sense are on less than half a circle, or fewer than the
    /// centre needs.
    pub fn of(readings: &[RadialReading]) -> Option<Self> {
        if readings.len() < MIN_READINGS || arc(readings) < LEAST_ARC {
            return None;
        }
        let fit = fit_centre(readings)?;
        let centred = about_centre(readings, &fit);
        let of = |sense: Sense, values: &[f64]| {
            let mine = readings.iter().zip(values).filter(|(r, _)| r.sense == sense).map(|(_, x)| *x);
            mine.fold(None, |ends: Option<[f64; 2]>, x| Some(ends.map_or([x; 2], |[a, b]| [a.max(x), b.min(x)])))
        };
        let read: Vec<f64> = readings.iter().map(|r| r.deviation).collect();
        let ends = Sense::ALL.map(|sense| of(sense, &centred));
        let own_width = |sense: Sense| {
            let path: Vec<RadialReading> = readings.iter().filter(|r| r.sense == sense).copied().collect();
            let fit = fit_centre(&path).filter(|_| path.len() >= MIN_READINGS)?;
            Some(range(about_centre(&path, &fit).into_iter()))
        };
        Some(Self {
            centre: [fit.values[1], fit.values[2]],
            deviation: Sense::ALL.map(own_width),
            bidirectional: ends[0].zip(ends[1]).map(|(a, b)| a[0].max(b[0]) - a[1].min(b[1])),
            mean: ends[0].and(ends[1]).map(|_| fit.values[0]),
            extremes: Sense::ALL.map(|sense| of(sense, &read)),
            centred,
        })
    }
}

/// Fits a circle: its radius and its centre.
fn fit_centre(readings: &[RadialReading]) -> Option<CircleFit> {
    let rows = DMatrix::from_fn(readings.len(), 3, |i, j| {
        let (sine, cosine) = sin_cos_degrees(readings[i].angle);
        [1.0, cosine, sine][j]
    });
    fit_circle(&rows, readings)
}

/// Returns the readings about the centre of a fit.
fn about_centre(readings: &[RadialReading], fit: &CircleFit) -> Vec<f64> {
    let off = |r: &RadialReading| {
        let (sine, cosine) = sin_cos_degrees(r.angle);
        r.deviation - fit.values[1] * cosine - fit.values[2] * sine
    };
    readings.iter().map(off).collect()
}

/// The arc (deg) on which there are readings of every sense that was read: a turn less the widest gap.
pub fn arc(readings: &[RadialReading]) -> f64 {
    let of = |sense: &Sense| {
        let angles: Vec<f64> = readings.iter().filter(|r| r.sense == *sense).map(|r| r.angle).collect();
        (!angles.is_empty()).then(|| covered_angle(angles))
    };
    Sense::ALL.iter().filter_map(of).reduce(f64::min).unwrap_or(0.0)
}

fn covered_angle(angles: Vec<f64>) -> f64 {
    let mut angles: Vec<f64> = angles.into_iter().map(|angle| angle.rem_euclid(TURN)).collect();
    angles.sort_by(f64::total_cmp);
    angles.dedup();
    let Some(first) = angles.first().copied() else { return 0.0 };
    let next = angles.iter().skip(1).copied().chain([first + TURN]);
    let gap = angles.iter().zip(next).map(|(a, b)| b - a).fold(0.0, f64::max);
    // Even steps round the whole turn leave gaps of one step; of few readings a gap is one.
    let whole = angles.len() >= MIN_OF_TURN && gap <= 2.0 * TURN / angles.len() as f64;
    if whole { TURN } else { TURN - gap }
}

pub(super) struct CircleFit {
    pub values: DVector<f64>,
    /// Root of the covariance of the values, of readings that scatter by 1.
    root: DMatrix<f64>,
    /// Standard deviation of a reading; `None` without readings to spare.
    scatter: Option<f64>,
    /// Root mean square of what it leaves.
    pub rest: f64,
}

impl CircleFit {
    /// Returns the standard uncertainty of a value.
    pub fn sigma(&self, j: usize) -> Option<f64> {
        self.scatter.map(|scatter| scatter * self.root.row(j).norm())
    }

    /// Returns the variance of a combination of the values.
    pub fn variance(&self, of: &DVector<f64>) -> f64 {
        let length = self.scatter.unwrap_or(0.0) * self.root.tr_mul(of).norm();
        length * length
    }
}

pub(super) fn fit_circle(rows: &DMatrix<f64>, readings: &[RadialReading]) -> Option<CircleFit> {
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
    let mut root = svd.root_covariance(unknowns);
    norms.iter().enumerate().for_each(|(j, norm)| root.row_mut(j).unscale_mut(*norm));
    let scatter = (spare > 0).then(|| libm::sqrt(squares / spare as f64));
    Some(CircleFit { values, root, scatter, rest: libm::sqrt(squares / count as f64) })
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Readings of both senses round a circle, by angle (rad) and sense.
    pub fn circle(step: usize, of: impl Fn(f64, Sense) -> f64) -> Vec<RadialReading> {
        let at = |angle: f64, sense| RadialReading { angle, sense, deviation: of(angle.to_radians(), sense) };
        let angles = || (0..360).step_by(step).map(|i| i as f64 + 0.5);
        Sense::ALL.iter().flat_map(|sense| angles().map(|a| at(a, *sense)).collect::<Vec<_>>()).collect()
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

    /// Reversal moves the centre of either path by 3 um apart: G is of the path, G(b) of both.
    #[test]
    fn each_path_has_its_own_centre() {
        let readings = circle(1, |t, sense| 3.0 * sense.sign() * libm::cos(t) + 2.0 * libm::cos(2.0 * t));
        let found = CircleFigures::of(&readings).unwrap();
        for g in found.deviation {
            assert!((g.unwrap() - 4.0).abs() < 2e-3, "{g:?}");
        }
        // 2 cos 2t + 3 cos t is 5 at 0; its least value 2 (2 c^2 - 1) + 3 c at c = -3/8 is -2.5625.
        assert!((found.bidirectional.unwrap() - 7.5625).abs() < 2e-3, "{found:?}");
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
        // One sense round the circle, the other on a part of it.
        let both: Vec<RadialReading> =
            part(0.0, 360.0).into_iter().filter(|r| r.sense == Sense::Clockwise || r.angle < 85.0).collect();
        assert!((arc(&both) - 84.0).abs() < 1e-9 && CircleFigures::of(&both).is_none());
    }

    /// Few readings are on the arc between them, however even they are.
    #[test]
    fn few_readings_are_no_circle() {
        let at = |angles: &[f64]| -> Vec<RadialReading> {
            let of = |angle: &f64| RadialReading { angle: *angle, sense: Sense::CounterClockwise, deviation: 1.0 };
            angles.iter().map(of).collect()
        };
        for (angles, expected) in
            [(&[0.0, 70.0, 140.0][..], 140.0), (&[0.0, 170.0, 175.0], 175.0), (&[0.0, 100.0], 100.0), (&[0.0; 3], 0.0)]
        {
            assert!((arc(&at(angles)) - expected).abs() < 1e-9, "{angles:?}");
            assert!(CircleFigures::of(&at(angles)).is_none());
        }
        let even: Vec<f64> = (0..12).map(|i| f64::from(i) * 30.0).collect();
        assert_eq!(arc(&at(&even)), 360.0);
    }
}
