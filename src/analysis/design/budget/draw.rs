//! Random errors that respect their tolerances, the same for every machine and arrangement.
//!
//! A drawn error is its tolerance times `g(Z)` with Z normally distributed, and g bringing Z to the
//! stated distribution on -1..1. A location error draws one Z. A component error draws a curve: Z is a
//! sum of [`HARMONICS`] waves, `w_k (a_k cos k t + b_k sin k t)` with a_k, b_k normal and `w_k^2`
//! proportional to `1/k^2`, so that at every position Z is normal with variance 1 and the error has
//! the stated distribution there. t runs over half a turn along the travel (a whole one on continuous
//! axes, where the curve closes); a mean that repeats a location error is not drawn on purpose. The
//! curve is kept at [`NODES`] positions, straight in between.
//!
//! The numbers of an error depend on the seed, its name and the sample alone: a stream of ChaCha8 each. The name is
//! that in the frame of its axis, so that they are the same whichever way the axis points.

use crate::machine::sin_cos_degrees;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::fmt::Display;
use std::sync::OnceLock;

/// Number of nodes of a curve along the travel, both ends included.
pub const NODES: usize = 65;

/// The same rounded up to whole vectors of any width.
pub(super) const NODE_PLACES: usize = NODES.next_multiple_of(8);

/// A number for each node; the places behind them hold 0.
pub(super) type NodeValues = [f64; NODE_PLACES];

/// Number of waves of a curve.
pub const HARMONICS: usize = 6;

/// Number of Hermite polynomials, all odd, by which the correlation of bounded numbers is found; and the positions of
/// the normal number over which their coefficients are integrated, on one side of 0.
const HERMITE_TERMS: usize = 40;
const HERMITE_STEP: f64 = 1.0 / 64.0;
const HERMITE_STEPS: usize = 64 * 16;

/// The distribution of an error between its bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "snake_case")]
pub enum Distribution {
    /// Uniform: standard deviation tolerance / sqrt 3 (GUM 4.3.7).
    #[default]
    Uniform,
    /// Triangular about 0: standard deviation tolerance / sqrt 6 (GUM 4.3.9).
    Triangular,
}

impl Distribution {
    /// Returns the name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Triangular => "triangular",
        }
    }

    /// Returns a standard normal value as a fraction of the tolerance, -1 to 1.
    pub fn fraction(self, normal: f64) -> f64 {
        self.fraction_of(libm::erf(normal * std::f64::consts::FRAC_1_SQRT_2))
    }

    /// Returns the fraction of the tolerance for a value that is uniform on -1..1.
    pub(super) fn fraction_of(self, even: f64) -> f64 {
        match self {
            Self::Uniform => even,
            Self::Triangular => (1.0 - (1.0 - even.abs()).max(0.0).sqrt()).copysign(even),
        }
    }

    /// Returns the squares of the coefficients of [`Self::fraction`] by Hermite polynomials 1, 3, 5, ..., which add up
    /// to 1: two normal numbers with correlation r lead to numbers with correlation sum of square x r^degree (Mehler).
    fn hermite_squares(self) -> Vec<f64> {
        let mut sums = [0.0; HERMITE_TERMS];
        for i in 1..=HERMITE_STEPS {
            let z = i as f64 * HERMITE_STEP;
            let weighted = self.fraction(z) * libm::exp(-0.5 * z * z);
            // Orthonormal: h_(n+1) = (z h_n - sqrt(n) h_(n-1)) / sqrt(n + 1).
            let (mut before, mut last) = (1.0, z);
            for (k, sum) in sums.iter_mut().enumerate() {
                *sum += weighted * last;
                for n in [2 * k + 1, 2 * k + 2] {
                    let next = (z * last - (n as f64).sqrt() * before) / ((n + 1) as f64).sqrt();
                    (before, last) = (last, next);
                }
            }
        }
        let squares = sums.map(|sum| sum * sum);
        let total: f64 = squares.iter().sum();
        squares.map(|square| square / total).to_vec()
    }

    /// Returns the standard deviation as a fraction of the tolerance.
    pub fn deviation(self) -> f64 {
        match self {
            Self::Uniform => (1.0_f64 / 3.0).sqrt(),
            Self::Triangular => (1.0_f64 / 6.0).sqrt(),
        }
    }
}

/// The generator of random errors.
#[derive(Debug, Clone)]
pub struct Draws {
    seed: u64,
    distribution: Distribution,
    /// Weighted cosine and sine of every wave at every node: open curves, closed curves.
    waves: [Vec<[(f64, f64); HARMONICS]>; 2],
    /// Correlations of the values of a curve at two nodes, made at first use.
    correlations: [OnceLock<Vec<NodeValues>>; 2],
}

impl Draws {
    /// Returns the generator with a seed.
    pub fn new(seed: u64, distribution: Distribution) -> Self {
        let norm: f64 = (1..=HARMONICS).map(|k| 1.0 / (k * k) as f64).sum::<f64>().sqrt();
        let node = |turn: f64, m: usize| {
            std::array::from_fn(|i| {
                let k = (i + 1) as f64;
                let (sine, cosine) = sin_cos_degrees(k * turn * (m as f64 / (NODES - 1) as f64));
                (cosine / (k * norm), sine / (k * norm))
            })
        };
        let waves = [180.0, 360.0].map(|turn| (0..NODES).map(|m| node(turn, m)).collect());
        Self { seed, distribution, waves, correlations: Default::default() }
    }

    /// Returns the correlations of the values of a curve at any two nodes.
    pub(super) fn correlations(&self, closed: bool) -> &[NodeValues] {
        let make = || {
            let waves = &self.waves[usize::from(closed)];
            let series = self.distribution.hermite_squares();
            let of = |n: usize, m: usize| {
                let pairs = waves[n].iter().zip(&waves[m]);
                let normal: f64 = pairs.map(|((c, s), (d, t))| c * d + s * t).sum();
                // Odd powers: the numbers lie evenly about 0.
                series.iter().rev().fold(0.0, |sum, square| sum * normal * normal + square) * normal
            };
            let row = |n: usize| std::array::from_fn(|m| if m < NODES { of(n, m) } else { 0.0 });
            (0..NODES).map(row).collect()
        };
        self.correlations[usize::from(closed)].get_or_init(make)
    }

    /// Returns the distribution of the errors.
    pub fn distribution(&self) -> Distribution {
        self.distribution
    }

    /// Returns the weighted cosine and sine of every wave at every node.
    pub(super) fn waves(&self, closed: bool) -> &[[(f64, f64); HARMONICS]] {
        &self.waves[usize::from(closed)]
    }

    fn key(&self, error: &impl Display) -> [u8; 32] {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&self.seed.to_le_bytes());
        // A name has twelve bytes at most.
        error.to_string().bytes().zip(&mut key[8..]).for_each(|(byte, slot)| *slot = byte);
        key
    }

    /// Returns a location error of a sample, as a fraction of its tolerance.
    pub fn constant(&self, error: &impl Display, sample: usize) -> f64 {
        self.constants::<1>(error, sample)[0]
    }

    /// Returns a location error of samples `first..first + N`, as fractions of its tolerance.
    pub fn constants<const N: usize>(&self, error: &impl Display, first: usize) -> [f64; N] {
        let key = self.key(error);
        std::array::from_fn(|i| self.distribution.fraction(Normals::of_error(key, first + i).next()))
    }

    /// Returns the amplitudes of cosine and sine of the waves of samples `first..first + N`.
    pub(super) fn amplitudes<const N: usize>(&self, error: &impl Display, first: usize) -> [[[f64; N]; 2]; HARMONICS] {
        let key = self.key(error);
        let mut amplitudes = [[[0.0; N]; 2]; HARMONICS];
        for sample in 0..N {
            let mut normals = Normals::of_error(key, first + sample);
            amplitudes.iter_mut().flatten().for_each(|lanes| lanes[sample] = normals.next());
        }
        amplitudes
    }

    /// Returns a component error of a sample at the nodes, as fractions of its tolerance.
    pub fn curve(&self, error: &impl Display, sample: usize, closed: bool) -> [f64; NODES] {
        let mut normals = Normals::of_error(self.key(error), sample);
        let amplitudes: [(f64, f64); HARMONICS] = std::array::from_fn(|_| (normals.next(), normals.next()));
        let waves = self.waves(closed);
        std::array::from_fn(|m| {
            let wave = |((c, s), (a, b)): (&(f64, f64), &(f64, f64))| c * a + s * b;
            self.distribution.fraction(waves[m].iter().zip(&amplitudes).map(wave).sum())
        })
    }
}

/// Normally distributed numbers, by the method of Box and Muller.
pub(crate) struct Normals {
    generator: ChaCha8Rng,
    second: Option<f64>,
}

impl Normals {
    /// Returns the numbers of a sample, which depend on the seed and on nothing else.
    pub fn new(seed: u64, sample: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(sample);
        Self { generator, second: None }
    }

    /// Returns the numbers of a sample of an error.
    fn of_error(key: [u8; 32], sample: usize) -> Self {
        let mut generator = ChaCha8Rng::from_seed(key);
        generator.set_stream(sample as u64);
        Self { generator, second: None }
    }

    /// Returns a number uniform in (0, 1], with 53 bits.
    fn unit(&mut self) -> f64 {
        const SCALE: f64 = 1.0 / (1_u64 << 53) as f64;
        ((self.generator.next_u64() >> 11) + 1) as f64 * SCALE
    }

    /// Returns the next number.
    pub fn next(&mut self) -> f64 {
        if let Some(second) = self.second.take() {
            return second;
        }
        let radius = (-2.0 * libm::log(self.unit())).sqrt();
        let (sine, cosine) = libm::sincos(2.0 * std::f64::consts::PI * self.unit());
        self.second = Some(radius * sine);
        radius * cosine
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::{AxisName, Direction, ErrorFamily, ErrorId};

    fn error(name: &str, family: ErrorFamily) -> ErrorId {
        ErrorId { axis: AxisName::new(name).unwrap(), family, direction: Direction::Y }
    }

    #[test]
    fn curves_keep_their_bounds_close_where_they_should_and_are_smooth() {
        let draws = Draws::new(3, Distribution::Uniform);
        for sample in 0..300 {
            for closed in [false, true] {
                let curve = draws.curve(&error("X", ErrorFamily::Component), sample, closed);
                assert!(curve.iter().all(|u| u.abs() <= 1.0));
                let step = curve.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
                // Six standard deviations of the steepest slope: F' <= 0.8, Z' 2.0 per rad.
                let limit = 6.0 * 0.8 * 2.0 * std::f64::consts::PI / 64.0 * if closed { 2.0 } else { 1.0 };
                assert!(step < limit, "{step}");
                assert!(!closed || (curve[0] - curve[NODES - 1]).abs() < 1e-12);
            }
        }
    }

    /// Largest distance of the empirical distribution from a continuous one.
    fn kolmogorov(mut values: Vec<f64>, cdf: impl Fn(f64) -> f64) -> f64 {
        values.sort_by(f64::total_cmp);
        let n = values.len() as f64;
        let gap = |(i, x): (usize, &f64)| (cdf(*x) - i as f64 / n).abs().max((cdf(*x) - (i + 1) as f64 / n).abs());
        values.iter().enumerate().map(gap).fold(0.0, f64::max)
    }

    #[test]
    fn every_node_has_the_stated_distribution() {
        // 1.95 / sqrt n is passed by chance once in a thousand times; the seed is fixed.
        const SAMPLES: usize = 4000;
        let limit = 1.95 / (SAMPLES as f64).sqrt();
        let triangular = |x: f64| if x < 0.0 { (1.0 + x) * (1.0 + x) / 2.0 } else { 1.0 - (1.0 - x) * (1.0 - x) / 2.0 };
        let even = |x: f64| (1.0 + x) / 2.0;
        let laws: [(Distribution, &dyn Fn(f64) -> f64); 2] =
            [(Distribution::Uniform, &even), (Distribution::Triangular, &triangular)];
        for (distribution, law) in laws {
            let draws = Draws::new(11, distribution);
            let constants = draws.constants::<SAMPLES>(&error("C", ErrorFamily::Location), 0).to_vec();
            assert!(kolmogorov(constants, law) < limit);
            for (closed, node) in [(false, 0), (false, 32), (false, 64), (true, 17)] {
                let values =
                    (0..SAMPLES).map(|s| draws.curve(&error("X", ErrorFamily::Component), s, closed)[node]).collect();
                let distance = kolmogorov(values, law);
                assert!(distance < limit, "{distribution:?} {closed} {node}: {distance}");
            }
        }
    }
}
