//! The form of an axis beside a fitted curve: straight between knots at even positions over those measured, in every
//! direction in which readings may see it.

use super::fit::Fit;
use super::sums::summed;
use crate::algebra::linear::Svd;
use crate::identify::data::{DistanceEnd, Measurement, Reading, lever};
use crate::identify::model::{Basis, Model, Parameter, Term};
use crate::lower::{ErrorSite, Source};
use crate::machine::{Axis, AxisKind, AxisName, Curve, Direction, Knots};
use nalgebra::{DMatrix, DVector, Vector3};

/// Number of knots.
pub(super) const KNOTS: usize = 12;
/// Positions that an axis must have been measured at, to tell form from curve.
const FEWEST_PLACES: usize = 6;
/// Singular values below this share of the largest are zero.
const RANK: f64 = 1e-9;

/// An axis whose form readings may show.
pub(super) struct FormedAxis {
    pub name: AxisName,
    pub kind: AxisKind,
    /// Positions measured: from where to where (mm or deg).
    pub interval: (f64, f64),
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
    /// Covariance of the values at the knots (mm^2 or rad^2) of a form of unit size (mm) and of a correlation length
    /// that is a share of the interval.
    pub fn kernel(&self, length: f64) -> DMatrix<f64> {
        let near = |i: usize, j: usize| {
            let steps = (i as f64 - j as f64) / ((KNOTS - 1) as f64 * length);
            libm::exp(-0.5 * steps * steps)
        };
        let unit = lever(self.source.direction);
        &self.rest * DMatrix::from_fn(KNOTS, KNOTS, near) * self.rest.transpose() / (unit * unit)
    }

    /// True if it counts as displacement by itself.
    pub fn is_displacement(&self) -> bool {
        !self.source.direction.is_rotation()
    }
}

/// Returns the axes with enough positions, with their displacements and those angles that were read.
pub(super) fn formed(model: &Model<'_>, data: &[Measurement]) -> Vec<FormedAxis> {
    let axes = model.machines().first().map_or(&[][..], |machine| machine.axes());
    let mut first = 0;
    let mut one = |(axis, of): (usize, &Axis)| {
        let interval = measured(data, axis)?;
        let mut block = |direction: &Direction| {
            let source = Source { place: ErrorSite::Component(axis), direction: *direction };
            let read = |m: &Measurement| matches!(&m.reading, Reading::Error { source: of, .. } if *of == source);
            if direction.is_rotation() && !data.iter().any(read) {
                return None;
            }
            first += KNOTS;
            Some(Block { first: first - KNOTS, source, rest: rest(model.parameters(), source, interval) })
        };
        let blocks = Direction::ALL.iter().filter_map(&mut block).collect();
        Some(FormedAxis { name: of.name.clone(), kind: of.kind, interval, blocks })
    };
    axes.iter().enumerate().filter_map(&mut one).collect()
}

/// The interval of the positions of an axis, if they are enough.
fn measured(data: &[Measurement], axis: usize) -> Option<(f64, f64)> {
    let mut places: Vec<f64> = Vec::new();
    for m in data {
        places.push(m.pose[axis]);
        if let Reading::Distance { from: DistanceEnd::Pose(other), .. } = &m.reading {
            places.push(other[axis]);
        }
    }
    places.sort_by(f64::total_cmp);
    places.dedup();
    (places.len() >= FEWEST_PLACES).then(|| (places[0], places[places.len() - 1]))
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
        sums.weight /= data.iter().map(Measurement::readings).sum::<usize>().max(1) as f64;
        sums
    }

    fn zero(forms: usize, unknowns: usize) -> Self {
        Self { forms: DMatrix::zeros(forms, forms), cross: DMatrix::zeros(unknowns, forms), weight: 0.0 }
    }

    fn plus(self, other: Self) -> Self {
        let (forms, cross) = (self.forms + other.forms, self.cross + other.cross);
        Self { forms, cross, weight: self.weight + other.weight }
    }

    /// Adds a measurement. Few knots have an effect on it: two of each block, or four of a length between poses.
    fn add(&mut self, unknowns: &[Vector3<f64>], effects: &[Vector3<f64>], (weight, readings): (f64, usize)) {
        let acting: Vec<usize> = (0..effects.len()).filter(|j| effects[*j] != Vector3::zeros()).collect();
        for j in &acting {
            let effect = effects[*j] * weight;
            acting.iter().for_each(|i| self.forms[(*i, *j)] += effects[*i].dot(&effect));
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
        let at = |block: &Block, k: usize| {
            let point = |i: usize| (knot(self.interval, i), f64::from(u8::from(i == k)));
            let points: Vec<(f64, f64)> = (0..KNOTS).map(point).collect();
            let basis = Knots::new(&points, None).map_or(Basis::Constant, |knots| Basis::Spline(Curve::Linear(knots)));
            Parameter::single(machine, String::new(), block.source, basis, 0.0)
        };
        self.blocks.iter().flat_map(|block| (0..KNOTS).map(|k| at(block, k)).collect::<Vec<_>>()).collect()
    }
}

/// Selects the rows and columns of a square matrix.
pub(super) fn selected(of: &DMatrix<f64>, indices: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(indices.len(), indices.len(), |i, j| of[(indices[i], indices[j])])
}

/// Selects entries of a column.
pub(super) fn entries(of: &DMatrix<f64>, column: usize, indices: &[usize]) -> DVector<f64> {
    DVector::from_iterator(indices.len(), indices.iter().map(|i| of[(*i, column)]))
}
