//! The covariance of the unknowns by what all readings share.

use super::fit::Fit;
use super::solution::Solution;
use crate::identify::data::Measurement;
use crate::identify::model::{Model, TypeB};
use nalgebra::DMatrix;
use rayon::prelude::*;

/// Measurements that are summed together: the sums do not depend on the number of threads.
const TOGETHER: usize = 1024;

/// Returns the covariance of the unknowns, in their units, that uncertainties of type B make, each to first order.
pub fn common(
    model: &Model<'_>,
    data: &[Measurement],
    (fit, solution): (&Fit, &Solution),
    all: &[TypeB],
) -> DMatrix<f64> {
    let count = fit.theta.len();
    let effects = |m: &Measurement| all.iter().flat_map(|of| of.effect.of(model, m, &fit.theta)).collect::<Vec<_>>();
    let width = data.first().map_or(0, |m| effects(m).len());
    if width == 0 {
        return DMatrix::zeros(count, count);
    }
    let sum = |(data, weights): (&[Measurement], &[f64])| {
        let mut sum = DMatrix::zeros(count, width);
        for (m, weight) in data.iter().zip(weights) {
            let (unknowns, _) = model.rows(m, &fit.theta);
            for (k, effect) in effects(m).into_iter().enumerate() {
                // What was not read has no row in `unknowns`.
                sum.column_mut(k).iter_mut().zip(&unknowns).for_each(|(s, u)| *s += u.dot(&effect) * weight);
            }
        }
        sum
    };
    let parts: Vec<DMatrix<f64>> = data.par_chunks(TOGETHER).zip(fit.weights.par_chunks(TOGETHER)).map(sum).collect();
    let cross = parts.into_iter().fold(DMatrix::zeros(count, width), |sum, part| sum + part);
    let moved = solution.unit_covariance() * cross;
    &moved * moved.transpose()
}
