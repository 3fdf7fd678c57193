//! Lack of fit: readings near each other on an axis share the form that the fitted curves leave of it, so that many of
//! them are worth no more than a few.
//!
//! The form of an axis is a random function of its position in each direction: a Gaussian process of unknown size and
//! correlation length (the model inadequacy of Kennedy and O'Hagan 2001, section 4), less what the fitted curve takes
//! up of it. Size, length and the axes that have a form are not chosen but averaged over: each candidate counts by its
//! restricted likelihood (Patterson and Thompson 1971), and before the data it is three to one that there is no form.

use super::fit::Fit;
use super::form::{Block, FormedAxis, KNOTS, Sums, entries, formed, selected};
use super::solution::{MIN_SIGMA, Solution};
use crate::identify::data::Measurement;
use crate::identify::model::Model;
use crate::machine::{AxisKind, AxisName, ResidualForm};
use crate::units::significant;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rayon::prelude::*;

/// Correlation lengths, as shares of the interval measured: from two thirds of the distance of the knots to a quarter.
const LENGTHS: [f64; 3] = [0.06, 0.12, 0.25];
/// Sizes, in standard deviations of a reading.
const SIZES: [f64; 7] = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0];
/// Probability, before the data, that the axes have no form.
const NONE: f64 = 0.75;
/// Probability of any form from which on the forms are stated.
const LIKELY: f64 = 0.5;
/// Readings to spare below which scatter and form cannot be told apart.
const FEWEST_SPARE: usize = 20;
/// Modes of a form below this share of the largest change nothing.
const FAINT: f64 = 1e-3;
/// Sums of squares that unknowns or forms leave less than this share of are rounding.
const ROUNDING: f64 = 1e-12;
/// Steps in which a symmetric matrix of this size is diagonal, or never.
const MAX_STEPS: usize = 10_000;

/// The uncertainty that readings share through the form of the axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Misfit {
    /// Covariance of the unknowns that it makes, in their units.
    pub covariance: DMatrix<f64>,
    /// Probability that the axes have a form.
    pub probability: f64,
    /// The axes whose form the readings may show.
    pub judged: Vec<AxisName>,
    /// The forms of the axes, if any is likelier than none.
    pub forms: Vec<ResidualForm>,
}

/// Looks for form in what a fit leaves. `None` if the readings cannot show it: too few to spare, or no axis with enough
/// positions.
pub fn misfit(model: &Model<'_>, data: &[Measurement], fit: &Fit, solution: &Solution) -> Option<Misfit> {
    let axes = formed(model, data);
    if solution.freedom < FEWEST_SPARE || axes.is_empty() || solution.sigma <= MIN_SIGMA {
        return None;
    }
    let missing = model.known().1 - &fit.known * DVector::from_column_slice(&fit.theta);
    let sums = Sums::of(model, data, fit, &axes).with_known(&fit.known, &missing, solution.sigma);
    // By the root of the covariance: the product with the covariance itself would lose twice the digits.
    let root = solution.unit_root();
    let seen = root.tr_mul(&sums.cross);
    let left = (&sums.forms - seen.tr_mul(&seen)) / sums.weight;
    let found = averaged(&axes, &left, solution.freedom as f64)?;
    let half = root * seen;
    let mut covariance = DMatrix::zeros(half.nrows(), half.nrows());
    for (axis, variances) in axes.iter().zip(&found.variances) {
        for block in &axis.blocks {
            let columns = half.columns(block.first, KNOTS);
            covariance += columns * kernel(block, variances) * columns.transpose();
        }
    }
    let forms = axes.iter().zip(&found.variances).filter_map(|(axis, variances)| form(axis, variances));
    let forms = if found.probability > LIKELY { forms.collect() } else { Vec::new() };
    let judged = axes.iter().map(|axis| axis.name.clone()).collect();
    Some(Misfit { covariance, probability: found.probability, judged, forms })
}

/// Covariance of the values at the knots of forms of these variances (mm^2), by length.
fn kernel(block: &Block, variances: &[f64; 3]) -> DMatrix<f64> {
    let parts = LENGTHS.iter().zip(variances).map(|(length, variance)| block.kernel(*length) * *variance);
    parts.fold(DMatrix::zeros(KNOTS, KNOTS), |sum, part| sum + part)
}

/// The form of an axis, of the mean variance of its displacements over the positions measured.
fn form(axis: &FormedAxis, variances: &[f64; 3]) -> Option<ResidualForm> {
    let blocks: Vec<&Block> = axis.blocks.iter().filter(|block| block.is_displacement()).collect();
    let values = blocks.iter().map(|block| kernel(block, variances).trace()).sum::<f64>();
    let size = libm::sqrt(values / (KNOTS * blocks.len().max(1)) as f64);
    let all: f64 = variances.iter().sum();
    let mean = LENGTHS.iter().zip(variances).map(|(length, variance)| length * variance / all).sum::<f64>();
    let (min, max) = axis.interval;
    (all > 0.0 && size > MIN_SIGMA).then(|| ResidualForm {
        axis: axis.name.clone(),
        size: rounded(size),
        length: rounded(mean * (max - min)),
    })
}

/// To three digits: no form is known better.
fn rounded(value: f64) -> f64 {
    significant(value, 3).parse().unwrap_or(value)
}

/// Averages over the candidates.
struct Averaged {
    /// Variances (mm^2) of the form of each axis, by length.
    variances: Vec<[f64; 3]>,
    /// Probability of any form.
    probability: f64,
}

/// A candidate: axes that have a form of one length and size.
struct Candidate<'a> {
    /// Indices in the list of axes.
    axes: &'a [usize],
    /// Index of the length.
    length: usize,
    /// Variance of the form in that of a reading.
    ratio: f64,
    /// Variance of a reading (mm^2).
    variance: f64,
    /// Logarithm of the restricted likelihood.
    likelihood: f64,
}

/// Averages over the candidates where `left` are the sums of knots and residual (last) without what the unknowns take
/// up, and `spare` readings are. `None` where these are rounding.
fn averaged(axes: &[FormedAxis], left: &DMatrix<f64>, spare: f64) -> Option<Averaged> {
    let squares = left[(left.ncols() - 1, left.ncols() - 1)];
    if squares <= 0.0 || left.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let sets = sets(axes);
    let pairs: Vec<(&[usize], usize)> = sets.iter().flat_map(|set| (0..3).map(move |k| (&set[..], k))).collect();
    let candidates: Vec<Candidate<'_>> =
        pairs.into_par_iter().flat_map_iter(|(set, length)| candidates(axes, left, spare, (set, length))).collect();
    let without = -0.5 * spare * libm::log(squares);
    let largest = candidates.iter().map(|c| c.likelihood).fold(without, f64::max);
    let prior = (1.0 - NONE) / candidates.len().max(1) as f64;
    let weights: Vec<f64> = candidates.iter().map(|c| prior * libm::exp(c.likelihood - largest)).collect();
    let formed: f64 = weights.iter().sum();
    let all = formed + NONE * libm::exp(without - largest);
    let mut variances = vec![[0.0; 3]; axes.len()];
    let mut deviations = vec![0.0; axes.len()];
    for (candidate, weight) in candidates.iter().zip(&weights) {
        let (share, variance) = (weight / all, candidate.variance * candidate.ratio);
        for axis in candidate.axes {
            variances[*axis][candidate.length] += share * variance;
            deviations[*axis] += share * libm::sqrt(variance);
        }
    }
    variances.iter_mut().zip(&deviations).for_each(|(by_length, deviation)| shrink(by_length, *deviation));
    Some(Averaged { variances, probability: formed / all })
}

/// Scales variances by length so that their sum is the square of a standard deviation: an average of variances would
/// hang on the few largest sizes, which the data hardly refute.
fn shrink(variances: &mut [f64; 3], deviation: f64) {
    let sum: f64 = variances.iter().sum();
    if sum > 0.0 {
        variances.iter_mut().for_each(|variance| *variance *= deviation * deviation / sum);
    }
}

/// The sets of axes that may have a form: each by itself, those of each kind, all.
fn sets(axes: &[FormedAxis]) -> Vec<Vec<usize>> {
    let of = |kinds: &[AxisKind]| (0..axes.len()).filter(|i| kinds.contains(&axes[*i].kind)).collect::<Vec<usize>>();
    let mut sets: Vec<Vec<usize>> = (0..axes.len()).map(|i| vec![i]).collect();
    for kinds in [&[AxisKind::Linear][..], &[AxisKind::Rotary], &[AxisKind::Linear, AxisKind::Rotary]] {
        let set = of(kinds);
        if !set.is_empty() && !sets.contains(&set) {
            sets.push(set);
        }
    }
    sets
}

/// The candidates of a set of axes and a length.
fn candidates<'a>(
    axes: &[FormedAxis],
    left: &DMatrix<f64>,
    spare: f64,
    (set, length): (&'a [usize], usize),
) -> Vec<Candidate<'a>> {
    let (modes, knots) = modes(set.iter().flat_map(|axis| &axes[*axis].blocks), LENGTHS[length]);
    if modes.ncols() == 0 {
        return Vec::new();
    }
    let residual = left.ncols() - 1;
    let seen = modes.tr_mul(&(selected(left, &knots) * &modes));
    let Some(spectrum) = SymmetricEigen::try_new(seen, f64::EPSILON, MAX_STEPS) else { return Vec::new() };
    let along: DVector<f64> = spectrum.eigenvectors.tr_mul(&modes.tr_mul(&entries(left, residual, &knots)));
    let squares = left[(residual, residual)];
    let one = |size: &f64| {
        let ratio = size * size;
        let (mut determinant, mut rest) = (0.0, squares);
        for (value, part) in spectrum.eigenvalues.iter().zip(along.iter()) {
            let grown = 1.0 + ratio * value.max(0.0);
            determinant += libm::log(grown);
            rest -= ratio * part * part / grown;
        }
        let likelihood = -0.5 * (determinant + spare * libm::log(rest));
        let candidate = Candidate { axes: set, length, ratio, variance: rest / spare, likelihood };
        // A form that explains everything but rounding would win with no variance at all.
        (rest > ROUNDING * squares).then_some(candidate)
    };
    SIZES.iter().filter_map(one).collect()
}

/// Independent modes of the forms of blocks (columns, over their knots), one standard deviation each, and the knots.
fn modes<'b>(blocks: impl Iterator<Item = &'b Block>, length: f64) -> (DMatrix<f64>, Vec<usize>) {
    let mut knots = Vec::new();
    let mut columns: Vec<(usize, DVector<f64>)> = Vec::new();
    for block in blocks {
        let Some(own) = SymmetricEigen::try_new(block.kernel(length), f64::EPSILON, MAX_STEPS) else { continue };
        let largest = own.eigenvalues.max();
        for (value, mode) in own.eigenvalues.iter().zip(own.eigenvectors.column_iter()) {
            if *value > FAINT * largest {
                columns.push((knots.len(), mode * libm::sqrt(*value)));
            }
        }
        knots.extend(block.first..block.first + KNOTS);
    }
    let mut modes = DMatrix::zeros(knots.len(), columns.len());
    for (k, (first, column)) in columns.into_iter().enumerate() {
        modes.view_mut((first, k), (KNOTS, 1)).copy_from(&column);
    }
    (modes, knots)
}
