//! Checks after the fit: residuals, outliers, orders apart, and the prediction of data not used.

use super::fit::ParameterFit;
use super::in_data::FitInData;
use super::weighing::{median, solve, standardise};
use crate::identify::data::{Measurement, ReadingKind};
use crate::identify::model::{FitModel, zero_unread};
use crate::identify::thresholds::{MIN_OUTLIER_MM, OUTLIER_DEVIATIONS};
use crate::run::Advance;
use nalgebra::Vector3;
use rayon::prelude::*;

/// A measurement that does not fit the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlier {
    /// Its index among the measurements.
    pub row: usize,
    /// Length of its residual (mm).
    pub residual: f64,
    /// The same in robust standard deviations, per component.
    pub deviations: f64,
}

/// Residuals before and after the fit. Every RMS is that of vector lengths (mm).
#[derive(Debug, Clone, PartialEq)]
pub struct Residuals {
    /// RMS with the machine as the file has it, in the frame of the fit; instruments and set-ups fitted.
    pub before: f64,
    /// RMS with the fitted machine, in the frame of the readings.
    pub after: f64,
    /// Median length with the machine of the file, over readings that need no instrument unknowns.
    pub typical: f64,
    /// Median length of rotations with the machine of the file, mm at the lever of all rotations; instruments fitted.
    pub typical_turn: f64,
    /// Number and RMS for each kind of rows, with the fitted machine.
    pub kinds: Vec<(ReadingKind, usize, f64)>,
    /// Measurements that stand out, the worst first.
    pub outliers: Vec<Outlier>,
    /// RMS of the first-order part of the fitted deviations, of the second, and of all higher ones.
    pub parts: [f64; 3],
    /// RMS of the residuals of the first order alone, and of the first two together.
    pub truncated: [f64; 2],
}

fn rms(vectors: &[Vector3<f64>]) -> f64 {
    (vectors.iter().map(|v| v.norm_squared()).sum::<f64>() / vectors.len().max(1) as f64).sqrt()
}

impl Residuals {
    /// Compares the measurements with the machine before a fit and after it, where `theta` are the stated unknowns.
    pub fn of(model: &FitModel<'_>, data: &[Measurement], fit: &ParameterFit, theta: &[f64], seen: &FitInData) -> Self {
        let before = seen.residuals_before(model, data, &fit.weights);
        let after = seen.residuals(model, data);
        let orders: Vec<[Vector3<f64>; 3]> = data.par_iter().map(|m| orders(model, m, theta)).collect();
        let part = |k: usize| rms(&orders.iter().map(|o| o[k]).collect::<Vec<_>>());
        let sum = |k: usize| -> Vec<Vector3<f64>> {
            after.iter().zip(&orders).map(|(r, o)| r + o[k..].iter().sum::<Vector3<f64>>()).collect()
        };
        Self {
            before: rms(&before),
            typical: typical_size(model, data),
            typical_turn: median_of(data, &before, |kind| matches!(kind, ReadingKind::Turn(_))),
            after: rms(&after),
            kinds: kinds(data, &after),
            outliers: outliers(data, &after),
            parts: [part(0), part(1), part(2)],
            truncated: [rms(&sum(1)), rms(&sum(2))],
        }
    }
}

/// Returns the median length (mm) of what is read with the machine of the file, over readings that need no instrument
/// unknowns.
pub fn typical_size(model: &FitModel<'_>, data: &[Measurement]) -> f64 {
    median_of(data, &model.residuals(data, &model.start()), |kind| {
        !matches!(kind, ReadingKind::Length | ReadingKind::Line | ReadingKind::Touch | ReadingKind::Turn(_))
    })
}

/// Returns the median length over readings of some kinds.
fn median_of(data: &[Measurement], residuals: &[Vector3<f64>], is_of: impl Fn(ReadingKind) -> bool) -> f64 {
    median(data.iter().zip(residuals).filter(|(m, _)| is_of(m.kind())).map(|(_, r)| r.norm()).collect()).0
}

/// Returns the first-order, second-order and higher part of a fitted deviation, in the components read.
fn orders(model: &FitModel<'_>, m: &Measurement, theta: &[f64]) -> [Vector3<f64>; 3] {
    model.orders(m, theta, &model.prediction(m, theta)).map(|v| zero_unread(m, v))
}

fn kinds(data: &[Measurement], residuals: &[Vector3<f64>]) -> Vec<(ReadingKind, usize, f64)> {
    let mut groups: std::collections::BTreeMap<ReadingKind, Vec<Vector3<f64>>> = std::collections::BTreeMap::new();
    data.iter().zip(residuals).for_each(|(m, r)| groups.entry(m.kind()).or_default().push(*r));
    groups.into_iter().map(|(kind, residuals)| (kind, residuals.len(), rms(&residuals))).collect()
}

fn outliers(data: &[Measurement], residuals: &[Vector3<f64>]) -> Vec<Outlier> {
    // Residuals of mere rounding have no outliers.
    let sizes = standardise(data, residuals);
    let one = |(row, deviations): (usize, f64)| Outlier { row, residual: residuals[row].norm(), deviations };
    let mut found: Vec<Outlier> = sizes.into_iter().enumerate().map(one).collect();
    found.retain(|o| o.deviations > OUTLIER_DEVIATIONS && o.residual > MIN_OUTLIER_MM);
    found.sort_by(|a, b| b.deviations.total_cmp(&a.deviations));
    found
}

/// Returns the RMS (mm) of the prediction of data that the fit did not use (cross-validation): every measurement is
/// left out once, in `folds` parts, of which `progress` hears. `None` with fewer than two parts or measurements than
/// parts.
pub fn held_out<F>(
    model: &FitModel<'_>,
    data: &[Measurement],
    folds: usize,
    robust: bool,
    progress: Advance<'_, F>,
) -> Result<Option<f64>, F> {
    if folds < 2 || folds > data.len() {
        return Ok(None);
    }
    let part = |fold: usize| {
        let (held, used): (Vec<_>, Vec<_>) = data.iter().cloned().enumerate().partition(|(i, _)| i % folds == fold);
        let bare = |list: Vec<(usize, Measurement)>| list.into_iter().map(|(_, m)| m).collect::<Vec<_>>();
        let (held, used) = (bare(held), bare(used));
        let residuals = model.residuals(&held, &solve(model, &used, robust).theta);
        progress(1).map(|()| residuals)
    };
    let residuals: Vec<Vec<Vector3<f64>>> = (0..folds).map(part).collect::<Result<_, F>>()?;
    Ok(Some(rms(&residuals.concat())))
}
