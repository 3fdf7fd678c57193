//! Weights of readings. Readings of one quantity scatter alike; those of another have a variance of their own, found by
//! the fit (Helmert's variance components), unless the files give uncertainties. With robust weights (Huber) outliers
//! count less, and the uncertainty is that of Huber's estimate.

use super::fit::{FitSearch, LimitedResiduals, ParameterFit, Scatter};
use crate::algebra::linear::{ReducedSystem, Triangle};
use crate::identify::data::{Measurement, ReadingKind};
use crate::identify::lists::index_of;
use crate::identify::model::{FitModel, sizes};
use crate::identify::thresholds::*;
use nalgebra::{DMatrix, Vector3};

/// Fits the unknowns to the data with weights by the scatter of the readings; `robust` gives outliers less weight.
pub fn solve(model: &FitModel<'_>, data: &[Measurement], robust: bool) -> ParameterFit {
    let search = FitSearch::new(model, data);
    let mut found = search.fit();
    let groups = Groups::of(data);
    if groups.kinds.len() < 2 && !robust {
        return found;
    }
    let mut sigmas = vec![1e-3; groups.kinds.len()];
    for _ in 0..MAX_REWEIGHTINGS {
        let residuals = robust.then(|| model.residuals(data, &found.theta));
        sigmas = groups.sigmas(model, data, &found, sigmas, residuals.as_deref());
        let shares = residuals.map_or_else(|| vec![1.0; data.len()], |residuals| huber_weights(data, &residuals));
        let weights = groups.weights(data, &sigmas, &shares);
        let change = weights.iter().zip(&found.weights).map(|(a, b)| (a - b).abs() / b).fold(0.0, f64::max);
        let steps = found.steps;
        found = search.fit_from(weights, found.theta);
        found.steps += steps;
        if change < SETTLED_WEIGHT_CHANGE {
            break;
        }
    }
    if groups.kinds.len() > 1 {
        found.parameter_freedom = groups.parameter_freedom(model, data, &found, robust);
    }
    if robust {
        apply_huber_estimate(model, data, &groups, &sigmas, &mut found);
    }
    if groups.kinds.len() > 1 {
        found.scatter = groups.kinds.iter().zip(sigmas).map(|(of, sigma)| Scatter { of: *of, sigma }).collect();
    }
    found
}

/// Groups of readings of one quantity.
struct Groups {
    kinds: Vec<Option<ReadingKind>>,
    /// Index in `kinds`, of each measurement.
    of: Vec<usize>,
}

impl Groups {
    fn of(data: &[Measurement]) -> Self {
        let mut kinds = Vec::new();
        let index = |m: &Measurement| index_of(&mut kinds, (!m.has_uncertainty).then(|| m.kind()));
        let of = data.iter().map(index).collect();
        Self { kinds, of }
    }

    fn members(&self, group: usize) -> impl Iterator<Item = usize> {
        (0..self.of.len()).filter(move |i| self.of[*i] == group)
    }

    /// Returns the standard deviation of a reading of each quantity (mm), `before` in the last round. A robust fit
    /// takes it from the median of the residuals.
    fn sigmas(
        &self,
        model: &FitModel<'_>,
        data: &[Measurement],
        found: &ParameterFit,
        before: Vec<f64>,
        residuals: Option<&[Vector3<f64>]>,
    ) -> Vec<f64> {
        if self.kinds.len() < 2 {
            return before;
        }
        let Some(residuals) = residuals else {
            let weights: Vec<f64> = data.iter().map(|m| m.weight).collect();
            return balance_variances(&self.linear(model, data, &weights, found), before);
        };
        let squares = |g: usize| {
            let (median, count) = median(self.members(g).flat_map(|i| components(&data[i], &residuals[i])).collect());
            count as f64 * (median / MEDIAN_OVER_SIGMA) * (median / MEDIAN_OVER_SIGMA)
        };
        let linear = self.linear(model, data, &found.weights, found);
        let parts = residuals_of_quantities(&linear, &vec![1.0; linear.len()]).into_iter().enumerate();
        let parts = parts.map(|(g, own)| QuantityResidual { squares: squares(g), ..own });
        sigmas_of_quantities(&parts.collect::<Vec<_>>())
    }

    /// Returns the degrees of freedom of the variance of each unknown, which is a sum over the quantities:
    /// `(sum v_g)^2 / sum (v_g^2 / f_g)` (Welch 1947, Satterthwaite 1946).
    fn parameter_freedom(
        &self,
        model: &FitModel<'_>,
        data: &[Measurement],
        found: &ParameterFit,
        robust: bool,
    ) -> Vec<f64> {
        let (linear, seen) = (self.linear(model, data, &found.weights, found), visible_directions(model, found));
        let ones = vec![1.0; linear.len()];
        let parts = residuals_of_quantities(&linear, &ones);
        let all = parts.iter().map(|own| own.redundancy).sum::<f64>().max(1.0);
        let efficiency = if robust { MEDIAN_EFFICIENCY } else { 1.0 };
        let freedom = |own: &QuantityResidual| match own.redundancy {
            few if few < MIN_REDUNDANCY => all,
            redundancy => (redundancy * efficiency).max(1.0),
        };
        let freedoms: Vec<f64> = parts.iter().map(freedom).collect();
        let whole = stack(&linear, &ones).r;
        let columns = whole.tr_solve_upper_triangular(&seen.transpose());
        let Some(columns) = columns.and_then(|half| whole.solve_upper_triangular(&half)) else { return Vec::new() };
        let parts: Vec<DMatrix<f64>> = linear.iter().map(|own| &own.r * &columns).collect();
        let one = |j: usize| {
            let variances = parts.iter().map(|part| part.column(j).norm_squared());
            let (mut sum, mut squares) = (0.0, 0.0);
            for (variance, freedom) in variances.zip(&freedoms) {
                sum += variance;
                squares += variance * variance / freedom;
            }
            if squares > 0.0 { sum * sum / squares } else { all }
        };
        (0..columns.ncols()).map(one).collect()
    }

    /// Returns the linear problem of each quantity at the fit, in the directions that the data see.
    fn linear(
        &self,
        model: &FitModel<'_>,
        data: &[Measurement],
        weights: &[f64],
        found: &ParameterFit,
    ) -> Vec<ReducedSystem> {
        let seen = visible_directions(model, found);
        let one = |g: usize| {
            let (data, weights): (Vec<_>, Vec<_>) = self.members(g).map(|i| (data[i].clone(), weights[i])).unzip();
            let own = model.triangle(&data, &weights, &found.theta);
            ReducedSystem { r: own.r * &seen, ..own }
        };
        (0..self.kinds.len()).map(one).collect()
    }

    /// Returns the weights `w f / s^2` for the standard deviation s (um) of the quantity and a factor f of each
    /// reading.
    fn weights(&self, data: &[Measurement], sigmas: &[f64], factors: &[f64]) -> Vec<f64> {
        let one = |i: usize| {
            let um = sigmas[self.of[i]] * 1e3;
            data[i].weight * factors[i] / (um * um)
        };
        (0..data.len()).map(one).collect()
    }
}

/// Returns the orthonormal directions (columns, by displacements) that the data see, in the units of the unknowns.
fn visible_directions(model: &FitModel<'_>, found: &ParameterFit) -> DMatrix<f64> {
    let sizes = sizes(model.parameters());
    let svd = found.reduced.scaled(&sizes);
    let mut seen = svd.v.columns(0, svd.rank(RANK_TOLERANCE)).into_owned();
    seen.row_iter_mut().zip(sizes.iter()).for_each(|(mut row, size)| row /= *size);
    seen
}

/// Stacks the linear problems of all quantities, each over its standard deviation.
fn stack(linear: &[ReducedSystem], sigmas: &[f64]) -> ReducedSystem {
    let mut triangle = Triangle::new(linear.first().map_or(0, |own| own.r.ncols()));
    for (own, sigma) in linear.iter().zip(sigmas) {
        let rows = own.r.row_iter().zip(own.right.iter());
        rows.for_each(|(row, right)| triangle.push(row.iter().map(|x| x / sigma), right / sigma));
    }
    triangle.finish()
}

struct QuantityResidual {
    /// Weighted sum of squares (mm^2).
    squares: f64,
    /// Number of readings less their share of the rank.
    redundancy: f64,
}

/// Returns the residual of each quantity in the fit of all, each weighed by its standard deviation.
fn residuals_of_quantities(linear: &[ReducedSystem], sigmas: &[f64]) -> Vec<QuantityResidual> {
    let whole = stack(linear, sigmas);
    let step = whole.r.solve_upper_triangular(&whole.right);
    let one = |(own, sigma): (&ReducedSystem, &f64)| {
        // The data see all of these directions: the triangle has an inverse.
        let share = whole.r.tr_solve_upper_triangular(&(own.r.transpose() / *sigma));
        let residual = step.as_ref().map_or_else(|| own.right.clone(), |step| &own.right - &own.r * step);
        let squares = residual.norm_squared() + own.rest * own.rest;
        let rank = share.map_or(0.0, |share| share.norm_squared());
        QuantityResidual { squares, redundancy: own.rows as f64 - rank }
    };
    linear.iter().zip(sigmas).map(one).collect()
}

/// Iterates the standard deviations until they agree with the residuals of the fit that they weigh.
fn balance_variances(linear: &[ReducedSystem], mut sigmas: Vec<f64>) -> Vec<f64> {
    for _ in 0..MAX_VARIANCE_ITERATIONS {
        let next = sigmas_of_quantities(&residuals_of_quantities(linear, &sigmas));
        let change = next.iter().zip(&sigmas).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        sigmas = next;
        if change < 0.1 * SETTLED_WEIGHT_CHANGE {
            break;
        }
    }
    sigmas
}

/// Returns standard deviations `sqrt(squares / redundancy)`; quantities of little redundancy have the common one.
fn sigmas_of_quantities(parts: &[QuantityResidual]) -> Vec<f64> {
    let sum = |of: fn(&QuantityResidual) -> f64| parts.iter().map(of).sum::<f64>();
    let common = sum(|own| own.squares) / sum(|own| own.redundancy).max(1.0);
    let variance =
        |own: &QuantityResidual| if own.redundancy < MIN_REDUNDANCY { common } else { own.squares / own.redundancy };
    let sigmas: Vec<f64> = parts.iter().map(|part| libm::sqrt(variance(part))).collect();
    let least = sigmas.iter().fold(MIN_SCATTER_MM, |least: f64, sigma| least.max(sigma * MIN_SCATTER_SHARE));
    sigmas.into_iter().map(|sigma| sigma.max(least)).collect()
}

/// Returns the factor of the weight of each measurement by Huber: 1 up to his constant, then falling as 1 / size.
fn huber_weights(data: &[Measurement], residuals: &[Vector3<f64>]) -> Vec<f64> {
    let sizes = standardise(data, residuals);
    sizes.into_iter().map(|size| if size > HUBER_CONSTANT { HUBER_CONSTANT / size } else { 1.0 }).collect()
}

/// Replaces the linear problem of the weighed readings by that of all readings, whose scatter gives the variance of the
/// estimate: `K^2 sum psi^2 / mean(psi')^2` (Huber 1981, section 7.6), with `K = 1 + p/n var(psi') / mean(psi')^2`.
/// `psi` of a measurement of d components is that of their length.
fn apply_huber_estimate(
    model: &FitModel<'_>,
    data: &[Measurement],
    groups: &Groups,
    sigmas: &[f64],
    found: &mut ParameterFit,
) {
    let residuals = model.residuals(data, &found.theta);
    let shares = huber_weights(data, &residuals);
    let whole = groups.weights(data, sigmas, &vec![1.0; data.len()]);
    let slope = |(m, share): (&Measurement, &f64)| {
        let d = m.readings() as f64;
        (d, if *share < 1.0 { share * (d - 1.0) / d } else { 1.0 })
    };
    let slopes: Vec<(f64, f64)> = data.iter().zip(&shares).map(slope).collect();
    let count: f64 = slopes.iter().map(|(d, _)| d).sum();
    let mean = slopes.iter().map(|(d, slope)| d * slope).sum::<f64>() / count;
    let variance = slopes.iter().map(|(d, slope)| d * (slope - mean) * (slope - mean)).sum::<f64>() / count;
    let k = 1.0 + found.theta.len() as f64 / count * variance / (mean * mean);
    let psi = |i: usize| whole[i] * (shares[i] * shares[i]) * residuals[i].norm_squared();
    found.squares = k * k * (0..data.len()).map(psi).sum::<f64>() / (mean * mean);
    found.reduced = model.triangle(data, &whole, &found.theta);
    let limited = whole.iter().zip(&shares).map(|(weight, share)| weight * share).collect();
    found.limits = Some(LimitedResiduals { weights: whole, limited, slope: mean });
}

/// Returns the sizes of the components read of a residual, over their uncertainty.
fn components(m: &Measurement, residual: &Vector3<f64>) -> Vec<f64> {
    let seen = m.reading_mask();
    (0..3).filter(|k| seen[*k]).map(|k| residual[k].abs() * libm::sqrt(m.weight)).collect()
}

/// Returns the (upper) median and the number of values.
pub(crate) fn median(mut list: Vec<f64>) -> (f64, usize) {
    list.sort_by(f64::total_cmp);
    (list.get(list.len() / 2).copied().unwrap_or_default(), list.len())
}

/// Returns the RMS component of each residual in robust standard deviations of its quantity.
pub(crate) fn standardise(data: &[Measurement], residuals: &[Vector3<f64>]) -> Vec<f64> {
    let groups = Groups::of(data);
    let sigma = |g: usize| {
        let list = groups.members(g).flat_map(|i| components(&data[i], &residuals[i])).collect();
        (median(list).0 / MEDIAN_OVER_SIGMA).max(f64::MIN_POSITIVE)
    };
    let sigmas: Vec<f64> = (0..groups.kinds.len()).map(sigma).collect();
    let component = |m: &Measurement, r: &Vector3<f64>| r.norm() * libm::sqrt(m.weight / m.readings().max(1) as f64);
    (0..data.len()).map(|i| component(&data[i], &residuals[i]) / sigmas[groups.of[i]]).collect()
}
