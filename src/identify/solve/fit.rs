//! Weighted least squares on the exact model: Levenberg-Marquardt on the triangle.
//!
//! Steps are the shortest ones in units of displacement, so that null-space directions stay where they are. Damping is
//! needed although the model is almost linear: along a weakly identified direction the undamped step is a large turn,
//! over which the model is not linear, and the iteration oscillates. There is a weak prior for the same reason.

use crate::algebra::linear::{ReducedSystem, Svd};
use crate::identify::data::{Measurement, ReadingKind};
use crate::identify::model::{FitModel, Prior};
use crate::identify::thresholds::*;
use nalgebra::{DMatrix, DVector};

/// Scatter of the readings of one quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scatter {
    /// The quantity; `None`: those whose uncertainty the files give.
    pub of: Option<ReadingKind>,
    /// Standard deviation of a reading of weight 1 (mm); in units of 1 um of the uncertainty where that is given.
    pub sigma: f64,
}

/// A robust fit as one by least squares: to readings whose residuals are limited.
#[derive(Debug, Clone)]
pub struct LimitedResiduals {
    /// Weights of the readings by their scatter alone.
    pub weights: Vec<f64>,
    /// Weights that make the limited residuals of those before the limit.
    pub limited: Vec<f64>,
    /// Share of the residuals that count in full: the estimate follows only so much of a small change of all readings.
    pub slope: f64,
}

/// State of a fit.
#[derive(Debug, Clone)]
pub struct ParameterFit {
    /// Values of the parameters (mm, rad, degrees of position).
    pub theta: Vec<f64>,
    /// The linear problem there.
    pub reduced: ReducedSystem,
    /// Weighted sum of squares (mm^2) that the readings scatter by, as far as the uncertainty of the estimate goes.
    pub squares: f64,
    /// Weight of each measurement.
    pub weights: Vec<f64>,
    /// The limits of a robust fit.
    pub limits: Option<LimitedResiduals>,
    /// Scatter of each quantity, if unlike quantities were weighed against each other.
    pub scatter: Vec<Scatter>,
    /// Residual degrees of freedom of the uncertainty of each unknown, if unlike quantities were weighed.
    pub parameter_freedom: Vec<f64>,
    /// Values known before the data: rows over their standard uncertainty.
    pub known: DMatrix<f64>,
    /// RMS (mm) of the readings against the machine at the start, with instruments and set-ups fitted.
    pub initial_rms: f64,
    /// Combinations of standard deviation 1 that plausible sizes make known before the readings: an upper triangle over
    /// the machine's unknowns, which come first.
    pub plausible: DMatrix<f64>,
    /// True if a bound on a slope holds the unknown, too.
    pub slope_bounded: Vec<bool>,
    /// Accepted steps.
    pub steps: usize,
    /// True if the fit converged before it ran out of steps.
    pub converged: bool,
}

impl ParameterFit {
    /// Returns a fit that has not converged, before any scatter is weighed.
    pub(super) fn new(model: &FitModel<'_>, theta: Vec<f64>, reduced: ReducedSystem, weights: Vec<f64>) -> Self {
        let has_bound = |column: nalgebra::DVectorView<'_, f64>| column.iter().any(|x| *x != 0.0);
        Self {
            squares: reduced.right_norm() * reduced.right_norm(),
            known: model.known_rows(&theta).0,
            theta,
            reduced,
            weights,
            limits: None,
            scatter: Vec::new(),
            parameter_freedom: Vec::new(),
            initial_rms: 0.0,
            plausible: DMatrix::zeros(0, model.parameters().len()),
            slope_bounded: model.slope_rows().column_iter().map(has_bound).collect(),
            steps: 0,
            converged: false,
        }
    }

    /// Returns the largest plausible displacement (mm) by an unknown: the standard deviation before the data.
    pub fn plausible_mm(&self) -> f64 {
        MIN_PRIOR_SIGMA_MM.max(PLAUSIBLE_OVER_RMS * self.initial_rms)
    }

    /// Returns the fit with the linear problem at other values of the parameters.
    pub fn at(&self, model: &FitModel<'_>, data: &[Measurement], theta: Vec<f64>) -> Self {
        let weights = self.limits.as_ref().map_or(&self.weights, |limits| &limits.weights);
        let reduced = model.triangle(data, weights, &theta);
        Self { known: model.known_rows(&theta).0, theta, reduced, ..self.clone() }
    }
}

/// Fits the unknowns to the data with these weights, from their starts.
pub fn fit(model: &FitModel<'_>, data: &[Measurement], weights: Vec<f64>) -> ParameterFit {
    FitSearch::with_weights(model, data, weights).fit()
}

/// A search for the unknowns of a model from data, with the prior that both imply.
pub(crate) struct FitSearch<'a> {
    model: &'a FitModel<'a>,
    data: &'a [Measurement],
    prior: Prior,
    weights: Vec<f64>,
    start: Vec<f64>,
    /// The linear problem at the start, with the weights of the data.
    start_problem: ReducedSystem,
}

impl<'a> FitSearch<'a> {
    /// Prepares a search with the weights of the files.
    pub fn new(model: &'a FitModel<'a>, data: &'a [Measurement]) -> Self {
        Self::with_weights(model, data, data.iter().map(|m| m.weight).collect())
    }

    fn with_weights(model: &'a FitModel<'a>, data: &'a [Measurement], weights: Vec<f64>) -> Self {
        let start = model.start();
        let start_problem = model.triangle(data, &weights, &start);
        let prior = Prior::new(model, data, &start_problem);
        Self { model, data, prior, weights, start, start_problem }
    }

    /// Fits from the start.
    pub fn fit(&self) -> ParameterFit {
        self.descend(self.weights.clone(), self.start.clone(), self.start_problem.clone())
    }

    /// Fits from other values, with other weights.
    pub fn fit_from(&self, weights: Vec<f64>, theta: Vec<f64>) -> ParameterFit {
        let problem = self.model.triangle(self.data, &weights, &theta);
        self.descend(weights, theta, problem)
    }

    fn descend(&self, weights: Vec<f64>, theta: Vec<f64>, reduced: ReducedSystem) -> ParameterFit {
        let linear = |theta: &[f64]| self.model.triangle(self.data, &weights, theta);
        let prior = &self.prior;
        let mut descent = Descent {
            linear: &linear,
            cancelled: &|| self.model.is_cancelled(),
            prior,
            theta,
            reduced,
            damping: FIRST_DAMPING,
            steps: 0,
            last_reduction: None,
        };
        let converged = descent.run();
        let Descent { theta, reduced, steps, .. } = descent;
        let (initial_rms, plausible) = (prior.initial_rms, prior.plausible());
        ParameterFit {
            initial_rms,
            plausible,
            steps,
            converged,
            ..ParameterFit::new(self.model, theta, reduced, weights)
        }
    }
}

struct Descent<'a> {
    /// Returns the linear problem at given values.
    linear: &'a dyn Fn(&[f64]) -> ReducedSystem,
    /// True if nobody wants the fit any more.
    cancelled: &'a dyn Fn() -> bool,
    prior: &'a Prior,
    theta: Vec<f64>,
    reduced: ReducedSystem,
    damping: f64,
    steps: usize,
    /// Reduction of the cost that the last step predicted, if it was a whole one.
    last_reduction: Option<f64>,
}

impl Descent<'_> {
    /// Iterates until no step reduces the cost. Returns false if it ran out of steps, or if damping found no step.
    fn run(&mut self) -> bool {
        while self.steps < MAX_FIT_STEPS && self.damping <= MAX_DAMPING && !(self.cancelled)() {
            // The prior is weighed against this scatter.
            let variance = self.scatter();
            let problem = StepProblem::new(self.prior, &self.reduced, &self.theta, variance);
            let before = self.prior.cost(&self.reduced, &self.theta, variance);
            if self.finish_linearly(&problem, before, variance) || self.advance(&problem, before, variance) {
                return true;
            }
        }
        false
    }

    /// Returns the variance of a reading by the linear problem: the residual sum of squares over its degrees of
    /// freedom. With values known before the data it is that of the readings beside these: a linear problem alone may
    /// fit any readings exactly.
    fn scatter(&self) -> f64 {
        let (rows, unknowns) = (self.reduced.rows, self.theta.len());
        let is_redundant = rows > unknowns;
        let degrees_of_freedom = if is_redundant { rows - unknowns } else { rows.max(1) } as f64;
        match (self.prior.has_known_values, is_redundant) {
            (false, true) => return self.reduced.rest * self.reduced.rest / degrees_of_freedom,
            (false, false) => return self.scatter_by_rank(),
            (true, _) => (),
        }
        let mut variance = self.reduced.right_norm() * self.reduced.right_norm() / rows.max(1) as f64;
        for _ in 0..STEP_SCATTER_ITERATIONS {
            let problem = StepProblem::new(self.prior, &self.reduced, &self.theta, variance);
            let step = self.prior.unknowns(&problem.step(FIRST_DAMPING));
            let residual = (&self.reduced.right - &self.reduced.r * step).norm();
            variance = (residual * residual + self.reduced.rest * self.reduced.rest) / degrees_of_freedom;
        }
        variance
    }

    /// Returns the same where there are no more readings than unknowns: these may still fall short of the readings. Of
    /// readings that the unknowns reach, all of what is missed now is scatter.
    fn scatter_by_rank(&self) -> f64 {
        let (rows, whole) = (self.reduced.rows, self.reduced.right_norm());
        let svd = Svd::new(&self.prior.by_displacement(&self.reduced.r));
        let rank = svd.rank(RANK_TOLERANCE);
        let reached = svd.u.columns(0, rank).tr_mul(&self.reduced.right).norm_squared();
        match rows.saturating_sub(rank) {
            0 => whole * whole / rows.max(1) as f64,
            left => (whole * whole - reached).max(0.0) / left as f64,
        }
    }

    /// Takes the last step by the linear problem alone, if the remaining reduction is small beside the confidence
    /// region `p s^2` (Bates and Watts 1981). Returns true if it did.
    fn finish_linearly(&mut self, problem: &StepProblem, before: f64, variance: f64) -> bool {
        let whole = problem.step(FIRST_DAMPING);
        let remaining = before - problem.cost(&whole);
        let region = self.theta.len() as f64 * variance;
        let small = (CONVERGED_OFFSET * CONVERGED_OFFSET * region).max(cost_rounding(before));
        // A step leaves the same fraction of its predicted reduction as the step before it.
        let after = self.last_reduction.map_or(f64::INFINITY, |last| remaining * remaining / last);
        if !(remaining <= small || (remaining <= LINEAR_OFFSET * LINEAR_OFFSET * region && after <= small)) {
            return false;
        }
        let step = self.prior.unknowns(&whole);
        self.reduced.right -= &self.reduced.r * &step;
        self.theta.iter_mut().zip(step.iter()).for_each(|(t, s)| *t += s);
        true
    }

    /// Takes the longest damped step that reduces the cost. Returns true if no step predicts a reduction: the fit has
    /// converged.
    fn advance(&mut self, problem: &StepProblem, before: f64, variance: f64) -> bool {
        let (mut first, rounding) = (true, cost_rounding(before));
        while self.damping <= MAX_DAMPING {
            let scaled = problem.step(self.damping);
            let predicted = before - problem.cost(&scaled);
            let least = MIN_REDUCTION_SHARE * before + MIN_REDUCTION_MM2 * self.reduced.rows as f64;
            if predicted.is_nan() || predicted <= least {
                return true;
            }
            let step = self.prior.unknowns(&scaled);
            let trial: Vec<f64> = self.theta.iter().zip(step.iter()).map(|(t, s)| t + s).collect();
            let then = (self.linear)(&trial);
            let gain = before - self.prior.cost(&then, &trial, variance);
            if gain > 0.0 || (predicted <= rounding && gain >= -rounding) {
                // A step that came near to its prediction may be longer next time.
                self.damping *= if gain > 0.5 * predicted { 0.01 } else { 1.0 };
                self.last_reduction = first.then_some(predicted);
                (self.theta, self.reduced) = (trial, then);
                self.steps += 1;
                return false;
            }
            self.shorten(problem, &scaled);
            first = false;
        }
        false
    }

    /// Raises the damping until the step is half as long.
    fn shorten(&mut self, problem: &StepProblem, scaled: &DVector<f64>) {
        while self.damping <= MAX_DAMPING && problem.step(self.damping).norm() > 0.5 * scaled.norm() {
            self.damping *= 10.0;
        }
    }
}

/// Returns the rounding (mm^2) of a sum of squares. A step that predicts a smaller reduction is taken on trust.
fn cost_rounding(cost: f64) -> f64 {
    2.0 * libm::sqrt(cost * MIN_REDUCTION_MM2)
}

/// The linear problem of one step x in displacements: `min |A x - b|^2 + rest^2 + pull |x + away|^2`.
struct StepProblem {
    coefficients: DMatrix<f64>,
    /// b.
    right: DVector<f64>,
    rest: f64,
    /// Distance from the start.
    away: DVector<f64>,
    /// Weight of the prior.
    pull: f64,
    solver: StepSolver,
}

/// Normal equations for a good condition; singular values where the data may leave directions free.
enum StepSolver {
    Singular { svd: Svd, rank: usize },
    Normal { matrix: DMatrix<f64>, largest: f64 },
}

impl StepProblem {
    fn new(prior: &Prior, reduced: &ReducedSystem, theta: &[f64], variance: f64) -> Self {
        let (rows, missing) = prior.rows(theta, variance);
        let reduced = if rows.nrows() > 0 { reduced.with_rows(&rows, &missing) } else { reduced.clone() };
        let coefficients = prior.by_displacement(&reduced.r);
        let solver = if reduced.condition() < MAX_NORMAL_CONDITION {
            let normal = coefficients.tr_mul(&coefficients);
            let largest = normal.diagonal().max();
            StepSolver::Normal { matrix: normal, largest }
        } else {
            let svd = Svd::new(&coefficients);
            let rank = svd.rank(STEP_RANK_TOLERANCE);
            StepSolver::Singular { svd, rank }
        };
        let (away, pull) = (prior.displacement(theta), prior.weight(variance));
        Self { coefficients, right: reduced.right, rest: reduced.rest, away, pull, solver }
    }

    /// Returns the best step, in displacements.
    fn step(&self, damping: f64) -> DVector<f64> {
        match &self.solver {
            StepSolver::Singular { svd, rank } => {
                let largest = svd.values.iter().copied().fold(0.0, f64::max);
                svd.step(&self.right, *rank, &self.away, self.pull, damping * largest * largest)
            }
            StepSolver::Normal { matrix: normal, largest } => {
                let n = normal.ncols();
                let force = self.coefficients.tr_mul(&self.right) - &self.away * self.pull;
                let stiff = normal + DMatrix::identity(n, n) * (self.pull + damping * largest);
                stiff.cholesky().map_or_else(|| DVector::zeros(n), |factor| factor.solve(&force))
            }
        }
    }

    /// Returns the cost (mm^2) that a step leaves.
    fn cost(&self, step: &DVector<f64>) -> f64 {
        let residual = (&self.right - &self.coefficients * step).norm_squared();
        residual + self.rest * self.rest + self.pull * (&self.away + step).norm_squared()
    }
}
