//! The worth of a fit where nothing was measured: the uncertainty of the deviation over the whole volume, after the
//! best rigid motion of the workpiece frame.

use super::fit::Fit;
use super::solution::Solution;
use crate::identify::data::Measurement;
use crate::identify::model::{Basis, Model, Parameter, Volume};
use crate::lower::{ErrorSite, Source};
use crate::machine::{Direction, Machine, Pose, ResidualForm};
use nalgebra::{DMatrix, Matrix3};

/// A free direction of unit size (mm) that moves points by more than this (mm) changes the deviation.
const CHANGED: f64 = 1e-3;

/// Knowledge of the deviation.
#[derive(Debug, Clone, PartialEq)]
pub enum Spread {
    /// Standard uncertainty (mm), along the direction in which it is largest.
    Known(f64),
    /// The readings have none to spare, so that nothing scatters.
    Unknown,
    /// The data leave it free: a combination of parameters, in words, that changes it and no reading.
    Free(String),
}

/// The prediction of a fitted machine over its volume.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// The largest uncertainty of the deviation.
    pub spread: Spread,
    /// The pose at which it is (mm, deg).
    pub pose: Pose,
    /// Index of the tool there.
    pub tool: usize,
    /// The largest deviation that is predicted (mm).
    pub deviation: f64,
}

impl Prediction {
    /// Predicts with a fit; bounds on slopes hold curves where nothing was measured. The form of the axes beside the
    /// curves adds to the uncertainty everywhere.
    pub fn of(
        model: &Model<'_>,
        data: &[Measurement],
        (fit, solution): (&Fit, &Solution),
        forms: &[ResidualForm],
    ) -> Self {
        let theta = solution.theta();
        let volume = Volume::of(model, data, &theta);
        let jacobian = volume.deformation(&volume.jacobian);
        let deviations =
            volume.deformation(&DMatrix::from_column_slice(volume.deviations.len(), 1, volume.deviations.as_slice()));
        let length = |i: usize| deviations.fixed_view::<3, 1>(3 * i, 0).norm();
        let deviation = (0..volume.rows.len()).map(length).fold(0.0, f64::max);
        let bounded = bounded(model, fit);
        let sharing = |held: &Fit| Solution::of(held, model.parameters()).sharing_with(solution, fit);
        let held = bounded.as_ref().map(sharing);
        let solution = held.as_ref().unwrap_or(solution);
        let (columns, free) = solution.spread(&jacobian);
        let part = |i: usize| free.rows(3 * i, 3).norm();
        let beside = by_forms(model, &volume.rows, forms);
        let variance = |i: usize| {
            let block = jacobian.rows(3 * i, 3) * columns.columns(3 * i, 3);
            let symmetric = Matrix3::from_fn(|r, c| 0.5 * (block[(r, c)] + block[(c, r)]));
            (symmetric + beside[i]).symmetric_eigenvalues().max()
        };
        let worst = |size: &dyn Fn(usize) -> f64| {
            let farther = |a: (usize, f64), b: (usize, f64)| if b.1 > a.1 { b } else { a };
            (0..volume.rows.len()).map(|i| (i, size(i))).reduce(farther).unwrap_or((0, 0.0))
        };
        let (freest, size) = worst(&part);
        let (at, spread) = if size > CHANGED {
            let words = solution.loudest(&jacobian, model.parameters()).unwrap_or_default();
            (freest, Spread::Free(words))
        } else {
            let (at, variance) = worst(&variance);
            let known = Spread::Known(libm::sqrt(variance.max(0.0)));
            (at, if solution.freedom > 0 { known } else { Spread::Unknown })
        };
        let (pose, tool) = volume.rows.get(at).map(|m| (m.pose.clone(), m.tool)).unwrap_or_default();
        Self { spread, pose, tool, deviation }
    }
}

/// Covariances (mm^2) of the deviations at poses by the forms of axes: of displacements everywhere alike, of rotations
/// by their lever arms.
fn by_forms(model: &Model<'_>, poses: &[Measurement], forms: &[ResidualForm]) -> Vec<Matrix3<f64>> {
    let Some(machine) = model.machines().first() else { return Vec::new() };
    let scattering = forms.iter().flat_map(|form| scattering(machine, form));
    let (errors, scatter): (Vec<Parameter>, Vec<f64>) = scattering.unzip();
    let (model, none) = (model.with_parameters(&errors), vec![0.0; errors.len()]);
    let at = |pose: &Measurement| {
        let (effects, _) = model.rows(pose, &none);
        let parts = effects.iter().zip(&scatter).map(|(effect, scatter)| effect * effect.transpose() * *scatter);
        parts.sum()
    };
    poses.iter().map(at).collect()
}

/// The errors of an axis that its form moves, with their variances.
fn scattering(machine: &Machine, form: &ResidualForm) -> Vec<(Parameter, f64)> {
    let Some(axis) = machine.axis_index(form.axis.as_str()) else { return Vec::new() };
    let error = |direction: &Direction| {
        let source = Source { place: ErrorSite::Component(axis), direction: *direction };
        let scatter = form.scatter(*direction);
        (Parameter::single(machine, String::new(), source, Basis::Constant, 0.0), scatter * scatter)
    };
    Direction::ALL.iter().map(error).collect()
}

/// The fit with its bounds on slopes among what is known.
fn bounded(model: &Model<'_>, fit: &Fit) -> Option<Fit> {
    let (slopes, before) = (model.slopes(), fit.known.nrows());
    if slopes.nrows() == 0 {
        return None;
    }
    let mut known = fit.known.clone().insert_rows(before, slopes.nrows(), 0.0);
    known.rows_mut(before, slopes.nrows()).copy_from(slopes);
    Some(Fit { known, ..fit.clone() })
}
