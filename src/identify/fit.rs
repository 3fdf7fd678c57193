//! Weighted least squares on the exact model: Levenberg-Marquardt on the triangle.
//!
//! Steps are the shortest ones in units of displacement, so that directions which the data do not see stay where
//! they are. Damping is needed although the model is almost linear: where a direction is nearly invisible, the
//! undamped step is a large turn, the model is not linear over it, and the iteration runs to and fro. For the
//! same reason there is a weak prior: the displacement that a parameter makes is not beyond thirty times what was
//! measured, or 3 mm (10 mrad). It costs a well determined parameter far less than its uncertainty, and what the noise
//! drowns stays at home.

use super::measurement::Measurement;
use super::model::Model;
use crate::algebra::linear::{Reduced, Svd};
use nalgebra::{DMatrix, DVector, Vector3};

/// Most accepted steps.
const STEPS: usize = 200;
/// Relative offset of Bates and Watts (1981): a step that moves the estimate by less than this share of the radius of its
/// confidence region is the last. Where the data see all unknowns the next one would be smaller by orders; along what the
/// noise drowns the iteration creeps for long, and gains nothing that could be told from noise.
const OFFSET: f64 = 1e-3;
/// A step that promises less than this share of the sum of squares is none.
const PROMISE: f64 = 1e-15;
/// Or less than this per reading (mm^2): the rounding of positions.
const ROUNDING: f64 = 1e-22;
/// Singular values below this share of the largest are noise of rounding, for steps.
const NOISE: f64 = 1e-12;
/// Damping as a share of the largest squared singular value: first, and where it is given up.
const FIRST: f64 = 1e-12;
const MOST: f64 = 1e6;

/// Readings times unknowns squared from which on normal equations are worth a look.
const LARGE: f64 = 1e8;
/// Condition up to which the normal equations give the step.
const EASY: f64 = 1e5;

/// Standard deviation of the prior, as a displacement: so many times the root mean square of what was measured, and at
/// most this (mm).
const PRIOR: (f64, f64) = (30.0, 3.0);

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

/// The linear problem anywhere: by normal equations where there is much to reduce and the columns are well apart.
struct Linear<'a> {
    model: &'a Model<'a>,
    data: &'a [Measurement],
    weights: &'a [f64],
    quick: bool,
}

impl<'a> Linear<'a> {
    fn new(model: &'a Model<'_>, data: &'a [Measurement], weights: &'a [f64], theta: &[f64]) -> Self {
        let readings: usize = data.iter().map(Measurement::readings).sum();
        let unknowns = model.parameters().len() as f64;
        let large = readings as f64 * unknowns * unknowns > LARGE;
        Self { model, data, weights, quick: large && model.is_easy(data, weights, theta) }
    }

    fn at(&mut self, theta: &[f64]) -> Reduced {
        let quick = if self.quick { self.model.quick(self.data, self.weights, theta) } else { None };
        self.quick = quick.is_some();
        quick.unwrap_or_else(|| self.model.triangle(self.data, self.weights, theta))
    }
}

/// Fits the unknowns to the data, from their starts or from `theta`.
pub fn fit(model: &Model<'_>, data: &[Measurement], weights: Vec<f64>, theta: Option<Vec<f64>>) -> Fit {
    let home: Vec<f64> = model.parameters().iter().map(|p| p.start).collect();
    let mut linear = Linear::new(model, data, &weights, &home);
    let at_home = linear.at(&home);
    let heft: f64 = data.iter().zip(&weights).map(|(m, weight)| weight * m.readings() as f64).sum();
    let prior = Prior::new(model, at_home.right_norm() / libm::sqrt(heft));
    let (mut theta, mut reduced) = match theta {
        Some(theta) => {
            let there = linear.at(&theta);
            (theta, there)
        }
        None => (home, at_home),
    };
    let (mut damping, mut steps, mut settled) = (FIRST, 0, false);
    let mut small_before = false;
    while steps < STEPS && !settled && damping <= MOST {
        // The prior against the scatter of the readings as far as it is known by now.
        let variance = reduced.right_norm() * reduced.right_norm() / reduced.rows.max(1) as f64;
        let problem = Problem::new(&prior, &reduced, &theta, variance);
        let before = prior.cost(&reduced, &theta, variance);
        // The sum of squares is not known better than this. A step that promises less is taken on trust, and is the last.
        let unseen = 2.0 * libm::sqrt(before * ROUNDING);
        let small = unseen.max(OFFSET * OFFSET * theta.len() as f64 * variance);
        let mut first = true;
        while damping <= MOST {
            let scaled = problem.step(damping);
            let promise = before - problem.cost(&scaled);
            if promise.is_nan() || promise <= PROMISE * before + ROUNDING * reduced.rows as f64 {
                settled = true;
                break;
            }
            let step = scaled.component_div(&prior.scale);
            let trial: Vec<f64> = theta.iter().zip(step.iter()).map(|(t, s)| t + s).collect();
            let then = linear.at(&trial);
            let gain = before - prior.cost(&then, &trial, variance);
            if gain > 0.0 || (promise <= unseen && gain >= -unseen) {
                // A step that was cut short is small for that alone: then the next one decides.
                let is_small = promise <= small && gain <= small;
                settled = is_small && (first || small_before);
                small_before = is_small;
                // A step that kept its promise may be longer next time.
                damping *= if gain > 0.5 * promise { 0.01 } else { 1.0 };
                (theta, reduced) = (trial, then);
                steps += 1;
                break;
            }
            damping *= 10.0;
            first = false;
        }
    }
    Fit { theta, reduced, weights, steps, settled }
}

/// What is known before the data: parameters are near their starts, and curves are not steep.
struct Prior<'a> {
    start: Vec<f64>,
    /// Displacement that a unit of each unknown makes.
    scale: DVector<f64>,
    /// 1 for parameters of the machine, 0 for unknowns of instruments: nothing is known of those.
    counts: DVector<f64>,
    slopes: &'a DMatrix<f64>,
    /// Standard deviation of a displacement (mm).
    sigma: f64,
}

impl<'a> Prior<'a> {
    /// `measured`: root mean square of the readings, as far as the start leaves them (mm).
    fn new(model: &'a Model<'_>, measured: f64) -> Self {
        let list = model.parameters();
        let (times, most) = PRIOR;
        Self {
            sigma: (times * measured).min(most).max(f64::MIN_POSITIVE),
            start: list.iter().map(|p| p.start).collect(),
            scale: DVector::from_iterator(list.len(), list.iter().map(|p| p.size)),
            counts: DVector::from_fn(list.len(), |j, _| f64::from(u8::from(j < model.own()))),
            slopes: model.slopes(),
        }
    }

    /// Weight of a displacement beside readings of this variance.
    fn pull(&self, variance: f64) -> f64 {
        if variance > 0.0 { variance / self.sigma / self.sigma } else { 0.0 }
    }

    /// How far from home, in units of displacement.
    fn away(&self, theta: &[f64]) -> DVector<f64> {
        DVector::from_fn(theta.len(), |j, _| (theta[j] - self.start[j]) * self.scale[j] * self.counts[j])
    }

    /// Weighted sum of squares (mm^2) of readings and prior, readings scattering with this variance.
    fn cost(&self, reduced: &Reduced, theta: &[f64], variance: f64) -> f64 {
        let slopes = self.slopes * DVector::from_column_slice(theta);
        let pull = self.pull(variance);
        let data = reduced.right_norm() * reduced.right_norm();
        data + pull * self.away(theta).norm_squared() + variance * slopes.norm_squared()
    }
}

/// The linear problem of one step.
struct Problem {
    reduced: Reduced,
    scale: DVector<f64>,
    home: DVector<f64>,
    pull: f64,
    solver: Solver,
}

/// The singular values where the data may leave directions free; else the normal equations do.
enum Solver {
    Singular(Svd, usize),
    Normal(DMatrix<f64>, f64),
}

impl Problem {
    fn new(prior: &Prior<'_>, reduced: &Reduced, theta: &[f64], variance: f64) -> Self {
        let root = libm::sqrt(variance);
        let slopes = prior.slopes * root;
        let right = -&slopes * DVector::from_column_slice(theta);
        let reduced = if slopes.nrows() > 0 { reduced.with_rows(&slopes, &right) } else { reduced.clone() };
        let solver = if reduced.condition() < EASY {
            let scaled = DMatrix::from_fn(theta.len(), theta.len(), |i, j| reduced.r[(i, j)] / prior.scale[j]);
            let normal = scaled.tr_mul(&scaled);
            let largest = normal.diagonal().max();
            Solver::Normal(normal, largest)
        } else {
            let svd = reduced.scaled(&prior.scale);
            let rank = svd.rank(NOISE);
            Solver::Singular(svd, rank)
        };
        let (scale, home) = (prior.scale.clone(), prior.away(theta));
        Self { reduced, scale, home, pull: prior.pull(variance), solver }
    }

    /// The best step, in units of displacement.
    fn step(&self, damping: f64) -> DVector<f64> {
        match &self.solver {
            Solver::Singular(svd, rank) => {
                let largest = svd.values.iter().copied().fold(0.0, f64::max);
                svd.step(&self.reduced.right, *rank, (&self.home, self.pull), damping * largest * largest)
            }
            Solver::Normal(normal, largest) => {
                let n = normal.ncols();
                let force =
                    self.reduced.r.tr_mul(&self.reduced.right).component_div(&self.scale) - &self.home * self.pull;
                let stiff = normal + DMatrix::identity(n, n) * (self.pull + damping * largest);
                stiff.cholesky().map_or_else(|| DVector::zeros(n), |factor| factor.solve(&force))
            }
        }
    }

    /// What a step would leave.
    fn cost(&self, scaled: &DVector<f64>) -> f64 {
        let step = scaled.component_div(&self.scale);
        let left = (&self.reduced.right - &self.reduced.r * &step).norm_squared();
        left + self.reduced.rest * self.reduced.rest + self.pull * (&self.home + scaled).norm_squared()
    }
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
        .flat_map(|(m, r)| (0..3).filter(|i| m.seen()[*i]).map(|i| r[i].abs() * m.weight.sqrt()))
        .collect();
    components.sort_by(f64::total_cmp);
    // The median of the absolute value of a normal deviate is 0.6745 standard deviations.
    let median = components.get(components.len() / 2).copied().unwrap_or_default();
    let sigma = (median / 0.6745).max(f64::MIN_POSITIVE);
    sizes.into_iter().map(|size| size / sigma).collect()
}
