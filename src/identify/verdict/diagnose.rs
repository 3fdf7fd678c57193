//! A fit judged in its datum.

use super::datum;
use super::fitted::{FitDiagnosis, FittedDatum};
use super::problem::Problem;
use crate::identify::{
    DatumChange, FitInData, FitModel, Invariances, ParameterFit, Prediction, Residuals, Solution, common,
    form_uncertainty, in_datum, measured_ranges, randomness, repeats, unheld,
};
use crate::machine::Machine;

/// Judges a fit in its datum, without parts left out. Returns it with its frame in the data.
pub(crate) fn diagnose<'a>(
    model: &FitModel<'_>,
    file: &'a Machine,
    problem: &'a Problem,
    found: Invariances,
    fit: ParameterFit,
) -> (FitDiagnosis<'a>, FitInData) {
    let data = &problem.rows;
    // The last step came from the linear problem before it; along weak directions that is another one.
    let fit = fit.at(model, data, fit.theta.clone());
    let conditions = datum::conditions(file, &problem.request, &problem.unknowns[..model.own()]);
    let examine = |fit: &ParameterFit| {
        let solution = Solution::of(fit, &problem.unknowns);
        let solution = solution.with_first_order_rank(model, data, fit, &found.motion_parameters);
        let form = form_uncertainty(model, data, fit, &solution);
        let common = common(model, data, fit, &solution, &problem.unknowns, &problem.type_b);
        let solution = solution.add_covariances(form.as_ref().map(|form| &form.covariance), common);
        let change = in_datum(model, data, fit, &solution, &conditions);
        let (solution, change) = match change {
            Some(DatumChange { solution, removed, in_data, motions }) => (solution, Some((removed, in_data, motions))),
            None => (solution, None),
        };
        (solution, form, change)
    };
    let (solution, form, change) = examine(&fit);
    let as_fitted = || FitInData { theta: solution.theta(), stand: None };
    let unheld = unheld(model, data, &fit, change.as_ref().map(|(_, _, motions)| motions));
    let (removed, in_data) = change.map_or_else(|| (None, as_fitted()), |(removed, seen, _)| (Some(removed), seen));
    let measured = measured_ranges(model, data);
    let datum = removed.map(|removed| FittedDatum::of(file, conditions.entry, &removed, &measured));
    // Uncertainties by the linear problem at the values that are stated.
    let (fit, solution, form) = if removed.is_some_and(|removed| removed.removes_weak) {
        let there = fit.at(model, data, solution.theta());
        let (solution, form, _) = examine(&there);
        (there, solution, form)
    } else {
        (fit, solution, form)
    };
    let forms = form.as_ref().map_or(&[][..], |form| &form.forms);
    // In the datum: products of the motion that a datum removes are no deviation.
    let prediction = Prediction::of(model, data, &fit, &solution, forms);
    let theta = solution.theta();
    let fitted = FitDiagnosis {
        machine: file,
        unknowns: &problem.unknowns,
        own: model.own(),
        data,
        residuals: Residuals::of(model, data, &fit, &theta, &in_data),
        residual_tests: randomness(data, &in_data.residuals(model, data), &fit.weights),
        prediction,
        datum,
        measured,
        unheld,
        motions: found.motions,
        solution,
        held_out: None,
        repeats: repeats(data),
        known: &problem.known,
        gauges: &problem.gauges,
        type_b: &problem.type_b,
        form,
        fit,
        noise: None,
        suspicion: None,
    };
    (fitted, in_data)
}
