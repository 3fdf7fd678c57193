//! What is left after the fit: residuals, outliers, orders apart, and the prediction of data not used.

use super::fit::{Fit, fit, robust_fit, standardised};
use super::measurement::{Kind, Measurement, Reading};
use super::model::{Model, masked};
use nalgebra::Vector3;
use rayon::prelude::*;

/// A measurement this many robust standard deviations off (root mean square of its components) is listed.
const OUTLYING: f64 = 4.0;

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

/// What is left, before and after. Every RMS is that of vector lengths (mm).
#[derive(Debug, Clone, PartialEq)]
pub struct Residuals {
    /// With the machine as the file says.
    pub before: f64,
    /// With the fitted machine.
    pub after: f64,
    /// With the fitted machine, for each kind of rows: how many, and their RMS.
    pub kinds: Vec<(Kind, usize, f64)>,
    /// Measurements that stand out, the worst first.
    pub outliers: Vec<Outlier>,
    /// RMS of the first-order part of the fitted deviations, of the second, and of all higher ones.
    pub parts: [f64; 3],
    /// RMS of what the first order alone, and the first two together, leave of the measurements.
    pub left: [f64; 2],
}

/// RMS of vector lengths.
fn rms(vectors: &[Vector3<f64>]) -> f64 {
    (vectors.iter().map(|v| v.norm_squared()).sum::<f64>() / vectors.len().max(1) as f64).sqrt()
}

impl Residuals {
    /// Compares the measurements with the machine before and after a fit.
    pub fn of(model: &Model<'_>, data: &[Measurement], theta: &[f64]) -> Self {
        let start: Vec<f64> = model.parameters().iter().map(|p| p.start).collect();
        let after = model.residuals(data, theta);
        let orders: Vec<[Vector3<f64>; 3]> =
            data.par_iter().zip(&after).map(|(m, residual)| orders(model, m, theta, residual)).collect();
        let part = |k: usize| rms(&orders.iter().map(|o| o[k]).collect::<Vec<_>>());
        let sum = |k: usize| -> Vec<Vector3<f64>> {
            after.iter().zip(&orders).map(|(r, o)| r + o[k..].iter().sum::<Vector3<f64>>()).collect()
        };
        Self {
            before: rms(&model.residuals(data, &start)),
            after: rms(&after),
            kinds: kinds(data, &after),
            outliers: outliers(data, &after),
            parts: [part(0), part(1), part(2)],
            left: [rms(&sum(1)), rms(&sum(2))],
        }
    }
}

/// First-order, second-order and higher part of a fitted deviation, where it was measured.
fn orders(model: &Model<'_>, m: &Measurement, theta: &[f64], residual: &Vector3<f64>) -> [Vector3<f64>; 3] {
    model.orders(m, theta, &(m.values() - residual)).map(|v| masked(m, v))
}

fn kinds(data: &[Measurement], residuals: &[Vector3<f64>]) -> Vec<(Kind, usize, f64)> {
    let mut groups: std::collections::BTreeMap<Kind, Vec<Vector3<f64>>> = std::collections::BTreeMap::new();
    data.iter().zip(residuals).for_each(|(m, r)| groups.entry(m.kind()).or_default().push(*r));
    groups.into_iter().map(|(kind, residuals)| (kind, residuals.len(), rms(&residuals))).collect()
}

fn outliers(data: &[Measurement], residuals: &[Vector3<f64>]) -> Vec<Outlier> {
    // Residuals of mere rounding have no outliers.
    let sizes = standardised(data, residuals);
    let one = |(row, deviations): (usize, f64)| Outlier { row, residual: residuals[row].norm(), deviations };
    let mut found: Vec<Outlier> = sizes.into_iter().enumerate().map(one).collect();
    found.retain(|o| o.deviations > OUTLYING && o.residual > 1e-6);
    found.sort_by(|a, b| b.deviations.total_cmp(&a.deviations));
    found
}

/// RMS (mm) of the prediction of data that the fit has not seen: every measurement is left out once, in
/// `folds` parts taken in turn. `None` with fewer than two parts or measurements than parts.
pub fn held_out(model: &Model<'_>, data: &[Measurement], folds: usize, robust: bool) -> Option<f64> {
    if folds < 2 || folds > data.len() {
        return None;
    }
    let part = |fold: usize| {
        let (held, used): (Vec<_>, Vec<_>) = data.iter().cloned().enumerate().partition(|(i, _)| i % folds == fold);
        let bare = |list: Vec<(usize, Measurement)>| list.into_iter().map(|(_, m)| m).collect::<Vec<_>>();
        let (held, used) = (bare(held), bare(used));
        let Fit { theta, .. } = if robust { robust_fit(model, &used) } else { fit(model, &used, weights(&used)) };
        model.residuals(&held, &theta)
    };
    let left: Vec<Vector3<f64>> = (0..folds).flat_map(part).collect();
    Some(rms(&left))
}

/// The weights that stand in the data.
pub(super) fn weights(data: &[Measurement]) -> Vec<f64> {
    data.iter().map(|m| m.weight).collect()
}

/// Standard deviation of a reading (mm) from poses that were measured more than once, and how many
/// degrees of freedom that rests on; `None` without repeats.
pub fn repeatability(data: &[Measurement]) -> Option<(f64, usize)> {
    let key = |m: &Measurement| -> Vec<u64> {
        // -0 and 0 are the same position.
        m.pose.iter().map(|q| (q + 0.0).to_bits()).chain([m.tool as u64, m.approach as u64]).collect()
    };
    let mut groups: std::collections::BTreeMap<(Vec<u64>, usize), Vec<f64>> = std::collections::BTreeMap::new();
    for m in data {
        let Reading::Deviation { values, zero: None, .. } = &m.reading else { continue };
        for (i, value) in values.iter().enumerate() {
            value.iter().for_each(|v| groups.entry((key(m), i)).or_default().push(*v));
        }
    }
    let (mut squares, mut freedom) = (0.0, 0);
    for values in groups.values().filter(|values| values.len() > 1) {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        squares += values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
        freedom += values.len() - 1;
    }
    (freedom > 0).then(|| ((squares / freedom as f64).sqrt(), freedom))
}
