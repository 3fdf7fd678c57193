//! Figures of a single-axis measurement, formed as ISO 230-2:2014 forms them (mm or rad): means and standard
//! deviations by target and direction, reversal, repeatability, systematic deviation and accuracy with 2 s.

use super::{range, slope};
use crate::syntax::ColumnDirection;

/// A reading at a target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TargetReading {
    /// The target, mm or deg.
    pub position: f64,
    /// The side from which it was approached, if that is known.
    pub direction: Option<ColumnDirection>,
    /// Actual minus target, mm or rad.
    pub value: f64,
}

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

    /// Reversal B_i: mean of the forward approach minus mean of the reverse one. Lost motion is below zero.
    pub fn reversal(&self) -> Option<f64> {
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

/// The figures of one direction of approach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OneWayFigures {
    /// Systematic deviation E: the range of its means.
    pub systematic: f64,
    /// Repeatability R: the largest 4 s; `None` without repeated runs.
    pub repeatability: Option<f64>,
    /// Accuracy A; `None` without repeated runs.
    pub accuracy: Option<f64>,
}

impl OneWayFigures {
    fn of(targets: &[TargetReadings], direction: fn(&TargetReadings) -> Option<Repeated>) -> Option<Self> {
        let all: Vec<Repeated> = targets.iter().filter_map(direction).collect();
        let deviations: Option<Vec<f64>> = all.iter().map(|r| r.deviation).collect();
        (!all.is_empty()).then(|| Self {
            systematic: range(all.iter().map(|r| r.mean)),
            repeatability: deviations.map(|s| 4.0 * s.into_iter().fold(0.0, f64::max)),
            accuracy: accuracy(&all),
        })
    }
}

/// Accuracy of means and standard deviations: largest mean + 2 s minus smallest mean - 2 s; `None` if one was not
/// repeated.
fn accuracy(all: &[Repeated]) -> Option<f64> {
    let edges = |r: &Repeated| Some([r.mean - 2.0 * r.deviation?, r.mean + 2.0 * r.deviation?]);
    let edges: Option<Vec<[f64; 2]>> = all.iter().map(edges).collect();
    edges.map(|edges| range(edges.into_iter().flatten()))
}

/// The figures of one error over an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct AccuracyFigures {
    /// By rising position.
    pub targets: Vec<TargetReadings>,
    /// Smallest number of runs that a target has in a direction.
    pub runs: usize,
    /// Reversal B, the largest size of those of the targets; `None` without two directions.
    pub reversal: Option<f64>,
    /// Mean of the reversals of the targets, with its sign.
    pub mean_reversal: Option<f64>,
    /// Figures of the forward and of the reverse approach; `None` where it was not measured.
    pub one_way: [Option<OneWayFigures>; 2],
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
    /// Returns the figures; `None` without readings.
    pub fn of(readings: &[TargetReading]) -> Option<Self> {
        let targets = targets(readings);
        let all: Vec<Repeated> = targets.iter().flat_map(TargetReadings::all).collect();
        let reversals: Vec<f64> = targets.iter().filter_map(TargetReadings::reversal).collect();
        let points: Vec<(f64, f64)> = targets.iter().map(|t| (t.position, t.middle())).collect();
        Some(Self {
            runs: all.iter().map(|r| r.count).min()?,
            reversal: reversals.iter().map(|b| b.abs()).reduce(f64::max),
            mean_reversal: (!reversals.is_empty()).then(|| reversals.iter().sum::<f64>() / reversals.len() as f64),
            one_way: [OneWayFigures::of(&targets, |t| t.forward), OneWayFigures::of(&targets, |t| t.reverse)],
            repeatability: targets.iter().filter_map(TargetReadings::repeatability).reduce(f64::max),
            systematic: range(all.iter().map(|r| r.mean)),
            mean: range(points.iter().map(|p| p.1)),
            accuracy: accuracy(&all),
            slope: slope(&points),
            targets,
        })
    }

    /// Targets with the means of both directions.
    pub fn middle(&self) -> Vec<(f64, f64)> {
        self.targets.iter().map(|t| (t.position, t.middle())).collect()
    }

    /// Were both directions measured?
    pub fn bidirectional(&self) -> bool {
        self.targets.iter().any(|t| t.forward.is_some()) && self.targets.iter().any(|t| t.reverse.is_some())
    }
}

fn targets(readings: &[TargetReading]) -> Vec<TargetReadings> {
    let mut sorted: Vec<TargetReading> = readings.to_vec();
    sorted.sort_by(|a, b| a.position.total_cmp(&b.position));
    let groups = sorted.chunk_by(|a, b| a.position == b.position);
    let of = |group: &[TargetReading], way: Option<ColumnDirection>| {
        repeatability(group.iter().filter(|s| s.direction == way).map(|s| s.value).collect())
    };
    let target = |group: &[TargetReading]| TargetReadings {
        position: group[0].position,
        forward: of(group, Some(ColumnDirection::Forward)),
        reverse: of(group, Some(ColumnDirection::Reverse)),
        unknown: of(group, None),
    };
    groups.map(target).collect()
}

fn repeatability(values: Vec<f64>) -> Option<Repeated> {
    let count = values.len();
    let mean = (count > 0).then(|| values.iter().sum::<f64>() / count as f64)?;
    let squares = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
    let deviation = (count > 1).then(|| libm::sqrt(squares / (count - 1) as f64));
    Some(Repeated { mean, deviation, count })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two targets, two runs, both directions; the figures worked out by hand.
    #[test]
    fn figures_are_those_of_the_standard() {
        let sample = |position, direction, value| TargetReading { position, direction: Some(direction), value };
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
        let figures = AccuracyFigures::of(&all).unwrap();
        let s = 2.0_f64.sqrt();
        // Means 2, 0 | 5, 8; reversals 2, -3; spans 2 s + 2 s + |B|.
        assert_eq!((figures.reversal, figures.mean_reversal, figures.runs), (Some(3.0), Some(-0.5), 2));
        assert!((figures.repeatability.unwrap() - (2.0 * s + 3.0).max(4.0 * s)).abs() < 1e-12);
        assert_eq!((figures.systematic, figures.mean), (8.0, 5.5));
        assert!((figures.accuracy.unwrap() - ((8.0 + 2.0 * s) - (2.0 - 2.0 * s).min(0.0))).abs() < 1e-12);
        let [up, down] = figures.one_way.map(Option::unwrap);
        assert_eq!((up.systematic, down.systematic), (3.0, 8.0));
        // Forward 2 +- 2 s and 5 +- 0, reverse 0 +- 0 and 8 +- 2 s.
        assert!(
            (up.repeatability.unwrap() - 4.0 * s).abs() < 1e-12
                && (down.accuracy.unwrap() - (8.0 + 2.0 * s)).abs() < 1e-12
        );
        assert!((up.accuracy.unwrap() - (5.0 - (2.0 - 2.0 * s)).max(4.0 * s)).abs() < 1e-12);
        assert!((figures.slope - 0.055).abs() < 1e-15 && figures.bidirectional());
    }
}
