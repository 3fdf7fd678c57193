//! Invariances of the model itself, before a fit and at its solution: what may happen to the whole machine without any
//! reading that notices.
//!
//! A stretch of the whole machine (a similarity, or a stretch along some directions) matters where readings only say
//! that points are the same: they fit the better the smaller the machine is, and the best machine is a point.
//! Rigid motions
//! of the whole machine only move the workpiece frame.

use super::parameter::{Parameter, sizes};
use super::prediction::FitModel;
use super::volume::{Volume, middle};
use crate::algebra::linear::{Svd, Triangle, over_columns};
use crate::identify::data::{Measurement, Reading, ReadingKind};
use crate::identify::thresholds::*;
use crate::units::significant;
use nalgebra::{DMatrix, DVector, Matrix3, RowDVector, Vector3};

/// Changes of the whole machine that no reading notices.
#[derive(Debug, Clone, PartialEq)]
pub struct Invariances {
    /// Stretches of the machine that the readings would shrink to a point: in words, with the parameters that make
    /// them.
    pub stretches: Vec<(String, Vec<String>)>,
    /// Rigid motions of the whole machine, in words: `along X`, `about X`.
    pub motions: Vec<String>,
    /// The unknowns that make them, as displacements.
    pub motion_parameters: Vec<DVector<f64>>,
}

/// Finds the invariances of a model with these data at values of its unknowns.
pub fn invariances(model: &FitModel<'_>, data: &[Measurement], theta: &[f64]) -> Invariances {
    let volume = Volume::of(model, data, theta);
    let equations = MotionEquations::of(model, data, theta, &volume);
    let mut stretches = Vec::new();
    if same_points(model, data) {
        stretches = equations.stretches(model, &volume);
        // Derivatives notice a change of size by the residuals, which shrink with it.
        let other_sizes = SCALES.iter().filter_map(|scale| rescaled(model, data, theta, &volume, *scale));
        stretches.extend(other_sizes.map(|made| (WHOLE.to_owned(), parameter_names(&made, model.parameters()))));
    }
    let (motions, motion_parameters) = equations.motions(&volume);
    Invariances { stretches, motions, motion_parameters }
}

const WHOLE: &str = "the whole machine grows or shrinks";
/// Sizes of the whole machine, over that at hand, that are tried: no fit grows, and what is held may be so from a
/// smaller size on only.
const SCALES: [f64; 2] = [0.9, 0.5];

/// Returns the change of the unknowns, as displacements, that makes the machine `scale` times as large, the residuals
/// too; `None` if the unknowns cannot make it, or if a reading or what is known before the data notices.
fn rescaled(
    model: &FitModel<'_>,
    data: &[Measurement],
    theta: &[f64],
    volume: &Volume,
    scale: f64,
) -> Option<DVector<f64>> {
    let sizes = sizes(model.parameters());
    let (slopes, (known, _)) = (model.slope_rows(), model.known_rows(theta));
    let held = DMatrix::from_fn(slopes.nrows() + known.nrows(), theta.len(), |i, j| {
        let row = if i < slopes.nrows() { slopes[(i, j)] } else { known[(i - slopes.nrows(), j)] };
        row / sizes[j]
    });
    let held = Svd::new(&held);
    let free = held.null_space(held.rank(RANK_TOLERANCE));
    let centre = middle(&volume.points);
    let grown: Vec<Vector3<f64>> = volume.points.iter().map(|p| (p - centre) * (scale - 1.0)).collect();
    let size = libm::sqrt(grown.iter().map(|v| v.norm_squared()).sum::<f64>() / grown.len().max(1) as f64);
    let left = model.residuals(data, theta);
    let root = libm::sqrt(grown.len() as f64 / data.len().max(1) as f64).max(1.0);
    // Free directions, then a translation of the whole.
    let width = free.ncols() + 3;
    let (mut made, mut shift) = (DVector::zeros(theta.len()), Vector3::zeros());
    for _ in 0..DATUM_ITERATIONS {
        let there: Vec<f64> = (0..theta.len()).map(|j| theta[j] + made[j] / sizes[j]).collect();
        let now = Volume::of(model, data, &there);
        let effects = over_columns(&now.jacobian, &sizes) * &free;
        let mut triangle = Triangle::new(width);
        let gap = |i: usize| volume.points[i] + grown[i] + shift - now.points[i];
        for i in 0..effects.nrows() {
            let moved = (0..3).map(|k| -f64::from(u8::from(k == i % 3)));
            triangle.push(effects.row(i).iter().copied().chain(moved), gap(i / 3)[i % 3]);
        }
        let mut noticed = 0.0_f64;
        for (m, left) in data.iter().zip(&left) {
            let (columns, rest) = model.rows(m, &there);
            let (missed, seen) = (rest - left * scale, m.reading_mask());
            for k in (0..3).filter(|k| seen[*k]) {
                let row = RowDVector::from_fn(columns.len(), |_, j| columns[j][k] / sizes[j]) * &free * root;
                noticed = noticed.max(missed[k].abs());
                triangle.push(row.iter().copied().chain([0.0; 3]), missed[k] * root);
            }
        }
        let off = (0..grown.len()).map(|i| gap(i).norm()).fold(0.0, f64::max);
        if off < MAX_MOTION_RESIDUAL * size && noticed < MAX_UNNOTICED_SIZE_SHARE * size {
            return Some(made);
        }
        let reduced = triangle.finish();
        let svd = Svd::new(&reduced.r);
        let step = svd.solve(&reduced.right, svd.rank(VOLUME_RANK_TOLERANCE));
        made += &free * step.rows(0, free.ncols());
        shift += Vector3::from_fn(|k, _| step[free.ncols() + k]);
    }
    None
}

/// True if some readings only say that points are the same.
fn same_points(model: &FitModel<'_>, data: &[Measurement]) -> bool {
    let mut places: std::collections::BTreeMap<[Option<usize>; 3], Vec<Vector3<f64>>> = Default::default();
    if data.iter().any(|m| m.kind() == ReadingKind::Touch) {
        return true;
    }
    for m in data {
        let Reading::Deviation { zero, .. } = &m.reading else { continue };
        if zero.iter().all(Option::is_some) {
            let nominal = crate::lower::NominalPose::in_part(model.machine(m), &m.pose).pose.translation;
            places.entry(*zero).or_default().push(nominal + m.values());
        }
    }
    let alike = |list: &Vec<Vector3<f64>>| list.iter().all(|place| (place - list[0]).norm() < SAME_POINT_MM);
    places.values().any(|list| list.len() > 1 && alike(list))
}

/// Equations for motions of the whole machine: rows for the effect of the unknowns on the volume, then for their effect
/// on the readings and on what is known of them.
struct MotionEquations {
    /// Columns are the unknowns, then translations of the frame, as displacements.
    system: DMatrix<f64>,
    unknowns: usize,
    /// Length of the column of each unknown in the readings.
    effects: DVector<f64>,
}

impl MotionEquations {
    fn of(model: &FitModel<'_>, data: &[Measurement], theta: &[f64], volume: &Volume) -> Self {
        let unknowns = theta.len();
        let sizes = sizes(model.parameters());
        let mut readings = model.triangle(data, &vec![1.0; data.len()], theta).r;
        let (slopes, (known, _)) = (model.slope_rows(), model.known_rows(theta));
        let mut held = DMatrix::zeros(unknowns + slopes.nrows() + known.nrows(), unknowns);
        let rows: usize = data.iter().map(Measurement::readings).sum();
        // Readings count at least as much as poses of the volume.
        readings *= libm::sqrt(volume.jacobian.nrows() as f64 / rows.max(1) as f64).max(1.0);
        held.rows_mut(0, unknowns).copy_from(&readings);
        held.rows_mut(unknowns, slopes.nrows()).copy_from(slopes);
        held.rows_mut(unknowns + slopes.nrows(), known.nrows()).copy_from(&known);
        let (above, below) = (volume.jacobian.nrows(), held.nrows());
        let entry = |i: usize, j: usize| match (i < above, j < unknowns) {
            (true, true) => volume.jacobian[(i, j)] / sizes[j],
            (true, false) => f64::from(u8::from(i % 3 == j - unknowns)),
            (false, true) => held[(i - above, j)] / sizes[j],
            (false, false) => 0.0,
        };
        let system = DMatrix::from_fn(above + below, unknowns + 3, entry);
        let effects = DVector::from_fn(unknowns, |j, _| held.column(j).norm() / sizes[j]);
        Self { system, unknowns, effects }
    }

    /// Returns the combinations of motions (columns over the volume) that the unknowns make and no reading notices: the
    /// amount of each motion, and the unknowns (as displacements) that make it.
    fn invariant_combinations(&self, motions: &DMatrix<f64>) -> Vec<(DVector<f64>, DVector<f64>)> {
        let (width, count) = (self.system.ncols(), motions.ncols());
        let mut triangle = Triangle::new(width + count);
        for i in 0..self.system.nrows() {
            let motion = |k: usize| if i < motions.nrows() { motions[(i, k)] } else { 0.0 };
            triangle.push(self.system.row(i).iter().copied().chain((0..count).map(motion)), 0.0);
        }
        let whole = triangle.finish().r;
        let (own, wanted) = (whole.columns(0, width).into_owned(), whole.columns(width, count).into_owned());
        let lengths = DVector::from_fn(count, |k, _| wanted.column(k).norm().max(f64::MIN_POSITIVE));
        let wanted = DMatrix::from_fn(wanted.nrows(), count, |i, k| wanted[(i, k)] / lengths[k]);
        let svd = Svd::new(&own);
        let rank = svd.rank(VOLUME_RANK_TOLERANCE);
        let seen = svd.u.columns(0, rank).into_owned();
        // The part of each motion that the unknowns cannot make without a reading that notices.
        let residual = Svd::new(&(&wanted - &seen * seen.tr_mul(&wanted)));
        let made = (0..count).filter(|k| residual.values[*k] < MAX_MOTION_RESIDUAL);
        let one = |k: usize| {
            let mix = residual.v.column(k).into_owned();
            let made = svd.solve(&(&wanted * &mix), rank);
            (mix.component_div(&lengths), made.rows(0, self.unknowns).into_owned())
        };
        made.map(one).collect()
    }

    /// Returns the stretches that change readings, but only by shrinking them.
    fn stretches(&self, model: &FitModel<'_>, volume: &Volume) -> Vec<(String, Vec<String>)> {
        let unit = |i: usize, j: usize| {
            let mut map = Matrix3::zeros();
            (map[(i, j)], map[(j, i)]) = (1.0, 1.0);
            map
        };
        let maps = [unit(0, 0), unit(1, 1), unit(2, 2), unit(0, 1), unit(0, 2), unit(1, 2)];
        // Turning is no stretch.
        let stretched = volume.deformation(&volume.displacements_by(&maps));
        let found = self.without_rigid_motion(volume).invariant_combinations(&stretched);
        let acts = |made: &DVector<f64>| made.component_mul(&self.effects).amax() > MAX_MOTION_RESIDUAL * made.amax();
        // Unit length over the volume: errors beyond all measure make it by their products with other errors only.
        let largest = MAX_STRETCH_AMOUNT / libm::sqrt(stretched.nrows() as f64);
        // A shear keeps the volume: squareness that no reading holds, and no machine that shrinks.
        let grows = |mix: &DVector<f64>| mix.rows(0, 3).sum().abs() > MIN_STRETCH_PART_SHARE * mix.amax();
        let acting = found.into_iter().filter(|(mix, made)| acts(made) && made.amax() < largest && grows(mix));
        acting.map(|(mix, made)| (describe_stretch(&mix), parameter_names(&made, model.parameters()))).collect()
    }

    /// Returns the equations with the volume free of rigid motions.
    fn without_rigid_motion(&self, volume: &Volume) -> Self {
        let mut system = self.system.clone();
        let above = volume.jacobian.nrows();
        let free = volume.deformation(&self.system.rows(0, above).into_owned());
        system.rows_mut(0, above).copy_from(&free);
        Self { system, unknowns: self.unknowns, effects: self.effects.clone() }
    }

    /// Returns the rigid motions of the whole machine that no reading notices, in words, and the unknowns that make
    /// them.
    fn motions(&self, volume: &Volume) -> (Vec<String>, Vec<DVector<f64>>) {
        let motions = volume.motions();
        // Translations of the frame are among the motions here.
        let system = self.system.columns(0, self.unknowns).into_owned();
        let bare = Self { system, unknowns: self.unknowns, effects: self.effects.clone() };
        let lengths = DVector::from_fn(6, |k, _| motions.column(k).norm());
        // Orthonormal, motions of unit length.
        let (found, moving): (Vec<DVector<f64>>, Vec<DVector<f64>>) = bare
            .invariant_combinations(&motions)
            .into_iter()
            .map(|(mix, made)| (mix.component_mul(&lengths), made))
            .unzip();
        let free = |k: &usize| found.iter().map(|mix| mix[*k] * mix[*k]).sum::<f64>() > 1.0 - MAX_MOTION_RESIDUAL;
        let words = ["along X", "along Y", "along Z", "about X", "about Y", "about Z"];
        ((0..6).filter(free).map(|k| words[k].to_owned()).collect(), moving)
    }
}

fn describe_stretch(mix: &DVector<f64>) -> String {
    let largest = mix.amax();
    let first = (0..6).find(|k| mix[*k].abs() > MIN_STRETCH_PART_SHARE * largest).map_or(1.0, |k| mix[k]);
    let amounts: Vec<(usize, f64)> =
        (0..6).filter(|k| mix[*k].abs() > MIN_STRETCH_PART_SHARE * largest).map(|k| (k, mix[k] / first)).collect();
    if let [(0, a), (1, b), (2, c)] = amounts[..]
        && [a, b, c].iter().all(|x| (x - 1.0).abs() < MIN_STRETCH_PART_SHARE)
    {
        return WHOLE.to_owned();
    }
    let axes = ["X", "Y", "Z", "X-Y", "X-Z", "Y-Z"];
    let part = |(k, amount): &(usize, f64)| match amounts.len() {
        1 => axes[*k].to_owned(),
        _ => format!("{} (by {})", axes[*k], significant(*amount, 2)),
    };
    let parts: Vec<String> = amounts.iter().map(part).collect();
    format!("the machine grows or shrinks along {}", parts.join(", "))
}

/// Returns the names of the machine's parameters that take part.
fn parameter_names(made: &DVector<f64>, parameters: &[Parameter]) -> Vec<String> {
    let own = |j: &usize| !parameters[*j].is_nuisance();
    let largest = (0..made.len()).filter(own).map(|j| made[j].abs()).fold(0.0, f64::max);
    let part = (0..made.len()).filter(own).filter(|j| made[*j].abs() > MIN_STRETCH_PARAMETER_SHARE * largest);
    part.map(|j| parameters[j].name.clone()).collect()
}
