//! The form of an axis beside a fitted curve: straight between knots at even positions over those measured, in and
//! about every direction.

use super::fit::ParameterFit;
use super::sums::parallel_sum;
use crate::algebra::linear::Svd;
use crate::identify::data::{DistanceEnd, Measurement, Reading, lever};
use crate::identify::model::{BasisFunction, FitModel, Parameter, ParameterTerm, volume_poses};
use crate::identify::thresholds::*;
use crate::lower::{ErrorSite, Source};
use crate::machine::{Axis, AxisKind, AxisName, Curve, Direction, Knots};
use nalgebra::{DMatrix, DVector, Vector3};

pub(super) const FORM_KNOTS: usize = 12;
/// An interval of an axis with even knots.
#[derive(Debug, Clone, Copy)]
pub(super) struct KnotInterval {
    /// First and last knot, mm or deg.
    pub min: f64,
    pub max: f64,
}

impl KnotInterval {
    fn knot(&self, i: usize) -> f64 {
        self.min + (self.max - self.min) * i as f64 / (FORM_KNOTS - 1) as f64
    }

    /// Returns the hat functions of the knots: 1 at one of them, 0 at the others, straight between.
    fn hats(&self) -> Option<Vec<Curve>> {
        let one = |k: usize| {
            let points: Vec<(f64, f64)> =
                (0..FORM_KNOTS).map(|i| (self.knot(i), f64::from(u8::from(i == k)))).collect();
            Knots::new(&points, None).ok().map(Curve::Linear)
        };
        (0..FORM_KNOTS).map(one).collect()
    }
}

/// An axis whose form readings may show.
pub(super) struct FormedAxis {
    index: usize,
    pub name: AxisName,
    pub kind: AxisKind,
    /// The positions measured.
    pub interval: KnotInterval,
    /// One for each knot: 1 there, 0 at the others.
    hats: Vec<Curve>,
    pub blocks: Vec<FormBlock>,
}

pub(super) struct FormBlock {
    /// The column of the first.
    pub first: usize,
    source: Source,
    /// Projects values at the knots on the complement of the fitted curve.
    off_curve: DMatrix<f64>,
}

impl FormBlock {
    /// Returns the covariance of the values at the knots (mm^2 or rad^2) of a form of unit size (mm; of a rotation at
    /// its lever arm): `P exp(-d^2 / 2 l^2) P^T` for the distance d of two knots and the correlation length l, both as
    /// shares of the interval, and the projector P off the fitted curve.
    pub fn kernel(&self, length: f64) -> DMatrix<f64> {
        let near = |i: usize, j: usize| {
            let steps = (i as f64 - j as f64) / ((FORM_KNOTS - 1) as f64 * length);
            libm::exp(-0.5 * steps * steps)
        };
        let unit = lever(self.source.direction);
        &self.off_curve * DMatrix::from_fn(FORM_KNOTS, FORM_KNOTS, near) * self.off_curve.transpose() / (unit * unit)
    }

    /// True of a rotation.
    pub fn is_rotation(&self) -> bool {
        self.source.direction.is_rotation()
    }
}

/// Returns the axes with enough positions.
pub(super) fn axes_with_forms(model: &FitModel<'_>, data: &[Measurement]) -> Vec<FormedAxis> {
    let axes = model.machines().first().map_or(&[][..], |machine| machine.axes());
    let mut first = 0;
    let mut one = |(axis, of): (usize, &Axis)| {
        let interval = position_interval(data, axis, of)?;
        let hats = interval.hats()?;
        let mut block = |direction: &Direction| {
            let source = Source { place: ErrorSite::Component(axis), direction: *direction };
            first += FORM_KNOTS;
            FormBlock {
                first: first - FORM_KNOTS,
                source,
                off_curve: off_curve_projector(model.parameters(), source, interval),
            }
        };
        let blocks = Direction::ALL.iter().map(&mut block).collect();
        Some(FormedAxis { index: axis, name: of.name.clone(), kind: of.kind, interval, hats, blocks })
    };
    axes.iter().enumerate().filter_map(&mut one).collect()
}

/// Returns the interval of the positions of an axis; `None` if they are too few or too near each other.
fn position_interval(data: &[Measurement], axis: usize, of: &Axis) -> Option<KnotInterval> {
    let mut places: Vec<f64> = Vec::new();
    for m in data {
        places.push(m.pose[axis]);
        if let Reading::Distance { from: DistanceEnd::Pose(other), .. } = &m.reading {
            places.push(other[axis]);
        }
    }
    places.sort_by(f64::total_cmp);
    let (min, max) = (*places.first()?, *places.last()?);
    places.dedup_by(|next, before| *next - *before < SAME_POSITION_SHARE * (max - min));
    let (start, end) = of.travel.interval();
    (places.len() >= MIN_FORM_POSITIONS && max - min >= MIN_FORM_SPAN_SHARE * (end - start))
        .then_some(KnotInterval { min, max })
}

/// Returns the projector `1 - U U^T` of values at the knots off the space U of the fitted curve of an error.
fn off_curve_projector(parameters: &[Parameter], source: Source, interval: KnotInterval) -> DMatrix<f64> {
    let terms: Vec<&ParameterTerm> =
        parameters.iter().flat_map(|p| &p.terms).filter(|term| term.source == source).collect();
    let identity = DMatrix::identity(FORM_KNOTS, FORM_KNOTS);
    if terms.is_empty() {
        return identity;
    }
    // Powers of the relative position span the same space as those of the position.
    let relative = |i: usize| 2.0 * i as f64 / (FORM_KNOTS - 1) as f64 - 1.0;
    let value = |i: usize, basis: &BasisFunction| match basis {
        BasisFunction::Power(k) => (0..*k).fold(1.0, |power, _| power * relative(i)),
        basis => basis.value(interval.knot(i)),
    };
    let curve = DMatrix::from_fn(FORM_KNOTS, terms.len(), |i, j| value(i, &terms[j].basis));
    let svd = Svd::new(&curve);
    let curve = svd.u.columns(0, svd.rank(DESIGN_RANK_TOLERANCE));
    identity - curve * curve.transpose()
}

/// Sums over the readings, each over the root of its variance.
pub(super) struct Sums {
    /// Products of the effects of the knots on the readings, and of the residual (last).
    pub forms: DMatrix<f64>,
    /// Products of the effects of the unknowns (rows) with those.
    pub cross: DMatrix<f64>,
    /// The mean weight of a reading.
    pub weight: f64,
}

impl Sums {
    pub fn of(model: &FitModel<'_>, data: &[Measurement], fit: &ParameterFit, axes: &[FormedAxis]) -> Self {
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
            sums.add(&unknowns, &effects, weight, m.readings());
        };
        let zero = || Self::zero(count + 1, fit.theta.len());
        let mut sums = parallel_sum(data, &fit.weights, zero, add, Self::plus);
        sums.forms.fill_lower_triangle_with_upper_triangle();
        sums.weight /= data.iter().map(Measurement::readings).sum::<usize>().max(1) as f64;
        sums
    }

    /// Adds values known before the data as readings: `known` are rows over their standard uncertainty, `missing` the
    /// residuals of the fit in them; the readings scatter by `sigma` (mm).
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
    fn add(&mut self, unknowns: &[Vector3<f64>], effects: &[Vector3<f64>], weight: f64, readings: usize) {
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
    fn parameters(&self, model: &FitModel<'_>) -> Vec<Parameter> {
        let Some(machine) = model.machines().first() else { return Vec::new() };
        let of = |block: &FormBlock, hat: &Curve| {
            Parameter::single(machine, String::new(), block.source, BasisFunction::Spline(hat.clone()), 0.0)
        };
        self.blocks.iter().flat_map(|block| self.hats.iter().map(move |hat| of(block, hat))).collect()
    }
}

/// The forms over the volume, at the positions measured.
pub(super) struct VolumeForms {
    /// Products of the effects of the knots on the deviations.
    forms: DMatrix<f64>,
    /// The same of the deviations that no values of the unknowns can follow.
    unfollowed: DMatrix<f64>,
    /// The values of the unknowns that come nearest to each knot (columns). The data determine them.
    pub nearest: DMatrix<f64>,
}

impl VolumeForms {
    /// Evaluates the forms beside a fit; `root` is that of the covariance of its unknowns.
    pub fn of(
        model: &FitModel<'_>,
        data: &[Measurement],
        fit: &ParameterFit,
        root: &DMatrix<f64>,
        axes: &[FormedAxis],
    ) -> Self {
        let mut poses = volume_poses(model, data);
        for m in &mut poses {
            for FormedAxis { index, interval, .. } in axes {
                m.pose[*index] = m.pose[*index].clamp(interval.min, interval.max);
            }
        }
        let weights = vec![1.0; poses.len()];
        // These poses are not readings: they do not count as progress.
        let model = &model.clone().with_progress(&|_| Ok(()));
        let effects = model.triangle(&poses, &weights, &fit.theta).r;
        let Sums { forms, cross, .. } = Sums::of(model, &poses, &ParameterFit { weights, ..fit.clone() }, axes);
        Self::project(&effects, root, forms, &cross)
    }

    /// Projects the forms on the effects of the unknowns on the deviations (a triangle), in the directions of `root`.
    fn project(effects: &DMatrix<f64>, root: &DMatrix<f64>, forms: DMatrix<f64>, cross: &DMatrix<f64>) -> Self {
        let svd = Svd::new(&(effects * root));
        let root = root * svd.root_covariance(svd.rank(VOLUME_RANK_TOLERANCE));
        let followed = root.tr_mul(cross);
        Self { unfollowed: &forms - followed.tr_mul(&followed), forms, nearest: root * followed }
    }

    /// Returns two sums of squares of deviations by a block: of the part that the unknowns cannot follow, for values of
    /// this covariance, and of a constant of unit size.
    pub fn squares(&self, block: &FormBlock, covariance: &DMatrix<f64>) -> (f64, f64) {
        let own = |of: &DMatrix<f64>| of.view((block.first, block.first), (FORM_KNOTS, FORM_KNOTS)).into_owned();
        (covariance.component_mul(&own(&self.unfollowed)).sum(), own(&self.forms).sum())
    }
}

/// Returns a square matrix without the rows and columns that are not among `indices`.
pub(super) fn principal_submatrix(of: &DMatrix<f64>, indices: &[usize]) -> DMatrix<f64> {
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
        let effects = DMatrix::from_fn(9, 3, |i, j| if j == 2 { 0.0 } else { wave(i, j) });
        let (knots, root) = (DMatrix::from_fn(9, 2, |i, j| wave(i, 5 + j)), DMatrix::from_fn(3, 3, |i, j| wave(j, i)));
        let triangle = effects.clone().qr().r();
        let found = VolumeForms::project(&triangle, &root, knots.tr_mul(&knots), &effects.tr_mul(&knots));
        let (own, rest) = (effects.columns(0, 2), &knots - &effects * &found.nearest);
        assert!(own.tr_mul(&rest).amax() < 1e-12, "{rest}");
        assert!((rest.tr_mul(&rest) - &found.unfollowed).amax() < 1e-12);
    }
}
