//! Lack of fit: readings near each other on an axis share the form that the fitted curves do not follow, so that many
//! of them determine no more than a few.
//!
//! The form of an axis is a random function of its position in and about each direction: a Gaussian process of unknown
//! size and correlation length (the model inadequacy of Kennedy and O'Hagan 2001, section 4), less the part that the
//! fitted curve follows. Each error has a size of its own, estimated with all others ([`super::form_sizes`]); lengths,
//! one of the linear and one of the rotary axes, are averaged over, as is whether there is any form: the prior odds are
//! three to one that there is none.

use super::bend::{Bend, bends};
use super::fit::ParameterFit;
use super::form::{FormBlock, FormedAxis, Sums, VolumeForms, axes_with_forms};
use super::form_sizes::{FormPlace, FormSizes, ModeSums, SizePrior};
use super::solution::{FormCovariance, Solution};
use crate::identify::data::{LEVER_MM, Measurement, lever};
use crate::identify::model::FitModel;
use crate::identify::thresholds::*;
use crate::machine::{AxisKind, AxisName, ErrorId, ResidualForm};
use crate::units::significant;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// The uncertainty that readings share through the form of the axes.
#[derive(Debug, Clone, PartialEq)]
pub struct FormUncertainty {
    /// Covariance of the unknowns, in their units.
    pub covariance: FormCovariance,
    /// Probability that the axes have a form.
    pub probability: f64,
    /// The axes whose form the readings may show.
    pub examined_axes: Vec<AxisName>,
    /// The forms of the axes, if any is likelier than none.
    pub forms: Vec<ResidualForm>,
    /// What a richer curve of an error would take off the residuals, the most first.
    pub bends: Vec<Bend>,
    /// Errors with a form whose size the readings do not tell from those of the others.
    pub tied: Vec<ErrorId>,
}

/// Looks for form in the residuals of a fit. `None` if the readings cannot show it: too few residual degrees of
/// freedom, or no axis with enough positions.
pub fn form_uncertainty(
    model: &FitModel<'_>,
    data: &[Measurement],
    fit: &ParameterFit,
    solution: &Solution,
) -> Option<FormUncertainty> {
    let axes = axes_with_forms(model, data);
    if solution.degrees_of_freedom < MIN_FORM_FREEDOM || axes.is_empty() || solution.sigma <= MIN_SCATTER_MM {
        return None;
    }
    let missing = model.known_rows(&fit.theta).1 - &fit.known * DVector::from_column_slice(&fit.theta);
    let sums = Sums::of_fit(model, data, fit, &axes).with_known(&fit.known, &missing, solution.sigma);
    // By the root of the covariance: the product with the covariance itself would lose twice the digits.
    let root = solution.covariance_root();
    let seen = root.tr_mul(&sums.cross);
    let left = (&sums.forms - seen.tr_mul(&seen)) / sums.weight;
    let blocks = seen_blocks(&axes, &left);
    let average = FormAverage::over_lengths(&blocks, &left, solution.degrees_of_freedom as f64)?;
    let bends = bends(model, &axes, &left, solution.degrees_of_freedom as f64);
    let half = &root * seen;
    let volume = VolumeForms::of(model, data, fit, solution, &axes);
    let mut all = DMatrix::zeros(half.nrows(), half.nrows());
    let mut unmodelled = all.clone();
    for (SeenBlock { block, .. }, variances) in blocks.iter().zip(&average.variances) {
        let kernel = kernel(block, variances);
        let columns = half.columns(block.first, block.interval.count);
        all += columns * &kernel * columns.transpose();
        let columns = columns - volume.nearest.columns(block.first, block.interval.count);
        unmodelled += &columns * kernel * columns.transpose();
    }
    let found = |axis: usize| blocks.iter().zip(&average.variances).filter(move |(seen, _)| seen.axis == axis);
    let mut forms: Vec<ResidualForm> =
        axes.iter().enumerate().filter_map(|(i, axis)| form(axis, found(i), &volume)).collect();
    let machine = model.machines().first()?;
    let names = blocks.iter().zip(&average.resolutions).filter(|(_, resolution)| **resolution < MIN_SIZE_RESOLUTION);
    let mut tied: Vec<ErrorId> = names.filter_map(|(seen, _)| seen.block.source.error(machine)).collect();
    if average.probability <= MIN_FORM_PROBABILITY {
        forms.clear();
        tied.clear();
        unmodelled.copy_from(&all);
    }
    Some(FormUncertainty {
        covariance: FormCovariance { all, unmodelled },
        probability: average.probability,
        examined_axes: axes.into_iter().map(|axis| axis.name).collect(),
        forms,
        bends,
        tied,
    })
}

/// The form of an error that readings see.
struct SeenBlock<'a> {
    /// Index in the list of axes.
    axis: usize,
    kind: AxisKind,
    block: &'a FormBlock,
}

/// Returns the forms that readings see; `left` are the sums over the readings without the part that the unknowns
/// follow.
fn seen_blocks<'a>(axes: &'a [FormedAxis], left: &DMatrix<f64>) -> Vec<SeenBlock<'a>> {
    let of_axis = |(axis, of): (usize, &'a FormedAxis)| {
        let kind = of.kind;
        of.blocks.iter().map(move |block| SeenBlock { axis, kind, block })
    };
    let squares = |block: &FormBlock| block.own(left).component_mul(&block.kernel(0)).sum();
    let all = axes.iter().enumerate().flat_map(of_axis);
    all.filter(|seen| squares(seen.block) > MIN_FORM_SQUARES).collect()
}

/// Returns the covariance of the values at the knots of a form of these variances (mm^2), by length.
fn kernel(block: &FormBlock, variances: &[f64; 3]) -> DMatrix<f64> {
    let count = block.interval.count;
    let parts = variances.iter().enumerate().map(|(length, variance)| block.kernel(length) * *variance);
    parts.fold(DMatrix::zeros(count, count), |sum, part| sum + part)
}

/// Returns the standard deviation (mm, rad) of a form: that of a constant which deviates, RMS over the volume, as much
/// as the part of the form that the unknowns cannot follow.
fn size(block: &FormBlock, variances: &[f64; 3], volume: &VolumeForms) -> f64 {
    let (form, unit) = volume.squares(block, &kernel(block, variances));
    if form > 0.0 && unit > 0.0 { libm::sqrt(form / unit) } else { 0.0 }
}

/// Returns the form of an axis, with a size of each error; `None` if none is stated.
fn form<'g>(
    axis: &FormedAxis,
    found: impl Iterator<Item = (&'g SeenBlock<'g>, &'g [f64; 3])>,
    volume: &VolumeForms,
) -> Option<ResidualForm> {
    let (mut sizes, mut by_length) = ([0.0; 6], [0.0; 3]);
    for (SeenBlock { block, .. }, variances) in found {
        sizes[block.source.direction.index()] = size(block, variances, volume);
        by_length.iter_mut().zip(variances).for_each(|(sum, variance)| *sum += variance);
    }
    let sizes = sizes_that_count(sizes);
    let all: f64 = by_length.iter().sum();
    let lengths = axis.interval.lengths.iter().zip(by_length);
    let length = lengths.map(|(length, variance)| length * variance / all).sum();
    let states_any = sizes.iter().any(|size| *size > 0.0);
    let length = to_three_digits(f64::max(length, axis.interval.finest));
    states_any.then(|| ResidualForm { axis: axis.name.clone(), sizes, length })
}

/// Returns the sizes of displacements (mm) and rotations (rad) of an axis, 0 for one that is small beside the largest.
fn sizes_that_count(sizes: [f64; 6]) -> [f64; 6] {
    let moved = |k: usize| sizes[k] * if k < 3 { 1.0 } else { LEVER_MM };
    let largest = (0..6).map(moved).fold(0.0, f64::max);
    let limit = MIN_SCATTER_MM.max(MIN_FORM_SHARE * largest);
    std::array::from_fn(|k| if moved(k) > limit { to_three_digits(sizes[k]) } else { 0.0 })
}

/// Rounds to three digits: no form is known better.
fn to_three_digits(value: f64) -> f64 {
    significant(value, 3).parse().unwrap_or(value)
}

/// Sizes averaged over lengths, and over whether there is any form.
struct FormAverage {
    /// Variances (mm^2) of each form, by length.
    variances: Vec<[f64; 3]>,
    /// Share of the data in what is known of each size.
    resolutions: Vec<f64>,
    /// Probability of any form.
    probability: f64,
}

/// Lengths of the forms of all linear axes and of all rotary ones: indices.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Lengths {
    linear: usize,
    rotary: usize,
}

impl Lengths {
    fn of(self, kind: AxisKind) -> usize {
        if kind == AxisKind::Linear { self.linear } else { self.rotary }
    }
}

impl FormAverage {
    /// Averages over the lengths. `left` are the sums of knots and residual (last) without the part that the unknowns
    /// follow; `None` if they are rounding, or if no form is seen.
    fn over_lengths(blocks: &[SeenBlock<'_>], left: &DMatrix<f64>, degrees_of_freedom: f64) -> Option<Self> {
        let squares = left[(left.ncols() - 1, left.ncols() - 1)];
        if squares <= 0.0 || left.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let place =
            |seen: &SeenBlock<'_>| FormPlace { axis: seen.axis, is_rotation: lever(seen.block.source.direction) > 1.0 };
        let prior = SizePrior::of(&blocks.iter().map(place).collect::<Vec<_>>())?;
        let estimate = |lengths: Lengths, start: Option<&DVector<f64>>| {
            FormSizes::estimate(&mode_sums(blocks, left, lengths, degrees_of_freedom), &prior, start)
        };
        let middle = Lengths { linear: 1, rotary: 1 };
        let first = estimate(middle, None)?;
        let has = |kind: AxisKind| blocks.iter().any(|seen| seen.kind == kind);
        let linear = if has(AxisKind::Linear) { vec![0, 1, 2] } else { vec![1] };
        let rotary = if has(AxisKind::Rotary) { vec![0, 1, 2] } else { vec![1] };
        let choices: Vec<Lengths> = linear
            .iter()
            .flat_map(|linear| rotary.iter().map(|rotary| Lengths { linear: *linear, rotary: *rotary }))
            .collect();
        let near = |lengths: &Lengths| {
            let found =
                if *lengths == middle { Some(first.clone()) } else { estimate(*lengths, Some(&first.logarithms)) };
            found.map(|sizes| (*lengths, sizes))
        };
        let found: Vec<(Lengths, FormSizes)> = choices.par_iter().filter_map(near).collect();
        Some(Self::of(blocks, &found, -0.5 * degrees_of_freedom * libm::log(squares)))
    }

    /// Averages over choices of lengths, each by its likelihood; `without` is the logarithm of that without any form.
    fn of(blocks: &[SeenBlock<'_>], found: &[(Lengths, FormSizes)], without: f64) -> Self {
        let largest = found.iter().map(|(_, sizes)| sizes.evidence).fold(without, f64::max);
        let prior = (1.0 - PRIOR_PROBABILITY_NO_FORM) / found.len().max(1) as f64;
        let weights: Vec<f64> = found.iter().map(|(_, sizes)| prior * libm::exp(sizes.evidence - largest)).collect();
        let formed: f64 = weights.iter().sum();
        let all = formed + PRIOR_PROBABILITY_NO_FORM * libm::exp(without - largest);
        let mut variances = vec![[0.0; 3]; blocks.len()];
        let mut deviations = vec![0.0; blocks.len()];
        let mut resolutions = vec![0.0; blocks.len()];
        for ((lengths, sizes), weight) in found.iter().zip(&weights) {
            for (form, seen) in blocks.iter().enumerate() {
                let (share, variance) = (weight / all, sizes.form_variance(form));
                variances[form][lengths.of(seen.kind)] += share * variance;
                deviations[form] += share * libm::sqrt(variance);
                resolutions[form] += weight / formed.max(f64::MIN_POSITIVE) * sizes.resolution[form];
            }
        }
        variances.iter_mut().zip(&deviations).for_each(|(by_length, deviation)| shrink(by_length, *deviation));
        Self { variances, resolutions, probability: formed / all }
    }
}

/// Scales variances by length so that their sum is the square of a standard deviation: an average of variances would
/// hang on the few largest sizes, which the data hardly refute.
fn shrink(variances: &mut [f64; 3], deviation: f64) {
    let sum: f64 = variances.iter().sum();
    if sum > 0.0 {
        variances.iter_mut().for_each(|variance| *variance *= deviation * deviation / sum);
    }
}

/// Returns the sums over the readings by modes of the forms.
fn mode_sums(blocks: &[SeenBlock<'_>], left: &DMatrix<f64>, lengths: Lengths, degrees_of_freedom: f64) -> ModeSums {
    let last = left.ncols() - 1;
    let modes: Vec<DMatrix<f64>> = blocks.iter().map(|seen| seen.block.modes(lengths.of(seen.kind))).collect();
    let effects: Vec<DMatrix<f64>> = blocks
        .iter()
        .zip(&modes)
        .map(|(seen, modes)| left.columns(seen.block.first, seen.block.interval.count) * modes)
        .collect();
    let strength = |k: usize, j: usize| {
        let rows = effects[k].view((blocks[k].block.first, j), (modes[k].nrows(), 1));
        modes[k].column(j).dot(&rows.column(0))
    };
    let all = (0..blocks.len()).flat_map(|k| (0..modes[k].ncols()).map(move |j| (k, j)));
    let mut strengths: Vec<f64> = all.clone().map(|(k, j)| strength(k, j)).collect();
    strengths.sort_by(|a, b| b.total_cmp(a));
    let least = strengths.get(MAX_FORM_MODES).copied().unwrap_or(f64::NEG_INFINITY);
    let kept: Vec<(usize, usize)> = all.filter(|(k, j)| strength(*k, *j) > least).collect();
    let whole = DMatrix::from_fn(left.nrows(), kept.len(), |i, c| effects[kept[c].0][(i, kept[c].1)]);
    let mut squares = DMatrix::zeros(kept.len(), kept.len());
    let mut along = DVector::zeros(kept.len());
    for (row, (k, j)) in kept.iter().enumerate() {
        let (first, mode) = (blocks[*k].block.first, modes[*k].column(*j));
        squares.row_mut(row).copy_from(&(mode.transpose() * whole.rows(first, mode.len())));
        along[row] = whole[(last, row)];
    }
    let of_form = |k: usize| kept.partition_point(|(of, _)| *of < k)..kept.partition_point(|(of, _)| *of <= k);
    let forms = (0..blocks.len()).map(of_form).collect();
    ModeSums { squares, along, forms, residual: left[(last, last)], degrees_of_freedom }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_that_adds_nothing_is_not_stated() {
        let near = |found: [f64; 6], expected: [f64; 6]| {
            (0..6).for_each(|k| assert!((found[k] - expected[k]).abs() <= 1e-12 * expected[k], "{found:?}"));
        };
        // 3.3 urad move a point 300 mm away by 0.99 um.
        near(sizes_that_count([1.00049e-3, 0.0, 2e-5, 3.30001e-6, 0.0, 3e-9]), [1e-3, 0.0, 2e-5, 3.3e-6, 0.0, 0.0]);
        near(sizes_that_count([9e-6, 0.0, 0.0, 3.3e-6, 0.0, 0.0]), [0.0, 0.0, 0.0, 3.3e-6, 0.0, 0.0]);
        near(sizes_that_count([1e-13; 6]), [0.0; 6]);
    }
}
