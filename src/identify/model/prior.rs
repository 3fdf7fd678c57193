//! Knowledge before the data.
//!
//! Unknowns are compared as displacements (mm): of a constant error its own, of a curve the RMS over the travel. The
//! prior therefore does not depend on the basis in which a curve is written: powers about the machine's zero point may
//! be large and cancel, as long as the curve is small.

use super::gauge::Gauge;
use super::parameter::{BasisFunction, Parameter, ParameterTerm};
use super::prediction::FitModel;
use crate::algebra::linear::{ReducedSystem, Svd, Triangle};
use crate::evaluate::Order;
use crate::identify::data::{Measurement, lever};
use crate::identify::thresholds::*;
use crate::lower::ErrorSite;
use nalgebra::{DMatrix, DVector};

/// The prior of a fit: the values near which the unknowns are, and the directions that are held there.
pub(crate) struct Prior {
    start: DVector<f64>,
    /// Displacements (mm) from unknowns, the machine's first: an upper triangle.
    metric: DMatrix<f64>,
    /// Number of unknowns that are the machine's. Those of instruments have no prior.
    own: usize,
    /// RMS (mm) of the readings against the machine at the start, with instruments and set-ups fitted.
    pub initial_rms: f64,
    /// True if there are values known before the data.
    pub has_known_values: bool,
    /// Standard deviation of a displacement (mm).
    sigma: f64,
    /// Combinations that are known to be `values` with standard deviation 1.
    rows: DMatrix<f64>,
    values: DVector<f64>,
    /// Known distances, which are not linear in the unknowns.
    gauges: Vec<Gauge>,
}

impl Prior {
    /// Returns the prior of a model; `start_problem` is the linear problem at the start of its unknowns.
    pub fn new(model: &FitModel<'_>, data: &[Measurement], start_problem: &ReducedSystem) -> Self {
        let list = model.parameters();
        let start = DVector::from_iterator(list.len(), list.iter().map(|p| p.start));
        let gauges = model.gauges().to_vec();
        let (known, known_values) = model.known_rows(start.as_slice());
        let linear = model.known().len();
        let (known, known_values) = (known.rows(0, linear).into_owned(), known_values.rows(0, linear).into_owned());
        let initial_rms = initial_rms(model.own(), data, start_problem);
        let prior = Self {
            start,
            metric: metric(model),
            own: model.own(),
            initial_rms,
            has_known_values: known.nrows() + gauges.len() > 0,
            sigma: MIN_PRIOR_SIGMA_MM.max(PLAUSIBLE_OVER_RMS * initial_rms),
            rows: model.slope_rows().clone(),
            values: DVector::zeros(model.slope_rows().nrows()),
            gauges,
        };
        let prior = prior.with_rows(&known, &known_values);
        let many = libm::sqrt((start_problem.rows as f64 / SECOND_ORDER_READINGS).max(1.0));
        let held = second_order_only(model, data, &prior, start_problem);
        // These directions (of displacements) stay at the start.
        let rows = held.tr_mul(&prior.metric) / (SECOND_ORDER_SIGMA_MM.max(initial_rms) / many);
        let values = &rows * &prior.start;
        prior.with_rows(&rows, &values)
    }

    /// Adds combinations that are known to have values with standard deviation 1.
    fn with_rows(self, rows: &DMatrix<f64>, values: &DVector<f64>) -> Self {
        let first = self.rows.nrows();
        let mut all = self.rows.insert_rows(first, rows.nrows(), 0.0);
        all.rows_mut(first, rows.nrows()).copy_from(rows);
        let mut all_values = self.values.insert_rows(first, rows.nrows(), 0.0);
        all_values.rows_mut(first, rows.nrows()).copy_from(values);
        Self { rows: all, values: all_values, ..self }
    }

    /// Returns the displacements of the machine's unknowns over their standard deviation: an upper triangle.
    pub fn plausible(&self) -> DMatrix<f64> {
        self.metric.rows(0, self.own) / self.sigma
    }

    /// Returns the weight of a squared displacement beside readings of this variance. Readings that scatter by more
    /// than is plausible are far from a fit, with instruments still on their way, which the weight slows down.
    pub fn weight(&self, variance: f64) -> f64 {
        (variance / (self.sigma * self.sigma)).min(1.0)
    }

    /// Returns the distance from the start in displacements; 0 for unknowns of instruments.
    pub fn displacement(&self, theta: &[f64]) -> DVector<f64> {
        let mut away = &self.metric * (DVector::from_column_slice(theta) - &self.start);
        away.rows_mut(self.own, theta.len() - self.own).fill(0.0);
        away
    }

    /// Returns the known combinations as rows of readings of this variance: coefficients and residuals.
    pub fn rows(&self, theta: &[f64], variance: f64) -> (DMatrix<f64>, DVector<f64>) {
        let first = self.rows.nrows();
        let mut rows = self.rows.clone().insert_rows(first, self.gauges.len(), 0.0);
        let mut values = self.values.clone().insert_rows(first, self.gauges.len(), 0.0);
        for (i, gauge) in (first..).zip(&self.gauges) {
            let (row, value) = gauge.row(theta);
            row.into_iter().for_each(|(j, share)| rows[(i, j)] = share);
            values[i] = value;
        }
        let missing = values - &rows * DVector::from_column_slice(theta);
        (rows * libm::sqrt(variance), missing * libm::sqrt(variance))
    }

    /// Returns the weighted sum of squares (mm^2) of readings and prior for readings of this variance.
    pub fn cost(&self, reduced: &ReducedSystem, theta: &[f64], variance: f64) -> f64 {
        let data = reduced.right_norm() * reduced.right_norm();
        let (_, missing) = self.rows(theta, variance);
        data + self.weight(variance) * self.displacement(theta).norm_squared() + missing.norm_squared()
    }

    /// Returns coefficients of unknowns as coefficients of displacements: `A M^-1` for the metric M.
    pub fn by_displacement(&self, coefficients: &DMatrix<f64>) -> DMatrix<f64> {
        let solved = self.metric.tr_solve_upper_triangular(&coefficients.transpose());
        solved.map_or_else(|| coefficients.clone(), |columns| columns.transpose())
    }

    /// Returns the unknowns that make these displacements: `M^-1 d`.
    pub fn unknowns(&self, displacements: &DVector<f64>) -> DVector<f64> {
        self.metric.solve_upper_triangular(displacements).unwrap_or_else(|| DVector::zeros(displacements.len()))
    }
}

/// Returns the RMS (mm) of the readings against the machine at the start, with instruments and set-ups fitted: `home`
/// is the linear problem there.
fn initial_rms(own: usize, data: &[Measurement], home: &ReducedSystem) -> f64 {
    let instruments = home.r.columns(own, home.r.ncols() - own).into_owned();
    let rest = ReducedSystem::of(&instruments, &home.right);
    let svd = Svd::new(&rest.r);
    let missed = &rest.right - &rest.r * svd.solve(&rest.right, svd.rank(RANK_TOLERANCE));
    let squares = missed.norm_squared() + rest.rest * rest.rest + home.rest * home.rest;
    let weights: f64 = data.iter().map(|m| m.weight * m.readings() as f64).sum();
    if weights > 0.0 { libm::sqrt(squares / weights) } else { 0.0 }
}

/// Returns the metric: the triangle M of the displacements that a unit of each unknown makes over the travel, `|M x|`
/// is their RMS.
fn metric(model: &FitModel<'_>) -> DMatrix<f64> {
    let list = model.parameters();
    let mut triangle = Triangle::new(list.len());
    let mut done: Vec<&ParameterTerm> = Vec::new();
    for term in list.iter().flat_map(|p| &p.terms) {
        if !done.iter().any(|known| known.is_of_curve(term)) {
            effects(model, term).into_iter().for_each(|row| triangle.push(row, 0.0));
            done.push(term);
        }
    }
    for (j, parameter) in list.iter().enumerate() {
        let share = if parameter.is_nuisance() { 1.0 } else { MIN_METRIC_SHARE };
        triangle.push((0..list.len()).map(|k| if j == k { parameter.size * share } else { 0.0 }), 0.0);
    }
    triangle.finish().r
}

/// Returns the displacements (mm) that a unit of each unknown makes by an error, a row for each position of the travel,
/// over the root of their number; a single row for constants.
fn effects(model: &FitModel<'_>, of: &ParameterTerm) -> Vec<Vec<f64>> {
    let source = of.source;
    let mine = |p: &Parameter, q: f64| {
        let terms = p.terms.iter().filter(|t| of.is_of_curve(t));
        terms.map(|t| t.factor * t.basis.value(q)).sum::<f64>() * lever(source.direction)
    };
    let row = |q: f64| model.parameters().iter().map(|p| mine(p, q)).collect::<Vec<f64>>();
    let mut terms = model.parameters().iter().flat_map(|p| &p.terms);
    let is_curve = terms.any(|t| of.is_of_curve(t) && t.basis != BasisFunction::Constant);
    let ErrorSite::Component(axis) = source.place else { return vec![row(0.0)] };
    if !is_curve {
        return vec![row(0.0)];
    }
    let (min, max) = model.machines()[0].axes()[axis].travel.interval();
    let site = |i: usize| min + (max - min) * (i as f64 + 0.5) / METRIC_SITES as f64;
    let scaled = |i: usize| row(site(i)).into_iter().map(|x| x / libm::sqrt(METRIC_SITES as f64)).collect();
    (0..METRIC_SITES).map(scaled).collect()
}

/// Returns the directions (of displacements, columns) of the machine's unknowns that no reading sees to first order,
/// and the exact model only through products of errors.
fn second_order_only(model: &FitModel<'_>, data: &[Measurement], prior: &Prior, home: &ReducedSystem) -> DMatrix<f64> {
    let step = (data.len() / (SAMPLE_ROWS_PER_UNKNOWN * model.parameters().len()).max(MIN_SAMPLE_ROWS)).max(1);
    let some: Vec<Measurement> = data.iter().step_by(step).cloned().collect();
    let theta = model.start();
    let first = model.clone().to_order(Order::Degree(1)).triangle(&some, &vec![1.0; some.len()], &theta);
    let first = Svd::new(&prior.by_displacement(&first.r));
    let null = first.null_space(first.rank(RANK_TOLERANCE));
    // Not the unknowns of instruments, of which the first step may be a long one, and not directions with known values.
    let instruments = null.rows(prior.own, null.nrows() - prior.own).into_owned();
    let null = null_combinations(&instruments, 1.0, null);
    let known = prior.by_displacement(&prior.rows);
    let null = null_combinations(&(&known * &null), known.amax(), null);
    if null.ncols() == 0 {
        return null;
    }
    let exact = prior.by_displacement(&home.r);
    let largest = exact.column_iter().map(|column| column.norm()).fold(0.0, f64::max);
    let seen = Svd::new(&(exact * &null));
    let first_order = seen.values.iter().filter(|value| **value > MIN_FIRST_ORDER_SHARE * largest).count();
    null * seen.null_space(first_order)
}

/// Returns the combinations of directions (columns) on which these rows, of size `size`, are zero but for rounding.
fn null_combinations(rows: &DMatrix<f64>, size: f64, directions: DMatrix<f64>) -> DMatrix<f64> {
    if rows.nrows() == 0 || directions.ncols() == 0 {
        return directions;
    }
    let svd = Svd::new(rows);
    let seen = svd.values.iter().filter(|value| **value > RANK_TOLERANCE * size).count();
    &directions * svd.null_space(seen)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding shows no direction of an orthonormal basis, a part of a thousandth does.
    #[test]
    fn directions_that_rounding_alone_shows_are_unseen() {
        let directions = DMatrix::identity(3, 3);
        let rounding = DMatrix::from_row_slice(2, 3, &[1e-16, -2e-15, 0.0, 3e-16, 1e-15, 1e-16]);
        assert_eq!(null_combinations(&rounding, 1.0, directions.clone()).ncols(), 3);
        let seen = DMatrix::from_row_slice(2, 3, &[1e-3, -2e-15, 0.0, 3e-16, 1e-15, 1e-16]);
        let left = null_combinations(&seen, 1.0, directions);
        assert_eq!(left.ncols(), 2);
        assert!((seen * left).amax() < 1e-12);
    }
}
