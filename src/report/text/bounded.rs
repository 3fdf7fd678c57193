//! What bounds lead to at many poses, in figures: the same in `map`, in a comparison and on the page.

use super::budget::{DrawSettings, DrawnMachineFigures};
use crate::analysis::budget::PoseByPose;
use crate::evaluate::{Statistics, Summary};
use schemars::JsonSchema;
use serde::Serialize;

/// Figures of what bounds lead to over poses.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct BoundedFigures {
    /// Number of bounded errors.
    pub errors: usize,
    /// Settings of the machines drawn.
    #[serde(flatten)]
    pub drawing: DrawSettings,
    /// The position deviation, um.
    pub position_um: BoundedLengths,
    /// The rotation of the tool, urad.
    pub rotation_urad: BoundedLengths,
    /// Statistics over the poses of the 95 % value at each, position (um) and orientation (urad); the ranges are those
    /// that 95 % of the drawn machines do not exceed.
    #[serde(skip)]
    pub p95: [Summary; 2],
}

/// A deviation that bounds lead to over poses.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BoundedLengths {
    /// Statistics over the poses of the root of the sum of squares.
    pub rss: LengthStatistics,
    /// Largest deviation over the poses, of machines drawn.
    pub monte_carlo: DrawnMachineFigures,
}

/// Statistics of lengths, or of lengths minus those of others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct LengthStatistics {
    /// Largest.
    pub max: f64,
    /// Mean.
    pub mean: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// The ceil(0.95 n)-th smallest.
    pub p95: f64,
}

/// Statistics of the RSS minus those of another machine.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct RssDifference {
    /// Of the position, um.
    pub position_um: LengthStatistics,
    /// Of the orientation, urad.
    pub rotation_urad: LengthStatistics,
}

impl BoundedFigures {
    /// Returns the figures of what was found at poses.
    pub fn new(errors: usize, drawing: DrawSettings, found: &PoseByPose) -> Self {
        let summary = |q: usize, of: fn(crate::analysis::budget::BoundedLength) -> f64| {
            let length = |d: &crate::analysis::budget::BoundedDeviation| of([d.position, d.rotation][q]) * SCALES[q];
            Summary::of_lengths(&mut found.poses.iter().map(length).collect::<Vec<_>>())
        };
        let p95 = |q: usize| Summary { range: found.ranges[q].map(|x| x * SCALES[q]), ..summary(q, |of| of.p95) };
        let lengths = |q: usize| {
            let mut largest: Vec<f64> = found.largest[q].iter().map(|x| x * SCALES[q]).collect();
            largest.sort_by(f64::total_cmp);
            let Summary { max, mean, rms, p95, .. } = summary(q, |of| of.rss);
            let rss = LengthStatistics { max, mean, rms, p95 };
            BoundedLengths { rss, monte_carlo: DrawnMachineFigures::of(&largest) }
        };
        let (position_um, rotation_urad) = (lengths(0), lengths(1));
        Self { errors, drawing, position_um, rotation_urad, p95: [0, 1].map(p95) }
    }

    /// Returns the statistics of the 95 % value over `poses` poses.
    pub fn statistics(&self, poses: usize) -> Statistics {
        Statistics { poses, position_um: self.p95[0], rotation_urad: self.p95[1] }
    }

    /// Returns the statistics of the RSS minus those of another machine.
    pub fn rss_minus(&self, first: &Self) -> RssDifference {
        let of = |own: &BoundedLengths, first: &BoundedLengths| {
            let (own, first) = (own.rss, first.rss);
            let (max, mean) = (own.max - first.max, own.mean - first.mean);
            LengthStatistics { max, mean, rms: own.rms - first.rms, p95: own.p95 - first.p95 }
        };
        RssDifference {
            position_um: of(&self.position_um, &first.position_um),
            rotation_urad: of(&self.rotation_urad, &first.rotation_urad),
        }
    }
}

/// mm to um, rad to urad.
const SCALES: [f64; 2] = [1e3, 1e6];

impl DrawSettings {
    /// `1000 machines drawn, uniform distribution, seed 1`.
    pub fn words(&self) -> String {
        format!("{} machines drawn, {} distribution, seed {}", self.samples, self.distribution.name(), self.seed)
    }

    /// `, class production`, or nothing.
    pub fn class_words(&self) -> String {
        self.class.as_ref().map_or_else(String::new, |name| format!(", class {}", crate::diagnostic::shown(name)))
    }
}
