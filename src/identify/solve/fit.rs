//! Weighted least squares on the exact model: Levenberg-Marquardt on the triangle.
//!
//! Steps are the shortest ones in units of displacement, so that directions which the data do not see stay where
//! they are. Damping is needed although the model is almost linear: where a direction is nearly invisible, the
//! undamped step is a large turn, the model is not linear over it, and the iteration runs to and fro. For the
//! same reason there is a weak prior.

use crate::algebra::linear::{HomePull, ReducedSystem, Svd};
use crate::identify::data::{Measurement, ReadingKind};
use crate::identify::model::Model;
use crate::identify::model::Prior;
use nalgebra::{DMatrix, DVector};

/// Limit of accepted steps.
const MAX_STEPS: usize = 200;
/// Relative offset of Bates and Watts (1981): a step that moves the estimate by less than this share of the radius of
/// its
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
const FIRST_DAMPING: f64 = 1e-12;
const MAX_DAMPING: f64 = 1e6;

/// Rounds in which the scatter of the readings and what is known before them are weighed against each other.
const BALANCED: usize = 6;

/// Condition up to which the normal equations of the triangle give the step.
const EASY: f64 = 1e5;

/// Scatter of the readings of one quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scatter {
    /// The quantity; `None`: those whose uncertainty the files give.
    pub of: Option<ReadingKind>,
    /// Standard deviation of a reading of weight 1 (mm); in units of 1 um of the uncertainty where that is given.
    pub sigma: f64,
}

/// State of a fit.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Values of the parameters (mm, rad, degrees of position).
    pub theta: Vec<f64>,
    /// The linear problem there.
    pub reduced: ReducedSystem,
    /// Weighted sum of squares (mm^2) that the readings scatter by, as far as the uncertainty of the estimate goes.
    pub squares: f64,
    /// Weight of each measurement.
    pub weights: Vec<f64>,
    /// Scatter of each quantity, if unlike quantities were weighed against each other.
    pub scatter: Vec<Scatter>,
    /// Then also, of each unknown, the degrees of freedom that its uncertainty rests on.
    pub freedom: Vec<f64>,
    /// Values known before the data: rows over their standard uncertainty.
    pub known: DMatrix<f64>,
    /// Root mean square (mm) of what the readings are off the machine at the start, wherever instruments are.
    pub shown: f64,
    /// True if the unknown is held by something else than readings (bounds on slopes).
    pub bounded: Vec<bool>,
    /// Accepted steps.
    pub steps: usize,
    /// Did it settle, rather than run out of steps?
    pub settled: bool,
}

impl Fit {
    /// The same with the linear problem at other values of the parameters.
    pub fn at(&self, model: &Model<'_>, data: &[Measurement], theta: Vec<f64>) -> Self {
        let reduced = model.triangle(data, &self.weights, &theta);
        Self { theta, reduced, ..self.clone() }
    }
}

/// Fits the unknowns to the data with these weights, from their starts.
pub fn fit(model: &Model<'_>, data: &[Measurement], weights: Vec<f64>) -> Fit {
    Search::weighed(model, data, weights).fit()
}

/// A search for the unknowns; what is known before the data is looked up once.
pub(crate) struct Search<'a> {
    model: &'a Model<'a>,
    data: &'a [Measurement],
    prior: Prior,
    weights: Vec<f64>,
    home: Vec<f64>,
    /// The linear problem at home, with the weights of the data.
    there: ReducedSystem,
}

impl<'a> Search<'a> {
    /// Search over the data.
    pub fn new(model: &'a Model<'a>, data: &'a [Measurement]) -> Self {
        Self::weighed(model, data, data.iter().map(|m| m.weight).collect())
    }

    fn weighed(model: &'a Model<'a>, data: &'a [Measurement], weights: Vec<f64>) -> Self {
        let home: Vec<f64> = model.parameters().iter().map(|p| p.start).collect();
        let there = model.triangle(data, &weights, &home);
        let prior = Prior::new(model, data, &there);
        Self { model, data, prior, weights, home, there }
    }

    /// From home.
    pub fn fit(&self) -> Fit {
        self.descend(self.weights.clone(), self.home.clone(), self.there.clone())
    }

    /// From somewhere, with other weights.
    pub fn again(&self, weights: Vec<f64>, theta: Vec<f64>) -> Fit {
        let there = self.model.triangle(self.data, &weights, &theta);
        self.descend(weights, theta, there)
    }

    fn descend(&self, weights: Vec<f64>, theta: Vec<f64>, reduced: ReducedSystem) -> Fit {
        let linear = |theta: &[f64]| self.model.triangle(self.data, &weights, theta);
        let prior = &self.prior;
        let mut descent =
            Descent { linear: &linear, prior, theta, reduced, damping: FIRST_DAMPING, steps: 0, last: None };
        let settled = descent.run();
        let Descent { theta, reduced, steps, .. } = descent;
        let bounded = self.model.slopes().column_iter().map(|column| column.iter().any(|x| *x != 0.0)).collect();
        let squares = reduced.right_norm() * reduced.right_norm();
        let (scatter, freedom, known, shown) = (Vec::new(), Vec::new(), self.model.known().0, prior.shown);
        Fit { theta, reduced, squares, weights, scatter, freedom, known, shown, bounded, steps, settled }
    }
}

/// The iteration, wherever it stands.
struct Descent<'a> {
    /// The linear problem anywhere.
    linear: &'a dyn Fn(&[f64]) -> ReducedSystem,
    prior: &'a Prior,
    theta: Vec<f64>,
    reduced: ReducedSystem,
    damping: f64,
    steps: usize,
    /// Gain that the step that led here had promised, if it was a whole one.
    last: Option<f64>,
}

impl Descent<'_> {
    /// Goes down. False: there is no end to it, or no way.
    fn run(&mut self) -> bool {
        while self.steps < MAX_STEPS && self.damping <= MAX_DAMPING {
            // What the prior is weighed against.
            let variance = self.scatter();
            let problem = Problem::new(self.prior, &self.reduced, &self.theta, variance);
            let before = self.prior.cost(&self.reduced, &self.theta, variance);
            if self.arrives(&problem, before, variance) || self.stands(&problem, before, variance) {
                return true;
            }
        }
        false
    }

    /// Variance of a reading, as far as the linear problem knows it. With values known before the data it is what the
    /// readings leave beside these: a linear problem alone may fit any readings exactly.
    fn scatter(&self) -> f64 {
        let (rows, unknowns) = (self.reduced.rows, self.theta.len());
        if self.prior.informed {
            let spare = if rows > unknowns { rows - unknowns } else { rows.max(1) } as f64;
            let mut variance = self.reduced.right_norm() * self.reduced.right_norm() / rows.max(1) as f64;
            for _ in 0..BALANCED {
                let problem = Problem::new(self.prior, &self.reduced, &self.theta, variance);
                let step = self.prior.unknowns(&problem.step(FIRST_DAMPING));
                let left = (&self.reduced.right - &self.reduced.r * step).norm();
                variance = (left * left + self.reduced.rest * self.reduced.rest) / spare;
            }
            return variance;
        }
        let left = if rows > unknowns { self.reduced.rest } else { self.reduced.right_norm() };
        left * left / (if rows > unknowns { rows - unknowns } else { rows.max(1) }) as f64
    }

    /// Is the rest of the way so short that the linear problem will do for it? Then goes there.
    fn arrives(&mut self, problem: &Problem, before: f64, variance: f64) -> bool {
        let whole = problem.step(FIRST_DAMPING);
        let ahead = before - problem.cost(&whole);
        let radius = self.theta.len() as f64 * variance;
        let small = (OFFSET * OFFSET * radius).max(unseen(before));
        // A step leaves of the promise what the one before it left of its own.
        let rest = self.last.map_or(f64::INFINITY, |last| ahead * ahead / last);
        if !(ahead <= small || (ahead <= NEAR * NEAR * radius && rest <= small)) {
            return false;
        }
        let step = self.prior.unknowns(&whole);
        self.reduced.right -= &self.reduced.r * &step;
        self.theta.iter_mut().zip(step.iter()).for_each(|(t, s)| *t += s);
        true
    }

    /// Takes a step, as long a one as keeps its promise. True: no step promises anything.
    fn stands(&mut self, problem: &Problem, before: f64, variance: f64) -> bool {
        let (mut first, unseen) = (true, unseen(before));
        while self.damping <= MAX_DAMPING {
            let scaled = problem.step(self.damping);
            let promise = before - problem.cost(&scaled);
            if promise.is_nan() || promise <= PROMISE * before + ROUNDING * self.reduced.rows as f64 {
                return true;
            }
            let step = self.prior.unknowns(&scaled);
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
        while self.damping <= MAX_DAMPING && problem.step(self.damping).norm() > 0.5 * scaled.norm() {
            self.damping *= 10.0;
        }
    }
}

/// Sums of squares are not known better than this. A step that promises less is taken on trust.
fn unseen(cost: f64) -> f64 {
    2.0 * libm::sqrt(cost * ROUNDING)
}

/// The linear problem of one step, its unknowns as displacements.
struct Problem {
    coefficients: DMatrix<f64>,
    right: DVector<f64>,
    rest: f64,
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
    fn new(prior: &Prior, reduced: &ReducedSystem, theta: &[f64], variance: f64) -> Self {
        let (rows, missing) = prior.rows(theta, variance);
        let reduced = if rows.nrows() > 0 { reduced.with_rows(&rows, &missing) } else { reduced.clone() };
        let coefficients = prior.by_displacement(&reduced.r);
        let solver = if reduced.condition() < EASY {
            let normal = coefficients.tr_mul(&coefficients);
            let largest = normal.diagonal().max();
            Solver::Normal(normal, largest)
        } else {
            let svd = Svd::new(&coefficients);
            let rank = svd.rank(NOISE);
            Solver::Singular(svd, rank)
        };
        let (home, pull) = (prior.away(theta), prior.pull(variance));
        Self { coefficients, right: reduced.right, rest: reduced.rest, home, pull, solver }
    }

    /// The best step, as displacements.
    fn step(&self, damping: f64) -> DVector<f64> {
        match &self.solver {
            Solver::Singular(svd, rank) => {
                let largest = svd.values.iter().copied().fold(0.0, f64::max);
                svd.step(
                    &self.right,
                    *rank,
                    HomePull { away: &self.home, pull: self.pull },
                    damping * largest * largest,
                )
            }
            Solver::Normal(normal, largest) => {
                let n = normal.ncols();
                let force = self.coefficients.tr_mul(&self.right) - &self.home * self.pull;
                let stiff = normal + DMatrix::identity(n, n) * (self.pull + damping * largest);
                stiff.cholesky().map_or_else(|| DVector::zeros(n), |factor| factor.solve(&force))
            }
        }
    }

    /// Residual that a step would leave.
    fn cost(&self, step: &DVector<f64>) -> f64 {
        let left = (&self.right - &self.coefficients * step).norm_squared();
        left + self.rest * self.rest + self.pull * (&self.home + step).norm_squared()
    }
}
