//! Uncertainty of the deviation that a fit predicts over the whole volume, after the best rigid motion of the workpiece
//! frame.

use super::fit::ParameterFit;
use super::solution::Solution;
use crate::identify::data::Measurement;
use crate::identify::model::{BasisFunction, FitModel, Parameter, Volume};
use crate::identify::thresholds::MIN_FREE_EFFECT_MM;
use crate::lower::{ErrorSite, Source};
use crate::machine::{Direction, Machine, Pose, ResidualForm};
use nalgebra::{DMatrix, Matrix3};

/// Uncertainty of the deviation at the worst pose.
#[derive(Debug, Clone, PartialEq)]
pub enum DeviationUncertainty {
    /// Standard uncertainty (mm), along the direction in which it is largest.
    Known(f64),
    /// There are no residual degrees of freedom.
    Unknown,
    /// The null space changes the deviation: a combination of parameters, in words.
    Free(String),
}

/// The prediction of a fitted machine over its volume.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// The largest uncertainty of the deviation.
    pub uncertainty: DeviationUncertainty,
    /// The pose at which it is (mm, deg).
    pub pose: Pose,
    /// Index of the tool there.
    pub tool: usize,
    /// The largest deviation that is predicted (mm).
    pub deviation: f64,
}

impl Prediction {
    /// Predicts with a fit; bounds on slopes hold curves beyond the readings. The form of the axes beside the curves
    /// adds to the uncertainty everywhere.
    pub fn of(
        model: &FitModel<'_>,
        data: &[Measurement],
        fit: &ParameterFit,
        solution: &Solution,
        forms: &[ResidualForm],
    ) -> Self {
        let theta = solution.theta();
        let volume = Volume::of(model, data, &theta);
        let jacobian = volume.deformation(&volume.jacobian);
        let deviations =
            volume.deformation(&DMatrix::from_column_slice(volume.deviations.len(), 1, volume.deviations.as_slice()));
        let length = |i: usize| deviations.fixed_view::<3, 1>(3 * i, 0).norm();
        let deviation = (0..volume.rows.len()).map(length).fold(0.0, f64::max);
        let bounded = fit_with_bounds(model, fit);
        let sharing = |held: &ParameterFit| Solution::of(held, model.parameters()).add_covariances_of(solution, fit);
        let held = bounded.as_ref().map(sharing);
        let solution = held.as_ref().unwrap_or(solution);
        let (columns, free) = solution.covariance_with(&jacobian);
        let part = |i: usize| free.rows(3 * i, 3).norm();
        let beside = form_covariances(model, &volume.rows, forms);
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
        // What no plausible amount moves by more than a reading scatters is as good as held.
        let least = MIN_FREE_EFFECT_MM.max(solution.sigma / fit.plausible_mm());
        let (at, uncertainty) = if size > least {
            let words = solution.worst_null_direction(&jacobian, model.parameters()).unwrap_or_default();
            (freest, DeviationUncertainty::Free(words))
        } else {
            let (at, variance) = worst(&variance);
            let known = DeviationUncertainty::Known(libm::sqrt(variance.max(0.0)));
            (at, if solution.degrees_of_freedom > 0 { known } else { DeviationUncertainty::Unknown })
        };
        let (pose, tool) = volume.rows.get(at).map(|m| (m.pose.clone(), m.tool)).unwrap_or_default();
        Self { uncertainty, pose, tool, deviation }
    }
}

/// Returns the covariances (mm^2) of the deviations at poses by the forms of axes: the same everywhere by
/// displacements, by their lever arms of rotations.
fn form_covariances(model: &FitModel<'_>, poses: &[Measurement], forms: &[ResidualForm]) -> Vec<Matrix3<f64>> {
    let Some(machine) = model.machines().first() else { return Vec::new() };
    let scattering = forms.iter().flat_map(|form| form_errors(machine, form));
    let (errors, scatter): (Vec<Parameter>, Vec<f64>) = scattering.unzip();
    let (model, none) = (model.with_parameters(&errors), vec![0.0; errors.len()]);
    let at = |pose: &Measurement| {
        let (effects, _) = model.rows(pose, &none);
        let parts = effects.iter().zip(&scatter).map(|(effect, scatter)| effect * effect.transpose() * *scatter);
        parts.sum()
    };
    poses.iter().map(at).collect()
}

/// Returns the six errors of an axis with the variances of its form.
fn form_errors(machine: &Machine, form: &ResidualForm) -> Vec<(Parameter, f64)> {
    let Some(axis) = machine.axis_index(form.axis.as_str()) else { return Vec::new() };
    let error = |direction: &Direction| {
        let source = Source { place: ErrorSite::Component(axis), direction: *direction };
        let scatter = form.scatter(*direction);
        (Parameter::single(machine, String::new(), source, BasisFunction::Constant, 0.0), scatter * scatter)
    };
    Direction::ALL.iter().map(error).collect()
}

/// Returns the fit with its bounds on slopes among the known values; `None` without bounds.
fn fit_with_bounds(model: &FitModel<'_>, fit: &ParameterFit) -> Option<ParameterFit> {
    let (slopes, before) = (model.slope_rows(), fit.known.nrows());
    if slopes.nrows() == 0 {
        return None;
    }
    let mut known = fit.known.clone().insert_rows(before, slopes.nrows(), 0.0);
    known.rows_mut(before, slopes.nrows()).copy_from(slopes);
    Some(ParameterFit { known, ..fit.clone() })
}
