//! The problem of a fit, and its passes: the parameters and what is known of them, the readings, the solution in its
//! datum, what the readings contradict, and the machine file.

use super::accused::{self, SuspectReadings};
use super::fitted::{FitDiagnosis, FittedDatum};
use super::inputs::{FitAcceptance, FitInputs, FitRange};
use super::result::{IdentifyResult, NamedSvg};
use super::{advice, datum, limits, provenance, remarks};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::evaluate::Order;
use crate::identify::thresholds::{MAX_IDLE_EFFECT_MM, MAX_UNKNOWNS};
use crate::identify::{
    Circumstances, DatumChange, FileNotes, FitInData, FitModel, Invariances, Measurement, MeasurementSet, Parameter,
    ParameterFit, Prediction, PriorValue, ReadingContext, Residuals, SlopeBound, Solution, TypeB, common, fitted_file,
    form_uncertainty, held_out, in_datum, invariances, measured_ranges, parameters, parse_prior, randomness,
    read_measurements, repeats, slope_bounds, solve, suspect, type_b, unheld, unused_entries, with_command_line,
};
use crate::job::machine_file::{MachineFile, Overlay, ReadBackFailure, read_back};
use crate::job::poses;
use crate::machine::Machine;
use crate::run::{Advance, Call, Cancelled, Refused, sha256};
use crate::syntax::{Files, IdentifyEntry, MemoryFiles, ReadFailure};
use crate::units::counted;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Draws prediction and data.
pub(crate) type Draw<'a> = &'a dyn Fn(&FitModel<'_>, &[Measurement], &[f64]) -> Result<Vec<NamedSvg>, Diagnostic>;

/// The results of a fit that are asked for beside its values.
pub(crate) struct FitOutputs<'a> {
    /// Writes the fitted machine file.
    pub machine_file: bool,
    pub draw: Option<Draw<'a>>,
}

/// The unknowns and the data of a fit.
#[derive(Clone)]
pub(crate) struct Problem {
    pub request: IdentifyEntry,
    pub unknowns: Vec<Parameter>,
    pub bounds: Vec<SlopeBound>,
    pub known: Vec<PriorValue>,
    pub type_b: Vec<TypeB>,
    pub rows: Vec<Measurement>,
    /// SHA-256 of the files of measurements, by path.
    pub hashes: BTreeMap<PathBuf, String>,
}

impl Problem {
    pub(crate) fn read(call: &mut Call, file: &MachineFile, inputs: &FitInputs<'_>) -> Result<Self, Refused> {
        let Requested { request, own, bounds } = Requested::of(call, file, inputs.fit, inputs.fixed)?;
        let axis_poses = inputs.axis_poses.map(Path::to_owned);
        let context = ReadingContext { frame: inputs.frame, axis_poses, is_plan: inputs.is_plan };
        let (mut data, hashes) = measurements(call, file, &inputs.paths, inputs.texts, &context)?;
        call.extend(remarks::unused_readings(file, &data.leave_out(&own)));
        let mut known: Vec<PriorValue> = Vec::new();
        for (j, place) in data.nuisances.iter().enumerate() {
            let (unknown, value) = (own.len() + j, place.start);
            known.extend(place.known.map(|sigma| PriorValue { unknown, value, sigma }));
        }
        let unknowns: Vec<Parameter> = own.into_iter().chain(data.nuisances.into_iter().map(Parameter::from)).collect();
        for prior in priors(call, file, &request, inputs.priors, &unknowns)? {
            // What is said of a place goes before the uncertainty that its file gives.
            known.retain(|other| other.unknown != prior.unknown);
            known.push(prior);
        }
        let mut request = request;
        request.priors.extend(inputs.priors.iter().cloned());
        request.type_b.extend(inputs.type_b.iter().cloned());
        let shared: Result<Vec<TypeB>, _> = request.type_b.iter().map(|words| type_b(words)).collect();
        let type_b = shared.or_else(|refusal| call.refuse(*refusal))?;
        Ok(Self { request, unknowns, bounds, known, type_b, rows: data.rows, hashes })
    }

    pub(crate) fn model(&self, machine: &Machine, order: Order) -> FitModel<'_> {
        FitModel::new(machine, &self.unknowns).with_slope_bounds(&self.bounds).with_known(&self.known).to_order(order)
    }
}

impl Problem {
    /// Returns the same where parameters keep their start.
    pub(crate) fn without(&self, names: &[String]) -> Self {
        let kept: Vec<usize> = (0..self.unknowns.len()).filter(|j| !names.contains(&self.unknowns[*j].name)).collect();
        let known = |known: &PriorValue| {
            let unknown = kept.iter().position(|j| *j == known.unknown)?;
            Some(PriorValue { unknown, ..*known })
        };
        Self {
            unknowns: kept.iter().map(|j| self.unknowns[*j].clone()).collect(),
            known: self.known.iter().filter_map(known).collect(),
            ..self.clone()
        }
    }
}

pub(crate) struct Requested {
    pub request: IdentifyEntry,
    pub own: Vec<Parameter>,
    pub bounds: Vec<SlopeBound>,
}

impl Requested {
    pub(crate) fn of(call: &mut Call, file: &MachineFile, fit: &[String], fixed: &[String]) -> Result<Self, Refused> {
        let request = with_command_line(file, file.identify.clone().unwrap_or_default(), fit, fixed);
        let own = parameters(file, &request).or_else(|refusal| call.refuse(*refusal))?;
        let bounds = slope_bounds(file, &request, &own).or_else(|refusal| call.refuse(*refusal))?;
        // A list of one's own takes what it needs of the section.
        if fit.is_empty() {
            call.extend(remarks::entries_without_effect(&unused_entries(file, &request, &own)));
        }
        Ok(Self { request, own, bounds })
    }
}

/// Returns the values known before the data. A prior of the section that names nothing here has no effect.
pub(crate) fn priors(
    call: &mut Call,
    file: &MachineFile,
    request: &IdentifyEntry,
    options: &[String],
    unknowns: &[Parameter],
) -> Result<Vec<PriorValue>, Refused> {
    let mut list: Vec<PriorValue> = Vec::new();
    let mut without_effect = Vec::new();
    for (k, words) in request.priors.iter().chain(options).enumerate() {
        match parse_prior(words, file, unknowns) {
            Ok(found) => found.into_iter().for_each(|one| {
                list.retain(|other| other.unknown != one.unknown);
                list.push(one);
            }),
            Err(_) if k < request.priors.len() => without_effect.push(format!("prior {}", shown(words))),
            Err(refusal) => return call.refuse(*refusal),
        }
    }
    call.extend(remarks::entries_without_effect(&without_effect));
    Ok(list)
}

/// Files that remember the hashes of what is read.
struct Recording<'a> {
    files: &'a dyn Files,
    hashes: RefCell<BTreeMap<PathBuf, String>>,
}

impl Files for Recording<'_> {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadFailure> {
        let bytes = self.files.read(path)?;
        let _ = self.hashes.borrow_mut().insert(path.to_owned(), sha256(&bytes));
        Ok(bytes)
    }

    fn read_at_most(&self, path: &Path, limit: u64) -> Result<Vec<u8>, ReadFailure> {
        let bytes = self.files.read_at_most(path, limit)?;
        let _ = self.hashes.borrow_mut().insert(path.to_owned(), sha256(&bytes));
        Ok(bytes)
    }
}

/// Reads files of measurements, of which some are texts by name.
pub(crate) fn measurements(
    call: &mut Call,
    file: &MachineFile,
    paths: &[PathBuf],
    texts: &[(String, String)],
    context: &ReadingContext,
) -> Result<(MeasurementSet, BTreeMap<PathBuf, String>), Refused> {
    let texts = texts.iter().fold(MemoryFiles::default(), |files, (name, text)| files.with(name, text.as_str()));
    let overlay = Overlay { text: texts, files: call.run.files };
    let recording = Recording { files: &overlay, hashes: RefCell::default() };
    let data = read_measurements(paths, file, context, &recording, &mut call.diagnostics);
    call.check()?;
    let hashes = recording.hashes.into_inner();
    refuse_copies(call, paths, &hashes)?;
    poses::check(call, file, data.rows.iter().flat_map(Measurement::poses))?;
    Ok((data, hashes))
}

/// Refuses files with the same contents, whose readings would count twice.
fn refuse_copies(call: &mut Call, list: &[PathBuf], hashes: &BTreeMap<PathBuf, String>) -> Result<(), Refused> {
    let mut met: BTreeMap<Option<&String>, &PathBuf> = BTreeMap::new();
    for file in list {
        if let Some(known) = met.insert(hashes.get(file), file) {
            let names = [known, file].map(|path| shown(&path.display().to_string()));
            let message = format!("`{}` and `{}` hold the same readings, which would count twice", names[0], names[1]);
            return call.refuse(Diagnostic::new(codes::E0501, message).help("name every file once"));
        }
    }
    Ok(())
}

/// Refuses too many unknowns, and fewer readings than unknowns that a reading feels.
pub(crate) fn enough(call: &mut Call, file: &MachineFile, problem: &Problem) -> Result<(), Refused> {
    let unknowns = problem.unknowns.len();
    let readings: usize = problem.rows.iter().map(Measurement::readings).sum();
    let nuisances = |felt: &dyn Fn(usize) -> bool| {
        problem.unknowns.iter().enumerate().filter(|(j, p)| p.is_nuisance() && felt(*j)).count()
    };
    let instruments = nuisances(&|_| true);
    if unknowns > MAX_UNKNOWNS {
        let message = format!("{unknowns} unknowns, {instruments} of them of instruments, are too many");
        let help = "at most 500: fit less, or take runs of the same set-up together under one name";
        return call.refuse(Diagnostic::new(codes::E0508, message).help(help));
    }
    if readings + problem.known.len() >= unknowns {
        return Ok(());
    }
    let felt = felt_unknowns(file, problem);
    let unknowns = felt.iter().filter(|felt| **felt).count();
    let known = problem.known.iter().filter(|known| felt[known.unknown]).count();
    let help = "measure more poses, or fit less";
    if problem.unknowns.iter().zip(&felt).all(|(p, felt)| p.is_nuisance() || !felt) {
        let message = format!("{} feel none of the parameters", counted(readings, "reading"));
        return call.refuse(Diagnostic::new(codes::E0503, message).help(help));
    }
    if readings + known >= unknowns {
        return Ok(());
    }
    let instruments = nuisances(&|j| felt[j]);
    let also = if instruments > 0 {
        format!(" and {} of the instruments", counted(instruments, "unknown"))
    } else {
        String::new()
    };
    let own = counted(unknowns - instruments, "parameter");
    let message = format!("{} cannot determine {own}{also}", counted(readings, "reading"));
    call.refuse(Diagnostic::new(codes::E0503, message).help(help))
}

/// Returns for each unknown if a reading feels it where the fit starts.
fn felt_unknowns(file: &MachineFile, problem: &Problem) -> Vec<bool> {
    let start: Vec<f64> = problem.unknowns.iter().map(|p| p.start).collect();
    let weights = vec![1.0; problem.rows.len()];
    let effects = problem.model(file, Order::Exact).triangle(&problem.rows, &weights, &start).column_norms();
    let feels = |(effect, p): (&f64, &Parameter)| effect / p.size > MAX_IDLE_EFFECT_MM;
    effects.iter().zip(&problem.unknowns).map(feels).collect()
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

fn solve_over_volume(
    call: &mut Call,
    file: &MachineFile,
    inputs: &FitInputs<'_>,
    problem: &Problem,
    outputs: &FitOutputs<'_>,
) -> Result<IdentifyResult, Refused> {
    let (model, data) = (problem.model(file, inputs.order), &problem.rows);
    let invariant = |call: &mut Call, theta: &[f64]| {
        let found = invariances(&model, data, theta);
        remarks::shrinking(&found.stretches).map_or(Ok(found), |refusal| call.refuse(refusal))
    };
    invariant(call, &problem.unknowns.iter().map(|p| p.start).collect::<Vec<_>>())?;
    let fit = call.stage("readings fitted", 0, |advance| solve_to_end(&model, data, inputs.robust, advance))?;
    let found = invariant(call, &fit.theta)?;
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
    let remarks = remarks::all(&fitted, sources);
    let mut result = IdentifyResult::of(&fitted, sources);
    result.residuals = accused::residual_groups(&fitted, &in_data.residuals(&model, data));
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

/// Judges a fit in its datum, without parts left out. Returns it with its frame in the data.
pub(crate) fn diagnose<'a>(
    model: &FitModel<'_>,
    file: &'a Machine,
    problem: &'a Problem,
    found: Invariances,
    fit: ParameterFit,
) -> (FitDiagnosis<'a>, FitInData) {
    let data = &problem.rows;
    let conditions = datum::conditions(file, &problem.request, &problem.unknowns[..model.own()]);
    let examine = |fit: &ParameterFit| {
        let solution = Solution::of(fit, &problem.unknowns);
        let solution = solution.with_first_order_rank(model, data, fit, &found.motion_parameters);
        let form = form_uncertainty(model, data, fit, &solution);
        let common = common(model, data, fit, &solution, &problem.type_b);
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
        type_b: &problem.type_b,
        form,
        fit,
        noise: None,
        suspicion: None,
    };
    (fitted, in_data)
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
