//! The form of an axis beside a fitted curve: straight between knots at even positions over those measured, in and
//! about every direction.

use super::fit::Fit;
use super::sums::summed;
use crate::algebra::linear::Svd;
use crate::identify::data::{DistanceEnd, Measurement, Reading, lever};
use crate::identify::model::{Basis, Model, Parameter, Term, volume_poses};
use crate::lower::{ErrorSite, Source};
use crate::machine::{Axis, AxisKind, AxisName, Curve, Direction, Knots};
use nalgebra::{DMatrix, DVector, Vector3};

/// Number of knots.
pub(super) const KNOTS: usize = 12;
/// Positions that an axis must have been measured at, to tell form from curve.
const FEWEST_PLACES: usize = 6;
/// Positions nearer to each other than this share of the interval count as one.
const APART: f64 = 1e-3;
/// Least share of the travel that they must span.
const SPAN: f64 = 0.01;
/// Directions of the unknowns that move the volume by less than this share of the largest do not move it.
const MOVED: f64 = 1e-6;
/// Singular values below this share of the largest are zero.
const RANK: f64 = 1e-9;

/// An axis whose form readings may show.
pub(super) struct FormedAxis {
    /// Its place in a pose.
    index: usize,
    pub name: AxisName,
    pub kind: AxisKind,
    /// Positions measured: from where to where (mm or deg).
    pub interval: (f64, f64),
    /// One for each knot: 1 there, 0 at the others.
    hats: Vec<Curve>,
    pub blocks: Vec<Block>,
}

/// The knots of the form in one direction.
pub(super) struct Block {
    /// The column of the first.
    pub first: usize,
    /// The error.
    source: Source,
    /// Takes off values at the knots what the fitted curve takes up of them.
    rest: DMatrix<f64>,
}

impl Block {
    /// Covariance of the values at the knots (mm^2 or rad^2) of a form of unit size (mm, of a rotation at the lever arm
    /// by which it counts) and of a correlation length that is a share of the interval.
    pub fn kernel(&self, length: f64) -> DMatrix<f64> {
        let near = |i: usize, j: usize| {
            let steps = (i as f64 - j as f64) / ((KNOTS - 1) as f64 * length);
            libm::exp(-0.5 * steps * steps)
        };
        let unit = lever(self.source.direction);
        &self.rest * DMatrix::from_fn(KNOTS, KNOTS, near) * self.rest.transpose() / (unit * unit)
    }

    /// True of a rotation.
    pub fn is_rotation(&self) -> bool {
        self.source.direction.is_rotation()
    }
}

/// Returns the axes with enough positions.
pub(super) fn formed(model: &Model<'_>, data: &[Measurement]) -> Vec<FormedAxis> {
    let axes = model.machines().first().map_or(&[][..], |machine| machine.axes());
    let mut first = 0;
    let mut one = |(axis, of): (usize, &Axis)| {
        let interval = measured(data, axis, of)?;
        let hats = hats(interval)?;
        let mut block = |direction: &Direction| {
            let source = Source { place: ErrorSite::Component(axis), direction: *direction };
            first += KNOTS;
            Block { first: first - KNOTS, source, rest: rest(model.parameters(), source, interval) }
        };
        let blocks = Direction::ALL.iter().map(&mut block).collect();
        Some(FormedAxis { index: axis, name: of.name.clone(), kind: of.kind, interval, hats, blocks })
    };
    axes.iter().enumerate().filter_map(&mut one).collect()
}

/// The interval of the positions of an axis, if they are enough.
fn measured(data: &[Measurement], axis: usize, of: &Axis) -> Option<(f64, f64)> {
    let mut places: Vec<f64> = Vec::new();
    for m in data {
        places.push(m.pose[axis]);
        if let Reading::Distance { from: DistanceEnd::Pose(other), .. } = &m.reading {
            places.push(other[axis]);
        }
    }
    places.sort_by(f64::total_cmp);
    let (min, max) = (*places.first()?, *places.last()?);
    places.dedup_by(|next, before| *next - *before < APART * (max - min));
    let (start, end) = of.travel.interval();
    (places.len() >= FEWEST_PLACES && max - min >= SPAN * (end - start)).then_some((min, max))
}

/// The straight curves of the knots over an interval.
fn hats(interval: (f64, f64)) -> Option<Vec<Curve>> {
    let one = |k: usize| {
        let points: Vec<(f64, f64)> = (0..KNOTS).map(|i| (knot(interval, i), f64::from(u8::from(i == k)))).collect();
        Knots::new(&points, None).ok().map(Curve::Linear)
    };
    (0..KNOTS).map(one).collect()
}

fn knot((min, max): (f64, f64), i: usize) -> f64 {
    min + (max - min) * i as f64 / (KNOTS - 1) as f64
}

/// What the fitted curve of an error leaves of values at the knots.
fn rest(parameters: &[Parameter], source: Source, interval: (f64, f64)) -> DMatrix<f64> {
    let terms: Vec<&Term> = parameters.iter().flat_map(|p| &p.terms).filter(|term| term.source == source).collect();
    let identity = DMatrix::identity(KNOTS, KNOTS);
    if terms.is_empty() {
        return identity;
    }
    // Powers of the share of the interval span what those of the position do.
    let share = |i: usize| 2.0 * i as f64 / (KNOTS - 1) as f64 - 1.0;
    let value = |i: usize, basis: &Basis| match basis {
        Basis::Power(k) => (0..*k).fold(1.0, |power, _| power * share(i)),
        basis => basis.value(knot(interval, i)),
    };
    let curve = DMatrix::from_fn(KNOTS, terms.len(), |i, j| value(i, &terms[j].basis));
    let svd = Svd::new(&curve);
    let taken = svd.u.columns(0, svd.rank(RANK));
    identity - taken * taken.transpose()
}

/// Sums over the readings, each over the root of its variance.
pub(super) struct Sums {
    /// Products of the effects of the knots, and of what the fit leaves (last), on the readings.
    pub forms: DMatrix<f64>,
    /// Products of the effects of the unknowns (rows) with those.
    pub cross: DMatrix<f64>,
    /// The mean weight of a reading.
    pub weight: f64,
}

impl Sums {
    pub fn of(model: &Model<'_>, data: &[Measurement], fit: &Fit, axes: &[FormedAxis]) -> Self {
        let knots: Vec<Parameter> = axes.iter().flat_map(|axis| axis.parameters(model)).collect();
        let count = knots.len();
        let own = model.own();
        let instruments = &model.parameters()[own..];
        let all: Vec<Parameter> = knots.into_iter().chain(instruments.iter().cloned()).collect();
        let theta: Vec<f64> = vec![0.0; count].into_iter().chain(fit.theta[own..].iter().copied()).collect();
        let forms = model.with_parameters(&all);
        let add = |sums: &mut Self, m: &Measurement, weight: f64| {
            let (unknowns, left) = model.rows(m, &fit.theta);
            let mut effects = forms.rows(m, &theta).0;
            effects.truncate(count);
            effects.push(left);
            sums.add(&unknowns, &effects, (weight, m.readings()));
        };
        let zero = || Self::zero(count + 1, fit.theta.len());
        let mut sums = summed((data, &fit.weights), zero, add, Self::plus);
        sums.forms.fill_lower_triangle_with_upper_triangle();
        sums.weight /= data.iter().map(Measurement::readings).sum::<usize>().max(1) as f64;
        sums
    }

    /// The same with values known before the data as readings: rows over their standard uncertainty, and what the fit
    /// misses them by, beside readings that scatter by `sigma` (mm).
    pub fn with_known(mut self, known: &DMatrix<f64>, missing: &DVector<f64>, sigma: f64) -> Self {
        let (last, variance) = (self.forms.ncols() - 1, sigma * sigma);
        let mut residual = self.cross.column_mut(last);
        residual += known.tr_mul(missing) * variance;
        self.forms[(last, last)] += missing.norm_squared() * variance;
        self
    }

    fn zero(forms: usize, unknowns: usize) -> Self {
        Self { forms: DMatrix::zeros(forms, forms), cross: DMatrix::zeros(unknowns, forms), weight: 0.0 }
    }

    fn plus(self, other: Self) -> Self {
        let (forms, cross) = (self.forms + other.forms, self.cross + other.cross);
        Self { forms, cross, weight: self.weight + other.weight }
    }

    /// Adds a measurement, to the upper triangle of `forms` alone. Few knots have an effect on it: two of each block,
    /// or four of a length between poses.
    fn add(&mut self, unknowns: &[Vector3<f64>], effects: &[Vector3<f64>], (weight, readings): (f64, usize)) {
        let acting: Vec<usize> = (0..effects.len()).filter(|j| effects[*j] != Vector3::zeros()).collect();
        for (count, j) in acting.iter().enumerate() {
            let effect = effects[*j] * weight;
            acting[..=count].iter().for_each(|i| self.forms[(*i, *j)] += effects[*i].dot(&effect));
            let column = self.cross.column_mut(*j);
            column.into_iter().zip(unknowns).for_each(|(sum, unknown)| *sum += unknown.dot(&effect));
        }
        self.weight += weight * readings as f64;
    }
}

impl FormedAxis {
    /// The values at the knots as parameters.
    fn parameters(&self, model: &Model<'_>) -> Vec<Parameter> {
        let Some(machine) = model.machines().first() else { return Vec::new() };
        let of = |block: &Block, hat: &Curve| {
            Parameter::single(machine, String::new(), block.source, Basis::Spline(hat.clone()), 0.0)
        };
        self.blocks.iter().flat_map(|block| self.hats.iter().map(move |hat| of(block, hat))).collect()
    }
}

/// The forms over the volume, at the positions measured.
pub(super) struct VolumeForms {
    /// Products of the effects of the knots on the deviations.
    forms: DMatrix<f64>,
    /// The same of what no values of the unknowns follow.
    left: DMatrix<f64>,
    /// The values of the unknowns that come nearest to each knot (columns). The data determine them.
    pub nearest: DMatrix<f64>,
}

impl VolumeForms {
    /// Evaluates the forms beside a fit, with the root of the covariance of its unknowns.
    pub fn of(
        model: &Model<'_>,
        data: &[Measurement],
        (fit, root): (&Fit, &DMatrix<f64>),
        axes: &[FormedAxis],
    ) -> Self {
        let mut poses = volume_poses(model, data);
        for m in &mut poses {
            for FormedAxis { index, interval: (min, max), .. } in axes {
                m.pose[*index] = m.pose[*index].clamp(*min, *max);
            }
        }
        let weights = vec![1.0; poses.len()];
        // They are no readings, of which the fit reports its progress.
        let model = &model.clone().reporting(&|_| Ok(()));
        let moved = model.triangle(&poses, &weights, &fit.theta).r;
        let Sums { forms, cross, .. } = Sums::of(model, &poses, &Fit { weights, ..fit.clone() }, axes);
        Self::beside((&moved, root), forms, &cross)
    }

    /// Projects the forms on what the unknowns do to the deviations (`moved`, a triangle), in the directions of `root`.
    fn beside((moved, root): (&DMatrix<f64>, &DMatrix<f64>), forms: DMatrix<f64>, cross: &DMatrix<f64>) -> Self {
        let svd = Svd::new(&(moved * root));
        let root = root * svd.root_covariance(svd.rank(MOVED));
        let followed = root.tr_mul(cross);
        Self { left: &forms - followed.tr_mul(&followed), forms, nearest: root * followed }
    }

    /// Returns the sums of the squares of the deviations that a block makes at values of this covariance, of what the
    /// unknowns do not follow, and for a constant of unit size.
    pub fn squares(&self, block: &Block, covariance: &DMatrix<f64>) -> (f64, f64) {
        let own = |of: &DMatrix<f64>| of.view((block.first, block.first), (KNOTS, KNOTS)).into_owned();
        (covariance.component_mul(&own(&self.left)).sum(), own(&self.forms).sum())
    }
}

/// Selects the rows and columns of a square matrix.
pub(super) fn selected(of: &DMatrix<f64>, indices: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(indices.len(), indices.len(), |i, j| of[(indices[i], indices[j])])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a fit with known values leaves, by the dense projection of its readings and known values together.
    #[test]
    fn known_values_are_readings() {
        let wave = |i: usize, j: usize| libm::sin(1.3 * i as f64 + 2.1 * (j * j) as f64 + 0.4);
        let (unknowns, knots) = (DMatrix::from_fn(9, 2, wave), DMatrix::from_fn(9, 1, |i, _| wave(i, 7)));
        let (read, sigma) = (DVector::from_fn(9, |i, _| wave(i, 3)), 0.7);
        let (known, values) = (DMatrix::from_row_slice(1, 2, &[3.0, -1.0]), DVector::from_element(1, 4.0));
        let mut all = unknowns.clone().insert_rows(9, 1, 0.0);
        all.set_row(9, &(&known * sigma).row(0));
        let mut right = read.clone().insert_row(9, values[0] * sigma);
        let theta = (all.tr_mul(&all)).try_inverse().unwrap() * all.tr_mul(&right);
        let left = &read - &unknowns * &theta;
        let effects = DMatrix::from_fn(9, 2, |i, j| if j == 0 { knots[i] } else { left[i] });
        let sums = Sums { forms: effects.tr_mul(&effects), cross: unknowns.tr_mul(&effects), weight: 1.0 };
        let sums = sums.with_known(&known, &(&values - &known * &theta), sigma);
        let covariance = all.tr_mul(&all).try_inverse().unwrap();
        let found = &sums.forms - sums.cross.tr_mul(&(&covariance * &sums.cross));
        right -= &all * &theta;
        let whole = DMatrix::from_fn(10, 2, |i, j| {
            if j == 1 {
                right[i]
            } else if i < 9 {
                knots[i]
            } else {
                0.0
            }
        });
        let beside = DMatrix::identity(10, 10) - &all * covariance * all.transpose();
        let expected = whole.tr_mul(&(beside * &whole));
        assert!((found - expected).amax() < 1e-12);
    }

    /// Forms leave what is orthogonal to the deviations that the unknowns move; the last of three moves none.
    #[test]
    fn unknowns_follow_forms_over_the_volume() {
        let wave = |i: usize, j: usize| libm::sin(1.3 * i as f64 + 2.1 * (j * j) as f64 + 0.4);
        let moved = DMatrix::from_fn(9, 3, |i, j| if j == 2 { 0.0 } else { wave(i, j) });
        let (knots, root) = (DMatrix::from_fn(9, 2, |i, j| wave(i, 5 + j)), DMatrix::from_fn(3, 3, |i, j| wave(j, i)));
        let triangle = moved.clone().qr().r();
        let found = VolumeForms::beside((&triangle, &root), knots.tr_mul(&knots), &moved.tr_mul(&knots));
        let (own, rest) = (moved.columns(0, 2), &knots - &moved * &found.nearest);
        assert!(own.tr_mul(&rest).amax() < 1e-12, "{rest}");
        assert!((rest.tr_mul(&rest) - &found.left).amax() < 1e-12);
    }
}
