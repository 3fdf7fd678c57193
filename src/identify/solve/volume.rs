//! The worth of a fit where nothing was measured: the uncertainty of the deviation over the whole volume, after the
//! best rigid motion of the workpiece frame.

use super::fit::Fit;
use super::solution::Solution;
use crate::identify::data::Measurement;
use crate::identify::model::{Model, Volume};
use crate::machine::{Pose, ResidualForm};
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
        let variance = |i: usize| {
            let block = jacobian.rows(3 * i, 3) * columns.columns(3 * i, 3);
            Matrix3::from_fn(|r, c| 0.5 * (block[(r, c)] + block[(c, r)])).symmetric_eigenvalues().max()
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
            let form: f64 = forms.iter().map(|form| form.size * form.size).sum();
            let known = Spread::Known(libm::sqrt(variance.max(0.0) + form));
            (at, if solution.freedom > 0 { known } else { Spread::Unknown })
        };
        let (pose, tool) = volume.rows.get(at).map(|m| (m.pose.clone(), m.tool)).unwrap_or_default();
        Self { spread, pose, tool, deviation }
    }
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
