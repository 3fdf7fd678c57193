//! Drawn machines: the error of each over all poses, and the effect of each tolerance on it.

use super::kernel::{BudgetPose, JointBounds, SAMPLE_LANES, SampleChunk, SampleLanes, squares};
use super::quantile::rank;
use crate::run::Advance;
use rayon::prelude::*;
use std::ops::Range;

/// The statistic of one machine's deviations over the poses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "snake_case")]
pub enum Statistic {
    /// The largest.
    #[default]
    Max,
    /// The ceil(0.95 n)-th smallest.
    P95,
}

impl Statistic {
    /// Returns the statistic of values, at least one; reorders them.
    pub fn of(self, values: &mut [f64]) -> f64 {
        match self {
            Self::Max => values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            Self::P95 => *values.select_nth_unstable_by(rank(values.len(), 95) - 1, f64::total_cmp).1,
        }
    }

    /// Returns the pose that attains it, with the value there; of equal ones the first.
    pub fn pose_with_value(self, values: &[f64]) -> (usize, f64) {
        let index = match self {
            Self::Max => {
                let larger = |i: usize, best: usize| values[i].total_cmp(&values[best]).is_gt();
                (1..values.len()).fold(0, |best, i| if larger(i, best) { i } else { best })
            }
            Self::P95 => {
                let mut indices: Vec<usize> = (0..values.len()).collect();
                let order = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]).then(b.cmp(a));
                *indices.select_nth_unstable_by(rank(values.len(), 95) - 1, order).1
            }
        };
        (index, values[index])
    }
}

/// One drawn machine.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrawnMachine {
    /// Its statistic over the poses (mm or rad).
    pub value: f64,
    /// The part of that value by each bounded error; with that of a fixed deviation they sum up to it. Divided by the
    /// tolerance a part is the derivative of the value by that tolerance, for a drawn error grows in proportion to its
    /// tolerance.
    pub parts: Vec<f64>,
}

/// Returns the drawn machines with these indices at each list of poses; the same to the bit on any number of threads,
/// and for any range that they lie in. `chunk_at` gives the chunk of machines that begins with an index.
pub fn draw<F: Send, const N: usize>(
    places: [&[BudgetPose]; N],
    joints: &[JointBounds],
    chunk_at: &(dyn Fn(usize) -> SampleChunk + Sync),
    statistic: Statistic,
    samples: Range<usize>,
    progress: Advance<'_, F>,
) -> Result<[Vec<DrawnMachine>; N], F> {
    let count_bounds = joints.iter().map(|joint| joint.location.len() + joint.component.len()).sum();
    let chunk = |index: usize| {
        let first = samples.start + index * SAMPLE_LANES;
        let chunk = chunk_at(first);
        let removed = chunk.removed_by_source(joints);
        let count = SAMPLE_LANES.min(samples.end - first);
        let of = |poses: &[BudgetPose]| {
            let lengths: Vec<SampleLanes> = poses.iter().map(|pose| squares(&pose.deviations(&chunk))).collect();
            progress(count)?;
            let sample = |lane: usize| {
                let column: Vec<f64> = lengths.iter().map(|lanes| lanes[lane]).collect();
                let (pose, square) = statistic.pose_with_value(&column);
                let value = square.sqrt();
                let vectors = poses[pose].parts(&chunk, &removed, joints, lane, count_bounds);
                DrawnMachine { value, parts: parts(&vectors, poses[pose].constant_deviation()) }
            };
            Ok((0..count).map(sample).collect::<Vec<_>>())
        };
        places.iter().map(|poses| of(poses)).collect::<Result<Vec<_>, F>>()
    };
    let chunks: Vec<Vec<Vec<DrawnMachine>>> =
        (0..samples.len().div_ceil(SAMPLE_LANES)).into_par_iter().map(chunk).collect::<Result<_, F>>()?;
    let mut drawn = std::array::from_fn(|_| Vec::with_capacity(samples.len()));
    for chunk in chunks {
        drawn.iter_mut().zip(chunk).for_each(|(list, machines): (&mut Vec<DrawnMachine>, _)| list.extend(machines));
    }
    Ok(drawn)
}

/// Returns the components of vectors along their sum, in which a fixed vector is too.
fn parts(vectors: &[[f64; 3]], fixed: [f64; 3]) -> Vec<f64> {
    let sum = vectors.iter().fold(fixed, |sum, v| std::array::from_fn(|i| sum[i] + v[i]));
    let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let length = dot(&sum, &sum).sqrt();
    vectors.iter().map(|v| if length > 0.0 { dot(v, &sum) / length } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pose_that_attains_a_statistic_has_its_value() {
        for n in 1..60 {
            let values: Vec<f64> = (0..n).map(|i| f64::from((i * 37 + 11) % 23)).collect();
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            for (statistic, truth) in [
                (Statistic::Max, sorted[sorted.len() - 1]),
                (Statistic::P95, sorted[(n as usize * 95).div_ceil(100) - 1]),
            ] {
                let (pose, value) = statistic.pose_with_value(&values);
                assert_eq!((value, values[pose], statistic.of(&mut values.clone())), (truth, truth, truth), "{n}");
            }
            let largest = Statistic::Max.pose_with_value(&values).0;
            assert!(values[..largest].iter().all(|x| *x < values[largest]), "of equal ones the first");
        }
    }

    #[test]
    fn parts_sum_up_to_the_length() {
        let list = parts(&[[3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 0.0]], [0.0; 3]);
        assert!((list.iter().sum::<f64>() - 5.0).abs() < 1e-15 && (list[0] - 1.8).abs() < 1e-15);
        assert_eq!(parts(&[[0.0; 3]], [0.0; 3]), [0.0]);
        assert_eq!(parts(&[[3.0, 0.0, 0.0]], [0.0, 4.0, 0.0]), [1.8]);
    }
}
