//! Lack of fit: readings near each other on an axis share the form that the fitted curves leave of it, so that many of
//! them are worth no more than a few.
//!
//! The form of an axis is a random function of its position in and about each direction: a Gaussian process of unknown
//! size and correlation length (the model inadequacy of Kennedy and O'Hagan 2001, section 4), less what the fitted
//! curve takes up of it. Size, length and the axes whose displacements, rotations or both have a form are not chosen
//! but averaged over: each candidate counts by its restricted likelihood (Patterson and Thompson 1971), and before the
//! data it is three to one that there is no form.

use super::fit::Fit;
use super::form::{Block, FormedAxis, KNOTS, Sums, VolumeForms, formed, selected};
use super::solution::{MIN_SIGMA, Solution};
use crate::identify::data::{LEVER_MM, Measurement};
use crate::identify::model::Model;
use crate::machine::{AxisKind, AxisName, ResidualForm};
use crate::units::significant;
use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};
use rayon::prelude::*;
use std::ops::Range;

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
/// Sum of squares, over the variance of a reading, of a form of the size of the scatter that readings do not see.
const UNSEEN: f64 = 1e-3;
/// Share of the other kind below which displacements or rotations of an axis are not stated.
const MINOR: f64 = 1e-2;
/// Sums of squares that unknowns or forms leave less than this share of are rounding.
const ROUNDING: f64 = 1e-12;
/// Steps in which a symmetric matrix of this size is diagonal, or never.
const MAX_STEPS: usize = 10_000;

/// The uncertainty that readings share through the form of the axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Misfit {
    /// Covariance of the unknowns that it makes, in their units.
    pub covariance: DMatrix<f64>,
    /// The same of their distance from the values that come nearest to the machine over the volume, form and all (the
    /// L2 projection of Tuo and Wu 2015): predictions have this beside `forms`, which are off these. That of
    /// `covariance` if no form is stated.
    pub apart: DMatrix<f64>,
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
    let groups = groups(&axes, &left);
    let found = averaged(&groups, &left, solution.freedom as f64)?;
    let half = &root * seen;
    let volume = VolumeForms::of(model, data, (fit, &root), &axes);
    let mut covariance = DMatrix::zeros(half.nrows(), half.nrows());
    let mut apart = covariance.clone();
    for (group, variances) in groups.iter().zip(&found.variances) {
        for block in &group.blocks {
            let kernel = kernel(block, variances);
            let columns = half.columns(block.first, KNOTS);
            covariance += columns * &kernel * columns.transpose();
            let columns = columns - volume.nearest.columns(block.first, KNOTS);
            apart += &columns * kernel * columns.transpose();
        }
    }
    let found_of = |axis: usize| groups.iter().zip(&found.variances).filter(move |(group, _)| group.axis == axis);
    let forms = axes.iter().enumerate().filter_map(|(i, axis)| form(axis, found_of(i), &volume));
    let (forms, apart) =
        if found.probability > LIKELY { (forms.collect(), apart) } else { (Vec::new(), covariance.clone()) };
    let judged = axes.iter().map(|axis| axis.name.clone()).collect();
    Some(Misfit { covariance, apart, probability: found.probability, judged, forms })
}

/// The displacements or the rotations of an axis: forms of one size.
struct Group<'a> {
    /// Index in the list of axes.
    axis: usize,
    kind: AxisKind,
    is_rotation: bool,
    blocks: Vec<&'a Block>,
}

/// Returns the groups that readings see, where `left` are their sums without what the unknowns take up.
fn groups<'a>(axes: &'a [FormedAxis], left: &DMatrix<f64>) -> Vec<Group<'a>> {
    let one = |(axis, is_rotation): (usize, bool)| {
        let FormedAxis { kind, blocks, .. } = &axes[axis];
        let blocks: Vec<&Block> = blocks.iter().filter(|block| block.is_rotation() == is_rotation).collect();
        let squares = |block: &&Block| {
            let sums = left.view((block.first, block.first), (KNOTS, KNOTS));
            sums.component_mul(&block.kernel(LENGTHS[0])).sum()
        };
        let seen = blocks.iter().map(squares).sum::<f64>() > UNSEEN;
        seen.then_some(Group { axis, kind: *kind, is_rotation, blocks })
    };
    (0..axes.len()).flat_map(|axis| [(axis, false), (axis, true)]).filter_map(one).collect()
}

/// Covariance of the values at the knots of forms of these variances (mm^2), by length.
fn kernel(block: &Block, variances: &[f64; 3]) -> DMatrix<f64> {
    let parts = LENGTHS.iter().zip(variances).map(|(length, variance)| block.kernel(*length) * *variance);
    parts.fold(DMatrix::zeros(KNOTS, KNOTS), |sum, part| sum + part)
}

/// Standard deviation (mm, rad) of the form of a group: that of constants which deviate, in the mean over the volume,
/// as much as what the unknowns do not follow of it.
fn size(group: &Group<'_>, variances: &[f64; 3], volume: &VolumeForms) -> f64 {
    let squares = group.blocks.iter().map(|block| volume.squares(block, &kernel(block, variances)));
    let (left, unit) = squares.fold((0.0, 0.0), |(left, unit), (of, one)| (left + of, unit + one));
    if left > 0.0 { libm::sqrt(left / unit) } else { 0.0 }
}

/// The form of an axis, with a size of its displacements and one of its rotations; `None` if neither is stated.
fn form<'g>(
    axis: &FormedAxis,
    found: impl Iterator<Item = (&'g Group<'g>, &'g [f64; 3])>,
    volume: &VolumeForms,
) -> Option<ResidualForm> {
    let (mut sizes, mut by_length) = ([0.0; 2], [0.0; 3]);
    for (group, variances) in found {
        sizes[usize::from(group.is_rotation)] = size(group, variances, volume);
        by_length.iter_mut().zip(variances).for_each(|(sum, variance)| *sum += variance);
    }
    let [size, rotation] = stated(sizes);
    let all: f64 = by_length.iter().sum();
    let mean = LENGTHS.iter().zip(by_length).map(|(length, variance)| length * variance / all).sum::<f64>();
    let (min, max) = axis.interval;
    (size > 0.0 || rotation > 0.0).then(|| ResidualForm {
        axis: axis.name.clone(),
        size,
        rotation,
        length: rounded(mean * (max - min)),
    })
}

/// The sizes of displacements (mm) and rotations (rad) of an axis that count beside each other, 0 for those that do
/// not.
fn stated([size, rotation]: [f64; 2]) -> [f64; 2] {
    let turned = rotation * LEVER_MM;
    let counts = |one: f64, other: f64| one > MIN_SIGMA.max(MINOR * other);
    let keep = |value: f64, counts: bool| if counts { rounded(value) } else { 0.0 };
    [keep(size, counts(size, turned)), keep(rotation, counts(turned, size))]
}

/// To three digits: no form is known better.
fn rounded(value: f64) -> f64 {
    significant(value, 3).parse().unwrap_or(value)
}

/// Averages over the candidates.
struct Averaged {
    /// Variances (mm^2) of the forms of each group, by length.
    variances: Vec<[f64; 3]>,
    /// Probability of any form.
    probability: f64,
}

/// A candidate: groups that have forms of one length and size.
struct Candidate<'a> {
    /// Indices in the list of groups.
    groups: &'a [usize],
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
fn averaged(groups: &[Group<'_>], left: &DMatrix<f64>, spare: f64) -> Option<Averaged> {
    let squares = left[(left.ncols() - 1, left.ncols() - 1)];
    if squares <= 0.0 || left.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let sets = sets(groups);
    let seen: Vec<SeenModes> = LENGTHS.par_iter().map(|length| SeenModes::of(groups, left, *length)).collect();
    let pairs: Vec<(&[usize], usize)> = sets.iter().flat_map(|set| (0..3).map(move |k| (&set[..], k))).collect();
    let candidates: Vec<Candidate<'_>> = pairs
        .into_par_iter()
        .flat_map_iter(|(set, length)| seen[length].candidates((set, length), (squares, spare)))
        .collect();
    let without = -0.5 * spare * libm::log(squares);
    let largest = candidates.iter().map(|c| c.likelihood).fold(without, f64::max);
    let prior = (1.0 - NONE) / candidates.len().max(1) as f64;
    let weights: Vec<f64> = candidates.iter().map(|c| prior * libm::exp(c.likelihood - largest)).collect();
    let formed: f64 = weights.iter().sum();
    let all = formed + NONE * libm::exp(without - largest);
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

/// The sets of groups that may have forms: displacements, rotations or both, of each axis by itself, of those of each
/// kind, of all.
fn sets(groups: &[Group<'_>]) -> Vec<Vec<usize>> {
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
struct SeenModes {
    /// The modes of each group.
    groups: Vec<Range<usize>>,
    /// Products of the effects of the modes on the readings.
    squares: DMatrix<f64>,
    /// Products of these effects with the residual.
    along: DVector<f64>,
}

impl SeenModes {
    fn of(groups: &[Group<'_>], left: &DMatrix<f64>, length: f64) -> Self {
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
                let product = modes.tr_mul(&left.view((*first, *other), (KNOTS, KNOTS))) * others;
                squares.view_mut((row, column), product.shape()).copy_from(&product);
                column += others.ncols();
            }
            let residual = left.view((*first, left.ncols() - 1), (KNOTS, 1));
            along.rows_mut(row, modes.ncols()).copy_from(&modes.tr_mul(&residual));
            row += modes.ncols();
        }
        Self { groups: ranges, squares, along }
    }

    /// The candidates of a set of groups and a length, where the residuals have this sum of squares and `spare`
    /// readings are.
    fn candidates<'a>(&self, (set, length): (&'a [usize], usize), (squares, spare): (f64, f64)) -> Vec<Candidate<'a>> {
        let modes: Vec<usize> = set.iter().flat_map(|group| self.groups[*group].clone()).collect();
        let (seen, along) = (selected(&self.squares, &modes), self.along.select_rows(&modes));
        let one = |size: &f64| {
            let ratio = size * size;
            let (determinant, explained) = explained(&seen, &along, ratio)?;
            let rest = squares - explained;
            let likelihood = -0.5 * (determinant + spare * libm::log(rest));
            let candidate = Candidate { groups: set, length, ratio, variance: rest / spare, likelihood };
            // A form that explains everything but rounding would win with no variance at all.
            (rest > ROUNDING * squares).then_some(candidate)
        };
        SIZES.iter().filter_map(one).collect()
    }
}

/// Returns the logarithm of the determinant of I + ratio S for modes of a variance (`ratio`, in that of a reading),
/// where S are products of their effects, and the sum of squares that they explain of `along`.
fn explained(seen: &DMatrix<f64>, along: &DVector<f64>, ratio: f64) -> Option<(f64, f64)> {
    let mut grown = seen * ratio;
    (0..along.len()).for_each(|i| grown[(i, i)] += 1.0);
    let root = Cholesky::new(grown)?.unpack();
    let determinant = 2.0 * root.diagonal().iter().map(|x| libm::log(*x)).sum::<f64>();
    let solved = root.solve_lower_triangular(along)?;
    Some((determinant, ratio * solved.norm_squared()))
}

/// Independent modes of the form of a block (columns, over its knots), one standard deviation each.
fn modes(block: &Block, length: f64) -> DMatrix<f64> {
    let Some(own) = SymmetricEigen::try_new(block.kernel(length), f64::EPSILON, MAX_STEPS) else {
        return DMatrix::zeros(KNOTS, 0);
    };
    let largest = own.eigenvalues.max();
    let kept: Vec<usize> = (0..KNOTS).filter(|k| own.eigenvalues[*k] > FAINT * largest).collect();
    DMatrix::from_fn(KNOTS, kept.len(), |i, j| own.eigenvectors[(i, kept[j])] * libm::sqrt(own.eigenvalues[kept[j]]))
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
            let (determinant, explained) = explained(&seen, &along, ratio).unwrap();
            assert!((determinant - libm::log(covariance.determinant())).abs() < 1e-12, "{ratio}");
            let rest = read.dot(&(likeliest * &read));
            assert!((read.norm_squared() - explained - rest).abs() < 1e-12, "{ratio}");
        }
    }

    fn group<'a>(axis: usize, kind: AxisKind, is_rotation: bool) -> Group<'a> {
        Group { axis, kind, is_rotation, blocks: Vec::new() }
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
        near(stated([1.00049e-3, 3.30001e-6]), [1e-3, 3.3e-6]);
        near(stated([9e-6, 3.3e-6]), [0.0, 3.3e-6]);
        near(stated([1e-3, 3e-8]), [1e-3, 0.0]);
        near(stated([1e-10, 0.0]), [0.0, 0.0]);
    }
}
