//! The form of an axis that its error curves leave: a random function of the position in each direction.

use super::{Axis, AxisName, Curve, Direction, Knots, Travel};
use std::f64::consts::TAU;

/// Variance of a wave, as a share of the largest, below which the wave is left out.
const MIN_WAVE_SHARE: f64 = 1e-3;
/// Correlation lengths between the end of an axis and where its waves repeat: values so far apart correlate by 1 %.
const LENGTHS_TO_REPEAT: f64 = 3.0;
/// Knots of a wave to a correlation length: splines through them keep the size to 0.1 %.
const KNOTS_PER_LENGTH: f64 = 6.0;
/// Knots beyond either end, so that no spline ends on the travel.
const KNOTS_BEYOND: usize = 3;

/// The scatter of an axis about its error curves: a Gaussian process of zero mean for each of its displacements and
/// rotations, independent of the others.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualForm {
    /// The axis.
    pub axis: AxisName,
    /// Standard deviations of the displacements along X, Y and Z (mm) and of the rotations about them (rad); 0 of an
    /// error without a form.
    pub sizes: [f64; 6],
    /// Correlation length, mm or deg: values at positions so far apart correlate by exp(-1/2).
    pub length: f64,
}

impl ResidualForm {
    /// Largest travel over the correlation length: the number of waves grows with it.
    pub const MAX_TRAVEL_OVER_LENGTH: f64 = 200.0;

    /// Returns the standard deviation of the error in a direction, mm or rad.
    pub fn scatter(&self, direction: Direction) -> f64 {
        self.sizes[direction.index()]
    }

    /// Returns the root mean square of the sizes of the displacements (mm) or of the rotations (rad).
    pub fn mean_size(&self, is_rotation: bool) -> f64 {
        let sizes = if is_rotation { &self.sizes[3..] } else { &self.sizes[..3] };
        libm::sqrt(sizes.iter().map(|size| size * size).sum::<f64>() / 3.0)
    }

    /// Returns independent modes of the form in a direction, one standard deviation each (mm or rad over mm or deg):
    /// cosines and sines whose squares add up to the square of the size at every position, the longest waves first.
    /// They repeat after a turn, or three lengths beyond the travel.
    pub fn modes(&self, axis: &Axis, direction: Direction) -> Vec<Curve> {
        let size = self.scatter(direction);
        if size == 0.0 {
            return Vec::new();
        }
        let (min, max) = axis.travel.interval();
        let turns = axis.travel == Travel::Continuous;
        let period = if turns { max - min } else { max - min + LENGTHS_TO_REPEAT * self.length };
        let variance = |k: usize| {
            let turned = TAU * k as f64 * self.length / period;
            libm::exp(-0.5 * turned * turned) * if k == 0 { 1.0 } else { 2.0 }
        };
        let variances: Vec<f64> = (0..).map(variance).take_while(|v| *v > MIN_WAVE_SHARE).collect();
        let all: f64 = variances.iter().sum();
        let wave = |k: usize, is_sine: bool| {
            let amount = size * libm::sqrt(variances[k] / all);
            let parts = if is_sine { (0.0, amount) } else { (amount, 0.0) };
            if turns {
                return Some(Curve::Harmonics((0..=k).map(|i| if i == k { parts } else { (0.0, 0.0) }).collect()));
            }
            let step = self.length / KNOTS_PER_LENGTH;
            let count = libm::ceil((max - min) / step) as usize + 2 * KNOTS_BEYOND;
            let point = |i: usize| {
                let q = min + (i as f64 - KNOTS_BEYOND as f64) * step;
                let (sine, cosine) = libm::sincos(TAU * k as f64 * (q - min) / period);
                (q, parts.0 * cosine + parts.1 * sine)
            };
            Knots::new(&(0..=count).map(point).collect::<Vec<_>>(), None).ok().map(Curve::cubic)
        };
        let both = |k: usize| [wave(k, false), (k > 0).then(|| wave(k, true)).flatten()];
        (0..variances.len()).flat_map(both).flatten().collect()
    }
}
