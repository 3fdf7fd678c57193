//! Statistics of deviations over a volume, in micrometres and microradians.

use super::terms::Deviation;
use nalgebra::Vector3;
use serde::Serialize;

/// Statistics of the deviations at many poses: the contract of `map` and of certificates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Statistics {
    /// Number of poses.
    pub poses: usize,
    /// Position deviations of the functional point, um.
    pub position_um: Summary,
    /// Rotations of the tool, urad.
    pub rotation_urad: Summary,
}

/// Statistics of vectors: of their length, except for the range.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, schemars::JsonSchema)]
pub struct Summary {
    /// Largest length.
    pub max: f64,
    /// Mean length.
    pub mean: f64,
    /// Root of the mean of the squared length.
    pub rms: f64,
    /// The ceil(0.95 n)-th smallest length.
    pub p95: f64,
    /// Maximum minus minimum of each component; ISO 230-1 builds V_XYZ of these.
    pub range: [f64; 3],
}

impl Statistics {
    /// Returns the statistics of deviations in mm and rad; all zero without deviations.
    pub fn of(deviations: &[Deviation]) -> Self {
        Self {
            poses: deviations.len(),
            position_um: Summary::of(&vectors(deviations, |d| d.position * 1e3)),
            rotation_urad: Summary::of(&vectors(deviations, |d| d.rotation * 1e6)),
        }
    }

    /// Returns these minus other statistics, number by number: negative is better than the others.
    pub fn minus(&self, other: &Self) -> Difference {
        Difference {
            position_um: self.position_um.minus(&other.position_um),
            rotation_urad: self.rotation_urad.minus(&other.rotation_urad),
        }
    }
}

/// Statistics minus statistics.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Difference {
    /// Position deviations of the functional point, um.
    pub position_um: Summary,
    /// Rotations of the tool, urad.
    pub rotation_urad: Summary,
}

fn vectors(deviations: &[Deviation], pick: impl Fn(&Deviation) -> Vector3<f64>) -> Vec<Vector3<f64>> {
    deviations.iter().map(pick).collect()
}

impl Summary {
    /// Returns the statistics of vectors, in their unit; all zero without vectors.
    pub fn of(vectors: &[Vector3<f64>]) -> Self {
        if vectors.is_empty() {
            return Self::default();
        }
        let mut lengths: Vec<f64> = vectors.iter().map(Vector3::norm).collect();
        let range = std::array::from_fn(|i| range(vectors.iter().map(|v| v[i])));
        Self { range, ..Self::of_lengths(&mut lengths) }
    }

    /// Returns the statistics of lengths, in their unit, without ranges; all zero without lengths. Reorders the
    /// lengths.
    pub fn of_lengths(lengths: &mut [f64]) -> Self {
        if lengths.is_empty() {
            return Self::default();
        }
        let count = lengths.len() as f64;
        Self {
            max: lengths.iter().copied().fold(0.0, f64::max),
            mean: lengths.iter().sum::<f64>() / count,
            rms: (lengths.iter().map(|l| l * l).sum::<f64>() / count).sqrt(),
            range: [0.0; 3],
            p95: quantile_95(lengths),
        }
    }

    fn minus(&self, other: &Self) -> Self {
        Self {
            max: self.max - other.max,
            mean: self.mean - other.mean,
            rms: self.rms - other.rms,
            p95: self.p95 - other.p95,
            range: std::array::from_fn(|i| self.range[i] - other.range[i]),
        }
    }
}

fn range(values: impl Iterator<Item = f64>) -> f64 {
    let (min, max) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), x| (min.min(x), max.max(x)));
    max - min
}

/// Returns the ceil(0.95 n)-th smallest value, its rank computed in integers because 0.95 is not a double; 0 without
/// values. Reorders the values.
pub fn quantile_95(values: &mut [f64]) -> f64 {
    let rank = (values.len() * 95).div_ceil(100);
    if rank == 0 {
        return 0.0;
    }
    let (_, value, _) = values.select_nth_unstable_by(rank - 1, f64::total_cmp);
    *value
}

/// Returns the indices of the `count` largest position deviations, largest first; of equal ones the first.
pub fn worst(deviations: &[Deviation], count: usize) -> Vec<usize> {
    let lengths: Vec<f64> = deviations.iter().map(|d| d.position.norm()).collect();
    let mut indices: Vec<usize> = (0..lengths.len()).collect();
    let order = |a: &usize, b: &usize| lengths[*b].total_cmp(&lengths[*a]).then(a.cmp(b));
    if count < indices.len() {
        let _ = indices.select_nth_unstable_by(count, order);
        indices.truncate(count);
    }
    indices.sort_unstable_by(order);
    indices
}

#[cfg(test)]
mod tests {
    use super::*;

    fn deviations(x_um: &[f64]) -> Vec<Deviation> {
        let one = |x: &f64| Deviation { position: Vector3::new(x * 1e-3, 0.0, 0.0), rotation: Vector3::zeros() };
        x_um.iter().map(one).collect()
    }

    #[test]
    fn statistics_of_a_known_list() {
        let s = Statistics::of(&deviations(&[3.0, -4.0]));
        assert_eq!(s.poses, 2);
        let p = s.position_um;
        assert!((p.max - 4.0).abs() < 1e-15 && (p.mean - 3.5).abs() < 1e-15 && (p.rms - 12.5_f64.sqrt()).abs() < 1e-15);
        assert!((p.range[0] - 7.0).abs() < 1e-15 && p.range[1] == 0.0);
        assert_eq!(s.rotation_urad, Summary::default());
    }

    #[test]
    fn the_quantile_is_the_named_rank() {
        for (n, rank) in [(1, 1), (19, 19), (20, 19), (21, 20), (40, 38), (100, 95), (101, 96)] {
            let mut values: Vec<f64> = (1..=n).rev().map(f64::from).collect();
            assert_eq!(quantile_95(&mut values), f64::from(rank), "{n}");
        }
    }

    #[test]
    fn the_worst_come_first_and_ties_keep_their_order() {
        let list = deviations(&[1.0, 5.0, -5.0, 2.0, 5.0]);
        assert_eq!(worst(&list, 3), [1, 2, 4]);
        assert_eq!(worst(&list, 9), [1, 2, 4, 3, 0]);
        assert!(worst(&[], 3).is_empty());
    }
}
