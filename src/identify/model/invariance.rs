//! Invariances of the model itself, found before the fit: what may happen to the whole machine without any reading
//! that notices.
//!
//! A stretch of the whole machine (a similarity, or a stretch along some directions) matters where readings only say
//! that points are the same: they fit the better the smaller the machine is, and the best machine is a point.
//! Rigid motions
//! of the whole machine only move the workpiece frame.

use super::parameter::Parameter;
use super::prediction::Model;
use super::volume::Volume;
use crate::algebra::linear::{Svd, Triangle};
use crate::identify::data::{Measurement, Reading};
use crate::units::significant;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// What the parameters leave of a motion of the whole machine if they make it, as a share: errors of the file are
/// smaller.
const LEFT: f64 = 1e-2;
/// Combinations of parameters that move points by less than this share of the most visible are none.
const RANK: f64 = 1e-6;
/// Readings whose points are further apart (mm) than this say more than that points are the same.
const SAME: f64 = 1.0;
/// Parameters below this share of the largest are not named.
const NAMED: f64 = 0.05;
/// Stretches below this share of the largest are not named.
const STRETCHED: f64 = 0.02;

/// Changes of the whole machine that no reading notices.
#[derive(Debug, Clone, PartialEq)]
pub struct Invariances {
    /// Stretches of the machine that the readings would shrink to a point: what, and the parameters that make it.
    pub stretches: Vec<(String, Vec<String>)>,
    /// Rigid motions of the whole machine, in words: `along X`, `about X`.
    pub motions: Vec<String>,
    /// The unknowns that make them, as displacements.
    pub moving: Vec<DVector<f64>>,
}

/// Finds the invariances of a model with these data, at its start.
pub fn invariances(model: &Model<'_>, data: &[Measurement]) -> Invariances {
    let theta: Vec<f64> = model.parameters().iter().map(|p| p.start).collect();
    let volume = Volume::of(model, data, &theta);
    let held = Held::of(model, data, &theta, &volume);
    let stretches = if same_points(model, data) { held.stretches(model, &volume) } else { Vec::new() };
    let (motions, moving) = held.motions(&volume);
    Invariances { stretches, motions, moving }
}

/// True if some readings only say that points are the same.
fn same_points(model: &Model<'_>, data: &[Measurement]) -> bool {
    let mut places: std::collections::BTreeMap<[Option<usize>; 3], Vec<Vector3<f64>>> = Default::default();
    for m in data {
        let Reading::Deviation { zero, .. } = &m.reading else { continue };
        if zero.iter().all(Option::is_some) {
            let nominal = crate::lower::NominalPose::in_part(model.machine(m), &m.pose).pose.translation;
            places.entry(*zero).or_default().push(nominal + m.values());
        }
    }
    let alike = |list: &Vec<Vector3<f64>>| list.iter().all(|place| (place - list[0]).norm() < SAME);
    places.values().any(|list| list.len() > 1 && alike(list))
}

/// Equations by which data and parameters hold motions of the whole machine.
struct Held {
    /// Unknowns, then translations of the frame, as displacements: their effect on volume and readings.
    system: DMatrix<f64>,
    /// Number of unknowns.
    unknowns: usize,
    /// Share of the rows of the system that a row of the volume is worth.
    sizes: DVector<f64>,
    /// Effect of each unknown on the readings.
    felt: DVector<f64>,
}

impl Held {
    fn of(model: &Model<'_>, data: &[Measurement], theta: &[f64], volume: &Volume) -> Self {
        let unknowns = theta.len();
        let sizes = DVector::from_iterator(unknowns, model.parameters().iter().map(|p: &Parameter| p.size));
        let mut readings = model.triangle(data, &vec![1.0; data.len()], theta).r;
        let (slopes, (known, _)) = (model.slopes(), model.known());
        let mut held = DMatrix::zeros(unknowns + slopes.nrows() + known.nrows(), unknowns);
        let rows: usize = data.iter().map(Measurement::readings).sum();
        // As many readings as places of the volume.
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
        let felt = DVector::from_fn(unknowns, |j, _| held.column(j).norm() / sizes[j]);
        Self { system, unknowns, sizes, felt }
    }

    /// Those combinations of motions (columns over the volume) that the unknowns make and no reading notices: how much
    /// of each motion, and the unknowns (as displacements) that make it.
    fn unnoticed(&self, motions: &DMatrix<f64>) -> Vec<(DVector<f64>, DVector<f64>)> {
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
        let rank = svd.rank(RANK);
        let seen = svd.u.columns(0, rank).into_owned();
        let left = Svd::new(&(&wanted - &seen * seen.tr_mul(&wanted)));
        let made = (0..count).filter(|k| left.values[*k] < LEFT);
        let one = |k: usize| {
            let mix = left.v.column(k).into_owned();
            let made = svd.solve(&(&wanted * &mix), rank);
            (mix.component_div(&lengths), made.rows(0, self.unknowns).into_owned())
        };
        made.map(one).collect()
    }

    /// Stretches that shrink what the readings say.
    fn stretches(&self, model: &Model<'_>, volume: &Volume) -> Vec<(String, Vec<String>)> {
        let unit = |i: usize, j: usize| {
            let mut map = Matrix3::zeros();
            (map[(i, j)], map[(j, i)]) = (1.0, 1.0);
            map
        };
        let maps = [unit(0, 0), unit(1, 1), unit(2, 2), unit(0, 1), unit(0, 2), unit(1, 2)];
        // Turning is no stretch.
        let stretched = volume.deformation(&volume.mapped(&maps));
        let found = self.turned(volume).unnoticed(&stretched);
        let told = found.into_iter().filter(|(_, made)| made.component_mul(&self.felt).amax() > LEFT * made.amax());
        told.map(|(mix, made)| (stretch(&mix), names(&made, model.parameters()))).collect()
    }

    /// The same with the volume free of rigid motions.
    fn turned(&self, volume: &Volume) -> Self {
        let mut system = self.system.clone();
        let above = volume.jacobian.nrows();
        let free = volume.deformation(&self.system.rows(0, above).into_owned());
        system.rows_mut(0, above).copy_from(&free);
        Self { system, unknowns: self.unknowns, sizes: self.sizes.clone(), felt: self.felt.clone() }
    }

    /// Rigid motions of the whole machine, in words, and the unknowns that make them.
    fn motions(&self, volume: &Volume) -> (Vec<String>, Vec<DVector<f64>>) {
        let motions = volume.motions();
        // Translations are no unknowns of their own here.
        let system = self.system.columns(0, self.unknowns).into_owned();
        let bare = Self { system, unknowns: self.unknowns, sizes: self.sizes.clone(), felt: self.felt.clone() };
        let lengths = DVector::from_fn(6, |k, _| motions.column(k).norm());
        // Orthonormal, motions of unit length.
        let (found, moving): (Vec<DVector<f64>>, Vec<DVector<f64>>) =
            bare.unnoticed(&motions).into_iter().map(|(mix, made)| (mix.component_mul(&lengths), made)).unzip();
        let free = |k: &usize| found.iter().map(|mix| mix[*k] * mix[*k]).sum::<f64>() > 1.0 - LEFT;
        let words = ["along X", "along Y", "along Z", "about X", "about Y", "about Z"];
        ((0..6).filter(free).map(|k| words[k].to_owned()).collect(), moving)
    }
}

/// A stretch, in words.
fn stretch(mix: &DVector<f64>) -> String {
    let largest = mix.amax();
    let first = (0..6).find(|k| mix[*k].abs() > STRETCHED * largest).map_or(1.0, |k| mix[k]);
    let amounts: Vec<(usize, f64)> =
        (0..6).filter(|k| mix[*k].abs() > STRETCHED * largest).map(|k| (k, mix[k] / first)).collect();
    if let [(0, a), (1, b), (2, c)] = amounts[..]
        && [a, b, c].iter().all(|x| (x - 1.0).abs() < STRETCHED)
    {
        return "the whole machine grows or shrinks".to_owned();
    }
    let axes = ["X", "Y", "Z", "X-Y", "X-Z", "Y-Z"];
    let part = |(k, amount): &(usize, f64)| match amounts.len() {
        1 => axes[*k].to_owned(),
        _ => format!("{} (by {})", axes[*k], significant(*amount, 2)),
    };
    let parts: Vec<String> = amounts.iter().map(part).collect();
    format!("the machine grows or shrinks along {}", parts.join(", "))
}

/// The machine's parameters that take part.
fn names(made: &DVector<f64>, parameters: &[Parameter]) -> Vec<String> {
    let own = |j: &usize| !parameters[*j].is_nuisance();
    let largest = (0..made.len()).filter(own).map(|j| made[j].abs()).fold(0.0, f64::max);
    let part = (0..made.len()).filter(own).filter(|j| made[*j].abs() > NAMED * largest);
    part.map(|j| parameters[j].name.clone()).collect()
}
