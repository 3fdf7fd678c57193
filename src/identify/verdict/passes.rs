//! The passes of a fit: the solution, its judgement in its datum, what the readings contradict, and the machine file.

use super::accused::{self, SuspectReadings};
use super::diagnose::diagnose;
use super::fitted::FitDiagnosis;
use super::inputs::{FitAcceptance, FitInputs, FitRange};
use super::problem::Problem;
use super::result::{IdentifyResult, NamedSvg, ReadingResidual};
use super::{advice, limits, provenance, remarks};
use crate::diagnostic::Diagnostic;
use crate::identify::{
    Circumstances, FileNotes, FitModel, Invariances, Measurement, ParameterFit, fitted_file, held_out, invariances,
    measured_ranges, solve, suspect,
};
use crate::job::machine_file::{MachineFile, ReadBackFailure, read_back};
use crate::run::{Advance, Call, Cancelled, Refused};
use crate::syntax::IdentifyEntry;

/// Draws prediction and data.
pub(crate) type Draw<'a> = &'a dyn Fn(&FitModel<'_>, &[Measurement], &[f64]) -> Result<Vec<NamedSvg>, Diagnostic>;

/// The results of a fit that are asked for beside its values.
pub(crate) struct FitOutputs<'a> {
    /// Writes the fitted machine file.
    pub machine_file: bool,
    pub draw: Option<Draw<'a>>,
}

/// Fits, and judges the fit over the volume of the machine, or over that part of it that was measured.
pub(crate) fn solve_problem(
    call: &mut Call,
    file: &MachineFile,
    inputs: &FitInputs<'_>,
    problem: &Problem,
    outputs: &FitOutputs<'_>,
) -> Result<IdentifyResult, Refused> {
    match inputs.range {
        FitRange::Travel => solve_over_volume(call, file, inputs, problem, outputs),
        FitRange::Measured => {
            let ranges = measured_ranges(&problem.model(file, inputs.order), &problem.rows);
            solve_over_volume(call, &file.with_volume_within(&ranges), inputs, problem, outputs)
        }
    }
}

/// Refuses data (E0514) in which the machine of these unknowns may grow or shrink without a reading that notices, at
/// these values of the unknowns.
pub(crate) fn hold_size(
    call: &mut Call,
    file: &MachineFile,
    inputs: &FitInputs<'_>,
    problem: &Problem,
    theta: &[f64],
) -> Result<Invariances, Refused> {
    let found = invariances(&problem.model(file, inputs.order), &problem.rows, theta);
    if found.stretches.is_empty() {
        return Ok(found);
    }
    let held = advice::holding_size(file, inputs, problem, &found);
    remarks::shrinking(&found.stretches, held.as_deref()).map_or(Ok(found), |refusal| call.refuse(refusal))
}

fn solve_over_volume(
    call: &mut Call,
    file: &MachineFile,
    inputs: &FitInputs<'_>,
    problem: &Problem,
    outputs: &FitOutputs<'_>,
) -> Result<IdentifyResult, Refused> {
    let (model, data) = (problem.model(file, inputs.order), &problem.rows);
    hold_size(call, file, inputs, problem, &model.start())?;
    let fit = call.stage("readings fitted", 0, |advance| solve_to_end(&model, data, inputs.robust, advance))?;
    let found = hold_size(call, file, inputs, problem, &fit.theta)?;
    let (mut fitted, in_data) = call.stage("uncertainty", 1, |advance| {
        let diagnosed = diagnose(&model, file, problem, found, fit);
        advance(1).map(|()| diagnosed)
    })?;
    let held_out = inputs.folds.map(|folds| {
        call.stage("parts left out", folds, |advance| held_out(&model, data, folds, inputs.robust, advance))
    });
    fitted.held_out = held_out.transpose()?.flatten();
    fitted.noise = inputs.noise;
    let circumstances = Circumstances::of(
        &fitted.fit,
        &fitted.solution,
        fitted.residuals.after,
        &fitted.repeats,
        inputs.noise,
        inputs.robust,
    );
    fitted.suspicion = suspect(&model, data, &circumstances);
    let sources = &call.diagnostics.sources;
    let mut remarks = remarks::all(&fitted, sources);
    if !inputs.robust {
        remarks.extend(remarks::outlying(&fitted, sources));
    }
    let mut result = IdentifyResult::of(&fitted, sources);
    let left = in_data.residuals(&model, data);
    result.residuals = accused::residual_groups(&fitted, &left);
    result.reading_residuals =
        data.iter().zip(&left).map(|(m, left)| ReadingResidual::of(m.kind(), (*left).into())).collect();
    result.suspect = accused::suspect(&fitted, sources, &inputs.accept);
    accuse(call, result.suspect.as_ref(), remarks, outputs.machine_file)?;
    if outputs.machine_file {
        let text = machine_file(call, file, inputs, problem, &fitted, result.suspect.as_ref())?;
        result.machine_file = Some(text);
    } else if let Err(why) = plausible(file, inputs, problem, &fitted, FileNotice::default()) {
        call.extend([remarks::implausible(&why)]);
    }
    if let Some(draw) = outputs.draw {
        let drawn = draw(&in_data.model(&model), data, &in_data.theta).or_else(|refusal| call.refuse(refusal));
        result.pictures = drawn?;
    }
    Ok(result)
}

/// Fits, and hears of readings that were evaluated; a fit that is cancelled ends early, and its result is none.
fn solve_to_end(
    model: &FitModel<'_>,
    data: &[Measurement],
    robust: bool,
    advance: Advance<'_>,
) -> Result<ParameterFit, Cancelled> {
    let fit = solve(&model.clone().with_progress(advance), data, robust);
    advance(0).map(|()| fit)
}

/// Names readings that accuse themselves before all remarks; refuses them if a file is to be written.
fn accuse(
    call: &mut Call,
    suspect: Option<&SuspectReadings>,
    remarks: Vec<Diagnostic>,
    writes: bool,
) -> Result<(), Refused> {
    let refuses = suspect.filter(|suspect| writes && !suspect.accepted);
    if let Some(suspect) = refuses {
        call.extend(remarks);
        return call.refuse(suspect.diagnostic(true));
    }
    call.extend(suspect.map(|suspect| suspect.diagnostic(false)));
    call.extend(remarks);
    Ok(())
}

/// Returns the text of the fitted machine file; refuses one that the program itself would not take.
fn machine_file(
    call: &mut Call,
    file: &MachineFile,
    inputs: &FitInputs<'_>,
    problem: &Problem,
    fitted: &FitDiagnosis<'_>,
    suspect: Option<&SuspectReadings>,
) -> Result<String, Refused> {
    call.extend(remarks::weak_directions_in_file(fitted));
    let refusals = [
        remarks::undetermined_values(fitted),
        remarks::uncertain_prediction(fitted),
        accused::worse_than_nothing(fitted),
    ];
    let mut refusals: Vec<Diagnostic> = refusals.into_iter().flatten().collect();
    // What is not determined has no covariance that would mean anything.
    let joint = refusals.is_empty();
    let accepted = inputs.accept.contains(&FitAcceptance::Undetermined);
    if !accepted
        && let Some(first) = refusals.first_mut()
        && let Some(words) = advice::fixing(file, inputs, problem, fitted)
    {
        first.help = first.help.take().map(|help| format!("{words}; {help}"));
    }
    if let ([first, others @ ..], false) = (&refusals[..], accepted) {
        call.extend(others.iter().cloned());
        return call.refuse(first.clone());
    }
    plausible(file, inputs, problem, fitted, FileNotice { joint, suspect })
        .or_else(|why| call.refuse(remarks::refusal_of_file(&why)))
}

/// What a fitted file says beside its values.
#[derive(Default)]
struct FileNotice<'a> {
    /// True if it has the joint covariance.
    joint: bool,
    /// What the caller has accepted.
    suspect: Option<&'a SuspectReadings>,
}

/// Returns the text of the fitted machine file, or the reason for which the program itself would not take it.
fn plausible(
    file: &MachineFile,
    inputs: &FitInputs<'_>,
    problem: &Problem,
    fitted: &FitDiagnosis<'_>,
    FileNotice { joint, suspect }: FileNotice<'_>,
) -> Result<String, ReadBackFailure> {
    let provenance = provenance::entries(file, inputs, &problem.request, &problem.hashes, fitted, suspect);
    let own_parameters = &fitted.unknowns[..fitted.own];
    let text = |request: &IdentifyEntry| {
        let (form, unheld) = (fitted.form.as_ref(), &*fitted.unheld);
        let measured = &*fitted.measured;
        let notes = FileNotes { provenance: &provenance, request, joint, form, unheld, measured };
        fitted_file(file, own_parameters, &fitted.solution, notes)
    };
    let first = text(&problem.request);
    let refused = match read_back(&first) {
        Ok(_) => return Ok(first),
        Err(why) => why,
    };
    // A machine whose readings show larger errors than usual may have them.
    let shown = limits::plausible_request(&problem.request, fitted.fit.initial_rms);
    shown.map(|request| text(&request)).filter(|text| read_back(text).is_ok()).ok_or(refused)
}
