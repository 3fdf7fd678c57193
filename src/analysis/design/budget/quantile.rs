//! Percentiles of samples, with confidence intervals that suppose nothing of the distribution.

/// Outside of an interval with 95 % confidence, on each side.
pub const TAIL: f64 = 0.025;

/// A percentile of the population the samples come from.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Percentile {
    /// The percentile, in percent.
    pub percent: usize,
    /// The ceil(percent n / 100)-th smallest sample.
    pub value: f64,
    /// Lower end of the interval that holds it with 95 % confidence; `None` with too few samples.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

/// The fraction of a population that has a property, by samples of it.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Proportion {
    /// The fraction of the samples, 0 to 1.
    pub value: f64,
    /// Lower end of its 95 % interval (Wilson).
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Proportion {
    /// The normal number beyond which 2.5 % lie.
    const NORMAL: f64 = 1.959_963_984_540_054;

    /// Returns the fraction of `count` samples, at least one, with Wilson's score interval: it stays within 0 to 1, and
    /// has a width where all samples agree.
    pub fn of(found: usize, count: usize) -> Self {
        let (n, square) = (count as f64, Self::NORMAL * Self::NORMAL);
        let value = found as f64 / n;
        let middle = (value + 0.5 * square / n) / (1.0 + square / n);
        let spread = value * (1.0 - value) / n + 0.25 * square / (n * n);
        let half = Self::NORMAL * spread.sqrt() / (1.0 + square / n);
        Self { value, low: (middle - half).max(0.0), high: (middle + half).min(1.0) }
    }
}

/// Returns the rank (from 1) of a percentile among `count` samples.
pub fn rank(count: usize, percent: usize) -> usize {
    (count * percent).div_ceil(100).max(1)
}

impl Percentile {
    /// Returns a percentile of samples in rising order, at least one. The number of samples below the percentile is
    /// binomially distributed, whatever the distribution: that gives the ranks of the interval's ends.
    pub fn of(sorted: &[f64], percent: usize) -> Self {
        let n = sorted.len();
        let (low, high) = ranks(n, percent, TAIL);
        let at = |rank: usize| rank.checked_sub(1).and_then(|i| sorted.get(i)).copied();
        Self { percent, value: sorted[rank(n, percent) - 1], low: at(low), high: at(high) }
    }
}

/// Returns the ranks (from 1) of the samples between which a percentile is; beyond each end with a probability of at
/// most `tail`. The lower one is 0, the upper one more than `count`, if there are too few samples.
pub fn ranks(count: usize, percent: usize, tail: f64) -> (usize, usize) {
    let below = binomial(count, percent as f64 / 100.0);
    // P(X < low rank) <= tail and P(X >= high rank) <= tail for X samples below the percentile.
    (below.partition_point(|sum| *sum <= tail), below.partition_point(|sum| *sum < 1.0 - tail) + 1)
}

/// Returns the cumulated probabilities of 0, 1, ... n successes of n.
fn binomial(n: usize, p: f64) -> Vec<f64> {
    let odds = libm::log(p / (1.0 - p));
    let mut exponent = n as f64 * libm::log1p(-p);
    let mut sum = 0.0;
    (0..=n)
        .map(|k| {
            if k > 0 {
                exponent += odds + libm::log((n + 1 - k) as f64 / k as f64);
            }
            sum += libm::exp(exponent);
            sum
        })
        .collect()
}

/// Returns the mean, and its standard error.
pub fn mean(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
    (mean, if n > 1.0 { (square / (n - 1.0) / n).sqrt() } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_has_the_ranks_of_the_tables() {
        // The sign test's interval for the median of 99: P(X <= 39) = 0.0219, P(X <= 40) = 0.0350.
        let samples: Vec<f64> = (1..=99).map(f64::from).collect();
        let median = Percentile::of(&samples, 50);
        assert_eq!((median.value, median.low, median.high), (50.0, Some(40.0), Some(60.0)));
        // With 50 samples the largest is above the 95 % value only with 1 - 0.95^50 = 92 %.
        let few = Percentile::of(&samples[..50], 95);
        assert!(few.high.is_none() && few.low.is_some());
    }

    #[test]
    fn proportions_have_the_interval_of_wilson() {
        // Newcombe (1998), table I, method 3: 81 of 263, 15 of 148, 0 of 20, 1 of 29.
        for (found, count, low, high) in
            [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)]
        {
            let of = Proportion::of(found, count);
            assert!((of.low - low).abs() < 6e-5 && (of.high - high).abs() < 6e-5, "{found}/{count}: {of:?}");
        }
    }

    #[test]
    fn the_interval_holds_the_percentile_as_often_as_it_says() {
        let mut state = 1_u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut held = 0;
        for _ in 0..2000 {
            let mut samples: Vec<f64> = (0..200).map(|_| unit()).collect();
            samples.sort_by(f64::total_cmp);
            let p = Percentile::of(&samples, 95);
            held += usize::from(p.low.unwrap() <= 0.95 && 0.95 <= p.high.unwrap());
        }
        // At least 95 %, and not much more: the ranks are whole numbers.
        assert!((1880..=1975).contains(&held), "{held}");
    }
}
