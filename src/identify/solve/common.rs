//! The covariance of the unknowns by what all readings share.

use super::fit::ParameterFit;
use super::solution::{CommonEffects, Solution};
use super::sums::parallel_sum;
use crate::identify::data::Measurement;
use crate::identify::model::{FitModel, OffsetChannel, Parameter, TypeB};
use nalgebra::{DMatrix, DVector, DVectorView};

/// Effects (mm, rad) up to this are rounding.
const MAX_ROUNDING: f64 = 1e-12;
/// Share of an effect up to which it is rounding beside what the set-up takes.
const MAX_ROUNDING_SHARE: f64 = 1e-7;

/// Returns the covariance of the unknowns, in their units, by uncertainties of type B: `sum (C J^T s) (C J^T s)^T` over
/// the effects s of one standard uncertainty each, in every channel, on the readings.
pub fn common(
    model: &FitModel<'_>,
    data: &[Measurement],
    fit: &ParameterFit,
    solution: &Solution,
    parameters: &[Parameter],
    all: &[TypeB],
) -> CommonEffects {
    let count = fit.theta.len();
    let add = |sums: &mut Shifts, m: &Measurement, weight: f64| {
        let (unknowns, _) = model.rows(m, &fit.theta);
        for (k, of) in all.iter().enumerate() {
            for (channel, effect) in of.effect.of(model, m, &fit.theta) {
                // What was not read has no row in `unknowns`.
                let sum = sums.column((k, channel), count);
                sum.iter_mut().zip(&unknowns).for_each(|(s, u)| *s += u.dot(&effect) * weight);
            }
        }
    };
    let shifts = parallel_sum(data, &fit.weights, Shifts::default, add, |sums, more| sums.plus(more, count));
    if shifts.columns.is_empty() {
        return CommonEffects { covariance: DMatrix::zeros(count, count), idle: (0..all.len()).collect() };
    }
    let root = solution.covariance_root();
    let effects = &root * root.tr_mul(&DMatrix::from_columns(&shifts.columns));
    let moves = |k: usize| {
        let own = shifts.causes.iter().zip(effects.column_iter()).filter(|((of, _), _)| *of == k);
        // What a set-up takes whole moves no error of the machine.
        let of_errors = |effect: DVectorView<'_, f64>| {
            let errors = parameters.iter().zip(effect.iter()).filter(|(of, _)| !of.is_nuisance());
            errors.fold(0.0, |most, (_, x)| f64::max(most, x.abs()))
        };
        own.into_iter().any(|(_, effect)| of_errors(effect) > MAX_ROUNDING.max(MAX_ROUNDING_SHARE * effect.amax()))
    };
    let idle = (0..all.len()).filter(|k| !moves(*k)).collect();
    CommonEffects { covariance: &effects * effects.transpose(), idle }
}

/// An uncertainty, by its index, in one channel.
type Cause = (usize, Option<OffsetChannel>);

/// Products of the unknowns' effects on the readings with one standard uncertainty of each cause.
#[derive(Default)]
struct Shifts {
    causes: Vec<Cause>,
    columns: Vec<DVector<f64>>,
}

impl Shifts {
    fn column(&mut self, cause: Cause, unknowns: usize) -> &mut DVector<f64> {
        let known = self.causes.iter().position(|of| *of == cause);
        let k = known.unwrap_or_else(|| {
            self.causes.push(cause);
            self.columns.push(DVector::zeros(unknowns));
            self.causes.len() - 1
        });
        &mut self.columns[k]
    }

    fn plus(mut self, more: Self, unknowns: usize) -> Self {
        more.causes.into_iter().zip(more.columns).for_each(|(cause, column)| *self.column(cause, unknowns) += column);
        self
    }
}
