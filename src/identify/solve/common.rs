//! The covariance of the unknowns by what all readings share.

use super::fit::Fit;
use super::solution::Solution;
use super::sums::summed;
use crate::identify::data::Measurement;
use crate::identify::model::{Model, TypeB};
use nalgebra::DMatrix;

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
    let add = |sum: &mut DMatrix<f64>, m: &Measurement, weight: f64| {
        let (unknowns, _) = model.rows(m, &fit.theta);
        for (k, effect) in effects(m).into_iter().enumerate() {
            // What was not read has no row in `unknowns`.
            sum.column_mut(k).iter_mut().zip(&unknowns).for_each(|(s, u)| *s += u.dot(&effect) * weight);
        }
    };
    let cross = summed((data, &fit.weights), || DMatrix::zeros(count, width), add, |a, b| a + b);
    let moved = solution.unit_covariance() * cross;
    &moved * moved.transpose()
}
