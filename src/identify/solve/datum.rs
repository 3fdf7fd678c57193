//! The datum of the errors. Curves of all axes include the rigid motions of the whole and the choice of every axis's
//! zero: directions that only move the workpiece frame. Conditions on the curves (their line, their zero)
//! choose among these equivalent machines; nothing that is predicted changes but by a rigid motion. Values and
//! covariance are those of the S-transformation (Baarda 1973) to these conditions, carried on to the exact model.

use super::fit::ParameterFit;
use super::in_data::{FitInData, follow};
use super::solution::{DatumTransform, Solution};
use crate::algebra::linear::{ReducedSystem, Svd, Triangle, beside, over_columns};
use crate::identify::data::{LEVER_MM, Measurement, lever};
use crate::identify::model::{
    BasisFunction, FitModel, Parameter, ParameterTerm, RigidMotion, Volume, approach_weight, middle, sizes,
};
use crate::identify::thresholds::*;
use crate::lower::{ErrorSite, Source};
use crate::machine::{Approach, Axis, AxisKind, Direction, Travel};
use crate::syntax::{DatumEntry, DatumLine, DatumZero, SquarenessSite};
use nalgebra::{DMatrix, DVector, Rotation3, Vector3};

/// The conditions of a datum.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DatumConditions {
    /// The datum as the file chooses it.
    pub entry: DatumEntry,
    /// Location errors that are redundant beside the others: they stay at their start.
    pub redundant_locations: Vec<String>,
}

/// The rigid motion that a datum removed from a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidMotionRemoved {
    /// Number of conditions.
    pub conditions: usize,
    /// Translation of the workpiece frame, mm.
    pub translation: [f64; 3],
    /// Rotation about the middle of the volume, rad.
    pub rotation: [f64; 3],
    /// True if curves removed directions that readings see weakly. Noise may have drawn these beyond the range in which
    /// the linear problem at the fit holds.
    pub removes_weak: bool,
}

/// A fit in its datum.
#[derive(Debug, Clone)]
pub struct DatumChange {
    /// The fit with its diagnosis, in the datum.
    pub solution: Solution,
    /// The motion that was removed.
    pub removed: RigidMotionRemoved,
    /// The fit in the datum as the readings see it.
    pub in_data: FitInData,
    /// Rigid motions of the workpiece frame (columns, as displacements) among which a datum chooses.
    pub motions: DMatrix<f64>,
}

/// Transforms a fit with error curves to a datum; `None` if no curve is fitted, or the datum is free.
pub fn in_datum(
    model: &FitModel<'_>,
    data: &[Measurement],
    fit: &ParameterFit,
    solution: &Solution,
    conditions: &DatumConditions,
) -> Option<DatumChange> {
    let parameters = model.parameters();
    let DatumEntry { line, zero, .. } = conditions.entry;
    let curved = |p: &Parameter| p.terms.iter().any(|t| matches!(t.source.place, ErrorSite::Component(_)));
    if !parameters.iter().any(curved) || (line == DatumLine::Free && zero == DatumZero::Free) {
        return None;
    }
    let gauge = Gauge::of(model, data)?;
    let mut rows = conditions_of(model, data, conditions);
    for row in &mut rows {
        row.iter_mut().zip(&gauge.errors).filter(|(_, error)| !**error).for_each(|(x, _)| *x = 0.0);
    }
    let chosen = gauge.independent(&rows);
    if chosen.nrows() == 0 {
        return None;
    }
    let shift = gauge.shift(&chosen);
    let map = gauge.map(&fit.reduced.r, &chosen, &shift);
    let fitted = solution.theta();
    let (theta, removed) = gauge.exact_values(model, data, fit, &fitted, &chosen, &map);
    let transform = DatumTransform { map: &map, theta: &theta, fixes_weak: gauge.has_weak };
    let in_data = gauge.in_data(model, data, &fitted, &theta);
    let solution = solution.clone().in_datum(&transform, fit, parameters);
    let motions = gauge.motions(model, data, &fit.reduced.r);
    Some(DatumChange { solution, removed, in_data, motions })
}

/// Combinations of the machine's errors that only move the workpiece frame.
struct Gauge {
    /// True if an unknown is an error of the machine: neither set-up nor instrument.
    errors: Vec<bool>,
    /// Set-ups and instruments, which follow the errors.
    followers: Vec<usize>,
    /// Displacement that a unit of each unknown makes.
    sizes: DVector<f64>,
    /// Columns: combinations (of displacements).
    basis: DMatrix<f64>,
    /// True if some of them only nearly are rigid motions, so that readings see them weakly.
    has_weak: bool,
}

impl Gauge {
    fn of(model: &FitModel<'_>, data: &[Measurement]) -> Option<Self> {
        let parameters = model.parameters();
        let sizes = sizes(parameters);
        let volume = Volume::first_order(model, data);
        // A curve without effect on the volume has no datum, and follows no other error.
        let effect = |j: usize| volume.jacobian.column(j).norm() / sizes[j];
        let error = |j: usize| match parameters[j].terms.first().map(|t| t.source.place) {
            Some(ErrorSite::Location(_)) => true,
            Some(ErrorSite::Component(_)) => effect(j) > MAX_IDLE_EFFECT_MM,
            _ => false,
        };
        let errors: Vec<bool> = (0..parameters.len()).map(error).collect();
        let follows = |j: &usize| match parameters[*j].terms.first().map(|t| t.source.place) {
            Some(ErrorSite::Tool | ErrorSite::Workpiece) | None => true,
            Some(ErrorSite::Location(_) | ErrorSite::Component(_)) => false,
        };
        let followers: Vec<usize> = (0..errors.len()).filter(follows).collect();
        let own: Vec<usize> = (0..errors.len()).filter(|j| errors[*j]).collect();
        let jacobian = over_columns(&volume.jacobian, &sizes).select_columns(&own);
        let effects = volume.deformation(&jacobian);
        let svd = Svd::new(&ReducedSystem::of(&effects, &DVector::zeros(effects.nrows())).r);
        let mut null: Vec<DVector<f64>> =
            svd.null_space(svd.rank(MAX_RIGID_SHARE)).column_iter().map(|column| column.into_owned()).collect();
        let turning = TurningErrors { model, volume: &volume, own: &own, jacobian: &jacobian };
        let exact = null.len();
        for turning in turning.all() {
            let (rest, length) = (beside(turning.clone(), &null), turning.norm());
            if rest.norm() > MAX_TURNING_SHARE * length {
                null.push(rest.normalize());
            }
        }
        if null.is_empty() {
            return None;
        }
        let mut basis = DMatrix::zeros(errors.len(), null.len());
        for (column, direction) in null.iter().enumerate() {
            own.iter().zip(direction.iter()).for_each(|(j, x)| basis[(*j, column)] = *x);
        }
        Some(Self { errors, followers, sizes, basis, has_weak: null.len() > exact })
    }

    /// Selects the conditions (rows, by displacements) that fix a combination which those before leave free.
    fn independent(&self, rows: &[DVector<f64>]) -> DMatrix<f64> {
        let (mut kept, mut seen): (Vec<&DVector<f64>>, Vec<DVector<f64>>) = (Vec::new(), Vec::new());
        for row in rows {
            let rest = beside(self.basis.tr_mul(row), &seen);
            if rest.norm() > MAX_DEPENDENT_SHARE * row.norm() && row.norm() > 0.0 && seen.len() < self.basis.ncols() {
                kept.push(row);
                seen.push(rest.normalize());
            }
        }
        DMatrix::from_fn(kept.len(), self.errors.len(), |i, j| kept[i][j])
    }

    /// Returns for each condition the combination that changes it by one and the others not (columns, by
    /// displacements).
    fn shift(&self, conditions: &DMatrix<f64>) -> DMatrix<f64> {
        let effect = conditions * &self.basis;
        let svd = Svd::new(&effect);
        let rank = conditions.nrows();
        let columns: Vec<DVector<f64>> =
            (0..rank).map(|k| svd.solve(&DVector::from_fn(rank, |i, _| f64::from(u8::from(i == k))), rank)).collect();
        &self.basis * DMatrix::from_columns(&columns)
    }

    /// Returns the linear map of unknowns to those in the datum: errors move along the combinations, set-ups and
    /// instruments follow as far as the readings (`r`) see it.
    fn map(&self, r: &DMatrix<f64>, conditions: &DMatrix<f64>, shift: &DMatrix<f64>) -> DMatrix<f64> {
        let count = self.errors.len();
        let unit = |m: &DMatrix<f64>| DMatrix::from_fn(count, count, |i, j| m[(i, j)] * self.sizes[j] / self.sizes[i]);
        let shifted = unit(&(shift * conditions));
        let others = &self.followers;
        let svd = self.follower_columns(r);
        let rank = svd.rank(RANK_TOLERANCE);
        let seen = r * &shifted;
        let mut map = DMatrix::identity(count, count) - &shifted;
        for j in (0..count).filter(|j| self.errors[*j]) {
            let follow = svd.solve(&seen.column(j).into_owned(), rank);
            others.iter().enumerate().for_each(|(k, o)| map[(*o, j)] += follow[k] / self.sizes[*o]);
        }
        map
    }

    /// Returns the rigid motions of the workpiece frame (columns, as displacements) that the combinations make where
    /// set-ups follow as far as the readings (`r`) see it: a set-up of the workpiece undoes them.
    fn motions(&self, model: &FitModel<'_>, data: &[Measurement], r: &DMatrix<f64>) -> DMatrix<f64> {
        let volume = Volume::first_order(model, data);
        let [effects, seen] = [&volume.jacobian, r].map(|rows| over_columns(rows, &self.sizes));
        let svd = self.follower_columns(r);
        let rank = svd.rank(RANK_TOLERANCE);
        let mut net = self.basis.clone();
        for mut column in net.column_iter_mut() {
            let follow = svd.solve(&(&seen * &column), rank);
            self.followers.iter().enumerate().for_each(|(k, j)| column[*j] -= follow[k]);
        }
        volume.rigid_motions(&(effects * net), &model.machines()[0])
    }

    /// Decomposes the columns of set-ups and instruments, by displacements, in a triangle of the readings.
    fn follower_columns(&self, r: &DMatrix<f64>) -> Svd {
        Svd::new(&over_columns(r, &self.sizes).select_columns(&self.followers))
    }

    /// Returns the unknowns in the datum by the exact model, and the rigid motion that was removed. `map` is only their
    /// start: the points must be those of the fit after a rigid motion, which is no linear condition.
    fn exact_values(
        &self,
        model: &FitModel<'_>,
        data: &[Measurement],
        fit: &ParameterFit,
        theta: &[f64],
        conditions: &DMatrix<f64>,
        map: &DMatrix<f64>,
    ) -> (Vec<f64>, RigidMotionRemoved) {
        let before = Volume::of(model, data, theta);
        let mut theta: Vec<f64> = (map * DVector::from_column_slice(theta)).iter().copied().collect();
        // Errors that keep the conditions.
        let kept = Svd::new(&self.of_errors(conditions)).null_space(conditions.nrows());
        let mut rigid = (Rotation3::identity(), Vector3::zeros());
        for _ in 0..DATUM_ITERATIONS {
            let now = Volume::of(model, data, &theta);
            let (rest, motion) = best_alignment(&before.points, &now.points);
            rigid = motion;
            let sized = over_columns(&now.jacobian, &self.sizes);
            let reduced = ReducedSystem::of(&now.deformation(&(self.of_errors(&sized) * &kept)), &rest);
            let svd = Svd::new(&reduced.r);
            let step = &kept * svd.solve(&reduced.right, svd.rank(DATUM_STEP_TOLERANCE));
            let own = (0..theta.len()).filter(|j| self.errors[*j]);
            own.enumerate().for_each(|(k, j)| theta[j] += step[k] / self.sizes[j]);
        }
        follow(model, data, &fit.weights, &mut theta, &self.followers);
        let (rotation, translation) = rigid;
        let removed = RigidMotionRemoved {
            conditions: conditions.nrows(),
            translation: translation.into(),
            rotation: rotation.scaled_axis().into(),
            removes_weak: self.has_weak,
        };
        (theta, removed)
    }

    /// Selects the columns of the machine's errors.
    fn of_errors(&self, rows: &DMatrix<f64>) -> DMatrix<f64> {
        let own: Vec<usize> = (0..self.errors.len()).filter(|j| self.errors[*j]).collect();
        rows.select_columns(&own)
    }

    /// Returns the errors in the datum, set-ups and instruments as they were fitted, and the workpiece where the errors
    /// that a datum took out had put it.
    fn in_data(&self, model: &FitModel<'_>, data: &[Measurement], fitted: &[f64], theta: &[f64]) -> FitInData {
        let own = |j: usize| if self.errors[j] { theta[j] } else { fitted[j] };
        let seen: Vec<f64> = (0..theta.len()).map(own).collect();
        let (then, now) = (Volume::of(model, data, fitted).points, Volume::of(model, data, &seen).points);
        let (_, (rotation, translation)) = best_alignment(&then, &now);
        let centre = middle(&now);
        FitInData {
            theta: seen,
            stand: Some(RigidMotion { rotation, translation: translation + centre - rotation * centre }),
        }
    }
}

/// Errors that turn with a rotary axis and so move the workpiece frame, but in bases that only come near to sine and
/// cosine (splines): a small part of them remains, which readings hardly separate from noise.
struct TurningErrors<'a> {
    model: &'a FitModel<'a>,
    volume: &'a Volume,
    /// The machine's errors among the unknowns.
    own: &'a [usize],
    /// Their effect on the volume, by displacements.
    jacobian: &'a DMatrix<f64>,
}

impl TurningErrors<'_> {
    /// Returns the nearly rigid combinations of the machine's errors, by displacements.
    fn all(&self) -> Vec<DVector<f64>> {
        let parameters = self.model.parameters();
        let place = |k: usize| parameters[self.own[k]].terms.first().map(|t| t.source.place);
        let located: Vec<usize> =
            (0..self.own.len()).filter(|k| matches!(place(*k), Some(ErrorSite::Location(_)))).collect();
        let locations = self.volume.deformation(&self.jacobian.select_columns(&located));
        let svd = Svd::new(&locations);
        let rank = svd.rank(RANK_TOLERANCE);
        // Adds the location errors that make the effect of a curve as rigid as they can.
        let complete = |curve: DVector<f64>| {
            let effect = self.jacobian * &curve;
            let deformation =
                self.volume.deformation(&DMatrix::from_columns(std::slice::from_ref(&effect))).column(0).into_owned();
            let others = svd.solve(&-&deformation, rank);
            let mut whole = curve;
            located.iter().zip(others.iter()).for_each(|(k, x)| whole[*k] += x);
            let is_rigid = (deformation + &locations * others).norm() < MAX_TURNING_SHARE * effect.norm();
            (effect.norm() > 0.0 && is_rigid).then_some(whole)
        };
        self.curves().into_iter().filter_map(complete).collect()
    }

    /// Returns the curves of radial errors and tilts that turn with each rotary axis or against it.
    fn curves(&self) -> Vec<DVector<f64>> {
        let axes = self.model.machines()[0].axes().iter().enumerate().filter(|(_, axis)| axis.kind == AxisKind::Rotary);
        let of_axis = |(index, axis)| {
            let conditions = AxisConditions { model: self.model, index, axis, range: axis.travel.interval() };
            [false, true].into_iter().flat_map(|turns| conditions.turning_curves(turns)).collect::<Vec<_>>()
        };
        let own = |all: DVector<f64>| DVector::from_fn(self.own.len(), |k, _| all[self.own[k]]);
        axes.flat_map(of_axis).map(own).collect()
    }
}

/// Fits the best rigid motion of points `from` to points `to`. Returns the residuals (three of each point, mm) and the
/// motion: rotation about the middle, then translation.
fn best_alignment(to: &[Vector3<f64>], from: &[Vector3<f64>]) -> (DVector<f64>, (Rotation3<f64>, Vector3<f64>)) {
    let centre = middle(from);
    let (mut rotation, mut translation) = (Rotation3::identity(), Vector3::zeros());
    let mut rest = Vec::new();
    for _ in 0..DATUM_ITERATIONS {
        let place = |p: &Vector3<f64>| rotation * (p - centre) + centre + translation;
        rest = to.iter().zip(from).map(|(to, from)| to - place(from)).collect::<Vec<Vector3<f64>>>();
        let mut triangle = Triangle::new(6);
        for (rest, from) in rest.iter().zip(from) {
            let arm = rotation * (from - centre) / LEVER_MM;
            for i in 0..3 {
                let turn = |k: usize| Vector3::ith(k, 1.0).cross(&arm)[i];
                let row = (0..6).map(|k| if k < 3 { f64::from(u8::from(i == k)) } else { turn(k - 3) });
                triangle.push(row, rest[i]);
            }
        }
        let reduced = triangle.finish();
        let svd = Svd::new(&reduced.r);
        let step = svd.solve(&reduced.right, svd.rank(DESIGN_RANK_TOLERANCE));
        translation += Vector3::new(step[0], step[1], step[2]);
        rotation = Rotation3::new(Vector3::new(step[3], step[4], step[5]) / LEVER_MM) * rotation;
    }
    (DVector::from_fn(3 * rest.len(), |i, _| rest[i / 3][i % 3]), (rotation, translation))
}

/// Returns the conditions of a datum (rows, by displacements of the unknowns) in the order in which they count.
fn conditions_of(model: &FitModel<'_>, data: &[Measurement], conditions: &DatumConditions) -> Vec<DVector<f64>> {
    let machine = &model.machines()[0];
    let measured = measured_ranges(model, data);
    let of_axis = |(index, axis): (usize, &Axis)| {
        let range = measured[index].unwrap_or_else(|| axis.travel.interval());
        AxisConditions { model, index, axis, range }.rows(conditions.entry)
    };
    let mut rows: Vec<DVector<f64>> = machine.axes().iter().enumerate().flat_map(of_axis).collect();
    let parameters = model.parameters();
    let location = |p: &Parameter| matches!(p.terms.first().map(|t| t.source.place), Some(ErrorSite::Location(_)));
    let straight = conditions.entry.squareness == SquarenessSite::Straightness;
    let linear = |p: &Parameter| match p.terms.first().map(|t| t.source.place) {
        Some(ErrorSite::Location(i)) => machine.axes().get(i).is_some_and(|axis| axis.kind == AxisKind::Linear),
        _ => false,
    };
    let is_redundant = |p: &Parameter| conditions.redundant_locations.contains(&p.name) || (straight && linear(p));
    let held = (0..parameters.len()).filter(|j| location(&parameters[*j]) && is_redundant(&parameters[*j]));
    rows.extend(held.map(|j| DVector::from_fn(parameters.len(), |k, _| f64::from(u8::from(j == k)))));
    rows.retain(|row| row.norm() > 0.0);
    rows
}

/// Returns for each axis with fitted curves the range (mm, deg) in which it was measured, if that is shorter than the
/// travel. An axis that stood still, or that turns without end, has none.
pub fn measured_ranges(model: &FitModel<'_>, data: &[Measurement]) -> Vec<Option<(f64, f64)>> {
    let machine = &model.machines()[0];
    let terms = || model.parameters().iter().flat_map(|p| &p.terms);
    let curved = |index: usize| terms().any(|t| t.source.place == ErrorSite::Component(index));
    let mut ranges = vec![(f64::INFINITY, f64::NEG_INFINITY); machine.axes().len()];
    for pose in data.iter().flat_map(Measurement::poses) {
        ranges.iter_mut().zip(pose).for_each(|(range, q)| *range = (range.0.min(*q), range.1.max(*q)));
    }
    let shorter = |(index, (axis, range)): (usize, (&Axis, (f64, f64)))| {
        let (min, max) = axis.travel.interval();
        let width = range.1 - range.0;
        let endless = axis.travel == Travel::Continuous;
        (curved(index) && !endless && 0.0 < width && width < MIN_WHOLE_RANGE_SHARE * (max - min)).then_some(range)
    };
    machine.axes().iter().zip(ranges).enumerate().map(shorter).collect()
}

struct AxisConditions<'a> {
    model: &'a FitModel<'a>,
    index: usize,
    axis: &'a Axis,
    /// Positions over which curves are judged: the travel, or the measured part of it.
    range: (f64, f64),
}

impl AxisConditions<'_> {
    fn rows(&self, entry: DatumEntry) -> Vec<DVector<f64>> {
        let along = Vector3::from(self.axis.direction).normalize();
        let across = self.across();
        let at_zero = self.axis.datum_zero(entry.zero, self.range.into());
        let value = |direction: &Vector3<f64>, turns: bool| {
            at_zero.map(|q| self.mean_displacement(direction, turns, &[q], |_| 1.0))
        };
        if self.axis.kind == AxisKind::Linear {
            let angles = (0..3).filter_map(|k| value(&Vector3::ith(k, 1.0), true));
            let straight = across.iter().flat_map(|direction| self.line(direction, entry));
            return value(&along, false).into_iter().chain(angles).chain(straight).collect();
        }
        let own = [value(&along, false), value(&along, true)].into_iter().flatten();
        let turning = [false, true].into_iter().flat_map(|turns| self.turning(&across, turns));
        if entry.line == DatumLine::Free { own.collect() } else { own.chain(turning).collect() }
    }

    /// Returns two orthonormal directions across the axis.
    fn across(&self) -> [Vector3<f64>; 2] {
        let along = Vector3::from(self.axis.direction).normalize();
        let least = (0..3).fold(0, |l, k| if along[k].abs() < along[l].abs() { k } else { l });
        let first = Vector3::ith(least, 1.0).cross(&along).normalize();
        [first, along.cross(&first)]
    }

    /// Returns the curves of radial errors, or of tilts (`turns`), that come nearest to a vector across the axis which
    /// turns with it or against it, by displacements. Bases that come near to none have none.
    fn turning_curves(&self, turns: bool) -> Vec<DVector<f64>> {
        let (sites, [first, second]) = (self.sites(), self.across());
        let rows: Vec<DVector<f64>> = sites
            .iter()
            .flat_map(|q| (0..3).map(|k| self.mean_displacement(&Vector3::ith(k, 1.0), turns, &[*q], |_| 1.0)))
            .collect();
        let width = self.model.parameters().len();
        let matrix = DMatrix::from_fn(rows.len(), width, |i, j| rows[i][j]);
        let svd = Svd::new(&matrix);
        let rank = svd.rank(RANK_TOLERANCE);
        let nearest = |sense: f64, phase: f64| {
            let vector = |i: usize| {
                let (sine, cosine) = libm::sincos((sites[i / 3] + phase).to_radians());
                (first * cosine + second * (sense * sine))[i % 3]
            };
            let wanted = DVector::from_fn(rows.len(), |i, _| vector(i));
            let curve = svd.solve(&wanted, rank);
            ((&matrix * &curve - &wanted).norm() < MAX_TURNING_SHARE * wanted.norm()).then_some(curve)
        };
        [(1.0, 0.0), (1.0, 90.0), (-1.0, 0.0), (-1.0, 90.0)].into_iter().filter_map(|(s, p)| nearest(s, p)).collect()
    }

    /// Returns the straight line of a straightness: where it is, and its slope.
    fn line(&self, direction: &Vector3<f64>, entry: DatumEntry) -> Vec<DVector<f64>> {
        let (min, max) = self.range;
        let sites = self.sites();
        let relative = |q: f64| (2.0 * q - min - max) / (max - min).max(f64::MIN_POSITIVE);
        let places = match entry.line {
            DatumLine::Free => return Vec::new(),
            DatumLine::LeastSquares => sites,
            DatumLine::EndPoints => vec![min, max],
        };
        let mean = self.mean_displacement(direction, false, &places, |_| 1.0);
        let slope = self.mean_displacement(direction, false, &places, relative);
        if entry.squareness == SquarenessSite::Straightness { vec![mean] } else { vec![mean, slope] }
    }

    /// Returns the conditions on radial errors, or tilts, of a rotary axis: their mean, and the part that turns with
    /// the axis or against it, are 0.
    fn turning(&self, across: &[Vector3<f64>; 2], turns: bool) -> Vec<DVector<f64>> {
        let sites = self.sites();
        let part = |k: usize, of: &dyn Fn(f64) -> f64| self.mean_displacement(&across[k], turns, &sites, of);
        let mut rows = vec![part(0, &|_| 1.0), part(1, &|_| 1.0)];
        for sense in [1.0, -1.0] {
            let cosine = |q: f64| libm::cos(q.to_radians());
            let sine = move |q: f64| sense * libm::sin(q.to_radians());
            rows.push(part(0, &cosine) + part(1, &sine));
            rows.push(part(1, &cosine) - part(0, &sine));
        }
        rows
    }

    fn sites(&self) -> Vec<f64> {
        let (min, max) = self.range;
        (0..DATUM_SITES).map(|i| min + (max - min) * (i as f64 + 0.5) / DATUM_SITES as f64).collect()
    }

    /// Returns for each unknown the weighted mean over positions of the displacement that it makes along (`turns`:
    /// about) a direction: `1/n sum w(q) e(q) . direction`.
    fn mean_displacement(
        &self,
        direction: &Vector3<f64>,
        turns: bool,
        sites: &[f64],
        weight: impl Fn(f64) -> f64,
    ) -> DVector<f64> {
        let parameters = self.model.parameters();
        let component = |t: &ParameterTerm| -> f64 {
            let k = t.source.direction.index();
            let mine = t.source == Source { place: ErrorSite::Component(self.index), direction: Direction::ALL[k] };
            if mine && (k >= 3) == turns { direction[k % 3] } else { 0.0 }
        };
        let value = |p: &Parameter, q: f64| -> f64 {
            let terms = p.terms.iter().map(|t| (component(t), t)).filter(|(c, _)| *c != 0.0);
            let of = |(c, t): (f64, &ParameterTerm)| {
                let basis = if t.basis == BasisFunction::Constant { 1.0 } else { t.basis.value(q) };
                c * t.factor * approach_weight(t.approach, Approach::Mean) * basis * lever(t.source.direction)
            };
            terms.map(of).sum()
        };
        let mean = |p: &Parameter| sites.iter().map(|q| weight(*q) * value(p, *q)).sum::<f64>() / sites.len() as f64;
        DVector::from_iterator(parameters.len(), parameters.iter().map(|p| mean(p) / p.size))
    }
}
