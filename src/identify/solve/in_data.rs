//! A fitted machine as the readings see it. A datum moves the workpiece frame of the machine that is stated; readings
//! were taken in the frame before, and what is left of them is left there. No motion is fitted for it: six freedoms
//! would swallow part of what is left.

use crate::algebra::linear::{Svd, over_columns};
use crate::identify::data::Measurement;
use crate::identify::model::{FitModel, RigidMotion, sizes};
use crate::identify::thresholds::*;
use nalgebra::{DMatrix, Vector3};

/// Unknowns of a fit with the frame of its readings.
#[derive(Debug, Clone, PartialEq)]
pub struct FitInData {
    /// Errors as they are stated, set-ups and instruments as they were fitted.
    pub theta: Vec<f64>,
    /// Motion of the stated machine's points to where the readings found them; `None` without a datum.
    pub stand: Option<RigidMotion>,
}

impl FitInData {
    /// Returns the model in the frame of the readings.
    pub fn model<'a>(&self, model: &FitModel<'a>) -> FitModel<'a> {
        self.stand.map_or_else(|| model.clone(), |stand| model.clone().moved(stand))
    }

    /// Returns measured minus predicted readings.
    pub fn residuals(&self, model: &FitModel<'_>, data: &[Measurement]) -> Vec<Vector3<f64>> {
        self.model(model).residuals(data, &self.theta)
    }

    /// Returns the residuals of the machine at the start of its unknowns in the same frame, instruments and set-ups
    /// fitted to it.
    pub fn residuals_before(&self, model: &FitModel<'_>, data: &[Measurement], weights: &[f64]) -> Vec<Vector3<f64>> {
        let here = self.model(model);
        let parameters = model.parameters();
        let start = |j: usize| if j < model.own() { parameters[j].start } else { self.theta[j] };
        let mut theta: Vec<f64> = (0..parameters.len()).map(start).collect();
        follow(&here, data, weights, &mut theta, &(model.own()..parameters.len()).collect::<Vec<_>>());
        here.residuals(data, &theta)
    }
}

/// Fits some unknowns, such as set-ups and instruments, to the readings again; the others are held.
pub(super) fn follow(
    model: &FitModel<'_>,
    data: &[Measurement],
    weights: &[f64],
    theta: &mut [f64],
    followers: &[usize],
) {
    if followers.is_empty() {
        return;
    }
    let sizes = sizes(model.parameters());
    for _ in 0..DATUM_ITERATIONS {
        let reduced = model.triangle(data, weights, theta);
        let columns: DMatrix<f64> = over_columns(&reduced.r, &sizes).select_columns(followers);
        let svd = Svd::new(&columns);
        let step = svd.solve(&reduced.right, svd.rank(RANK_TOLERANCE));
        followers.iter().enumerate().for_each(|(k, j)| theta[*j] += step[k] / sizes[*j]);
    }
}
