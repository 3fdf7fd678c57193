//! Two machines with the same drawn errors: the difference of their 95 % values, by order statistics.
//!
//! Nothing is supposed of the distributions. Let t be the 95 % value of machine b. If that of a is not larger, a
//! exceeds t with a probability of at most 5 %, which is that of b. So of the samples in which one of the two exceeds
//! t and the other does not, a is the one in at most half: a binomial test for pairs (McNemar). The value t is not
//! known, but an interval of order statistics of b holds it; the hypothesis is rejected if the test rejects it at
//! every value of that interval. A shift of a turns the test into an interval of the difference. There are no random
//! numbers in it.
//!
//! If b has t in several samples, it exceeds t more seldom than with 5 %: the comparison is with reaching t. That tells
//! little or, of a machine that is the same in every draw, nothing; then order statistics of a count, too.

use super::quantile::ranks;
use crate::units::Interval;

/// The ranked percentile, in percent.
const PERCENT: usize = 95;

/// Steps of the search for the ends of an interval.
const MAX_BISECTIONS: usize = 40;

/// Machines whose values differ by less than this fraction in every sample are equal.
const EQUAL: f64 = 1e-9;

/// The test of one pair out of many.
#[derive(Debug, Clone, PartialEq)]
pub struct PairedTest {
    /// Ranks (from 1) of the interval that holds the 95 % value.
    ranks: (usize, usize),
    /// By the number of samples in which exactly one exceeds: the number that must be of one machine.
    min_of: Vec<usize>,
    samples: usize,
}

/// The difference of two 95 % values with its interval; `None` where there are too few samples for an end.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct PairedDifference {
    /// Of the samples.
    pub value: f64,
    /// Lower end.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

/// A machine or arrangement against the first, on the machines drawn of both.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct VersusFirst {
    /// What is known of the two.
    pub verdict: Verdict,
    /// Its 95 % value minus that of the first, um. The intervals of all pairs and all rounds hold together with 95 %
    /// confidence.
    pub minus_first: PairedDifference,
}

/// What is known of a machine or arrangement and the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It is the first.
    First,
    /// It has the value of the first in every drawn machine.
    Equal,
    /// The drawn machines do not tell which of the two is better.
    NotToldApart,
    /// It is worse than the first.
    Worse,
    /// It is better than the first.
    Better,
}

impl Verdict {
    /// Returns the verdict on machines whose figures differ by so much, which nothing leaves uncertain.
    pub fn of_difference(minus_first: f64) -> Self {
        match minus_first {
            d if d > 0.0 => Self::Worse,
            d if d < 0.0 => Self::Better,
            _ => Self::Equal,
        }
    }

    /// Returns the verdict in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::First => "first",
            Self::Equal => "equal",
            Self::NotToldApart => "not told apart",
            Self::Worse => "worse",
            Self::Better => "better",
        }
    }
}

impl PairedDifference {
    /// Returns the difference of machines that differ by as much in every sample.
    pub fn certain(a: &[f64], b: &[f64]) -> Self {
        let value = percentile_95(a) - percentile_95(b);
        Self { value, low: Some(value), high: Some(value) }
    }
}

/// Probability that any statement about any pair in any round is wrong.
pub const ERROR_PROBABILITY: f64 = 0.05;

/// Returns how many machines are drawn at most, where nobody states it, to tell apart what a first number does not.
pub fn most_samples(first: usize) -> usize {
    const TIMES: usize = 8;
    first.saturating_mul(TIMES)
}

/// Returns the number of drawn machines after each round: they double up to a limit.
pub fn round_sizes(samples: usize, limit: usize) -> Vec<usize> {
    let mut sizes = vec![samples];
    let mut last = samples;
    while last < limit {
        last = last.saturating_mul(2).min(limit);
        sizes.push(last);
    }
    sizes
}

impl PairedTest {
    /// Returns the test of one of so many rounds, for pairs out of `machines` machines with a number of samples each.
    pub fn of_round(samples: usize, machines: usize, rounds: usize) -> Self {
        Self::new(samples, machines, ERROR_PROBABILITY / rounds.max(1) as f64)
    }

    /// Returns the test for pairs out of `machines` machines, at least 2, each with a number of samples. All intervals
    /// of all pairs hold together but for the probability `alpha`.
    pub fn new(samples: usize, machines: usize, alpha: f64) -> Self {
        let machines = machines.max(2) as f64;
        // Half is for the intervals of the 95 % values with two ends each, half for the pairs in either order.
        let tail = alpha / (4.0 * machines);
        let pair = alpha / (2.0 * machines * (machines - 1.0));
        Self { ranks: ranks(samples, PERCENT, tail), min_of: majorities(samples, pair), samples }
    }

    /// True if the 95 % value of `a` is larger than that of `b`. Both have the samples of the test, in one order.
    pub fn exceeds(&self, a: &[f64], b: &[f64]) -> bool {
        let apart = |range: Interval| self.bounds(a).is_some_and(|own| own.min > range.max);
        self.bounds(b).is_some_and(|range| self.rejects(a, b, range, 0.0) || is_tied(b, range.min) && apart(range))
    }

    /// Returns the difference of the 95 % values, that of `a` minus that of `b`.
    pub fn difference(&self, a: &[f64], b: &[f64]) -> PairedDifference {
        let value = percentile_95(a) - percentile_95(b);
        PairedDifference { value, low: self.low(a, b, value), high: self.low(b, a, -value).map(|low| -low) }
    }

    /// Returns the lower end of the difference, whose value is given.
    fn low(&self, a: &[f64], b: &[f64], value: f64) -> Option<f64> {
        let bounds = self.bounds(b)?;
        let apart = is_tied(b, bounds.min).then(|| self.bounds(a)).flatten().map(|own| own.min - bounds.max);
        // A shift below all differences makes `a` exceed in every sample.
        let min_a = a.iter().copied().fold(f64::INFINITY, f64::min);
        let max_b = b.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let outer = (min_a - max_b).min(value) - (max_b - bounds.min).max(1.0);
        let by_pairs = bisect(outer, value, |shift| self.rejects(a, b, bounds, shift));
        by_pairs.into_iter().chain(apart).reduce(f64::max)
    }

    /// Returns a machine against the first.
    pub fn versus(&self, a: &[f64], first: &[f64]) -> VersusFirst {
        if are_equal(a, first) {
            return VersusFirst { verdict: Verdict::Equal, minus_first: PairedDifference::certain(a, first) };
        }
        let minus_first = self.difference(a, first);
        let verdict = match minus_first {
            PairedDifference { low: Some(low), .. } if low > 0.0 => Verdict::Worse,
            PairedDifference { high: Some(high), .. } if high < 0.0 => Verdict::Better,
            _ => Verdict::NotToldApart,
        };
        VersusFirst { verdict, minus_first }
    }

    /// Returns the values between which the 95 % value of a machine is; `None` with too few samples.
    fn bounds(&self, b: &[f64]) -> Option<Interval> {
        let (low, high) = self.ranks;
        if low < 1 || high > self.samples || b.len() != self.samples {
            return None;
        }
        let mut sorted = b.to_vec();
        let (_, upper, _) = sorted.select_nth_unstable_by(high - 1, f64::total_cmp);
        let upper = *upper;
        let (_, lower, _) = sorted.select_nth_unstable_by(low - 1, f64::total_cmp);
        Some(Interval::new(*lower, upper))
    }

    /// True if at every value between the bounds `a`, lowered by a shift, exceeds alone so often that it is no chance.
    fn rejects(&self, a: &[f64], b: &[f64], range: Interval, shift: f64) -> bool {
        let Interval { min: low, max: high } = range;
        if is_tied(b, low) && !self.is_majority(alone_at(a, b, low, shift)) {
            return false;
        }
        let mut alone = AloneCounts::default();
        let mut events: Vec<(f64, bool, bool)> = Vec::new();
        for (a, b) in a.iter().zip(b) {
            let a = a - shift;
            let (from, to, first) = if a > *b { (*b, a, true) } else { (a, *b, false) };
            // One exceeds alone at all values from `from` to just below `to`.
            if to <= low || from > high || from >= to {
                continue;
            }
            if from <= low {
                *alone.of(first) += 1;
            } else {
                events.push((from, true, first));
            }
            if to <= high {
                events.push((to, false, first));
            }
        }
        if !self.is_majority(alone) {
            return false;
        }
        events.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut events = events.into_iter().peekable();
        while let Some((value, begins, first)) = events.next() {
            let count = alone.of(first);
            *count = if begins { *count + 1 } else { count.saturating_sub(1) };
            let last_here = events.peek().is_none_or(|(next, ..)| *next > value);
            if last_here && !self.is_majority(alone) {
                return false;
            }
        }
        true
    }

    fn is_majority(&self, alone: AloneCounts) -> bool {
        self.min_of.get(alone.first + alone.second).is_some_and(|min| alone.first >= *min)
    }
}

/// Numbers of samples of which only one of two machines exceeds a value.
#[derive(Debug, Clone, Copy, Default)]
struct AloneCounts {
    first: usize,
    second: usize,
}

impl AloneCounts {
    fn of(&mut self, first: bool) -> &mut usize {
        if first { &mut self.first } else { &mut self.second }
    }
}

/// True if several samples have a value.
fn is_tied(samples: &[f64], value: f64) -> bool {
    samples.iter().filter(|sample| **sample == value).nth(1).is_some()
}

/// Returns the numbers of samples of which only `a`, lowered by a shift, exceeds a value, and only `b` reaches it.
fn alone_at(a: &[f64], b: &[f64], value: f64, shift: f64) -> AloneCounts {
    let both = || a.iter().zip(b).map(|(a, b)| (a - shift > value, *b >= value));
    AloneCounts {
        first: both().filter(|of| *of == (true, false)).count(),
        second: both().filter(|of| *of == (false, true)).count(),
    }
}

/// Returns the shift nearest to `inner` that is still rejected; `None` if not even `outer` is.
fn bisect(outer: f64, inner: f64, rejected: impl Fn(f64) -> bool) -> Option<f64> {
    if !rejected(outer) {
        return None;
    }
    // Zero decides whether two machines are told apart: it is among the shifts that are tried.
    let (mut yes, mut no) = (outer, inner);
    if outer < 0.0 && inner > 0.0 {
        if rejected(0.0) { yes = 0.0 } else { no = 0.0 }
    }
    for _ in 0..MAX_BISECTIONS {
        let middle = 0.5 * (yes + no);
        if rejected(middle) { yes = middle } else { no = middle }
    }
    Some(yes)
}

/// True if two machines have the same value in every sample.
pub fn are_equal(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= EQUAL * a.abs().max(b.abs()))
}

/// Returns the 95 % value of samples, at least one.
pub fn percentile_95(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    let place = super::quantile::rank(values.len(), PERCENT) - 1;
    *values.select_nth_unstable_by(place, f64::total_cmp).1
}

/// Returns for n = 0, 1, ... `count` throws of a coin the smallest number of heads that is reached with at most this
/// probability; beyond n if none is.
fn majorities(count: usize, probability: f64) -> Vec<usize> {
    let mut min = 0;
    let logs: Vec<f64> = (0..=count + 1).map(|n| libm::lgamma(n as f64 + 1.0)).collect();
    let tail = |n: usize, k: usize| {
        let mut term = libm::exp(logs[n] - logs[k] - logs[n - k] - n as f64 * std::f64::consts::LN_2);
        let mut sum = term;
        for i in k..n {
            term *= (n - i) as f64 / (i + 1) as f64;
            sum += term;
            if term < 1e-17 * sum {
                break;
            }
        }
        sum
    };
    let least = |n: usize| {
        while min <= n && tail(n, min) > probability {
            min += 1;
        }
        min
    };
    (0..=count).map(least).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn majorities_are_those_of_the_sign_test() {
        // P(Bin(n, 1/2) >= k): 5 of 5 is 0.03125, 7 of 8 is 0.03516, 15 of 20 is 0.02069, 14 of 20 is 0.05766.
        let min = majorities(20, 0.05);
        assert_eq!((min[0], min[4], min[5], min[8], min[20]), (1, 5, 5, 7, 15));
        let strict = majorities(2000, 1e-8);
        assert_eq!((strict[26], strict[27], strict[30]), (27, 27, 30));
        // By the normal approximation with continuity: 1000 + 0.5 + 5.6120 * 22.36.
        assert!((strict[2000] as f64 - 1126.0).abs() <= 1.0, "{}", strict[2000]);
    }

    struct Lcg(u64);

    impl Lcg {
        fn unit(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    #[test]
    fn intervals_hold_the_difference_and_shrink() {
        // a = u + 0.3 v and b = u + 0.3 w + 0.05: the 95 % values differ by -0.05 exactly.
        let mut random = Lcg(5);
        let (mut missed, mut widths) = (0, [0.0; 2]);
        for (samples, width) in [400, 3200].into_iter().zip(&mut widths) {
            let test = PairedTest::new(samples, 2, 0.05);
            for _ in 0..200 {
                let (mut a, mut b) = (Vec::new(), Vec::new());
                for _ in 0..samples {
                    let u = random.unit();
                    a.push(u + 0.3 * random.unit());
                    b.push(u + 0.3 * random.unit() + 0.05);
                }
                let found = test.difference(&a, &b);
                let (low, high) = (found.low.unwrap(), found.high.unwrap());
                assert!(low <= found.value && found.value <= high);
                missed += usize::from(!(low <= -0.05 && -0.05 <= high));
                *width += (high - low) / 200.0;
                assert_eq!(test.exceeds(&b, &a), test.difference(&b, &a).low.unwrap() > 0.0);
            }
        }
        // 5 % of 400 is 20.
        assert!(missed <= 20, "{missed}");
        assert!(widths[1] < 0.5 * widths[0], "{widths:?}");
    }

    /// A machine that is the same in every draw, at, above and below the 95 % value of one that is drawn.
    #[test]
    fn a_machine_that_is_the_same_in_every_draw_is_told_apart_by_order_statistics() {
        let mut random = Lcg(11);
        let test = PairedTest::new(1000, 2, 0.05);
        let mut told = [0; 3];
        for _ in 0..400 {
            let drawn: Vec<f64> = (0..1000).map(|_| random.unit()).collect();
            for (value, told) in [0.95, 0.97, 0.93].into_iter().zip(&mut told) {
                let same = vec![value; 1000];
                let PairedDifference { value: middle, low, high } = test.difference(&same, &drawn);
                let (low, high) = (low.unwrap(), high.unwrap());
                assert!(low <= middle && middle <= high);
                let back = test.difference(&drawn, &same);
                assert_eq!((back.low, back.high), (Some(-high), Some(-low)));
                *told += usize::from(low > 0.0 || high < 0.0);
            }
        }
        // 5 % of 400 is 20; 0.02 is three standard deviations of a rank of 1000.
        assert!(told[0] <= 20 && told[1] > 200 && told[2] > 200, "{told:?}");
    }

    /// Both have the same value in most samples.
    #[test]
    fn ties_are_not_taken_for_exceeding() {
        let mut random = Lcg(3);
        let test = PairedTest::new(1000, 2, 0.05);
        let mut wrong = 0;
        for _ in 0..200 {
            let mut draw = |share: f64, from: f64| -> Vec<f64> {
                (0..1000).map(|_| if random.unit() < share { 1.0 } else { from + random.unit() }).collect()
            };
            // The 95 % value of both is 1, of which a is above in 4.5 % and b in 1 % of all machines.
            let (a, b) = (draw(0.955, 2.0), draw(0.99, 1.0));
            wrong += usize::from(test.exceeds(&a, &b));
        }
        assert!(wrong <= 10, "{wrong}");
    }

    #[test]
    fn too_few_samples_tell_nothing_and_equal_ones_are_equal() {
        let few: Vec<f64> = (0..40).map(f64::from).collect();
        let more: Vec<f64> = few.iter().map(|x| x + 100.0).collect();
        let test = PairedTest::new(40, 2, 0.05);
        assert!(!test.exceeds(&more, &few) && test.difference(&more, &few).low.is_none());
        let rounded: Vec<f64> = few.iter().map(|x| x * (1.0 + 1e-12)).collect();
        assert!(are_equal(&few, &rounded) && !are_equal(&few, &more));
    }
}
