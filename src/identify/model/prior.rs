//! Knowledge before the data.
//!
//! Unknowns are compared as displacements: of an error that is one number its own, of a curve the root mean square over
//! the travel. So it does not matter in which basis a curve is written: powers about the machine's zero point may be
//! large
//! and cancel, as long as the curve is small.

use super::parameter::{Basis, Parameter};
use super::prediction::Model;
use crate::algebra::linear::{ReducedSystem, Svd, Triangle};
use crate::evaluate::Order;
use crate::identify::data::{Measurement, lever};
use crate::lower::{ErrorSite, Source};
use crate::machine::Approach;
use nalgebra::{DMatrix, DVector};

/// Least standard deviation of a displacement (mm): 10 mrad of a rotation.
const SIGMA: f64 = 3.0;
/// Standard deviation of a displacement over what the readings show of all errors together. An error that is no larger
/// than it is moved by less than half of its standard uncertainty.
const USUAL: f64 = 3.0;
/// Places of the travel where a curve is looked at.
const SITES: usize = 50;
/// Least displacement of a unit of an unknown, as a share of its usual one: bases that say the same curve twice are
/// told
/// apart by this alone.
const FAINT: f64 = 1e-7;
/// Standard deviation (mm) of what only products of errors show: 0.1 mrad of a rotation. Noise that is no noise, but
/// what the chosen curves miss, would otherwise draw it out by millimetres.
const HELD: f64 = 0.03;
/// Readings from which on it is held the tighter the more there are: what is no noise does not average out.
const MANY: f64 = 1000.0;
/// First-order singular values below this share of the largest are zero.
const NULL: f64 = 1e-10;
/// What the exact model sees by more than this share of the largest is there without products of small errors.
const PLAIN: f64 = 1e-2;
/// Rows per unknown, and rows at least, of a sample that shows what the first order sees.
const SAMPLE: (usize, usize) = (4, 1000);

/// Near which values the unknowns are, and in which directions they stay.
pub(crate) struct Prior {
    start: DVector<f64>,
    /// Displacements (mm) from unknowns, the machine's first: an upper triangle.
    metric: DMatrix<f64>,
    /// Number of unknowns that are the machine's. Nothing is known of the instruments'.
    own: usize,
    /// Size (mm) of all errors together as the readings show it.
    pub shown: f64,
    /// True if values are known before the data.
    pub informed: bool,
    /// Standard deviation of a displacement (mm).
    sigma: f64,
    /// Combinations that are known to be `values` with standard deviation 1.
    rows: DMatrix<f64>,
    values: DVector<f64>,
}

impl Prior {
    /// Prior of a model; `home` is the linear problem at the starts of its unknowns.
    pub fn new(model: &Model<'_>, data: &[Measurement], home: &ReducedSystem) -> Self {
        let list = model.parameters();
        let start = DVector::from_iterator(list.len(), list.iter().map(|p| p.start));
        let (slopes, (known, known_values)) = (model.slopes(), model.known());
        let held = slopes.nrows();
        let mut rows = slopes.clone().insert_rows(held, known.nrows(), 0.0);
        rows.rows_mut(held, known.nrows()).copy_from(&known);
        let mut values = DVector::zeros(held + known.nrows());
        values.rows_mut(held, known.nrows()).copy_from(&known_values);
        let shown = shown(model.own(), data, home);
        let (sigma, informed) = (SIGMA.max(USUAL * shown), known.nrows() > 0);
        let prior = Self { start, metric: metric(model), own: model.own(), shown, informed, sigma, rows, values };
        let many = libm::sqrt((home.rows as f64 / MANY).max(1.0));
        let hidden = bilinear(model, data, &prior, home);
        prior.holding(&hidden, HELD.max(shown) / many)
    }

    /// Adds directions (of displacements, columns) that stay at the start within `sigma` (mm).
    fn holding(self, directions: &DMatrix<f64>, sigma: f64) -> Self {
        let (known, held) = (self.rows.nrows(), directions.tr_mul(&self.metric) / sigma);
        let mut rows = self.rows.insert_rows(known, held.nrows(), 0.0);
        let mut values = self.values.insert_rows(known, held.nrows(), 0.0);
        rows.rows_mut(known, held.nrows()).copy_from(&held);
        values.rows_mut(known, held.nrows()).copy_from(&(&held * &self.start));
        Self { rows, values, ..self }
    }

    /// Weight of a displacement beside readings of this variance.
    pub fn pull(&self, variance: f64) -> f64 {
        variance / (self.sigma * self.sigma)
    }

    /// Distance from home, as displacements.
    pub fn away(&self, theta: &[f64]) -> DVector<f64> {
        let mut away = &self.metric * (DVector::from_column_slice(theta) - &self.start);
        away.rows_mut(self.own, theta.len() - self.own).fill(0.0);
        away
    }

    /// Other knowledge, as rows of readings of this variance: coefficients, and what is missing.
    pub fn rows(&self, theta: &[f64], variance: f64) -> (DMatrix<f64>, DVector<f64>) {
        let missing = &self.values - &self.rows * DVector::from_column_slice(theta);
        (&self.rows * libm::sqrt(variance), missing * libm::sqrt(variance))
    }

    /// Weighted sum of squares (mm^2) of readings and prior, readings scattering with this variance.
    pub fn cost(&self, reduced: &ReducedSystem, theta: &[f64], variance: f64) -> f64 {
        let data = reduced.right_norm() * reduced.right_norm();
        let (_, missing) = self.rows(theta, variance);
        data + self.pull(variance) * self.away(theta).norm_squared() + missing.norm_squared()
    }

    /// Coefficients of unknowns as coefficients of displacements.
    pub fn by_displacement(&self, coefficients: &DMatrix<f64>) -> DMatrix<f64> {
        let solved = self.metric.tr_solve_upper_triangular(&coefficients.transpose());
        solved.map_or_else(|| coefficients.clone(), |columns| columns.transpose())
    }

    /// Unknowns that make these displacements.
    pub fn unknowns(&self, displacements: &DVector<f64>) -> DVector<f64> {
        self.metric.solve_upper_triangular(displacements).unwrap_or_else(|| DVector::zeros(displacements.len()))
    }
}

/// Root mean square (mm) of what the readings are off the machine at the start, wherever instruments and set-ups are.
fn shown(own: usize, data: &[Measurement], home: &ReducedSystem) -> f64 {
    let instruments = home.r.columns(own, home.r.ncols() - own);
    let mut triangle = Triangle::new(instruments.ncols());
    let rows = instruments.row_iter().zip(home.right.iter());
    rows.for_each(|(row, right)| triangle.push(row.iter().copied(), *right));
    let rest = triangle.finish();
    let svd = Svd::new(&rest.r);
    let missed = &rest.right - &rest.r * svd.solve(&rest.right, svd.rank(NULL));
    let squares = missed.norm_squared() + rest.rest * rest.rest + home.rest * home.rest;
    let weights: f64 = data.iter().map(|m| m.weight * m.readings() as f64).sum();
    if weights > 0.0 { libm::sqrt(squares / weights) } else { 0.0 }
}

/// Displacements from unknowns: the triangle of what each does over the travel.
fn metric(model: &Model<'_>) -> DMatrix<f64> {
    let list = model.parameters();
    let mut triangle = Triangle::new(list.len());
    let mut met: Vec<(Source, Approach)> = Vec::new();
    for term in list.iter().flat_map(|p| &p.terms) {
        let key = (term.source, term.approach);
        if !met.contains(&key) {
            met.push(key);
            effects(model, key).into_iter().for_each(|row| triangle.push(row, 0.0));
        }
    }
    for (j, parameter) in list.iter().enumerate() {
        let share = if parameter.is_nuisance() { 1.0 } else { FAINT };
        triangle.push((0..list.len()).map(|k| if j == k { parameter.size * share } else { 0.0 }), 0.0);
    }
    triangle.finish().r
}

/// Effect of a unit of each unknown on an error: displacements at places of the travel, over the root of their number.
fn effects(model: &Model<'_>, (source, approach): (Source, Approach)) -> Vec<Vec<f64>> {
    let mine = |p: &Parameter, q: f64| {
        let terms = p.terms.iter().filter(|t| (t.source, t.approach) == (source, approach));
        terms.map(|t| t.factor * t.basis.value(q)).sum::<f64>() * lever(source.direction)
    };
    let row = |q: f64| model.parameters().iter().map(|p| mine(p, q)).collect::<Vec<f64>>();
    let is_curve = model
        .parameters()
        .iter()
        .flat_map(|p| &p.terms)
        .any(|t| (t.source, t.approach) == (source, approach) && t.basis != Basis::Constant);
    let ErrorSite::Component(axis) = source.place else { return vec![row(0.0)] };
    if !is_curve {
        return vec![row(0.0)];
    }
    let (min, max) = model.machines()[0].axes()[axis].travel.interval();
    let site = |i: usize| min + (max - min) * (i as f64 + 0.5) / SITES as f64;
    let scaled = |i: usize| row(site(i)).into_iter().map(|x| x / libm::sqrt(SITES as f64)).collect();
    (0..SITES).map(scaled).collect()
}

/// Directions (of displacements, columns) of the machine's unknowns that no reading sees to first order, and the exact
/// model only through products of errors.
fn bilinear(model: &Model<'_>, data: &[Measurement], prior: &Prior, home: &ReducedSystem) -> DMatrix<f64> {
    let (per_unknown, least) = SAMPLE;
    let step = (data.len() / (per_unknown * model.parameters().len()).max(least)).max(1);
    let some: Vec<Measurement> = data.iter().step_by(step).cloned().collect();
    let theta: Vec<f64> = model.parameters().iter().map(|p| p.start).collect();
    let first = model.clone().to_order(Order::Degree(1)).triangle(&some, &vec![1.0; some.len()], &theta);
    let first = Svd::new(&prior.by_displacement(&first.r));
    let hidden = first.null_space(first.rank(NULL));
    // Not the unknowns of instruments, of which the first step may be a long one, and not what other knowledge is
    // about.
    let instruments = hidden.rows(prior.own, hidden.nrows() - prior.own).into_owned();
    let hidden = unseen((&instruments, 1.0), hidden);
    let known = prior.by_displacement(&prior.rows);
    let hidden = unseen((&(&known * &hidden), known.amax()), hidden);
    if hidden.ncols() == 0 {
        return hidden;
    }
    let exact = prior.by_displacement(&home.r);
    let loudest = exact.column_iter().map(|column| column.norm()).fold(0.0, f64::max);
    let seen = Svd::new(&(exact * &hidden));
    let plain = seen.values.iter().filter(|value| **value > PLAIN * loudest).count();
    hidden * seen.null_space(plain)
}

/// Those combinations of directions that make nothing of these rows, of which less than `NULL` of `size` is rounding.
fn unseen((rows, size): (&DMatrix<f64>, f64), directions: DMatrix<f64>) -> DMatrix<f64> {
    if rows.nrows() == 0 || directions.ncols() == 0 {
        return directions;
    }
    let svd = Svd::new(rows);
    let seen = svd.values.iter().filter(|value| **value > NULL * size).count();
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
        assert_eq!(unseen((&rounding, 1.0), directions.clone()).ncols(), 3);
        let seen = DMatrix::from_row_slice(2, 3, &[1e-3, -2e-15, 0.0, 3e-16, 1e-15, 1e-16]);
        let left = unseen((&seen, 1.0), directions);
        assert_eq!(left.ncols(), 2);
        assert!((seen * left).amax() < 1e-12);
    }
}
