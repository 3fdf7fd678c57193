//! The form of an axis that its error curves leave: a random function of the position in each direction.

use super::{Axis, AxisName, Curve, Direction, Knots, Travel};
use nalgebra::{DMatrix, SymmetricEigen};

/// Knots to a correlation length.
const KNOTS_PER_LENGTH: f64 = 2.0;
/// Least and largest number of knots over the travel.
const KNOTS: (usize, usize) = (6, 64);
/// Variance of a mode, as a share of the largest, below which the mode is left out.
pub const MIN_MODE_SHARE: f64 = 1e-3;
/// Steps in which a symmetric matrix of this size is diagonal, or never.
pub const MAX_EIGEN_STEPS: usize = 10_000;
/// A turn, deg.
const TURN: f64 = 360.0;

/// The scatter of an axis about its error curves: a Gaussian process of zero mean for each of its displacements and
/// rotations, independent of the others.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualForm {
    /// The axis.
    pub axis: AxisName,
    /// Standard deviation of each displacement, mm; 0 if they have no form.
    pub size: f64,
    /// Standard deviation of each rotation, rad; 0 if they have no form.
    pub rotation: f64,
    /// Correlation length, mm or deg: values at positions so far apart correlate by exp(-1/2).
    pub length: f64,
}

impl ResidualForm {
    /// Returns the standard deviation of the error in a direction, mm or rad.
    pub fn scatter(&self, direction: Direction) -> f64 {
        if direction.is_rotation() { self.rotation } else { self.size }
    }

    /// Returns independent modes of the form in a direction, one standard deviation each (mm or rad over mm or deg),
    /// the largest first: straight lines between knots over the travel.
    pub fn modes(&self, axis: &Axis, direction: Direction) -> Vec<Curve> {
        let size = self.scatter(direction);
        if size == 0.0 {
            return Vec::new();
        }
        let (min, max) = axis.travel.interval();
        let turns = axis.travel == Travel::Continuous;
        let wanted = ((max - min) / self.length * KNOTS_PER_LENGTH).ceil() as usize;
        let count = wanted.saturating_add(1).clamp(KNOTS.0, KNOTS.1);
        // The last knot of a turn is the first again.
        let steps = if turns { count } else { count - 1 };
        let place = |i: usize| if i == steps { max } else { min + (max - min) * i as f64 / steps as f64 };
        let apart = |i: usize, j: usize| {
            let straight = (place(i) - place(j)).abs();
            if turns { straight.min(TURN - straight) } else { straight }
        };
        let near = |i: usize, j: usize| {
            let lengths = apart(i, j) / self.length;
            libm::exp(-0.5 * lengths * lengths)
        };
        let correlations = DMatrix::from_fn(count, count, near);
        let Some(spectrum) = SymmetricEigen::try_new(correlations, f64::EPSILON, MAX_EIGEN_STEPS) else {
            return Vec::new();
        };
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|a, b| spectrum.eigenvalues[*b].total_cmp(&spectrum.eigenvalues[*a]).then(a.cmp(b)));
        let kept = order.iter().filter(|k| spectrum.eigenvalues[**k] > MIN_MODE_SHARE * spectrum.eigenvalues[order[0]]);
        let mode = |k: &usize| {
            let scale = size * libm::sqrt(spectrum.eigenvalues[*k]);
            let value = |i: usize| spectrum.eigenvectors[(i % count, *k)] * scale;
            let points: Vec<(f64, f64)> = (0..=steps).map(|i| (place(i), value(i))).collect();
            Knots::new(&points, turns.then_some(TURN)).ok().map(Curve::Linear)
        };
        kept.filter_map(mode).collect()
    }
}
