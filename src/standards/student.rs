//! Student's distribution: intervals from few readings, and how likely chance makes a deviation.

use std::collections::BTreeMap;

/// From here on it is the normal distribution, to three digits.
const MANY: usize = 1000;

/// Intervals of 95 %, each number of degrees of freedom looked up once.
#[derive(Debug, Default)]
pub(crate) struct Coverage(BTreeMap<usize, f64>);

impl Coverage {
    /// Returns the number of standard uncertainties that 95 % reach to both sides. Between whole degrees of freedom it
    /// is interpolated over their inverses.
    pub fn reach(&mut self, freedom: f64) -> f64 {
        let freedom = freedom.clamp(1.0, MANY as f64);
        let below = freedom as usize;
        let (low, high) = (self.whole(below), self.whole(below + 1));
        let (a, b) = (1.0 / below as f64, 1.0 / (below + 1) as f64);
        high + (low - high) * (1.0 / freedom - b) / (a - b)
    }

    fn whole(&mut self, freedom: usize) -> f64 {
        *self.0.entry(freedom).or_insert_with(|| coverage_95(freedom))
    }
}

/// The number of standard uncertainties that reaches 95 % of Student's distribution, both sides together.
fn coverage_95(freedom: usize) -> f64 {
    let freedom = freedom.clamp(1, MANY);
    let (mut low, mut high) = (1.0, 16.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        *(if within(middle, freedom) < 0.95 { &mut low } else { &mut high }) = middle;
    }
    low
}

/// Probability that chance goes beyond `t` to either side.
pub(super) fn beyond(t: f64, freedom: usize) -> f64 {
    1.0 - within(t.abs(), freedom.clamp(1, MANY))
}

/// Probability of less than `t` to either side: the finite sums of Abramowitz and Stegun, 26.7.3 and 26.7.4.
fn within(t: f64, freedom: usize) -> f64 {
    let angle = libm::atan(t / libm::sqrt(freedom as f64));
    let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
    let odd = freedom % 2 == 1;
    let (mut term, mut sum) = (if odd { cosine } else { 1.0 }, 0.0);
    let first = if odd { 3 } else { 2 };
    for k in (first..=freedom).step_by(2) {
        sum += term;
        term *= cosine * cosine * (k - 1) as f64 / k as f64;
    }
    if odd { (angle + sine * sum) * std::f64::consts::FRAC_2_PI } else { sine * sum }
}

#[cfg(test)]
mod tests {
    use super::{Coverage, beyond, coverage_95};

    /// Percentage points as printed in every table (Abramowitz and Stegun, table 26.10).
    #[test]
    fn it_is_the_table() {
        for (freedom, printed) in
            [(1, 12.706), (2, 4.303), (3, 3.182), (4, 2.776), (5, 2.571), (10, 2.228), (30, 2.042), (120, 1.980)]
        {
            assert!((coverage_95(freedom) - printed).abs() < 6e-4, "{freedom}");
        }
        let mut coverage = Coverage::default();
        assert!((coverage.reach(4.0) - 2.776).abs() < 6e-4 && (2.571..2.776).contains(&coverage.reach(4.5)));
        assert!((coverage_95(1_000_000) - 1.960).abs() < 3e-3);
        // Two-sided 0.1 %: 4.587 of 10 degrees of freedom, 3.646 of 30.
        assert!((beyond(4.587, 10) - 1e-3).abs() < 1e-6 && (beyond(-3.646, 30) - 1e-3).abs() < 1e-6);
    }
}
