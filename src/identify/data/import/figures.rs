//! Figures of a single-axis measurement, formed as ISO 230-2:2014 forms them (mm or rad): means and standard
//! deviations by target and direction, reversal, repeatability, systematic deviation and accuracy with 2 s.

use super::sample::Sample;
use crate::syntax::ColumnDirection;

/// Mean and standard deviation of repeated readings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repeated {
    /// The mean.
    pub mean: f64,
    /// The estimate of the standard deviation; `None` of a single reading.
    pub deviation: Option<f64>,
    /// Number of readings.
    pub count: usize,
}

/// Readings at one target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TargetReadings {
    /// mm or deg.
    pub position: f64,
    /// Approached with rising position.
    pub forward: Option<Repeated>,
    /// Approached with falling position.
    pub reverse: Option<Repeated>,
    /// Direction unknown.
    pub unknown: Option<Repeated>,
}

impl TargetReadings {
    /// Readings of one direction, whichever there is.
    pub fn any(&self) -> Option<Repeated> {
        self.forward.or(self.reverse).or(self.unknown)
    }

    fn all(&self) -> impl Iterator<Item = Repeated> {
        [self.forward, self.reverse, self.unknown].into_iter().flatten()
    }

    /// The mean of the means of both directions.
    fn middle(&self) -> f64 {
        let all: Vec<f64> = self.all().map(|r| r.mean).collect();
        all.iter().sum::<f64>() / all.len().max(1) as f64
    }

    /// Reversal value B_i.
    fn reversal(&self) -> Option<f64> {
        Some(self.forward?.mean - self.reverse?.mean)
    }

    /// Repeatability R_i: 4 s of one direction; of both, at least their spans with the reversal between.
    fn repeatability(&self) -> Option<f64> {
        let four = |r: Option<Repeated>| r.and_then(|r| r.deviation).map(|s| 4.0 * s);
        let both = four(self.forward).zip(four(self.reverse)).zip(self.reversal());
        let across = both.map(|((up, down), b)| (up + down) / 2.0 + b.abs());
        [across, four(self.forward), four(self.reverse), four(self.unknown)].into_iter().flatten().reduce(f64::max)
    }
}

/// The figures of one error over an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct AccuracyFigures {
    /// By rising position.
    pub targets: Vec<TargetReadings>,
    /// Smallest number of runs that a target has in a direction.
    pub runs: usize,
    /// Largest reversal, with its sign; `None` without two directions.
    pub reversal: Option<f64>,
    /// Mean reversal.
    pub mean_reversal: Option<f64>,
    /// Repeatability R; `None` without repeated runs.
    pub repeatability: Option<f64>,
    /// Systematic deviation E: the range of all means.
    pub systematic: f64,
    /// Mean deviation M: the range of the means of both directions.
    pub mean: f64,
    /// Accuracy A; `None` without repeated runs.
    pub accuracy: Option<f64>,
    /// Slope of the best-fit line (least squares) of the means, per mm or deg.
    pub slope: f64,
}

impl AccuracyFigures {
    pub(crate) fn of(samples: &[&Sample]) -> Option<Self> {
        let targets = targets(samples);
        let means = || targets.iter().flat_map(TargetReadings::all).map(|r| r.mean);
        let reversals: Vec<f64> = targets.iter().filter_map(TargetReadings::reversal).collect();
        let largest = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
        let repeated = targets.iter().flat_map(TargetReadings::all).all(|r| r.deviation.is_some());
        let edge = |sign: f64| {
            let one = move |r: Repeated| r.mean + sign * 2.0 * r.deviation.unwrap_or(0.0);
            targets.iter().flat_map(TargetReadings::all).map(one).collect::<Vec<f64>>()
        };
        let points: Vec<(f64, f64)> = targets.iter().map(|t| (t.position, t.middle())).collect();
        let spread = range(edge(1.0).into_iter().chain(edge(-1.0)));
        Some(Self {
            runs: targets.iter().flat_map(TargetReadings::all).map(|r| r.count).min()?,
            reversal: reversals.iter().copied().reduce(largest),
            mean_reversal: (!reversals.is_empty()).then(|| reversals.iter().sum::<f64>() / reversals.len() as f64),
            repeatability: targets.iter().filter_map(TargetReadings::repeatability).reduce(f64::max),
            systematic: range(means()),
            mean: range(points.iter().map(|p| p.1)),
            accuracy: repeated.then_some(spread),
            slope: slope(&points),
            targets,
        })
    }

    /// Targets with the means of both directions.
    pub(super) fn middle(&self) -> Vec<(f64, f64)> {
        self.targets.iter().map(|t| (t.position, t.middle())).collect()
    }

    /// Were both directions measured?
    pub fn bidirectional(&self) -> bool {
        self.targets.iter().any(|t| t.forward.is_some()) && self.targets.iter().any(|t| t.reverse.is_some())
    }
}

fn range(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if high >= low { high - low } else { 0.0 }
}

fn targets(samples: &[&Sample]) -> Vec<TargetReadings> {
    let mut sorted: Vec<&Sample> = samples.to_vec();
    sorted.sort_by(|a, b| a.position.total_cmp(&b.position));
    let groups = sorted.chunk_by(|a, b| a.position == b.position);
    let of = |group: &[&Sample], way: Option<ColumnDirection>| {
        repeated(group.iter().filter(|s| s.direction == way).map(|s| s.value).collect())
    };
    let target = |group: &[&Sample]| TargetReadings {
        position: group[0].position,
        forward: of(group, Some(ColumnDirection::Forward)),
        reverse: of(group, Some(ColumnDirection::Reverse)),
        unknown: of(group, None),
    };
    groups.map(target).collect()
}

fn repeated(values: Vec<f64>) -> Option<Repeated> {
    let count = values.len();
    let mean = (count > 0).then(|| values.iter().sum::<f64>() / count as f64)?;
    let squares = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
    let deviation = (count > 1).then(|| libm::sqrt(squares / (count - 1) as f64));
    Some(Repeated { mean, deviation, count })
}

fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len().max(1) as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let sum = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>();
    let square = sum(&|p| (p.0 - x) * (p.0 - x));
    if square > 0.0 { sum(&|p| (p.0 - x) * (p.1 - y)) / square } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two targets, two runs, both directions; the figures worked out by hand.
    #[test]
    fn figures_are_those_of_the_standard() {
        let sample = |position, direction, value| Sample {
            error: 0,
            position,
            direction: Some(direction),
            run: String::new(),
            value,
        };
        let (f, r) = (ColumnDirection::Forward, ColumnDirection::Reverse);
        let all = [
            sample(0.0, f, 1.0),
            sample(0.0, f, 3.0),
            sample(0.0, r, 0.0),
            sample(0.0, r, 0.0),
            sample(100.0, f, 5.0),
            sample(100.0, f, 5.0),
            sample(100.0, r, 7.0),
            sample(100.0, r, 9.0),
        ];
        let figures = AccuracyFigures::of(&all.iter().collect::<Vec<_>>()).unwrap();
        let s = 2.0_f64.sqrt();
        // Means 2, 0 | 5, 8; reversals 2, -3; spans 2 s + 2 s + |B|.
        assert_eq!((figures.reversal, figures.mean_reversal, figures.runs), (Some(-3.0), Some(-0.5), 2));
        assert!((figures.repeatability.unwrap() - (2.0 * s + 3.0).max(4.0 * s)).abs() < 1e-12);
        assert_eq!((figures.systematic, figures.mean), (8.0, 5.5));
        assert!((figures.accuracy.unwrap() - ((8.0 + 2.0 * s) - (2.0 - 2.0 * s).min(0.0))).abs() < 1e-12);
        assert!((figures.slope - 0.055).abs() < 1e-15 && figures.bidirectional());
    }
}
