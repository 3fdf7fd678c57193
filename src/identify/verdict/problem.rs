//! The problem of a fit: the parameters and what is known of them, and the readings.

use super::inputs::FitInputs;
use super::remarks;
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::evaluate::Order;
use crate::identify::data::LEVER_MM;
use crate::identify::thresholds::{HELD_MM, MAX_IDLE_EFFECT_MM, MAX_UNKNOWNS};
use crate::identify::{
    FitModel, Gauge, Measurement, MeasurementSet, NEEDED, Parameter, PriorValue, ReadingContext, SlopeBound, ToolUse,
    TypeB, parameters_for, parse_gauge, parse_prior, read_measurements, slope_bounds, type_b, unused_entries,
    with_command_line,
};
use crate::job::machine_file::{MachineFile, Overlay};
use crate::job::poses;
use crate::machine::{Direction, Machine, plausible_size};
use crate::run::{Call, Refused, sha256};
use crate::syntax::{Files, IdentifyEntry, MemoryFiles, ReadFailure};
use crate::units::counted;
use indexmap::IndexSet;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The unknowns and the data of a fit.
#[derive(Clone)]
pub(crate) struct Problem {
    pub request: IdentifyEntry,
    pub unknowns: Vec<Parameter>,
    pub bounds: Vec<SlopeBound>,
    pub known: Vec<PriorValue>,
    pub gauges: Vec<Gauge>,
    pub type_b: Vec<TypeB>,
    pub rows: Vec<Measurement>,
    /// SHA-256 of the files of measurements, by path.
    pub hashes: BTreeMap<PathBuf, String>,
}

impl Problem {
    pub(crate) fn read(call: &mut Call, file: &MachineFile, inputs: &FitInputs<'_>) -> Result<Self, Refused> {
        let axis_poses = inputs.axis_poses.map(Path::to_owned);
        let context = ReadingContext { frame: inputs.frame, axis_poses, is_plan: inputs.is_plan };
        let (mut data, hashes) = measurements(call, file, &inputs.paths, inputs.texts, &context)?;
        let uses: IndexSet<ToolUse> = data.rows.iter().map(|m| ToolUse { tool: m.tool, run: m.run.clone() }).collect();
        let uses: Vec<ToolUse> = uses.into_iter().collect();
        // Unknowns of instruments are always fitted; those that are fixed are known to be as they start.
        let is_instrument = |word: &String| data.nuisances.iter().any(|unknown| unknown.name == word.trim());
        let (fixed, held) = inputs.fixed.iter().cloned().partition(|word| !is_instrument(word));
        let (held, fit): (Vec<String>, Vec<String>) =
            (held, inputs.fit.iter().filter(|word| !is_instrument(word)).cloned().collect());
        let Requested { request, own, bounds } = Requested::of(call, file, &fit, &fixed, &uses)?;
        call.extend(remarks::unused_readings(file, &data.leave_out(&own)));
        let mut known: Vec<PriorValue> = Vec::new();
        for (j, place) in data.nuisances.iter().enumerate() {
            let (unknown, value) = (own.len() + j, place.start);
            let is_held = held.iter().any(|word| word.trim() == place.name);
            let size = if place.is_angle { LEVER_MM } else { 1.0 };
            let sigma = if is_held { Some(HELD_MM / size) } else { place.known };
            known.extend(sigma.map(|sigma| PriorValue { unknown, value, sigma }));
        }
        let bases = vec![0.0; own.len()].into_iter().chain(data.nuisances.iter().map(|unknown| unknown.base)).collect();
        let unknowns: Vec<Parameter> = own.into_iter().chain(data.nuisances.into_iter().map(Parameter::from)).collect();
        let plausible = plausible_size(Some(&request), Direction::X);
        let priors =
            Priors { unknowns: &unknowns, bases, plausible }.read(call, file, &request.priors, inputs.priors)?;
        for prior in priors.0 {
            // What is said of a place goes before the uncertainty that its file gives.
            known.retain(|other| other.unknown != prior.unknown);
            known.push(prior);
        }
        let mut request = request;
        request.priors.extend(inputs.priors.iter().cloned());
        request.type_b.extend(inputs.type_b.iter().cloned());
        let shared: Result<Vec<TypeB>, _> = request.type_b.iter().map(|words| type_b(words)).collect();
        let type_b = shared.or_else(|refusal| call.refuse(*refusal))?;
        Ok(Self { request, unknowns, bounds, known, gauges: priors.1, type_b, rows: data.rows, hashes })
    }

    pub(crate) fn model(&self, machine: &Machine, order: Order) -> FitModel<'_> {
        FitModel::new(machine, &self.unknowns)
            .with_slope_bounds(&self.bounds)
            .with_known(&self.known)
            .with_gauges(&self.gauges)
            .to_order(order)
    }

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
            gauges: self.gauges.iter().filter_map(|gauge| gauge.among(&kept)).collect(),
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
    /// Reads the request for readings with these tools in these runs.
    fn of(
        call: &mut Call,
        file: &MachineFile,
        fit: &[String],
        fixed: &[String],
        uses: &[ToolUse],
    ) -> Result<Self, Refused> {
        let mut request = with_command_line(file, file.identify.clone().unwrap_or_default(), fit, fixed);
        if request.fit.is_empty() {
            call.announce(
                "nothing says what to fit: these are the location errors that the chain needs (--fit needed)",
            );
            request.fit.push(NEEDED.to_owned());
        }
        let own = parameters_for(file, &request, uses).or_else(|refusal| call.refuse(*refusal))?;
        let bounds = slope_bounds(file, &request, &own).or_else(|refusal| call.refuse(*refusal))?;
        // A list of one's own takes what it needs of the section.
        if fit.is_empty() {
            call.extend(remarks::entries_without_effect(&unused_entries(file, &request, &own)));
        }
        Ok(Self { request, own, bounds })
    }
}

/// The unknowns that priors name.
struct Priors<'a> {
    unknowns: &'a [Parameter],
    /// Zero of each unknown (mm).
    bases: Vec<f64>,
    /// Size (mm) of an error that is no mistake.
    plausible: f64,
}

impl Priors<'_> {
    /// Returns the values and distances known before the data. A prior of the section that names nothing here has no
    /// effect, and one of the options goes before it.
    fn read(
        &self,
        call: &mut Call,
        file: &MachineFile,
        section: &[String],
        options: &[String],
    ) -> Result<(Vec<PriorValue>, Vec<Gauge>), Refused> {
        let (mut list, mut gauges): (Vec<PriorValue>, Vec<(bool, Gauge)>) = Default::default();
        let mut without_effect = Vec::new();
        for (k, words) in section.iter().chain(options).enumerate() {
            let is_option = k >= section.len();
            let gauge = parse_gauge(words, self.unknowns, &self.bases, self.plausible);
            let found = match gauge {
                Ok(None) => parse_prior(words, file, self.unknowns).map(|found| (found, Vec::new())),
                Ok(Some(found)) => Ok((Vec::new(), found)),
                Err(refusal) => Err(refusal),
            };
            let (values, distances) = match found {
                Ok(found) => found,
                Err(_) if !is_option => {
                    without_effect.push(format!("prior {}", shown(words)));
                    continue;
                }
                Err(refusal) => return call.refuse(*refusal),
            };
            for one in values {
                list.retain(|other| other.unknown != one.unknown);
                list.push(one);
            }
            for one in distances {
                if gauges.iter().any(|(from, other)| *from == is_option && other.is_of_same(&one)) {
                    let message =
                        format!("the prior `{}` is of two points whose distance is given twice", shown(words));
                    let help = "give it once: the same gauge would count twice";
                    return call.refuse(Diagnostic::new(codes::E0516, message).help(help));
                }
                gauges.retain(|(_, other)| !other.is_of_same(&one));
                gauges.push((is_option, one));
            }
        }
        call.extend(remarks::entries_without_effect(&without_effect));
        Ok((list, gauges.into_iter().map(|(_, gauge)| gauge).collect()))
    }
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
    if readings + problem.known.len() + problem.gauges.len() >= unknowns {
        return Ok(());
    }
    let felt = felt_unknowns(file, problem);
    let unknowns = felt.iter().filter(|felt| **felt).count();
    let known = problem.known.iter().filter(|known| felt[known.unknown]).count() + problem.gauges.len();
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
