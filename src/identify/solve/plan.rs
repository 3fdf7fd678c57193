//! A plan of few poses to measure, such that the parameters are known best. Nothing has to be measured for it.

use super::fit::ParameterFit;
use super::solution::Solution;
use crate::diagnostic::{Place, SourceId};
use crate::evaluate::{Frame, random_poses};
use crate::identify::data::{Measurement, Reading};
use crate::identify::model::{FitModel, invariances};
use crate::identify::thresholds::{MIN_PRIOR_SIGMA_MM, PLAN_CANDIDATES};
use nalgebra::{DMatrix, Matrix3};

/// Poses to measure, and the uncertainties to be expected.
#[derive(Debug, Clone)]
pub struct PosePlan {
    /// In the order in which they help most; nothing is measured in them.
    pub poses: Vec<Measurement>,
    /// Uncertainties, rank and null space to be expected; the values are those of the machine file.
    pub expected: Solution,
}

/// Chooses `count` poses from the volume (and the tools) of the machine, one after the other: each time the one that
/// shrinks the determinant of the parameters' covariance most (D-optimality). All three components are measured with a
/// standard deviation of `noise` (mm).
pub fn plan(model: &FitModel<'_>, count: usize, noise: f64, seed: u64) -> PosePlan {
    let candidates = candidates(model, seed);
    let theta: Vec<f64> = model.parameters().iter().map(|p| p.start).collect();
    let rows: Vec<DMatrix<f64>> = candidates.iter().map(|c| scaled_rows(model, c, &theta, noise)).collect();
    let mut covariance = DMatrix::identity(theta.len(), theta.len()) * (MIN_PRIOR_SIGMA_MM * MIN_PRIOR_SIGMA_MM);
    let mut poses = Vec::new();
    for _ in 0..count {
        let gain = |rows: &DMatrix<f64>| (Matrix3::identity() + spread(rows, &covariance)).determinant();
        // The first of equals.
        let best = rows.iter().map(gain).enumerate().fold((0, f64::NEG_INFINITY), |b, g| if g.1 > b.1 { g } else { b });
        update(&mut covariance, &rows[best.0]);
        poses.push(candidates[best.0].clone());
    }
    let expected = expected_solution(model, &poses, &theta, noise);
    PosePlan { poses, expected }
}

fn candidates(model: &FitModel<'_>, seed: u64) -> Vec<Measurement> {
    let place = Place { source: SourceId(0), range: 0..0 };
    let of_tool = |(tool, machine): (usize, &crate::machine::Machine)| {
        let poses = random_poses(machine, PLAN_CANDIDATES, seed.wrapping_add(tool as u64));
        let place = place.clone();
        let reading = Reading::Deviation { values: [Some(0.0); 3], frame: Frame::Workpiece, zero: [None; 3] };
        let blank = move |pose| Measurement { tool, ..Measurement::new(pose, reading.clone(), place.clone()) };
        poses.into_iter().map(blank).collect::<Vec<_>>()
    };
    model.machines().iter().enumerate().flat_map(of_tool).collect()
}

/// Returns the derivatives of the three components by displacements of the parameters, over the noise.
fn scaled_rows(model: &FitModel<'_>, candidate: &Measurement, theta: &[f64], noise: f64) -> DMatrix<f64> {
    let (columns, _) = model.rows(candidate, theta);
    DMatrix::from_fn(3, columns.len(), |i, j| columns[j][i] / model.parameters()[j].size / noise)
}

/// Returns the covariance of the predicted components, in units of the noise.
fn spread(rows: &DMatrix<f64>, covariance: &DMatrix<f64>) -> Matrix3<f64> {
    let spread = rows * covariance * rows.transpose();
    Matrix3::from_fn(|i, j| spread[(i, j)])
}

/// Updates the covariance by one more measurement (Sherman, Morrison and Woodbury).
fn update(covariance: &mut DMatrix<f64>, rows: &DMatrix<f64>) {
    let seen = &*covariance * rows.transpose();
    if let Some(inverse) = (Matrix3::identity() + spread(rows, covariance)).try_inverse() {
        let inverse = DMatrix::from_fn(3, 3, |i, j| inverse[(i, j)]);
        *covariance -= &seen * inverse * seen.transpose();
    }
}

fn expected_solution(model: &FitModel<'_>, poses: &[Measurement], theta: &[f64], noise: f64) -> Solution {
    let weights = vec![1.0; poses.len()];
    let reduced = model.triangle(poses, &weights, theta);
    let blank = ParameterFit::new(model, theta.to_vec(), reduced, weights);
    let mut fit = ParameterFit { squares: 0.0, converged: true, ..blank };
    // As if the readings scattered by the noise over as many degrees of freedom as there will be.
    let rest = Solution::of(&fit, model.parameters()).degrees_of_freedom.max(1);
    fit.squares = noise * noise * rest as f64;
    let motions = invariances(model, poses, theta).motion_parameters;
    Solution::of(&fit, model.parameters()).with_first_order_rank(model, poses, &fit, &motions)
}
