//! Tests whether residuals are noise: three on which a calibration engineer can act, per kind of row and component, in
//! the order of measurement.

use crate::identify::data::{Measurement, ReadingKind, TurnKind};
use crate::identify::thresholds::{MIN_SCATTER_MM, MIN_TESTED_RESIDUALS};
use nalgebra::Vector3;
use serde::Serialize;

/// Tests of residuals for randomness; the probabilities hold if the residuals are noise.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ResidualTest {
    /// Readings tested.
    pub of: String,
    /// Number of residuals.
    pub count: usize,
    /// Probability of residuals so far from a normal distribution.
    pub normality: f64,
    /// Probability of so few or so many runs of one sign.
    pub runs: f64,
    /// Correlation of a residual with the one before it.
    pub lag1: f64,
}

fn name(kind: ReadingKind, component: usize) -> String {
    let index = component.min(2);
    let component = ["dx", "dy", "dz"][index];
    match kind {
        ReadingKind::Deviation => component.to_owned(),
        ReadingKind::Relative => format!("rel.{component}"),
        ReadingKind::Position => format!("tracker.{}", &component[1..]),
        ReadingKind::Turn(TurnKind::Rotation) => ["da", "db", "dc"][index].to_owned(),
        ReadingKind::Turn(TurnKind::Axis) => format!("axis.{}", &component[1..]),
        ReadingKind::Turn(of) => format!("{}.{}", of.label(), ["a", "b", "c"][index]),
        kind => kind.word().to_owned(),
    }
}

/// Tests every component that has enough residuals.
pub fn randomness(data: &[Measurement], residuals: &[Vector3<f64>], weights: &[f64]) -> Vec<ResidualTest> {
    let mut groups: std::collections::BTreeMap<(ReadingKind, usize), Vec<f64>> = std::collections::BTreeMap::new();
    for ((m, r), w) in data.iter().zip(residuals).zip(weights) {
        for k in (0..3).filter(|k| m.reading_mask()[*k]) {
            groups.entry((m.kind(), k)).or_default().push(r[k] * libm::sqrt(*w));
        }
    }
    let test = |((kind, component), values): ((ReadingKind, usize), Vec<f64>)| {
        let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
        // Residuals of rounding are not noise.
        (values.len() >= MIN_TESTED_RESIDUALS && high - low > MIN_SCATTER_MM).then(|| ResidualTest {
            of: name(kind, component),
            count: values.len(),
            normality: normality(&values),
            runs: runs(&values),
            lag1: lag1(&values),
        })
    };
    groups.into_iter().filter_map(test).collect()
}

/// Returns the mean and the central moments 2 to 4.
fn moments(values: &[f64]) -> (f64, [f64; 3]) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let moment = |k: usize| values.iter().map(|v| (0..k).fold(1.0, |p, _| p * (v - mean))).sum::<f64>() / n;
    (mean, [moment(2), moment(3), moment(4)])
}

/// Returns the probability of the Jarque-Bera (1980) statistic `n/6 (skewness^2 + excess^2 / 4)`, chi-squared of two
/// degrees.
fn normality(values: &[f64]) -> f64 {
    let (_, [second, third, fourth]) = moments(values);
    let (skewness, excess) = (third / (second * libm::sqrt(second)), fourth / (second * second) - 3.0);
    let statistic = values.len() as f64 / 6.0 * (skewness * skewness + excess * excess / 4.0);
    libm::exp(-statistic / 2.0)
}

/// Returns the probability of the number of runs of one sign (Wald and Wolfowitz 1940), normal about `2 a b / n + 1`
/// for a and b of each sign.
fn runs(values: &[f64]) -> f64 {
    let signs: Vec<bool> = values.iter().map(|v| *v > 0.0).collect();
    let above = signs.iter().filter(|s| **s).count() as f64;
    let (n, below) = (signs.len() as f64, signs.len() as f64 - above);
    let product = 2.0 * above * below;
    if product <= n {
        return 0.0;
    }
    let found = 1.0 + signs.windows(2).filter(|w| w[0] != w[1]).count() as f64;
    let variance = product * (product - n) / (n * n * (n - 1.0));
    both_tails((found - (product / n + 1.0)) / libm::sqrt(variance))
}

/// Returns the probability that a standard normal number is as far from 0 as this.
pub(crate) fn both_tails(z: f64) -> f64 {
    libm::erfc(z.abs() / std::f64::consts::SQRT_2)
}

/// Returns the autocorrelation at lag 1.
fn lag1(values: &[f64]) -> f64 {
    let (mean, [variance, ..]) = moments(values);
    let sum: f64 = values.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum();
    sum / (values.len() as f64 * variance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drift_and_outliers_are_told_from_noise() {
        // Twelve even draws added up are normal, near enough; splitmix64 (Steele, Lea and Flood 2014) draws them.
        let mut state = 1_u64;
        let mut even = || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
        };
        let noise: Vec<f64> = (0..300).map(|_| (0..12).map(|_| even()).sum::<f64>() - 6.0).collect();
        assert!(normality(&noise) > 0.01 && runs(&noise) > 0.01 && lag1(&noise).abs() < 0.15);
        let drift: Vec<f64> = noise.iter().enumerate().map(|(i, v)| v + i as f64 / 75.0 - 2.0).collect();
        assert!(runs(&drift) < 1e-6 && lag1(&drift) > 0.4);
        let mut bumped = noise;
        bumped[7] = 12.0;
        assert!(normality(&bumped) < 1e-6);
    }
}
