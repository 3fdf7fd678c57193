//! `record`: one calibration as a folder.
//!
//! 1. `description` reads what the engineer states; `files` copies the files that it names.
//! 2. `errors` makes the table of errors and the curves, `decisions` judges them by their limits.
//! 3. The certificate of every installed set is that of `verify`.
//! 4. `record.json`, `record.html` and `certificate.xml` are written from these, and `SHA256SUMS` lists every file.
//!
//! `check` compares a folder with its `SHA256SUMS`; `trend` puts records in a line.

mod trend;

pub use crate::record::check::{RecordCheck, check_record};
pub use crate::record::files::{SetFault, SetFiles, set_files};
pub use trend::{AlarmState, ErrorTrend, RecordTrend, TrendPoint, TrendRecord, TrendStep, record_trend};

use super::verify::{VerifyOptions, verify};
use crate::diagnostic::{Diagnostic, Diagnostics, Sources, codes, shown};
use crate::file_set::options::CompensationOptions;
use crate::job::machine_file::{LoadOptions, MachineFile, load};
use crate::record::dcc::certificate;
use crate::record::decisions::{Figures, decisions, document};
use crate::record::description::{Description, SetEntry, StateName, unfit};
use crate::record::figures::{figures_in, runs_in};
use crate::record::files::{JSON_NAME, RecordFiles};
use crate::record::{
    Instrument, LimitDecision, Line, RecordData, RecordPictures, RecordedFigures, RecordedSet, errors, record_page,
    record_pictures,
};
use crate::run::{Answer, Call, Refused, Run};
use serde_json::{Value, json};
use std::path::Path;

/// Options of [`record`] and [`record_trend`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct RecordOptions {
    /// Tool of the machine; the first by default.
    pub tool: Option<String>,
    /// Options of the compensation, with which the sets are verified.
    pub compensation: CompensationOptions,
    /// Number of poses of certificates and comparisons.
    pub poses: usize,
    /// Seed of the poses.
    pub seed: u64,
}

impl Default for RecordOptions {
    fn default() -> Self {
        Self { tool: None, compensation: CompensationOptions::default(), poses: 2000, seed: 1 }
    }
}

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

/// Makes the record of a calibration from its description; nothing is written.
///
/// Fails if the description does not fit, if a file that it names cannot be read, and if an installed set does not
/// replay.
pub fn record(path: &Path, options: &RecordOptions, run: Run<'_>) -> Result<Answer<Record>, Diagnostics> {
    Call::answer(run, &Sources::default(), |call| made(call, path, options))
}

/// The two states of the machine.
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

/// Takes over the warnings or the refusal of another call.
fn taken<T>(call: &mut Call<'_>, answer: Result<Answer<T>, Diagnostics>) -> Result<T, Refused> {
    match answer {
        Ok(answer) => {
            call.diagnostics.absorb(answer.warnings);
            Ok(answer.value)
        }
        Err(refusal) => {
            call.diagnostics.absorb(refusal);
            Err(Refused)
        }
    }
}

fn made(call: &mut Call<'_>, path: &Path, options: &RecordOptions) -> Result<Record, Refused> {
    let description = Description::read(call, path)?;
    let base = path.parent().unwrap_or(Path::new(""));
    let load_options = LoadOptions { tool: options.tool.clone() };
    let machine = |call: &mut Call<'_>, name: &Line| {
        let answer = load(base.join(name.as_str()), &load_options, call.run);
        taken(call, answer)
    };
    let found = machine(call, &description.as_found)?;
    let left = description.as_left.as_ref().map(|name| machine(call, name)).transpose()?;
    let states = States { found, left };
    let mut files = RecordFiles::default();
    let as_found = files.machine(call, &states.found, &load_options, "as-found")?;
    let as_left = states.left.as_ref().map(|left| files.machine(call, left, &load_options, "as-left")).transpose()?;
    let mut data = Vec::new();
    for source in &description.data {
        data.push(files.copy(call, base, source, "data")?.0);
    }
    let (copies, figures) = figures(call, &description, base, &mut files)?;
    let instruments = instruments(call, &description, base, &mut files)?;
    let rows = errors::rows(&states.found, states.left.as_deref());
    if rows.iter().all(|row| row.found.is_none_or(|found| found.bounded)) {
        let message = format!("`{}` gives no error a value", shown(states.found.path()));
        return call.refuse(unfit(message, "name a machine file with measured errors, such as `identify` writes"));
    }
    let (decisions, alarms) = decisions(call, &description, &rows, &figures)?;
    let mut sets = Vec::new();
    for (number, entry) in description.sets.iter().enumerate() {
        sets.push(set(call, entry, (number + 1, base), (&states, options), &mut files)?);
    }
    let mut curves = errors::curves(&states.found, "found");
    curves.extend(states.left.iter().flat_map(|left| errors::curves(left, "left")));
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
        remarks: description.remarks,
        as_found,
        as_left,
        errors: rows,
        curves,
        decisions,
        alarms,
        sets,
        data,
        figures: copies,
    };
    let runs = figures.iter().filter_map(|of| Some((format!("Runs, {}", of.source), runs_in(&of.document)?)));
    let mut pictures = record_pictures(&states.found, states.left.as_deref());
    pictures.extend(runs);
    written(call, data, &pictures, files)
}

/// Writes the documents.
fn written(
    call: &mut Call<'_>,
    data: RecordData,
    pictures: &RecordPictures,
    mut files: RecordFiles,
) -> Result<Record, Refused> {
    call.extend(crate::run::finite::refusal(&data));
    call.checked()?;
    let failed = |what: &str, why: String| {
        Diagnostic::new(codes::E0702, format!("the template of {what} failed: {why}"))
            .help("report this: it is a fault")
    };
    let page = record_page(&data, pictures).or_else(|why| call.refuse(failed("record.html", why.to_string())))?;
    let xml = match certificate(&data) {
        Ok(xml) => xml,
        Err(why) => return call.refuse(failed("certificate.xml", why.to_string())),
    };
    let json = serde_json::to_string_pretty(&data).unwrap_or_default() + "\n";
    for (name, text) in [(JSON_NAME, json), ("record.html", page), ("certificate.xml", xml)] {
        let _ = files.add(call, name.to_owned(), text.into_bytes())?;
    }
    Ok(Record { files: files.finish(), data })
}

fn figures(
    call: &mut Call<'_>,
    description: &Description,
    base: &Path,
    files: &mut RecordFiles,
) -> Result<(Vec<RecordedFigures>, Vec<Figures>), Refused> {
    let (mut copies, mut figures) = (Vec::new(), Vec::new());
    for source in &description.figures {
        let (copy, bytes) = files.copy(call, base, source, "figures")?;
        let document = document(call, source, &bytes)?;
        let values = figures_in(&document);
        figures.push(Figures { source: source.to_string(), file: copy.file.clone(), document });
        copies.push(RecordedFigures { copy, values });
    }
    Ok((copies, figures))
}

/// The instruments, with the names of the copies of their certificates.
fn instruments(
    call: &mut Call<'_>,
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

/// Copies a set, and verifies it if it is installed.
fn set(
    call: &mut Call<'_>,
    entry: &SetEntry,
    (number, base): (usize, &Path),
    (states, options): (&States, &RecordOptions),
    files: &mut RecordFiles,
) -> Result<RecordedSet, Refused> {
    let path = base.join(entry.folder.as_str());
    let folder = format!("sets/{number}");
    let (lock, copied) = files.set(call, &path, &folder)?;
    let compile = match &entry.compile {
        None => None,
        Some(source) => {
            let (_, bytes) = files.copy(call, base, source, "certificates")?;
            let compile = document(call, source, &bytes)?;
            if compile.pointer("/compensated/position_um/p95").is_none_or(|p95| !p95.is_number()) {
                let message = format!("`{source}` is no certificate of `compile`");
                return call.refuse(unfit(message, "write it with `abbe compile ... --format json`"));
            }
            Some(compile)
        }
    };
    let verified = (!entry.replaced).then(|| verified(call, entry, base, &path, (states, options))).transpose()?;
    Ok(RecordedSet {
        folder,
        installed: !entry.replaced,
        target: lock.target,
        files: copied,
        verified_with: verified.is_some().then(|| entry.verify_with.word()),
        verify: verified,
        compile,
    })
}

fn verified(
    call: &mut Call<'_>,
    entry: &SetEntry,
    base: &Path,
    path: &Path,
    (states, options): (&States, &RecordOptions),
) -> Result<Value, Refused> {
    let options = VerifyOptions {
        target: None,
        compensation: options.compensation.clone(),
        poses: options.poses,
        seed: options.seed,
        installed: entry.installed.as_ref().map(|folder| base.join(folder.as_str())),
    };
    let answer = verify(states.of(entry.verify_with), path, &options, call.run);
    taken(call, answer).map(|report| json!(report))
}

impl Record {
    /// Returns the decisions.
    pub fn decisions(&self) -> &[LimitDecision] {
        &self.data.decisions
    }
}
