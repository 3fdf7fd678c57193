//! Makes the record of a calibration.
//!
//! 1. The description is read, and the files that it names are copied.
//! 2. The errors of both states make the table and the curves; limits judge them.
//! 3. Installed sets are verified.
//! 4. The documents are written, and the list of all hashes.

use super::data::{Instrument, LimitDecision, Line, RecordData, RecordedFigures, RecordedSet};
use super::dcc::certificate;
use super::decisions::{Figures, decisions, document};
use super::description::{Description, SetEntry, StateName, unfit};
use super::errors;
use super::figures::{contributors_in, figures_in, runs_in};
use super::files::{JSON_NAME, RecordFiles};
use super::page::{RecordPictures, record_page, record_pictures};
use super::promise::promised;
use super::sign::{SIGNATURE_NAME, Signer};
use crate::controller::Lock;
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::job::machine_file::{LoadOptions, MachineFile, load};
use crate::run::{Call, Refused, finite};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A set to be verified. Paths are as they are read.
pub(crate) struct SetUnderTest {
    pub folder: PathBuf,
    /// The folder with the files in force before.
    pub installed: Option<PathBuf>,
    pub second: Option<SecondFiles>,
}

/// A second measurement, with the set in force.
pub(crate) struct SecondFiles {
    pub data: Vec<PathBuf>,
    pub axis_poses: Option<PathBuf>,
    pub type_b: Vec<String>,
}

/// Verifies a set against a machine.
pub(crate) type Verify<'a> = &'a dyn Fn(&mut Call<'_>, &MachineFile, SetUnderTest) -> Result<Value, Refused>;

/// A record in memory.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct Record {
    /// Its files: name within the folder, `/` between folders, and bytes.
    #[serde(skip)]
    pub files: Vec<(String, Vec<u8>)>,
    /// Its content.
    #[serde(flatten)]
    pub data: RecordData,
}

struct States {
    found: MachineFile,
    left: Option<MachineFile>,
}

impl States {
    fn of(&self, state: StateName) -> &MachineFile {
        match (state, &self.left) {
            (StateName::Left, Some(left)) => left,
            _ => &self.found,
        }
    }
}

/// Makes the record that a description asks for, with a tool of the machine; a key signs it.
pub(crate) fn make(
    call: &mut Call,
    path: &Path,
    load_options: &LoadOptions,
    key: Option<&Path>,
    verify: Verify<'_>,
) -> Result<Record, Refused> {
    let signer = key.map(|key| Signer::read(call, key)).transpose()?;
    let description = Description::read(call, path)?;
    let base = path.parent().unwrap_or(Path::new(""));
    let machine = |call: &mut Call, name: &Line| {
        let answer = load(base.join(name.as_str()), load_options, call.run);
        call.take(answer)
    };
    let found = machine(call, &description.as_found)?;
    let left = description.as_left.as_ref().map(|name| machine(call, name)).transpose()?;
    let states = States { found, left };
    let mut files = RecordFiles::default();
    let as_found = files.machine(call, &states.found, load_options, "as-found")?;
    let as_left = states.left.as_ref().map(|left| files.machine(call, left, load_options, "as-left")).transpose()?;
    let mut data = Vec::new();
    for source in &description.data {
        data.push(files.copy(call, base, source, "data")?.0);
    }
    let (copies, figures) = figures(call, &description, base, &mut files)?;
    let instruments = instruments(call, &description, base, &mut files)?;
    let rows = errors::rows(&states.found, states.left.as_deref());
    if rows.iter().all(|row| row.found.is_none_or(|found| found.bounded || found.held)) {
        let message = format!("`{}` gives no error a value", shown(states.found.path()));
        return call.refuse(unfit(message, "name a machine file with measured errors, such as `identify` writes"));
    }
    let (decisions, alarms) = decisions(call, &description, &rows, &figures)?;
    let mut sets = Vec::new();
    for (number, entry) in description.sets.iter().enumerate() {
        let set = set(call, entry, number + 1, base, &states, verify, &mut files)?;
        let verified = set.verify.as_ref();
        let promised = verified.and_then(|verified| promised(states.of(entry.verify_with), &figures, verified));
        sets.push(RecordedSet { promised, ..set });
        let second = entry.second.iter().flat_map(|second| second.data.iter().chain(&second.axis_poses));
        for source in second.filter(|source| !description.data.contains(source)) {
            data.push(files.copy(call, base, source, "data")?.0);
        }
    }
    let mut curves = errors::curves(&states.found, "found");
    curves.extend(states.left.iter().flat_map(|left| errors::curves(left, "left")));
    let mut covariances: Vec<_> = errors::covariance(&states.found, "found").into_iter().collect();
    covariances.extend(states.left.as_ref().and_then(|left| errors::covariance(left, "left")));
    let Description { id, dates, language, country, place, laboratory, customer, .. } = description;
    let data = RecordData {
        record: 1,
        abbe: env!("CARGO_PKG_VERSION"),
        id,
        dates,
        language,
        country,
        place,
        laboratory,
        customer,
        persons: description.persons,
        machine: states.found.name().to_owned(),
        chain: states.found.chain().to_string(),
        plate: description.machine,
        instruments,
        temperatures: description.temperatures,
        standards: description.standards,
        statements: description.statements,
        remarks: description.remarks,
        as_found,
        as_left,
        errors: rows,
        covariances,
        curves,
        decisions,
        alarms,
        sets,
        data,
        figures: copies,
        signature: signer.as_ref().map(|signer| signer.stated(call)).transpose()?,
        files: Vec::new(),
    };
    let runs = figures.iter().filter_map(|of| Some((format!("Runs, {}", of.source), runs_in(&of.document)?)));
    let mut pictures = record_pictures(&states.found, states.left.as_deref());
    pictures.extend(runs);
    write(call, data, &pictures, files, signer.as_ref())
}

fn write(
    call: &mut Call,
    mut data: RecordData,
    pictures: &RecordPictures,
    mut files: RecordFiles,
    signer: Option<&Signer>,
) -> Result<Record, Refused> {
    call.extend(finite::refusal(&data));
    call.check()?;
    let failed = |what: &str, why: String| {
        Diagnostic::new(codes::E0702, format!("the template of {what} failed: {why}"))
            .help("report this: it is a fault")
    };
    let page = record_page(&data, pictures).or_else(|why| call.refuse(failed("record.html", why.to_string())))?;
    let xml = match certificate(&data) {
        Ok(xml) => xml,
        Err(why) => return call.refuse(failed("certificate.xml", why.to_string())),
    };
    for (name, text) in [("record.html", page), ("certificate.xml", xml)] {
        let _ = files.add(call, name.to_owned(), text.into_bytes())?;
    }
    data.files = files.hashes();
    let json = (serde_json::to_string_pretty(&data).unwrap_or_default() + "\n").into_bytes();
    if let Some(signer) = signer {
        let signature = signer.sign(call, &json)?;
        let _ = files.add(call, SIGNATURE_NAME.to_owned(), signature)?;
    }
    let _ = files.add(call, JSON_NAME.to_owned(), json)?;
    Ok(Record { files: files.finish(), data })
}

fn figures(
    call: &mut Call,
    description: &Description,
    base: &Path,
    files: &mut RecordFiles,
) -> Result<(Vec<RecordedFigures>, Vec<Figures>), Refused> {
    let (mut copies, mut figures) = (Vec::new(), Vec::new());
    for source in &description.figures {
        let (copy, bytes) = files.copy(call, base, source, "figures")?;
        let document = document(call, source, &bytes)?;
        let (values, contributors) = (figures_in(&document), contributors_in(&document));
        figures.push(Figures { source: source.to_string(), file: copy.file.clone(), document });
        copies.push(RecordedFigures { copy, values, contributors });
    }
    Ok((copies, figures))
}

/// The instruments, with the names of the copies of their certificates.
fn instruments(
    call: &mut Call,
    description: &Description,
    base: &Path,
    files: &mut RecordFiles,
) -> Result<Vec<Instrument>, Refused> {
    let mut all = description.instruments.clone();
    for instrument in &mut all {
        if let Some(due) = instrument.due.as_ref().filter(|due| **due < description.dates.end) {
            let message = format!("the certificate of `{}` ended on {}", instrument.name, due.as_str());
            call.warn(Diagnostic::new(codes::W0820, message).help("its calibration does not cover the last day"));
        }
        if instrument.calibrated > description.dates.begin {
            let message = format!("`{}` was calibrated on {}", instrument.name, instrument.calibrated.as_str());
            call.warn(Diagnostic::new(codes::W0820, message).help("its calibration does not cover the first day"));
        }
        let Some(source) = &instrument.file else { continue };
        let copy = files.copy(call, base, source, "instruments")?.0;
        instrument.file = Line::try_from(copy.file).ok();
    }
    Ok(all)
}

/// Copies the certificate that `compile` printed of a set.
fn compiled(
    call: &mut Call,
    source: &Line,
    base: &Path,
    lock: &Lock,
    files: &mut RecordFiles,
) -> Result<Value, Refused> {
    let (_, bytes) = files.copy(call, base, source, "certificates")?;
    let compile = document(call, source, &bytes)?;
    let help = "write it with `abbe compile ... --format json`";
    if compile.pointer("/compensated/position_um/p95").is_none_or(|p95| !p95.is_number()) {
        return call.refuse(unfit(format!("`{source}` is no certificate of `compile`"), help));
    }
    if compile["target"].as_str() != Some(&lock.target) {
        let target = shown(compile["target"].as_str().unwrap_or_default());
        let message =
            format!("`{source}` is the certificate of a set for `{target}`, the set is for `{}`", lock.target);
        return call.refuse(unfit(message, help));
    }
    Ok(compile)
}

/// True unless two certificates over the same number of poses of the volume state different deviations without files.
fn is_of_same_errors(compile: &Value, verified: &Value) -> bool {
    let is_alike = |key: &str| compile.pointer(key) == verified.pointer(key);
    let p95 = |of: &Value| of.pointer("/uncompensated/position_um/p95").and_then(Value::as_f64);
    let (Some(stated), Some(found)) = (p95(compile), p95(verified)) else { return true };
    !(is_alike("/poses") && is_alike("/over/kind") && is_alike("/direction") && is_alike("/tool"))
        || (stated - found).abs() <= 1e-6 * found.max(1e-3)
}

/// Copies a set, and verifies it if it is installed.
fn set(
    call: &mut Call,
    entry: &SetEntry,
    number: usize,
    base: &Path,
    states: &States,
    verify: Verify<'_>,
    files: &mut RecordFiles,
) -> Result<RecordedSet, Refused> {
    let path = base.join(entry.folder.as_str());
    let folder = format!("sets/{number}");
    let (lock, copied) = files.set(call, &path, &folder)?;
    let compile = entry.compile.as_ref().map(|source| compiled(call, source, base, &lock, files)).transpose()?;
    let at = |name: &Line| base.join(name.as_str());
    let second = entry.second.as_ref().map(|second| SecondFiles {
        data: second.data.iter().map(at).collect(),
        axis_poses: second.axis_poses.as_ref().map(at),
        type_b: second.type_b.iter().map(Line::to_string).collect(),
    });
    let under_test = SetUnderTest { folder: path, installed: entry.installed.as_ref().map(at), second };
    let machine = states.of(entry.verify_with);
    let verified = (!entry.replaced).then(|| verify(call, machine, under_test)).transpose()?;
    if let (Some(source), Some(compile), Some(verified)) = (&entry.compile, &compile, &verified) {
        let is_of_machine = entry.verify_with == StateName::Found && entry.installed.is_none();
        if is_of_machine && !is_of_same_errors(compile, verified) {
            let message = format!("`{source}` is the certificate of other errors than those of the machine as found");
            return call.refuse(unfit(message, "compile the set from `as_found`, and write its document anew"));
        }
    }
    Ok(RecordedSet {
        folder,
        installed: !entry.replaced,
        target: lock.target,
        files: copied,
        verified_with: verified.is_some().then(|| entry.verify_with.word()),
        verify: verified,
        promised: None,
        compile,
    })
}

impl Record {
    /// Returns the decisions.
    pub fn decisions(&self) -> &[LimitDecision] {
        &self.data.decisions
    }
}
