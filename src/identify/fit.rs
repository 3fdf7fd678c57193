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
/// confidence region is the last.
const OFFSET: f64 = 1e-3;
/// The same within which the linear problem is trusted for the last step, if the steps before converged.
const NEAR: f64 = 0.1;
/// A step that promises less than this share of the sum of squares is none.
const PROMISE: f64 = 1e-15;
/// Or less than this per reading (mm^2): the rounding of positions.
const ROUNDING: f64 = 1e-22;
/// Singular values below this share of the largest are noise of rounding, for steps.
const NOISE: f64 = 1e-12;
/// Damping as a share of the largest squared singular value: first, and where it is given up.
const FIRST: f64 = 1e-12;
const MOST: f64 = 1e6;

/// Condition up to which the normal equations of the triangle give the step.
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

/// Fits the unknowns to the data, from their starts or from `theta`.
pub fn fit(model: &Model<'_>, data: &[Measurement], weights: Vec<f64>, theta: Option<Vec<f64>>) -> Fit {
    let home: Vec<f64> = model.parameters().iter().map(|p| p.start).collect();
    let linear = |theta: &[f64]| model.triangle(data, &weights, theta);
    let at_home = linear(&home);
    let heft: f64 = data.iter().zip(&weights).map(|(m, weight)| weight * m.readings() as f64).sum();
    let prior = Prior::new(model, at_home.right_norm() / libm::sqrt(heft));
    let (theta, reduced) = match theta {
        Some(theta) => {
            let there = linear(&theta);
            (theta, there)
        }
        None => (home, at_home),
    };
    let mut descent = Descent { linear: &linear, prior, theta, reduced, damping: FIRST, steps: 0, last: None };
    let settled = descent.run();
    let Descent { theta, reduced, steps, .. } = descent;
    Fit { theta, reduced, weights, steps, settled }
}

/// The iteration, wherever it stands.
struct Descent<'a> {
    /// The linear problem anywhere.
    linear: &'a dyn Fn(&[f64]) -> Reduced,
    prior: Prior<'a>,
    theta: Vec<f64>,
    reduced: Reduced,
    damping: f64,
    steps: usize,
    /// What the step that led here had promised along the directions that the data see, if it was a whole one.
    last: Option<f64>,
}

impl Descent<'_> {
    /// Goes down. False: there is no end to it, or no way.
    fn run(&mut self) -> bool {
        while self.steps < STEPS && self.damping <= MOST {
            // What the prior is weighed against.
            let variance = self.scatter();
            let problem = Problem::new(&self.prior, &self.reduced, &self.theta, variance);
            let before = self.prior.cost(&self.reduced, &self.theta, variance);
            if self.arrives(&problem, before, variance) || self.stands(&problem, before, variance) {
                return true;
            }
        }
        false
    }

    /// Variance of a reading, as far as the linear problem knows it.
    fn scatter(&self) -> f64 {
        let (rows, unknowns) = (self.reduced.rows, self.theta.len());
        let left = if rows > unknowns { self.reduced.rest } else { self.reduced.right_norm() };
        left * left / (if rows > unknowns { rows - unknowns } else { rows.max(1) }) as f64
    }

    /// Is the rest of the way so short that the linear problem will do for it? Then goes there.
    fn arrives(&mut self, problem: &Problem, before: f64, variance: f64) -> bool {
        let ahead = problem.ahead();
        let radius = self.theta.len() as f64 * variance;
        let small = (OFFSET * OFFSET * radius).max(unseen(before));
        // A step leaves of the promise what the one before it left of its own.
        let rest = self.last.map_or(f64::INFINITY, |last| ahead.gain * ahead.gain / last);
        let near = ahead.gain <= small || (ahead.gain <= NEAR * NEAR * radius && rest <= small);
        if !near || ahead.drowned > ahead.deaf as f64 * variance {
            return false;
        }
        let step = ahead.step.component_div(&self.prior.scale);
        self.reduced.right -= &self.reduced.r * &step;
        self.theta.iter_mut().zip(step.iter()).for_each(|(t, s)| *t += s);
        true
    }

    /// Takes a step, as long a one as keeps its promise. True: no step promises anything.
    fn stands(&mut self, problem: &Problem, before: f64, variance: f64) -> bool {
        let (mut first, unseen) = (true, unseen(before));
        while self.damping <= MOST {
            let scaled = problem.step(self.damping);
            let promise = before - problem.cost(&scaled);
            if promise.is_nan() || promise <= PROMISE * before + ROUNDING * self.reduced.rows as f64 {
                return true;
            }
            let step = scaled.component_div(&self.prior.scale);
            let trial: Vec<f64> = self.theta.iter().zip(step.iter()).map(|(t, s)| t + s).collect();
            let then = (self.linear)(&trial);
            let gain = before - self.prior.cost(&then, &trial, variance);
            if gain > 0.0 || (promise <= unseen && gain >= -unseen) {
                // A step that kept its promise may be longer next time.
                self.damping *= if gain > 0.5 * promise { 0.01 } else { 1.0 };
                self.last = first.then_some(promise);
                (self.theta, self.reduced) = (trial, then);
                self.steps += 1;
                return false;
            }
            self.shorten(problem, &scaled);
            first = false;
        }
        false
    }

    /// Damps until the step is half as long.
    fn shorten(&mut self, problem: &Problem, scaled: &DVector<f64>) {
        while self.damping <= MOST && problem.step(self.damping).norm() > 0.5 * scaled.norm() {
            self.damping *= 10.0;
        }
    }
}

/// Sums of squares are not known better than this. A step that promises less is taken on trust.
fn unseen(cost: f64) -> f64 {
    2.0 * libm::sqrt(cost * ROUNDING)
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

    /// What is left to gain, by the linear problem.
    fn ahead(&self) -> Ahead {
        let Solver::Singular(svd, rank) = &self.solver else {
            let step = self.step(0.0);
            let gain = self.cost(&DVector::zeros(step.len())) - self.cost(&step);
            return Ahead { gain, step, drowned: 0.0, deaf: 0 };
        };
        let loudest = self.reduced.column_norms().component_div(&self.scale).max();
        let limit = loudest / libm::sqrt(self.reduced.rows.max(1) as f64);
        let mut ahead = Ahead { gain: 0.0, step: DVector::zeros(self.home.len()), drowned: 0.0, deaf: 0 };
        for (k, (force, stiffness)) in svd.forces(&self.reduced.right, *rank, (&self.home, self.pull)).enumerate() {
            let gain = if stiffness > 0.0 { force * force / stiffness } else { 0.0 };
            if svd.values[k] > limit {
                ahead.gain += gain;
                ahead.step.axpy(force / stiffness, &svd.v.column(k), 1.0);
            } else {
                ahead.drowned += gain;
                ahead.deaf += usize::from(k < *rank);
            }
        }
        ahead
    }

    /// What a step would leave.
    fn cost(&self, scaled: &DVector<f64>) -> f64 {
        let step = scaled.component_div(&self.scale);
        let left = (&self.reduced.right - &self.reduced.r * &step).norm_squared();
        left + self.reduced.rest * self.reduced.rest + self.pull * (&self.home + scaled).norm_squared()
    }
}

/// What is left to gain. Along directions in which all readings together hear less than one of them hears of a usual
/// parameter, only what stands out of the noise counts: there the model bends before it gains, and would be followed for
/// millimetres to save nanometres.
struct Ahead {
    /// Along the other directions: gain (mm^2) and step in units of displacement.
    gain: f64,
    step: DVector<f64>,
    /// Gain along the directions that hear so little, and how many they are.
    drowned: f64,
    deaf: usize,
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
