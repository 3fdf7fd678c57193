//! What bounds lead to at many poses, in figures: the same in `map`, in a comparison and on the page.

use super::budget::{DrawSettings, drawn_json};
use crate::analysis::budget::{Percentile, PoseByPose};
use crate::evaluate::{Statistics, Summary};
use serde_json::{Map, Value, json};

/// What bounds lead to at many poses. Of pairs the first is the position (um), the second the orientation (urad).
#[derive(Debug, Clone)]
pub struct BoundedFigures {
    /// Number of bounded errors.
    pub errors: usize,
    /// Settings of the machines drawn.
    pub drawing: DrawSettings,
    /// Statistics over the poses of the RSS at each; no ranges.
    pub rss: [Summary; 2],
    /// Statistics over the poses of the 95 % value at each; the ranges are those that 95 % of the drawn machines do not
    /// exceed.
    pub p95: [Summary; 2],
    /// The largest deviation over the poses of each drawn machine, in rising order.
    pub largest: [Vec<f64>; 2],
}

impl BoundedFigures {
    /// Returns the figures of what was found at poses.
    pub fn new(errors: usize, drawing: DrawSettings, found: &PoseByPose) -> Self {
        let summary = |q: usize, of: fn(crate::analysis::budget::BoundedLength) -> f64| {
            let length = |d: &crate::analysis::budget::BoundedDeviation| of([d.position, d.rotation][q]) * SCALES[q];
            Summary::of_lengths(&mut found.poses.iter().map(length).collect::<Vec<_>>())
        };
        let p95 = |q: usize| Summary { range: found.ranges[q].map(|x| x * SCALES[q]), ..summary(q, |of| of.p95) };
        let largest = |q: usize| {
            let mut sorted: Vec<f64> = found.largest[q].iter().map(|x| x * SCALES[q]).collect();
            sorted.sort_by(f64::total_cmp);
            sorted
        };
        let rss = [0, 1].map(|q| summary(q, |of| of.rss));
        Self { errors, drawing, rss, p95: [0, 1].map(p95), largest: [0, 1].map(largest) }
    }

    /// Returns the statistics of the 95 % value over `poses` poses.
    pub fn statistics(&self, poses: usize) -> Statistics {
        Statistics { poses, position_um: self.p95[0], rotation_urad: self.p95[1] }
    }

    /// Returns the largest deviation over the poses that 95 % of the machines do not exceed: position, orientation.
    pub fn everywhere(&self) -> [Percentile; 2] {
        [0, 1].map(|q| Percentile::of(&self.largest[q], 95))
    }

    /// Returns the statistics of the RSS minus those of another machine.
    pub fn rss_minus(&self, first: &Self) -> RssDifference {
        let of = |q: usize| {
            let (own, first) = (&self.rss[q], &first.rss[q]);
            let (max, mean) = (own.max - first.max, own.mean - first.mean);
            LengthDifference { max, mean, rms: own.rms - first.rms, p95: own.p95 - first.p95 }
        };
        RssDifference { position_um: of(0), rotation_urad: of(1) }
    }

    /// All but the statistics of the 95 % value.
    pub fn json(&self) -> Map<String, Value> {
        let mut json = Map::new();
        let _ = json.insert("errors".to_owned(), json!(self.errors));
        json.extend(self.drawing.json());
        for (q, name) in ["position_um", "rotation_urad"].into_iter().enumerate() {
            let Summary { max, mean, rms, p95, .. } = self.rss[q];
            let rss = json!({"max": max, "mean": mean, "rms": rms, "p95": p95});
            let figures = json!({"rss": rss, "monte_carlo": drawn_json(&self.largest[q])});
            let _ = json.insert(name.to_owned(), figures);
        }
        json
    }
}

/// Statistics of the RSS minus those of another machine; no ranges.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct RssDifference {
    /// Of the position, um.
    pub position_um: LengthDifference,
    /// Of the orientation, urad.
    pub rotation_urad: LengthDifference,
}

/// Statistics of lengths minus those of others.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct LengthDifference {
    /// Of the largest.
    pub max: f64,
    /// Of the mean.
    pub mean: f64,
    /// Of the root of the mean square.
    pub rms: f64,
    /// Of the ceil(0.95 n)-th smallest.
    pub p95: f64,
}

/// mm to um, rad to urad.
const SCALES: [f64; 2] = [1e3, 1e6];

impl serde::Serialize for BoundedFigures {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.json().serialize(serializer)
    }
}

impl DrawSettings {
    /// `1000 machines drawn, uniform distribution, seed 1`.
    pub fn words(&self) -> String {
        format!("{} machines drawn, {} distribution, seed {}", self.samples, self.distribution.name(), self.seed)
    }

    /// `, class production`, or nothing.
    pub fn class_words(&self) -> String {
        self.class.as_ref().map_or_else(String::new, |(name, _)| format!(", class {}", crate::diagnostic::shown(name)))
    }
}
