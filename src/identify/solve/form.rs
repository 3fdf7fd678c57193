//! The form of an axis beside a fitted curve: straight between knots at even positions over those measured, in and
//! about every direction.

use super::fit::ParameterFit;
use super::plausible::known_before;
use super::solution::Solution;
use super::sums::parallel_sum;
use crate::algebra::linear::Svd;
use crate::identify::data::{DistanceEnd, Measurement, Reading, lever};
use crate::identify::model::{BasisFunction, FitModel, Parameter, ParameterTerm, volume_poses};
use crate::identify::thresholds::*;
use crate::lower::{ErrorSite, Source};
use crate::machine::{Axis, AxisKind, AxisName, Curve, Direction, Knots, ResidualForm, Travel};
use nalgebra::{DMatrix, DVector, SymmetricEigen, Vector3};

/// An interval of an axis with even knots.
#[derive(Debug, Clone, Copy)]
pub(super) struct KnotInterval {
    /// First and last knot, mm or deg.
    pub min: f64,
    pub max: f64,
    /// Number of knots.
    pub count: usize,
    /// Correlation lengths that are tried, mm or deg.
    pub lengths: [f64; 3],
    /// The shortest length that a machine file states, mm or deg.
    pub finest: f64,
    /// True if positions a turn apart are one.
    turns: bool,
}

impl KnotInterval {
    fn new(min: f64, max: f64, of: &Axis, axes: usize) -> Self {
        let (span, is_rotary) = (max - min, of.kind == AxisKind::Rotary);
        let shortest = span / MIN_FORM_KNOTS as f64;
        let step = if is_rotary { shortest.min(ROTARY_FORM_STEP_DEG) } else { shortest };
        let most = (MAX_FORM_KNOTS / (6 * axes.max(1))).max(MIN_FORM_KNOTS);
        let length = |k: usize| {
            let length = CORRELATION_LENGTHS[k] * span;
            if is_rotary { length.min(ROTARY_CORRELATION_LENGTHS_DEG[k]) } else { length }
        };
        let count = (libm::ceil(span / step) as usize).clamp(MIN_FORM_KNOTS, most);
        let (start, end) = of.travel.interval();
        // A little more: three digits are stated.
        let finest = 1.01 * (end - start) / ResidualForm::MAX_TRAVEL_OVER_LENGTH;
        Self { min, max, count, lengths: [0, 1, 2].map(length), finest, turns: of.travel == Travel::Continuous }
    }

    pub fn knot(&self, i: usize) -> f64 {
        self.min + (self.max - self.min) * i as f64 / (self.count - 1) as f64
    }

    /// Returns the position of a knot in the interval, -1 to 1.
    pub fn relative(&self, i: usize) -> f64 {
        2.0 * i as f64 / (self.count - 1) as f64 - 1.0
    }

    /// Returns the position measured that is nearest to one of the travel, whole turns aside.
    fn nearest(&self, q: f64) -> f64 {
        let middle = (self.min + self.max) / 2.0;
        let q = if self.turns { middle + libm::remainder(q - middle, TURN_DEG) } else { q };
        q.clamp(self.min, self.max)
    }

    /// Returns the distance of two knots, mm or deg.
    fn apart(&self, i: usize, j: usize) -> f64 {
        let straight = (self.knot(i) - self.knot(j)).abs();
        if self.turns { straight.min((TURN_DEG - straight).abs()) } else { straight }
    }

    /// Returns the hat functions of the knots: 1 at one of them, 0 at the others, straight between.
    fn hats(&self) -> Option<Vec<Curve>> {
        let one = |k: usize| {
            let points: Vec<(f64, f64)> =
                (0..self.count).map(|i| (self.knot(i), f64::from(u8::from(i == k)))).collect();
            Knots::new(&points, None).ok().map(Curve::Linear)
        };
        (0..self.count).map(one).collect()
    }
}

const TURN_DEG: f64 = 360.0;
/// Steps in which a symmetric matrix of this size is diagonal, or never.
const MAX_EIGEN_STEPS: usize = 10_000;

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

/// The form of one error of an axis.
pub(super) struct FormBlock {
    /// The column of the first knot.
    pub first: usize,
    pub interval: KnotInterval,
    pub source: Source,
    /// Projects values at the knots on the complement of the fitted curve.
    off_curve: DMatrix<f64>,
}

impl FormBlock {
    /// Returns the covariance of the values at the knots (mm^2 or rad^2) of a form of unit size (mm; of a rotation at
    /// its lever arm): `P exp(-d^2 / 2 l^2) P^T` for the distance d of two knots, the correlation length l and the
    /// projector P off the fitted curve.
    pub fn kernel(&self, length: usize) -> DMatrix<f64> {
        let near = |i: usize, j: usize| {
            let lengths = self.interval.apart(i, j) / self.interval.lengths[length];
            libm::exp(-0.5 * lengths * lengths)
        };
        let (unit, count) = (lever(self.source.direction), self.interval.count);
        &self.off_curve * DMatrix::from_fn(count, count, near) * self.off_curve.transpose() / (unit * unit)
    }

    /// Returns independent modes of the form (columns, over its knots), one standard deviation each.
    pub fn modes(&self, length: usize) -> DMatrix<f64> {
        let count = self.interval.count;
        let Some(own) = SymmetricEigen::try_new(self.kernel(length), f64::EPSILON, MAX_EIGEN_STEPS) else {
            return DMatrix::zeros(count, 0);
        };
        let largest = own.eigenvalues.max();
        let kept: Vec<usize> = (0..count).filter(|k| own.eigenvalues[*k] > MIN_FORM_MODE_SHARE * largest).collect();
        DMatrix::from_fn(count, kept.len(), |i, j| {
            own.eigenvectors[(i, kept[j])] * libm::sqrt(own.eigenvalues[kept[j]])
        })
    }

    /// Returns its rows and columns of a matrix over all knots.
    pub fn own(&self, of: &DMatrix<f64>) -> DMatrix<f64> {
        of.view((self.first, self.first), (self.interval.count, self.interval.count)).into_owned()
    }

    /// Returns the part of functions, values at the knots (columns), that the fitted curve does not follow.
    pub fn beside_curve(&self, functions: &DMatrix<f64>) -> DMatrix<f64> {
        &self.off_curve * functions
    }
}

/// Returns the axes with enough positions.
pub(super) fn axes_with_forms(model: &FitModel<'_>, data: &[Measurement]) -> Vec<FormedAxis> {
    let axes = model.machines().first().map_or(&[][..], |machine| machine.axes());
    let mut first = 0;
    let mut one = |(axis, of): (usize, &Axis)| {
        let interval = position_interval(data, axis, of, axes.len())?;
        let hats = interval.hats()?;
        let mut block = |direction: &Direction| {
            let source = Source { place: ErrorSite::Component(axis), direction: *direction };
            first += interval.count;
            FormBlock {
                first: first - interval.count,
                interval,
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
fn position_interval(data: &[Measurement], axis: usize, of: &Axis, axes: usize) -> Option<KnotInterval> {
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
        .then(|| KnotInterval::new(min, max, of, axes))
}

/// Returns the projector `1 - U U^T` of values at the knots off the space U of the fitted curve of an error. What moves
/// other errors, too, such as a slope of `linear`, follows no form of this one by itself.
fn off_curve_projector(parameters: &[Parameter], source: Source, interval: KnotInterval) -> DMatrix<f64> {
    let moves_it_alone = |p: &&Parameter| !p.terms.is_empty() && p.terms.iter().all(|term| term.source == source);
    let own: Vec<&Parameter> = parameters.iter().filter(moves_it_alone).collect();
    let identity = DMatrix::identity(interval.count, interval.count);
    if own.is_empty() {
        return identity;
    }
    // Powers of the relative position span the same space as those of the position.
    let value = |i: usize, term: &ParameterTerm| match &term.basis {
        BasisFunction::Power(k) if own.iter().all(|p| p.terms.len() == 1) => {
            (0..*k).fold(1.0, |power, _| power * interval.relative(i))
        }
        basis => term.factor * basis.value(interval.knot(i)),
    };
    let sum = |i: usize, j: usize| own[j].terms.iter().map(|term| value(i, term)).sum::<f64>();
    let mut curve = DMatrix::from_fn(interval.count, own.len(), sum);
    curve.column_iter_mut().for_each(|mut column| {
        let norm = column.norm();
        column /= norm.max(f64::MIN_POSITIVE);
    });
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
    /// Adds up the readings of a fit. A robust one is that by least squares to readings whose residuals are limited.
    pub fn of_fit(model: &FitModel<'_>, data: &[Measurement], fit: &ParameterFit, axes: &[FormedAxis]) -> Self {
        let Some(limits) = &fit.limits else { return Self::of(model, data, fit, axes) };
        let weighed =
            |weights: &[f64]| Self::of(model, data, &ParameterFit { weights: weights.to_vec(), ..fit.clone() }, axes);
        let (mut sums, limited) = (weighed(&limits.weights), weighed(&limits.limited));
        let last = sums.forms.ncols() - 1;
        sums.forms.set_column(last, &(limited.forms.column(last) / limits.slope));
        sums.forms.set_row(last, &(limited.forms.row(last) / limits.slope));
        sums.forms[(last, last)] = fit.squares;
        sums.cross.set_column(last, &(limited.cross.column(last) / limits.slope));
        sums
    }

    /// Adds up measurements with the weights of a fit.
    fn of(model: &FitModel<'_>, data: &[Measurement], fit: &ParameterFit, axes: &[FormedAxis]) -> Self {
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
    /// Evaluates the forms beside a fit and its diagnosis. Unknowns stay within what is plausible, as in the fit.
    pub fn of(
        model: &FitModel<'_>,
        data: &[Measurement],
        fit: &ParameterFit,
        solution: &Solution,
        axes: &[FormedAxis],
    ) -> Self {
        let mut poses = volume_poses(model, data);
        for m in &mut poses {
            for FormedAxis { index, interval, .. } in axes {
                m.pose[*index] = interval.nearest(m.pose[*index]);
            }
        }
        let weights = vec![1.0; poses.len()];
        // These poses are not readings: they do not count as progress.
        let model = &model.clone().with_progress(&|_| Ok(()));
        let effects = model.triangle(&poses, &weights, &fit.theta).r;
        let scatter = solution.sigma * libm::sqrt(3.0 * poses.len() as f64 / fit.reduced.rows as f64);
        let effects = known_before(effects, &fit.plausible, scatter);
        let Sums { forms, cross, .. } = Sums::of(model, &poses, &ParameterFit { weights, ..fit.clone() }, axes);
        Self::project(&effects, &solution.covariance_root(), forms, &cross)
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
        (covariance.component_mul(&block.own(&self.unfollowed)).sum(), block.own(&self.forms).sum())
    }
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
