//! Lack of fit: readings near each other on an axis share the form that the fitted curves do not follow, so that many
//! of them determine no more than a few.
//!
//! The form of an axis is a random function of its position in and about each direction: a Gaussian process of unknown
//! size and correlation length (the model inadequacy of Kennedy and O'Hagan 2001, section 4), less the part that the
//! fitted curve follows. Size, length and the axes whose displacements, rotations or both have a form are averaged
//! over: each candidate counts by its restricted likelihood (Patterson and Thompson 1971), and the prior odds are three
//! to one that there is no form.

use super::fit::ParameterFit;
use super::form::{FORM_KNOTS, FormBlock, FormedAxis, Sums, VolumeForms, axes_with_forms, principal_submatrix};
use super::solution::{FormCovariance, Solution};
use crate::identify::data::{LEVER_MM, Measurement};
use crate::identify::model::FitModel;
use crate::identify::thresholds::*;
use crate::machine::{AxisKind, AxisName, MAX_EIGEN_STEPS, MIN_MODE_SHARE, ResidualForm};
use crate::units::significant;
use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};
use rayon::prelude::*;
use std::ops::Range;

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
    let missing = model.known_rows().1 - &fit.known * DVector::from_column_slice(&fit.theta);
    let sums = Sums::of(model, data, fit, &axes).with_known(&fit.known, &missing, solution.sigma);
    // By the root of the covariance: the product with the covariance itself would lose twice the digits.
    let root = solution.covariance_root();
    let seen = root.tr_mul(&sums.cross);
    let left = (&sums.forms - seen.tr_mul(&seen)) / sums.weight;
    let groups = groups(&axes, &left);
    let average = average_forms(&groups, &left, solution.degrees_of_freedom as f64)?;
    let half = &root * seen;
    let volume = VolumeForms::of(model, data, fit, &root, &axes);
    let mut all = DMatrix::zeros(half.nrows(), half.nrows());
    let mut unmodelled = all.clone();
    for (group, variances) in groups.iter().zip(&average.variances) {
        for block in &group.blocks {
            let kernel = kernel(block, variances);
            let columns = half.columns(block.first, FORM_KNOTS);
            all += columns * &kernel * columns.transpose();
            let columns = columns - volume.nearest.columns(block.first, FORM_KNOTS);
            unmodelled += &columns * kernel * columns.transpose();
        }
    }
    let of_axis = |axis: usize| groups.iter().zip(&average.variances).filter(move |(group, _)| group.axis == axis);
    let mut forms: Vec<ResidualForm> =
        axes.iter().enumerate().filter_map(|(i, axis)| form(axis, of_axis(i), &volume)).collect();
    if average.probability <= MIN_FORM_PROBABILITY {
        forms.clear();
        unmodelled.copy_from(&all);
    }
    Some(FormUncertainty {
        covariance: FormCovariance { all, unmodelled },
        probability: average.probability,
        examined_axes: axes.into_iter().map(|axis| axis.name).collect(),
        forms,
    })
}

/// The displacements or the rotations of an axis: forms of one size.
struct FormGroup<'a> {
    /// Index in the list of axes.
    axis: usize,
    kind: AxisKind,
    is_rotation: bool,
    blocks: Vec<&'a FormBlock>,
}

/// Returns the groups that readings see; `left` are the sums over the readings without the part that the unknowns
/// follow.
fn groups<'a>(axes: &'a [FormedAxis], left: &DMatrix<f64>) -> Vec<FormGroup<'a>> {
    let one = |(axis, is_rotation): (usize, bool)| {
        let FormedAxis { kind, blocks, .. } = &axes[axis];
        let blocks: Vec<&FormBlock> = blocks.iter().filter(|block| block.is_rotation() == is_rotation).collect();
        let squares = |block: &&FormBlock| {
            let sums = left.view((block.first, block.first), (FORM_KNOTS, FORM_KNOTS));
            sums.component_mul(&block.kernel(CORRELATION_LENGTHS[0])).sum()
        };
        let seen = blocks.iter().map(squares).sum::<f64>() > MIN_FORM_SQUARES;
        seen.then_some(FormGroup { axis, kind: *kind, is_rotation, blocks })
    };
    (0..axes.len()).flat_map(|axis| [(axis, false), (axis, true)]).filter_map(one).collect()
}

/// Returns the covariance of the values at the knots of forms of these variances (mm^2), by length.
fn kernel(block: &FormBlock, variances: &[f64; 3]) -> DMatrix<f64> {
    let parts = CORRELATION_LENGTHS.iter().zip(variances).map(|(length, variance)| block.kernel(*length) * *variance);
    parts.fold(DMatrix::zeros(FORM_KNOTS, FORM_KNOTS), |sum, part| sum + part)
}

/// Returns the standard deviation (mm, rad) of the form of a group: that of constants which deviate, RMS over the
/// volume, as much as the part of the form that the unknowns cannot follow.
fn size(group: &FormGroup<'_>, variances: &[f64; 3], volume: &VolumeForms) -> f64 {
    let squares = group.blocks.iter().map(|block| volume.squares(block, &kernel(block, variances)));
    let (form, unit) = squares.fold((0.0, 0.0), |(form, unit), (of, one)| (form + of, unit + one));
    if form > 0.0 { libm::sqrt(form / unit) } else { 0.0 }
}

/// Returns the form of an axis, with a size of its displacements and one of its rotations; `None` if neither is stated.
fn form<'g>(
    axis: &FormedAxis,
    found: impl Iterator<Item = (&'g FormGroup<'g>, &'g [f64; 3])>,
    volume: &VolumeForms,
) -> Option<ResidualForm> {
    let (mut sizes, mut by_length) = ([0.0; 2], [0.0; 3]);
    for (group, variances) in found {
        sizes[usize::from(group.is_rotation)] = size(group, variances, volume);
        by_length.iter_mut().zip(variances).for_each(|(sum, variance)| *sum += variance);
    }
    let [size, rotation] = sizes_that_count(sizes);
    let all: f64 = by_length.iter().sum();
    let mean = CORRELATION_LENGTHS.iter().zip(by_length).map(|(length, variance)| length * variance / all).sum::<f64>();
    (size > 0.0 || rotation > 0.0).then(|| ResidualForm {
        axis: axis.name.clone(),
        size,
        rotation,
        length: to_three_digits(mean * (axis.interval.max - axis.interval.min)),
    })
}

/// Returns the sizes of displacements (mm) and rotations (rad) of an axis, 0 for one that is small beside the other.
fn sizes_that_count([size, rotation]: [f64; 2]) -> [f64; 2] {
    let turned = rotation * LEVER_MM;
    let counts = |one: f64, other: f64| one > MIN_SCATTER_MM.max(MIN_FORM_SHARE * other);
    let keep = |value: f64, counts: bool| if counts { to_three_digits(value) } else { 0.0 };
    [keep(size, counts(size, turned)), keep(rotation, counts(turned, size))]
}

/// Rounds to three digits: no form is known better.
fn to_three_digits(value: f64) -> f64 {
    significant(value, 3).parse().unwrap_or(value)
}

/// Averages over the candidates.
struct FormAverage {
    /// Variances (mm^2) of the forms of each group, by length.
    variances: Vec<[f64; 3]>,
    /// Probability of any form.
    probability: f64,
}

/// The residual sum of squares of a fit without forms (mm^2) and its degrees of freedom.
#[derive(Debug, Clone, Copy)]
struct ResidualSum {
    squares: f64,
    degrees_of_freedom: f64,
}

/// A candidate: groups that have forms of one length and size.
struct FormCandidate<'a> {
    /// Indices in the list of groups.
    groups: &'a [usize],
    length: usize,
    /// Variance of the form in that of a reading.
    ratio: f64,
    /// Variance of a reading (mm^2).
    variance: f64,
    /// Logarithm of the restricted likelihood.
    likelihood: f64,
}

/// Averages over the candidates. `left` are the sums of knots and residual (last) without the part that the unknowns
/// follow; `None` if they are rounding.
fn average_forms(groups: &[FormGroup<'_>], left: &DMatrix<f64>, degrees_of_freedom: f64) -> Option<FormAverage> {
    let squares = left[(left.ncols() - 1, left.ncols() - 1)];
    let residual = ResidualSum { squares, degrees_of_freedom };
    if squares <= 0.0 || left.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let sets = sets(groups);
    let seen: Vec<FormModes> =
        CORRELATION_LENGTHS.par_iter().map(|length| FormModes::of(groups, left, *length)).collect();
    let pairs: Vec<(&[usize], usize)> = sets.iter().flat_map(|set| (0..3).map(move |k| (&set[..], k))).collect();
    let candidates: Vec<FormCandidate<'_>> =
        pairs.into_par_iter().flat_map_iter(|(set, length)| seen[length].candidates(set, length, residual)).collect();
    let without = -0.5 * degrees_of_freedom * libm::log(squares);
    let largest = candidates.iter().map(|c| c.likelihood).fold(without, f64::max);
    let prior = (1.0 - PRIOR_PROBABILITY_NO_FORM) / candidates.len().max(1) as f64;
    let weights: Vec<f64> = candidates.iter().map(|c| prior * libm::exp(c.likelihood - largest)).collect();
    let formed: f64 = weights.iter().sum();
    let all = formed + PRIOR_PROBABILITY_NO_FORM * libm::exp(without - largest);
    let mut variances = vec![[0.0; 3]; groups.len()];
    let mut deviations = vec![0.0; groups.len()];
    for (candidate, weight) in candidates.iter().zip(&weights) {
        let (share, variance) = (weight / all, candidate.variance * candidate.ratio);
        for group in candidate.groups {
            variances[*group][candidate.length] += share * variance;
            deviations[*group] += share * libm::sqrt(variance);
        }
    }
    variances.iter_mut().zip(&deviations).for_each(|(by_length, deviation)| shrink(by_length, *deviation));
    Some(FormAverage { variances, probability: formed / all })
}

/// Scales variances by length so that their sum is the square of a standard deviation: an average of variances would
/// hang on the few largest sizes, which the data hardly refute.
fn shrink(variances: &mut [f64; 3], deviation: f64) {
    let sum: f64 = variances.iter().sum();
    if sum > 0.0 {
        variances.iter_mut().for_each(|variance| *variance *= deviation * deviation / sum);
    }
}

/// Returns the sets of groups that may have forms: displacements, rotations or both, of each axis by itself, of those
/// of each kind, of all.
fn sets(groups: &[FormGroup<'_>]) -> Vec<Vec<usize>> {
    let last = groups.iter().map(|group| group.axis + 1).max().unwrap_or(0);
    let alone = (0..last).map(|axis| groups.iter().map(|group| group.axis == axis).collect::<Vec<bool>>());
    let of_kinds = |kinds: &[AxisKind]| groups.iter().map(|group| kinds.contains(&group.kind)).collect();
    let kinds = [&[AxisKind::Linear][..], &[AxisKind::Rotary], &[AxisKind::Linear, AxisKind::Rotary]].map(of_kinds);
    let mut sets: Vec<Vec<usize>> = Vec::new();
    for of_axes in alone.chain(kinds) {
        for motions in [&[false][..], &[true], &[false, true]] {
            let is_in = |i: &usize| of_axes[*i] && motions.contains(&groups[*i].is_rotation);
            let set: Vec<usize> = (0..groups.len()).filter(is_in).collect();
            if !set.is_empty() && !sets.contains(&set) {
                sets.push(set);
            }
        }
    }
    sets
}

/// Independent modes of the forms of all groups for one length, one standard deviation each, as readings see them.
struct FormModes {
    groups: Vec<Range<usize>>,
    /// Products of the effects of the modes on the readings.
    squares: DMatrix<f64>,
    /// Products of these effects with the residual.
    along: DVector<f64>,
}

impl FormModes {
    fn of(groups: &[FormGroup<'_>], left: &DMatrix<f64>, length: f64) -> Self {
        let (mut ranges, mut blocks): (_, Vec<(usize, DMatrix<f64>)>) = (Vec::new(), Vec::new());
        let mut count = 0;
        for group in groups {
            let first = count;
            for block in &group.blocks {
                let modes = modes(block, length);
                count += modes.ncols();
                blocks.push((block.first, modes));
            }
            ranges.push(first..count);
        }
        let (mut squares, mut along) = (DMatrix::zeros(count, count), DVector::zeros(count));
        let mut row = 0;
        for (first, modes) in &blocks {
            let mut column = 0;
            for (other, others) in &blocks {
                let product = modes.tr_mul(&left.view((*first, *other), (FORM_KNOTS, FORM_KNOTS))) * others;
                squares.view_mut((row, column), product.shape()).copy_from(&product);
                column += others.ncols();
            }
            let residual = left.view((*first, left.ncols() - 1), (FORM_KNOTS, 1));
            along.rows_mut(row, modes.ncols()).copy_from(&modes.tr_mul(&residual));
            row += modes.ncols();
        }
        Self { groups: ranges, squares, along }
    }

    fn candidates<'a>(&self, set: &'a [usize], length: usize, residual: ResidualSum) -> Vec<FormCandidate<'a>> {
        let ResidualSum { squares, degrees_of_freedom } = residual;
        let modes: Vec<usize> = set.iter().flat_map(|group| self.groups[*group].clone()).collect();
        let (seen, along) = (principal_submatrix(&self.squares, &modes), self.along.select_rows(&modes));
        let one = |size: &f64| {
            let ratio = size * size;
            let (determinant, explained) = explain(&seen, &along, ratio)?;
            let rest = squares - explained;
            let likelihood = -0.5 * (determinant + degrees_of_freedom * libm::log(rest));
            let candidate =
                FormCandidate { groups: set, length, ratio, variance: rest / degrees_of_freedom, likelihood };
            // A form that explains everything but rounding would win with no variance at all.
            (rest > MIN_RESIDUAL_SHARE * squares).then_some(candidate)
        };
        FORM_SIZES.iter().filter_map(one).collect()
    }
}

/// Returns `log det(I + ratio S)` for products S of the effects of modes of a variance (`ratio`, in that of a reading),
/// and the sum of squares that they explain: `ratio a^T (I + ratio S)^-1 a` for a = `along`.
fn explain(seen: &DMatrix<f64>, along: &DVector<f64>, ratio: f64) -> Option<(f64, f64)> {
    let mut grown = seen * ratio;
    (0..along.len()).for_each(|i| grown[(i, i)] += 1.0);
    let root = Cholesky::new(grown)?.unpack();
    let determinant = 2.0 * root.diagonal().iter().map(|x| libm::log(*x)).sum::<f64>();
    let solved = root.solve_lower_triangular(along)?;
    Some((determinant, ratio * solved.norm_squared()))
}

/// Returns independent modes of the form of a block (columns, over its knots), one standard deviation each.
fn modes(block: &FormBlock, length: f64) -> DMatrix<f64> {
    let Some(own) = SymmetricEigen::try_new(block.kernel(length), f64::EPSILON, MAX_EIGEN_STEPS) else {
        return DMatrix::zeros(FORM_KNOTS, 0);
    };
    let largest = own.eigenvalues.max();
    let kept: Vec<usize> = (0..FORM_KNOTS).filter(|k| own.eigenvalues[*k] > MIN_MODE_SHARE * largest).collect();
    DMatrix::from_fn(FORM_KNOTS, kept.len(), |i, j| {
        own.eigenvectors[(i, kept[j])] * libm::sqrt(own.eigenvalues[kept[j]])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Readings of variance I + ratio E E^T, by the dense covariance of the readings themselves.
    #[test]
    fn modes_explain_what_the_covariance_of_the_readings_says() {
        let wave = |i: usize, j: usize| libm::sin(1.7 * i as f64 + 2.3 * (j * j) as f64 + 0.4);
        let (effects, read) = (DMatrix::from_fn(9, 3, wave), DVector::from_fn(9, |i, _| wave(i, 5)));
        let (seen, along) = (effects.tr_mul(&effects), effects.tr_mul(&read));
        for ratio in [0.0, 0.25, 16.0] {
            let covariance = DMatrix::identity(9, 9) + &effects * effects.transpose() * ratio;
            let likeliest = covariance.clone().try_inverse().unwrap();
            let (determinant, explained) = explain(&seen, &along, ratio).unwrap();
            assert!((determinant - libm::log(covariance.determinant())).abs() < 1e-12, "{ratio}");
            let rest = read.dot(&(likeliest * &read));
            assert!((read.norm_squared() - explained - rest).abs() < 1e-12, "{ratio}");
        }
    }

    fn group<'a>(axis: usize, kind: AxisKind, is_rotation: bool) -> FormGroup<'a> {
        FormGroup { axis, kind, is_rotation, blocks: Vec::new() }
    }

    #[test]
    fn forms_are_of_displacements_of_rotations_and_of_both() {
        use AxisKind::{Linear, Rotary};
        let of = |motions: &[bool]| {
            let kinds = [Rotary, Rotary, Linear, Linear, Linear];
            let axes = kinds.iter().enumerate().flat_map(|(axis, kind)| motions.iter().map(move |m| (axis, *kind, *m)));
            axes.map(|(axis, kind, is_rotation)| group(axis, kind, is_rotation)).collect::<Vec<_>>()
        };
        // Five axes, the linear ones, the rotary ones, all.
        assert_eq!((sets(&of(&[false, true])).len(), sets(&of(&[false])).len()), (24, 8));
        let few = [group(0, Linear, false), group(0, Linear, true), group(1, Rotary, true)];
        let expected: [&[usize]; 6] = [&[0], &[1], &[0, 1], &[2], &[1, 2], &[0, 1, 2]];
        assert_eq!(sets(&few), expected);
    }

    #[test]
    fn a_size_that_adds_nothing_is_not_stated() {
        let near = |found: [f64; 2], expected: [f64; 2]| {
            (0..2).for_each(|k| assert!((found[k] - expected[k]).abs() <= 1e-12 * expected[k], "{found:?}"));
        };
        // 3.3 urad move a point 300 mm away by 0.99 um.
        near(sizes_that_count([1.00049e-3, 3.30001e-6]), [1e-3, 3.3e-6]);
        near(sizes_that_count([9e-6, 3.3e-6]), [0.0, 3.3e-6]);
        near(sizes_that_count([1e-3, 3e-8]), [1e-3, 0.0]);
        near(sizes_that_count([1e-10, 0.0]), [0.0, 0.0]);
    }
}
