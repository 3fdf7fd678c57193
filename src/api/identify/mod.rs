//! Measurements to error parameters, and a fitted machine file.

mod datum;
mod limits;
mod monomials;
mod pictures;
mod plan;
mod provenance;
mod remarks;
mod result;

pub use datum::{FittedDatum, FittedError};
pub use monomials::{MonomialCoefficient, MonomialComponent, MonomialFit, Rms, fit_monomials};
pub use pictures::NamedSvg;
pub use plan::{ExpectedParameter, MeasurementPlan, PlanOptions, PlannedPose, plan_measurements};
pub use result::{
    FittedParameter, FormOfAxis, IdentifyResult, KindResidual, KnownValue, LackOfFit, OrderShares, OutlierPlace,
    PredictedUncertainty, RepeatedReadings, ResidualTest, RmsBeforeAfter, ScatterOfKind, SharedUncertainty,
};

use super::machine_file::{MachineFile, Overlay, ReadBackFailure, read_back};
use super::poses;
use super::run::{Answer, Call, Refused, Run};
use crate::controller::sha256;
use crate::diagnostic::{Diagnostic, Diagnostics, codes, shown};
use crate::evaluate::{Frame, Order};
use crate::identify::{
    FileNotes, Fit, Known, Measurement, MeasurementSet, Misfit, Model, Parameter, Prediction, Randomness,
    ReadingContext, Repeats, Residuals, SlopeBound, Solution, TypeB, common, fitted_file, held_out, in_datum,
    invariances, known, misfit, overruled, parameters, randomness, read_measurements, repeats, slope_bounds, solve,
    type_b, unused,
};
use crate::machine::Machine;
use crate::syntax::{Files, IdentifyEntry, MemoryFiles, ReadFailure};
use crate::units::counted;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Options of [`identify`] and [`fit_monomials`].
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct IdentifyOptions {
    /// Files of measurements, read through `run.files`: CSV with a column for each axis and `dx [um]`, `dy [um]`,
    /// `dz [um]`, or lengths, ball readings, lines, single errors (docs/identify/measure.md).
    pub data: Vec<PathBuf>,
    /// Files of measurements by name and text; they come after `data`.
    pub texts: Vec<(String, String)>,
    /// Parameters to fit: `location`, `tool`, `workpiece`, `spindle`, `linear`, error names, `EXX:poly3`; if empty,
    /// the section `identify` of the machine file.
    pub fit: Vec<String>,
    /// Parameters that keep their value although a group names them.
    pub fixed: Vec<String>,
    /// Values known before the data, with a standard uncertainty: `ball b1 50 um`, `EC0Y 5 urad`, `constant S = 150
    /// mm 1 um`; `file`: what the machine file states. They come after those of the section `identify`.
    pub priors: Vec<String>,
    /// Standard uncertainties that all readings share: `laser 0.4 um/m` (a scale), `set-up 2 um` (an offset),
    /// `material 0.5 K x 11.7 um/m/K`. They come after those of the section `identify`.
    pub type_b: Vec<String>,
    /// Frame in which the deviations were measured.
    pub frame: Frame,
    /// The poses of points that a laser tracker's export has by name: a table with a column for each axis, and `point`.
    pub axis_poses: Option<PathBuf>,
    /// Model to fit: exact by default, or of order 1 or 2.
    pub order: Option<Order>,
    /// Gives readings that stand out less weight (Huber).
    pub robust: bool,
    /// Checks the prediction: leaves out every measurement once, in this many parts.
    pub folds: Option<usize>,
    /// Also writes the fitted machine file; fails if it is one that would be refused.
    pub machine_file: bool,
    /// Writes the machine file although it holds values whose uncertainty is larger than any error of a machine.
    pub accept_undetermined: bool,
    /// Also draws prediction and data over the planes of the linear axes.
    pub pictures: bool,
}

impl IdentifyOptions {
    fn order(&self) -> Order {
        self.order.unwrap_or(Order::Exact)
    }

    /// All files of measurements, in their order.
    fn paths(&self) -> Vec<PathBuf> {
        self.data.iter().cloned().chain(self.texts.iter().map(|(name, _)| PathBuf::from(name))).collect()
    }
}

/// Maximum number of unknowns of a fit: time grows with their third power.
const MAX_UNKNOWNS: usize = 500;

/// Fits error parameters of a machine to measurements.
///
/// Fails if the data cannot be read, contradict the machine's axes, or hold fewer readings than there are unknowns, and
/// if the parameters asked for are not those of the machine.
pub fn identify(
    file: &MachineFile,
    options: &IdentifyOptions,
    run: Run,
) -> Result<Answer<IdentifyResult>, Diagnostics> {
    Call::answer(run, file.sources(), |call| {
        let problem = Problem::read(call, file, options)?;
        enough(call, &problem)?;
        let monitor = call.run.monitor;
        monitor.begin(0);
        let progress = |readings| monitor.advance(readings);
        let result = solved(call, file, options, (&problem, &progress));
        monitor.end();
        result
    })
}

/// The unknowns and the data of a fit.
struct Problem {
    request: IdentifyEntry,
    unknowns: Vec<Parameter>,
    bounds: Vec<SlopeBound>,
    known: Vec<Known>,
    type_b: Vec<TypeB>,
    rows: Vec<Measurement>,
    /// SHA-256 of the files of measurements, by path.
    hashes: BTreeMap<PathBuf, String>,
}

impl Problem {
    fn read(call: &mut Call<'_>, file: &MachineFile, options: &IdentifyOptions) -> Result<Self, Refused> {
        let Requested { request, own, bounds } = Requested::of(call, file, &options.fit, &options.fixed)?;
        let (mut data, hashes) = measurements(call, file, options)?;
        call.extend(remarks::left_out(file, &data.leave_out(&own)));
        let mut known: Vec<Known> = Vec::new();
        for (j, place) in data.nuisances.iter().enumerate() {
            let (unknown, value) = (own.len() + j, place.start);
            known.extend(place.known.map(|sigma| Known { unknown, value, sigma }));
        }
        let unknowns: Vec<Parameter> = own.into_iter().chain(data.nuisances.into_iter().map(Parameter::from)).collect();
        for prior in priors(call, file, &request, &options.priors, &unknowns)? {
            // What is said of a place goes before the uncertainty that its file gives.
            known.retain(|other| other.unknown != prior.unknown);
            known.push(prior);
        }
        let mut request = request;
        request.priors.extend(options.priors.iter().cloned());
        request.type_b.extend(options.type_b.iter().cloned());
        let shared: Result<Vec<TypeB>, _> = request.type_b.iter().map(|words| type_b(words)).collect();
        let type_b = shared.or_else(|refusal| call.refuse(*refusal))?;
        Ok(Self { request, unknowns, bounds, known, type_b, rows: data.rows, hashes })
    }

    fn model(&self, machine: &Machine, order: Order) -> Model<'_> {
        Model::new(machine, &self.unknowns).bounded(&self.bounds).knowing(&self.known).to_order(order)
    }
}

/// The parameters asked for.
struct Requested {
    request: IdentifyEntry,
    own: Vec<Parameter>,
    bounds: Vec<SlopeBound>,
}

impl Requested {
    fn of(call: &mut Call<'_>, file: &MachineFile, fit: &[String], fixed: &[String]) -> Result<Self, Refused> {
        let request = overruled(file, file.identify.clone().unwrap_or_default(), fit, fixed);
        let own = parameters(file, &request).or_else(|refusal| call.refuse(*refusal))?;
        let bounds = slope_bounds(file, &request, &own).or_else(|refusal| call.refuse(*refusal))?;
        // A list of one's own takes what it needs of the section.
        if fit.is_empty() {
            call.extend(remarks::unused(&unused(file, &request, &own)));
        }
        Ok(Self { request, own, bounds })
    }
}

/// What is known of the unknowns before the data. A prior of the section that names nothing here has no effect.
fn priors(
    call: &mut Call<'_>,
    file: &MachineFile,
    request: &IdentifyEntry,
    options: &[String],
    unknowns: &[Parameter],
) -> Result<Vec<Known>, Refused> {
    let mut list: Vec<Known> = Vec::new();
    let mut idle = Vec::new();
    for (k, words) in request.priors.iter().chain(options).enumerate() {
        match known(words, file, unknowns) {
            Ok(found) => found.into_iter().for_each(|one| {
                list.retain(|other| other.unknown != one.unknown);
                list.push(one);
            }),
            Err(_) if k < request.priors.len() => idle.push(format!("prior {}", shown(words))),
            Err(refusal) => return call.refuse(*refusal),
        }
    }
    call.extend(remarks::unused(&idle));
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

/// The measurements, and the hashes of their files.
fn measurements(
    call: &mut Call<'_>,
    file: &MachineFile,
    options: &IdentifyOptions,
) -> Result<(MeasurementSet, BTreeMap<PathBuf, String>), Refused> {
    let texts =
        options.texts.iter().fold(MemoryFiles::default(), |files, (name, text)| files.with(name, text.as_str()));
    let overlay = Overlay { text: texts, files: call.run.files };
    let recording = Recording { files: &overlay, hashes: RefCell::default() };
    let paths = options.paths();
    let context = ReadingContext { frame: options.frame, axis_poses: options.axis_poses.clone() };
    let data = read_measurements(&paths, file, &context, &recording, &mut call.diagnostics);
    call.checked()?;
    let hashes = recording.hashes.into_inner();
    refuse_copies(call, &paths, &hashes)?;
    poses::check(call, file, data.rows.iter().flat_map(Measurement::poses))?;
    Ok((data, hashes))
}

/// Files with the same contents would count twice.
fn refuse_copies(call: &mut Call<'_>, list: &[PathBuf], hashes: &BTreeMap<PathBuf, String>) -> Result<(), Refused> {
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

fn enough(call: &mut Call<'_>, problem: &Problem) -> Result<(), Refused> {
    let unknowns = problem.unknowns.len();
    let readings: usize = problem.rows.iter().map(Measurement::readings).sum();
    let instruments = problem.unknowns.iter().filter(|p| p.is_nuisance()).count();
    if unknowns > MAX_UNKNOWNS {
        let message = format!("{unknowns} unknowns, {instruments} of them of instruments, are too many");
        let help = "at most 500: fit less, or take runs of the same set-up together under one name";
        return call.refuse(Diagnostic::new(codes::E0508, message).help(help));
    }
    if readings + problem.known.len() >= unknowns {
        return Ok(());
    }
    let also = if instruments > 0 {
        format!(" and {} of the instruments", counted(instruments, "unknown"))
    } else {
        String::new()
    };
    let own = counted(unknowns - instruments, "parameter");
    let message = format!("{} cannot determine {own}{also}", counted(readings, "reading"));
    call.refuse(Diagnostic::new(codes::E0503, message).help("measure more poses, or fit less"))
}

/// A fit with all that is known of it.
struct Fitted<'a> {
    machine: &'a Machine,
    /// The machine's parameters first.
    unknowns: &'a [Parameter],
    /// Number of the machine's parameters.
    own: usize,
    data: &'a [Measurement],
    solution: Solution,
    residuals: Residuals,
    randomness: Vec<Randomness>,
    held_out: Option<f64>,
    prediction: Prediction,
    /// Rigid motions of the whole machine that no reading notices.
    motions: Vec<String>,
    repeats: Vec<Repeats>,
    /// Values known before the data.
    known: &'a [Known],
    type_b: &'a [TypeB],
    /// The form of the axes beside the curves; `None` if the readings cannot show it.
    misfit: Option<Misfit>,
    datum: Option<FittedDatum>,
    fit: &'a Fit,
}

impl Fitted<'_> {
    fn rows(&self) -> usize {
        self.fit.reduced.rows
    }
}

fn solved(
    call: &mut Call<'_>,
    file: &MachineFile,
    options: &IdentifyOptions,
    (problem, progress): (&Problem, &(dyn Fn(usize) + Sync)),
) -> Result<IdentifyResult, Refused> {
    let (model, data) = (problem.model(file, options.order()).reporting(progress), &problem.rows);
    let found = invariances(&model, data);
    if let Some(refusal) = remarks::shrinking(&found.stretches) {
        return call.refuse(refusal);
    }
    let fit = solve(&model, data, options.robust);
    let conditions = datum::conditions(file, &problem.request, &problem.unknowns[..model.own()]);
    let examined = |fit: &Fit| {
        let solution = Solution::of(fit, &problem.unknowns).compared(&model, data, fit, &found.moving);
        let misfit = misfit(&model, data, fit, &solution);
        let common = common(&model, data, (fit, &solution), &problem.type_b);
        let solution = solution.sharing(misfit.as_ref().map(|misfit| [&misfit.covariance, &misfit.apart]), common);
        let in_datum = in_datum(&model, data, fit, &solution, &conditions);
        let (solution, moved) = in_datum.map_or((solution, None), |(solution, moved)| (solution, Some(moved)));
        (solution, misfit, moved)
    };
    let (solution, misfit, moved) = examined(&fit);
    let datum = moved.map(|moved| FittedDatum::of(conditions.entry, &moved));
    // Uncertainties by the linear problem at the values that are stated.
    let (fit, solution, misfit) = if moved.is_some_and(|moved| moved.far) {
        let there = fit.at(&model, data, solution.theta());
        let (solution, misfit, _) = examined(&there);
        (there, solution, misfit)
    } else {
        (fit, solution, misfit)
    };
    let forms = misfit.as_ref().map_or(&[][..], |misfit| &misfit.forms);
    // In the datum: products of what a datum takes out are no deviation.
    let prediction = Prediction::of(&model, data, (&fit, &solution), forms);
    let theta = solution.theta();
    let fitted = Fitted {
        machine: file,
        unknowns: &problem.unknowns,
        own: model.own(),
        data,
        residuals: Residuals::of(&model, data, &theta),
        randomness: randomness(data, &model.residuals(data, &theta), &fit.weights),
        prediction,
        datum,
        motions: found.motions,
        solution,
        held_out: options.folds.and_then(|folds| held_out(&model, data, folds, options.robust)),
        repeats: repeats(data),
        known: &problem.known,
        type_b: &problem.type_b,
        misfit,
        fit: &fit,
    };
    let sources = &call.diagnostics.sources;
    let remarks = remarks::all(&fitted, sources);
    let mut result = IdentifyResult::of(&fitted, sources);
    call.extend(remarks);
    if options.machine_file {
        result.machine_file = Some(machine_file(call, file, options, problem, &fitted)?);
    } else if let Err(why) = plausible(file, options, problem, &fitted, false) {
        call.extend([remarks::implausible(&why)]);
    }
    if options.pictures {
        let drawn = pictures::drawn(&model, data, &theta).or_else(|refusal| call.refuse(refusal));
        result.pictures = drawn?;
    }
    Ok(result)
}

/// The text of the fitted machine file, if it is one that the program itself would take.
fn machine_file(
    call: &mut Call<'_>,
    file: &MachineFile,
    options: &IdentifyOptions,
    problem: &Problem,
    fitted: &Fitted<'_>,
) -> Result<String, Refused> {
    call.extend(remarks::written(fitted));
    let refusals = [remarks::undetermined(fitted), remarks::unheld(fitted)];
    let refusals: Vec<Diagnostic> = refusals.into_iter().flatten().collect();
    // What is not determined has no covariance that would mean anything.
    let joint = refusals.is_empty();
    if let ([first, others @ ..], false) = (&refusals[..], options.accept_undetermined) {
        call.extend(others.iter().cloned());
        return call.refuse(first.clone());
    }
    plausible(file, options, problem, fitted, joint).or_else(|why| call.refuse(remarks::refused(&why)))
}

/// The text of the fitted machine file, or why the program itself would not take it.
fn plausible(
    file: &MachineFile,
    options: &IdentifyOptions,
    problem: &Problem,
    fitted: &Fitted<'_>,
    joint: bool,
) -> Result<String, ReadBackFailure> {
    let provenance = provenance::entries(file, options, problem, fitted);
    let own_parameters = &fitted.unknowns[..fitted.own];
    let text = |request: &IdentifyEntry| {
        let notes = FileNotes { provenance: &provenance, request, joint, misfit: fitted.misfit.as_ref() };
        fitted_file(file, own_parameters, &fitted.solution, notes)
    };
    let first = text(&problem.request);
    let refused = match read_back(&first) {
        Ok(_) => return Ok(first),
        Err(why) => why,
    };
    // A machine whose readings show larger errors than usual may have them.
    let shown = limits::shown(&problem.request, fitted.fit.shown);
    shown.map(|request| text(&request)).filter(|text| read_back(text).is_ok()).ok_or(refused)
}
