//! A plan of few readings, such that the parameters are known best. Nothing has to be measured for it.

use super::fit::ParameterFit;
use super::solution::Solution;
use super::volume::Prediction;
use crate::identify::data::{Measurement, Reading, taken_together};
use crate::identify::model::{FitModel, Parameter, invariances};
use crate::identify::thresholds::{MIN_PRIOR_SIGMA_MM, PLAN_SHARE_OF_ALL};
use crate::run::Advance;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Vector3};
use rayon::prelude::*;

/// Chooses `count` of the candidates, each once and one after the other: each time the one that shrinks the
/// determinant of the covariance of the machine's parameters most, whatever the unknowns of instruments are
/// (D_s-optimality: Atkinson, Donev and Tobias 2007). Lines count as one; a run of relative readings begins with its
/// first, which counts.
/// The first of each run is among them if `each_run` is set.
/// A component has a standard deviation of `noise` (mm), unless its row states its own.
/// `progress` hears of each choice. Returns the indices of each reading in the order of their worth.
pub fn plan<F>(
    model: &FitModel<'_>,
    candidates: &[Measurement],
    count: usize,
    each_run: bool,
    noise: f64,
    progress: Advance<'_, F>,
) -> Result<Vec<Vec<usize>>, F> {
    let theta = model.start();
    let groups = taken_together(candidates);
    let rows_of = |of: &Vec<usize>| scaled_rows(model, of.iter().map(|i| &candidates[*i]), &theta, noise);
    let rows: Vec<DMatrix<f64>> = groups.iter().map(rows_of).collect();
    let leads = leads(candidates, &groups);
    let mut covariance = prior(model);
    let is_first = |group: &usize| each_run && leads[*group] == Some(*group);
    let mut taken: Vec<usize> = (0..groups.len()).filter(is_first).take(count).collect();
    for group in &taken {
        update(&mut covariance, &rows[*group]);
        progress(1)?;
    }
    while taken.len() < count.min(groups.len()) {
        let own = covariance.view((0, 0), (model.own(), model.own())).into_owned().cholesky();
        let worth = |group: usize| {
            let lead = leads[group].filter(|lead| *lead != group && !taken.contains(lead));
            if taken.contains(&group) || (lead.is_some() && taken.len() + 2 > count) {
                return (f64::NEG_INFINITY, None);
            }
            let both = lead.map(|lead| stacked(&rows[lead], &rows[group]));
            let rows = both.as_ref().unwrap_or(&rows[group]);
            (information(rows, &covariance, own.as_ref()) / if lead.is_some() { 2.0 } else { 1.0 }, lead)
        };
        let worths: Vec<(f64, Option<usize>)> = (0..groups.len()).into_par_iter().map(worth).collect();
        // The first of equals.
        let best = (0..groups.len()).fold(0, |best, group| if worths[group].0 > worths[best].0 { group } else { best });
        for group in worths[best].1.into_iter().chain([best]) {
            update(&mut covariance, &rows[group]);
            taken.push(group);
            progress(1)?;
        }
    }
    Ok(taken.into_iter().map(|group| groups[group].clone()).collect())
}

/// Returns for each group the one with which its run of relative readings begins; `None` of other readings.
fn leads(data: &[Measurement], groups: &[Vec<usize>]) -> Vec<Option<usize>> {
    let mut first = std::collections::BTreeMap::new();
    let of = |(index, group): (usize, &Vec<usize>)| match group.first().map(|row| &data[*row].reading) {
        Some(Reading::Deviation { zero, .. }) => {
            zero.iter().flatten().next().map(|zero| *first.entry(*zero).or_insert(index))
        }
        _ => None,
    };
    groups.iter().enumerate().map(of).collect()
}

fn stacked(above: &DMatrix<f64>, below: &DMatrix<f64>) -> DMatrix<f64> {
    let mut all = above.clone().resize_vertically(above.nrows() + below.nrows(), 0.0);
    all.rows_mut(above.nrows(), below.nrows()).copy_from(below);
    all
}

/// Returns the covariance of displacements before the readings.
fn prior(model: &FitModel<'_>) -> DMatrix<f64> {
    let unknowns = model.parameters().len();
    let mut covariance = DMatrix::identity(unknowns, unknowns) * (MIN_PRIOR_SIGMA_MM * MIN_PRIOR_SIGMA_MM);
    for known in model.known() {
        let sigma = known.sigma * model.parameters()[known.unknown].size;
        let own = &mut covariance[(known.unknown, known.unknown)];
        *own = own.min(sigma * sigma);
    }
    let (equations, _) = model.known_rows(&model.start());
    for row in equations.row_iter().skip(model.known().len()) {
        let row = DVector::from_iterator(unknowns, row.iter().zip(model.parameters()).map(|(x, p)| x / p.size));
        let seen = &covariance * &row;
        covariance -= &seen * seen.transpose() / (1.0 + row.dot(&seen));
    }
    covariance
}

/// Standard deviation of a component of a row, mm.
fn sigma(row: &Measurement, noise: f64) -> f64 {
    (if row.has_uncertainty { 1e-3 } else { noise }) / row.weight.sqrt()
}

/// Returns the derivatives of the components that are read by displacements of the unknowns, over their noise.
fn scaled_rows<'m>(
    model: &FitModel<'_>,
    group: impl Iterator<Item = &'m Measurement>,
    theta: &[f64],
    noise: f64,
) -> DMatrix<f64> {
    let mut list: Vec<f64> = Vec::new();
    for row in group {
        let (columns, _) = model.rows(row, theta);
        let read = (0..3).filter(|k| row.reading_mask()[*k]);
        let scale = |(column, p): (&Vector3<f64>, &Parameter), k: usize| column[k] / p.size / sigma(row, noise);
        read.for_each(|k| list.extend(columns.iter().zip(model.parameters()).map(|of| scale(of, k))));
    }
    let unknowns = model.parameters().len();
    DMatrix::from_row_iterator(list.len() / unknowns.max(1), unknowns, list)
}

/// Returns by how much readings shrink the logarithm of the determinant of the covariance of the machine's parameters,
/// of which `own` is the factor.
fn information(rows: &DMatrix<f64>, covariance: &DMatrix<f64>, own: Option<&Cholesky<f64, Dyn>>) -> f64 {
    let seen = covariance * rows.transpose();
    let all = DMatrix::identity(rows.nrows(), rows.nrows()) + rows * &seen;
    let of_all = libm::log(all.determinant().max(1.0));
    let Some(own) = own else { return of_all };
    let part = seen.rows(0, own.l_dirty().nrows()).into_owned();
    // Of the instrument alone.
    let rest = &all - part.transpose() * own.solve(&part);
    of_all * (1.0 + PLAN_SHARE_OF_ALL) - libm::log(rest.determinant().max(1.0))
}

/// Updates the covariance by readings (Sherman, Morrison and Woodbury).
fn update(covariance: &mut DMatrix<f64>, rows: &DMatrix<f64>) {
    let seen = &*covariance * rows.transpose();
    let all = DMatrix::identity(rows.nrows(), rows.nrows()) + rows * &seen;
    if let Some(inverse) = all.try_inverse() {
        *covariance -= &seen * inverse * seen.transpose();
        // Rounding must not make it unsymmetric.
        *covariance = (&*covariance + covariance.transpose()) * 0.5;
    }
}

/// Returns uncertainties, rank and null space to be expected of readings, and the prediction over the volume; values
/// are those of the machine file.
pub fn expected(model: &FitModel<'_>, data: &[Measurement], noise: f64) -> (Solution, Prediction) {
    let theta = model.start();
    let weights: Vec<f64> = data.iter().map(|row| (noise / sigma(row, noise)) * (noise / sigma(row, noise))).collect();
    let reduced = model.triangle(data, &weights, &theta);
    let blank = ParameterFit::new(model, theta, reduced, weights);
    let mut fit = ParameterFit { squares: 0.0, converged: true, ..blank };
    // As if the readings scattered by the noise over as many degrees of freedom as there will be.
    let rest = Solution::of(&fit, model.parameters()).degrees_of_freedom.max(1);
    fit.squares = noise * noise * rest as f64;
    let motions = invariances(model, data, &fit.theta).motion_parameters;
    let solution = Solution::of(&fit, model.parameters()).with_first_order_rank(model, data, &fit, &motions);
    let prediction = Prediction::of(model, data, &fit, &solution, &[]);
    (solution, prediction)
}
