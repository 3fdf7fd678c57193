//! Weights of readings. Readings of one quantity scatter alike; those of another have a variance of their own, found by
//! the fit (Helmert's variance components), unless the files give uncertainties. With robust weights (Huber) readings
//! that stand out count less, and the uncertainty is that of Huber's estimate.

use super::fit::{Fit, Scatter, Search};
use crate::algebra::linear::{ReducedSystem, Triangle};
use crate::identify::data::{Measurement, ReadingKind};
use crate::identify::lists::index_of;
use crate::identify::model::Model;
use nalgebra::{DMatrix, DVector, Vector3};

/// Huber's constant, in standard deviations of a component.
const HUBER: f64 = 1.5;
/// Rounds of reweighting.
const ROUNDS: usize = 30;
/// Rounds on the linear problem, between two of the model.
const BALANCING: usize = 100;
/// Weights that change by less than this share have settled.
const SETTLED: f64 = 1e-3;
/// The median of the absolute value of a normal deviate, in standard deviations.
const MEDIAN: f64 = 0.6745;
/// Degrees of freedom of the median of absolute values as a share of those of the standard deviation: 0.37 of many
/// readings,
/// more of few, where the upper of two middle values errs to the safe side.
const EFFICIENCY: f64 = 0.5;
/// A quantity with less redundancy than this has no variance of its own.
const REDUNDANT: f64 = 3.0;
/// Least standard deviation (mm), and as a share of the largest: less is rounding.
const MIN_SIGMA: (f64, f64) = (1e-9, 1e-3);
/// Singular values below this share of the largest are zero.
const RANK: f64 = 1e-10;

/// Fits the unknowns to the data, readings weighed by how they scatter; `robust`: what stands out counts less, so
/// that a
/// bumped set-up does not bend the machine.
pub fn solve(model: &Model<'_>, data: &[Measurement], robust: bool) -> Fit {
    let search = Search::new(model, data);
    let mut found = search.fit();
    let groups = Groups::of(data);
    if groups.kinds.len() < 2 && !robust {
        return found;
    }
    let mut sigmas = vec![1e-3; groups.kinds.len()];
    for _ in 0..ROUNDS {
        let residuals = robust.then(|| model.residuals(data, &found.theta));
        sigmas = groups.sigmas(model, data, &found, sigmas, residuals.as_deref());
        let shares = residuals.map_or_else(|| vec![1.0; data.len()], |residuals| shares(data, &residuals));
        let weights = groups.weights(data, &sigmas, &shares);
        let change = weights.iter().zip(&found.weights).map(|(a, b)| (a - b).abs() / b).fold(0.0, f64::max);
        let steps = found.steps;
        found = search.again(weights, found.theta);
        found.steps += steps;
        if change < SETTLED {
            break;
        }
    }
    if groups.kinds.len() > 1 {
        found.freedom = groups.freedoms(model, data, &found, robust);
    }
    if robust {
        huber(model, data, &groups, &sigmas, &mut found);
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
        let index = |m: &Measurement| index_of(&mut kinds, (!m.known).then(|| m.kind()));
        let of = data.iter().map(index).collect();
        Self { kinds, of }
    }

    fn members(&self, group: usize) -> impl Iterator<Item = usize> {
        (0..self.of.len()).filter(move |i| self.of[*i] == group)
    }

    /// Standard deviation of a reading of each quantity (mm), where it was `before`: from the residuals, of robust
    /// fits.
    fn sigmas(
        &self,
        model: &Model<'_>,
        data: &[Measurement],
        found: &Fit,
        before: Vec<f64>,
        residuals: Option<&[Vector3<f64>]>,
    ) -> Vec<f64> {
        if self.kinds.len() < 2 {
            return before;
        }
        let Some(residuals) = residuals else {
            let weights: Vec<f64> = data.iter().map(|m| m.weight).collect();
            return balanced(&self.linear(model, data, &weights, found), before);
        };
        let squares = |g: usize| {
            let (median, count) = median(self.members(g).flat_map(|i| components(&data[i], &residuals[i])).collect());
            count as f64 * (median / MEDIAN) * (median / MEDIAN)
        };
        let linear = self.linear(model, data, &found.weights, found);
        let used = used(&linear, &vec![1.0; linear.len()]);
        let parts =
            linear.iter().zip(used).enumerate().map(|(g, (own, (used, _)))| (squares(g), own.rows as f64 - used));
        shared(&parts.collect::<Vec<_>>())
    }

    /// Degrees of freedom of each unknown's variance, which is a sum over the quantities (Welch 1947, Satterthwaite
    /// 1946).
    fn freedoms(&self, model: &Model<'_>, data: &[Measurement], found: &Fit, robust: bool) -> Vec<f64> {
        let (linear, seen) = (self.linear(model, data, &found.weights, found), seen(model, found));
        let ones = vec![1.0; linear.len()];
        let rests = linear.iter().zip(used(&linear, &ones)).map(|(own, (used, _))| own.rows as f64 - used);
        let rests: Vec<f64> = rests.collect();
        let all = rests.iter().sum::<f64>().max(1.0);
        let share = if robust { EFFICIENCY } else { 1.0 };
        let rests: Vec<f64> =
            rests.iter().map(|rest| if *rest < REDUNDANT { all } else { (rest * share).max(1.0) }).collect();
        let whole = stacked(&linear, &ones).r;
        let columns = whole.tr_solve_upper_triangular(&seen.transpose());
        let Some(columns) = columns.and_then(|half| whole.solve_upper_triangular(&half)) else { return Vec::new() };
        let parts: Vec<DMatrix<f64>> = linear.iter().map(|own| &own.r * &columns).collect();
        let one = |j: usize| {
            let variances = parts.iter().map(|part| part.column(j).norm_squared());
            let (mut sum, mut squares) = (0.0, 0.0);
            for (variance, rest) in variances.zip(&rests) {
                sum += variance;
                squares += variance * variance / rest;
            }
            if squares > 0.0 { sum * sum / squares } else { all }
        };
        (0..columns.ncols()).map(one).collect()
    }

    /// The linear problem of each quantity at what was found, in the directions that the data see.
    fn linear(&self, model: &Model<'_>, data: &[Measurement], weights: &[f64], found: &Fit) -> Vec<ReducedSystem> {
        let seen = seen(model, found);
        let one = |g: usize| {
            let (data, weights): (Vec<_>, Vec<_>) = self.members(g).map(|i| (data[i].clone(), weights[i])).unzip();
            let own = model.triangle(&data, &weights, &found.theta);
            ReducedSystem { r: own.r * &seen, ..own }
        };
        (0..self.kinds.len()).map(one).collect()
    }

    /// Weights, by the standard deviation (mm) of the quantity as if it was given (in um), and by what counts of each.
    fn weights(&self, data: &[Measurement], sigmas: &[f64], shares: &[f64]) -> Vec<f64> {
        let one = |i: usize| {
            let um = sigmas[self.of[i]] * 1e3;
            data[i].weight * shares[i] / (um * um)
        };
        (0..data.len()).map(one).collect()
    }
}

/// The directions that the data see, of displacements of unit length: columns.
fn seen(model: &Model<'_>, found: &Fit) -> DMatrix<f64> {
    let list = model.parameters();
    let sizes = DVector::from_iterator(list.len(), list.iter().map(|p| p.size));
    let svd = found.reduced.scaled(&sizes);
    let mut seen = svd.v.columns(0, svd.rank(RANK)).into_owned();
    seen.row_iter_mut().zip(sizes.iter()).for_each(|(mut row, size)| row /= *size);
    seen
}

/// All quantities in one linear problem, each over its standard deviation.
fn stacked(linear: &[ReducedSystem], sigmas: &[f64]) -> ReducedSystem {
    let mut triangle = Triangle::new(linear.first().map_or(0, |own| own.r.ncols()));
    for (own, sigma) in linear.iter().zip(sigmas) {
        let rows = own.r.row_iter().zip(own.right.iter());
        rows.for_each(|(row, right)| triangle.push(row.iter().map(|x| x / sigma), right / sigma));
    }
    triangle.finish()
}

/// What all quantities together use up of each one's readings, and what they leave of it (mm^2, weighted), each over
/// its
/// standard deviation.
fn used(linear: &[ReducedSystem], sigmas: &[f64]) -> Vec<(f64, f64)> {
    let whole = stacked(linear, sigmas);
    let step = whole.r.solve_upper_triangular(&whole.right);
    let one = |(own, sigma): (&ReducedSystem, &f64)| {
        // The data see all of these directions: the triangle has an inverse.
        let share = whole.r.tr_solve_upper_triangular(&(own.r.transpose() / *sigma));
        let left = step.as_ref().map_or_else(|| own.right.clone(), |step| &own.right - &own.r * step);
        (share.map_or(0.0, |share| share.norm_squared()), left.norm_squared() + own.rest * own.rest)
    };
    linear.iter().zip(sigmas).map(one).collect()
}

/// Standard deviations that agree with what the linear problem leaves when it is weighed by them.
fn balanced(linear: &[ReducedSystem], mut sigmas: Vec<f64>) -> Vec<f64> {
    for _ in 0..BALANCING {
        let used = used(linear, &sigmas);
        let parts: Vec<_> = linear.iter().zip(used).map(|(own, (used, left))| (left, own.rows as f64 - used)).collect();
        let next = shared(&parts);
        let change = next.iter().zip(&sigmas).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        sigmas = next;
        if change < 0.1 * SETTLED {
            break;
        }
    }
    sigmas
}

/// Standard deviations from sums of squares and redundancies; quantities with hardly any have the common one.
fn shared(parts: &[(f64, f64)]) -> Vec<f64> {
    let sum = |of: fn(&(f64, f64)) -> f64| parts.iter().map(of).sum::<f64>();
    let common = sum(|(squares, _)| *squares) / sum(|(_, redundant)| *redundant).max(1.0);
    let variance =
        |(squares, redundant): &(f64, f64)| if *redundant < REDUNDANT { common } else { squares / redundant };
    let sigmas: Vec<f64> = parts.iter().map(|part| libm::sqrt(variance(part))).collect();
    let least = sigmas.iter().fold(MIN_SIGMA.0, |least: f64, sigma| least.max(sigma * MIN_SIGMA.1));
    sigmas.into_iter().map(|sigma| sigma.max(least)).collect()
}

/// Fractions by which readings count.
fn shares(data: &[Measurement], residuals: &[Vector3<f64>]) -> Vec<f64> {
    let sizes = standardised(data, residuals);
    sizes.into_iter().map(|size| if size > HUBER { HUBER / size } else { 1.0 }).collect()
}

/// Turns the last of the linear problems, whose readings count in part, into that of all readings, with what they
/// scatter
/// by as far as the estimate goes: `K^2 sum psi^2 / mean(psi')^2` (Huber 1981, section 7.6). `psi` of a reading of d
/// components is that of their length.
fn huber(model: &Model<'_>, data: &[Measurement], groups: &Groups, sigmas: &[f64], found: &mut Fit) {
    let residuals = model.residuals(data, &found.theta);
    let shares = shares(data, &residuals);
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
}

/// Components of a residual over their uncertainty.
fn components(m: &Measurement, residual: &Vector3<f64>) -> Vec<f64> {
    let seen = m.seen();
    (0..3).filter(|k| seen[*k]).map(|k| residual[k].abs() * libm::sqrt(m.weight)).collect()
}

/// The (upper) median, and how many there are.
pub(crate) fn median(mut list: Vec<f64>) -> (f64, usize) {
    list.sort_by(f64::total_cmp);
    (list.get(list.len() / 2).copied().unwrap_or_default(), list.len())
}

/// Root mean square component of each residual in robust standard deviations of its quantity.
pub(crate) fn standardised(data: &[Measurement], residuals: &[Vector3<f64>]) -> Vec<f64> {
    let groups = Groups::of(data);
    let sigma = |g: usize| {
        let list = groups.members(g).flat_map(|i| components(&data[i], &residuals[i])).collect();
        (median(list).0 / MEDIAN).max(f64::MIN_POSITIVE)
    };
    let sigmas: Vec<f64> = (0..groups.kinds.len()).map(sigma).collect();
    let component = |m: &Measurement, r: &Vector3<f64>| r.norm() * libm::sqrt(m.weight / m.readings().max(1) as f64);
    (0..data.len()).map(|i| component(&data[i], &residuals[i]) / sigmas[groups.of[i]]).collect()
}
