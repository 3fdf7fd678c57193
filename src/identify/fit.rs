//! Weighted least squares on the exact model: Levenberg-Marquardt on the triangle.
//!
//! Steps are the shortest ones in units of displacement, so that directions which the data do not see stay where
//! they are. Damping is needed although the model is almost linear: where a direction is nearly invisible, the
//! undamped step is a large turn, the model is not linear over it, and the iteration runs to and fro. For the
//! same reason there is a weak prior: a parameter is within some 3 mm or 10 mrad of its start. It costs a well
//! determined parameter far less than its uncertainty, and what the noise drowns stays at home.

use super::measurement::Measurement;
use super::model::Model;
use crate::algebra::linear::Reduced;
use nalgebra::{DVector, Vector3};

/// Most accepted steps.
const STEPS: usize = 200;
/// A step that promises less than this share of the sum of squares is the last.
const PROMISE: f64 = 1e-13;
/// Or less than this per reading (mm^2): the rounding of positions.
const ROUNDING: f64 = 1e-22;
/// Singular values below this share of the largest are noise of rounding, for steps.
const NOISE: f64 = 1e-12;
/// Damping as a share of the largest squared singular value: first, and where it is given up.
const FIRST: f64 = 1e-9;
const MOST: f64 = 1e6;

/// Standard deviation of the prior, as a displacement (mm).
const PRIOR: f64 = 3.0;

/// Where a fit has come to.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Values of the parameters (mm, rad, degrees of position).
    pub theta: Vec<f64>,
    /// The linear problem there.
    pub reduced: Reduced,
    /// Weight of each measurement.
    pub weights: Vec<f64>,
    /// Accepted steps.
    pub steps: usize,
    /// Did it settle, rather than run out of steps?
    pub settled: bool,
}

/// Weighted sum of squares (mm^2).
fn cost(model: &Model<'_>, data: &[Measurement], weights: &[f64], theta: &[f64]) -> f64 {
    let residuals = model.residuals(data, theta);
    residuals.iter().zip(weights).map(|(r, w)| r.norm_squared() * w).sum()
}

/// Fits the parameters to the data, from their starts or from `theta`.
pub fn fit(model: &Model<'_>, data: &[Measurement], weights: Vec<f64>, theta: Option<Vec<f64>>) -> Fit {
    let start: Vec<f64> = model.parameters().iter().map(|p| p.start).collect();
    let scale = DVector::from_iterator(start.len(), model.parameters().iter().map(|p| p.size));
    let away = |theta: &[f64]| DVector::from_fn(start.len(), |j, _| (theta[j] - start[j]) * scale[j]);
    let mut theta = theta.unwrap_or_else(|| start.clone());
    let mut now = cost(model, data, &weights, &theta);
    let mut damping = FIRST;
    for steps in 0..STEPS {
        let reduced = model.linearised(data, &weights, &theta);
        // The prior against the scatter of the readings as far as it is known by now.
        let pull = now / reduced.rows.max(1) as f64 / (PRIOR * PRIOR);
        let home = away(&theta);
        let svd = reduced.scaled(&scale);
        let (rank, largest) = (svd.rank(NOISE), svd.values.iter().copied().fold(0.0, f64::max));
        let before = now + pull * home.norm_squared();
        loop {
            let scaled = svd.step(&reduced.right, rank, (&home, pull), damping * largest * largest);
            let step = scaled.component_div(&scale);
            let left = (&reduced.right - &reduced.r * &step).norm_squared() + pull * (&home + &scaled).norm_squared();
            let promise = reduced.right.norm_squared() + pull * home.norm_squared() - left;
            if promise.is_nan() || promise <= PROMISE * before + ROUNDING * reduced.rows as f64 || damping > MOST {
                let settled = damping <= MOST;
                return Fit { theta, reduced, weights, steps, settled };
            }
            let trial: Vec<f64> = theta.iter().zip(step.iter()).map(|(t, s)| t + s).collect();
            let then = cost(model, data, &weights, &trial);
            let gain = before - then - pull * away(&trial).norm_squared();
            if gain > 0.0 {
                // A step that kept its promise may be longer next time.
                damping = if gain > 0.5 * promise { damping * 0.01 } else { damping };
                (theta, now) = (trial, then);
                break;
            }
            damping *= 10.0;
        }
    }
    let reduced = model.linearised(data, &weights, &theta);
    Fit { theta, reduced, weights, steps: STEPS, settled: false }
}

/// Huber's constant, in standard deviations of a component.
const HUBER: f64 = 1.5;
/// Rounds of reweighting.
const ROUNDS: usize = 30;

/// The same with robust weights (Huber): a measurement further off than 1.5 standard deviations per
/// component counts less, so that a bumped set-up does not bend the machine.
pub fn robust_fit(model: &Model<'_>, data: &[Measurement]) -> Fit {
    let given: Vec<f64> = data.iter().map(|m| m.weight).collect();
    let mut found = fit(model, data, given.clone(), None);
    for _ in 0..ROUNDS {
        let residuals = model.residuals(data, &found.theta);
        let weights: Vec<f64> = standardised(data, &residuals)
            .into_iter()
            .zip(&given)
            .map(|(size, weight)| weight * if size > HUBER { HUBER / size } else { 1.0 })
            .collect();
        let change = weights.iter().zip(&found.weights).map(|(a, b)| (a - b).abs() / b).fold(0.0, f64::max);
        found = fit(model, data, weights, Some(found.theta));
        if change < 1e-3 {
            break;
        }
    }
    found
}

/// Root mean square component of each residual in robust standard deviations.
pub fn standardised(data: &[Measurement], residuals: &[Vector3<f64>]) -> Vec<f64> {
    let component = |(m, r): (&Measurement, &Vector3<f64>)| r.norm() * (m.weight / m.readings().max(1) as f64).sqrt();
    let sizes: Vec<f64> = data.iter().zip(residuals).map(component).collect();
    let mut components: Vec<f64> = data
        .iter()
        .zip(residuals)
        .flat_map(|(m, r)| (0..3).filter(|i| m.deviation[*i].is_some()).map(|i| r[i].abs() * m.weight.sqrt()))
        .collect();
    components.sort_by(f64::total_cmp);
    // The median of the absolute value of a normal deviate is 0.6745 standard deviations.
    let median = components.get(components.len() / 2).copied().unwrap_or_default();
    let sigma = (median / 0.6745).max(f64::MIN_POSITIVE);
    sizes.into_iter().map(|size| size / sigma).collect()
}
