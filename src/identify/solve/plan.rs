//! A plan of few poses to measure, such that the parameters are known best. Nothing has to be measured for it.

use super::fit::Fit;
use super::solution::Solution;
use crate::diagnostic::{Place, SourceId};
use crate::evaluate::{Frame, random_poses};
use crate::identify::data::{Measurement, Reading};
use crate::identify::model::{Model, invariances};
use nalgebra::{DMatrix, Matrix3};

/// Random poses to choose from, for each tool.
const CANDIDATES: usize = 500;
/// Knowledge of a parameter before, as a displacement (mm).
const BEFORE: f64 = 3.0;

/// Poses worth measuring, and what they will tell.
#[derive(Debug, Clone)]
pub struct MeasurementPlan {
    /// In the order in which they help most; nothing is measured in them.
    pub poses: Vec<Measurement>,
    /// Uncertainties, rank and null space to be expected; the values are those of the machine file.
    pub expected: Solution,
}

/// Chooses `count` poses from the volume (and the tools) of the machine, one after the other the one that
/// shrinks the uncertainty of all parameters together most (the determinant of their covariance), all three
/// components measured with a standard deviation of `noise` (mm).
pub fn plan(model: &Model<'_>, count: usize, noise: f64, seed: u64) -> MeasurementPlan {
    let candidates = candidates(model, seed);
    let theta: Vec<f64> = model.parameters().iter().map(|p| p.start).collect();
    let rows: Vec<DMatrix<f64>> = candidates.iter().map(|c| scaled_rows(model, c, &theta, noise)).collect();
    let mut covariance = DMatrix::identity(theta.len(), theta.len()) * (BEFORE * BEFORE);
    let mut poses = Vec::new();
    for _ in 0..count {
        let gain = |rows: &DMatrix<f64>| (Matrix3::identity() + spread(rows, &covariance)).determinant();
        // The first of equals.
        let best = rows.iter().map(gain).enumerate().fold((0, f64::NEG_INFINITY), |b, g| if g.1 > b.1 { g } else { b });
        update(&mut covariance, &rows[best.0]);
        poses.push(candidates[best.0].clone());
    }
    let expected = expected(model, &poses, &theta, noise);
    MeasurementPlan { poses, expected }
}

fn candidates(model: &Model<'_>, seed: u64) -> Vec<Measurement> {
    let place = Place { source: SourceId(0), range: 0..0 };
    let of_tool = |(tool, machine): (usize, &crate::machine::Machine)| {
        let poses = random_poses(machine, CANDIDATES, seed.wrapping_add(tool as u64));
        let place = place.clone();
        let reading = Reading::Deviation { values: [Some(0.0); 3], frame: Frame::Workpiece, zero: [None; 3] };
        let blank = move |pose| Measurement { tool, ..Measurement::new(pose, reading.clone(), place.clone()) };
        poses.into_iter().map(blank).collect::<Vec<_>>()
    };
    model.machines().iter().enumerate().flat_map(of_tool).collect()
}

/// Derivatives of the three components by the parameters in units of displacement, over the noise.
fn scaled_rows(model: &Model<'_>, candidate: &Measurement, theta: &[f64], noise: f64) -> DMatrix<f64> {
    let (columns, _) = model.rows(candidate, theta);
    DMatrix::from_fn(3, columns.len(), |i, j| columns[j][i] / model.parameters()[j].size / noise)
}

/// Covariance of the predicted components, in units of the noise.
fn spread(rows: &DMatrix<f64>, covariance: &DMatrix<f64>) -> Matrix3<f64> {
    let spread = rows * covariance * rows.transpose();
    Matrix3::from_fn(|i, j| spread[(i, j)])
}

/// The covariance after one more measurement.
fn update(covariance: &mut DMatrix<f64>, rows: &DMatrix<f64>) {
    let seen = &*covariance * rows.transpose();
    if let Some(inverse) = (Matrix3::identity() + spread(rows, covariance)).try_inverse() {
        let inverse = DMatrix::from_fn(3, 3, |i, j| inverse[(i, j)]);
        *covariance -= &seen * inverse * seen.transpose();
    }
}

fn expected(model: &Model<'_>, poses: &[Measurement], theta: &[f64], noise: f64) -> Solution {
    let weights = vec![1.0; poses.len()];
    let reduced = model.triangle(poses, &weights, theta);
    let bounded = vec![false; theta.len()];
    let (theta, scatter, freedom, known) = (theta.to_vec(), Vec::new(), Vec::new(), model.known().0);
    let (squares, shown, steps, settled) = (0.0, 0.0, 0, true);
    let mut fit = Fit { theta, reduced, squares, weights, scatter, freedom, known, shown, bounded, steps, settled };
    // As if the readings scattered by the noise over as many degrees of freedom as there will be.
    let rest = Solution::of(&fit, model.parameters()).freedom.max(1);
    fit.squares = noise * noise * rest as f64;
    let motions = invariances(model, poses).moving;
    Solution::of(&fit, model.parameters()).compared(model, poses, &fit, &motions)
}
