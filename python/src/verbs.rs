//! The verbs: each is one call of the façade. Their table is what the methods of the package are generated from.

use crate::diagnostics::refusal;
use crate::interrupt::run_owned;
use crate::machine::NativeMachine;
use crate::outcome::{NativeOutcome, Outcome};
use crate::request::{Request, TextsAndDisk};
use abbe::options::{MapTable, Starter, StudyFile, TableForm};
use abbe::sets::LOCK_NAME;
use abbe::{
    Answer, BudgetOptions, ClassifyOptions, CompareOptions, CompileOptions, ConvertOptions, Diagnostic, Diagnostics,
    DiffMachinesOptions, DiffOptions, EnumerateOptions, EquationsOptions, EvalOptions, FiguresOptions, IdentifyOptions,
    ImportOptions, InstrumentOptions, LocateOptions, MapOptions, PlanOptions, ReachOptions, RecordOptions,
    ReportOptions, Run, VerifyOptions,
};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use schemars::{JsonSchema, schema_for};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

type Found = Result<Outcome, Diagnostics>;
type Dispatch = dyn Fn(&Request, Run<'_>) -> Found + Send + Sync;
type Job<O> = fn(&Request, &O, Run<'_>) -> Found;

/// A verb with its options.
struct Verb {
    name: &'static str,
    schema: fn() -> Value,
    run: Box<Dispatch>,
}

impl Verb {
    fn new<O: DeserializeOwned + Default + Serialize + JsonSchema + 'static>(name: &'static str, job: Job<O>) -> Self {
        let schema = || json!({"schema": schema_for!(O), "default": O::default()});
        Self { name, schema, run: Box::new(move |request, run| job(request, &request.options()?, run)) }
    }
}

/// Rows of the pictures of a budget: as many as the program draws.
const TOP: usize = 12;

/// Name of the study's results.
const STATE: &str = "state";

/// Returns all verbs.
fn table() -> [Verb; 22] {
    [
        Verb::new("eval", |request, options: &EvalOptions, run| {
            Ok(Outcome::of(request, abbe::eval(request.machine()?, options, run)?).0)
        }),
        Verb::new("equations", equations),
        Verb::new("convert", convert),
        Verb::new("map", map),
        Verb::new("reach", |request, options: &ReachOptions, run| {
            let (outcome, result) = Outcome::of(request, abbe::reach(request.machine()?, options, run)?);
            Ok(outcome.text("reach.svg", result.picture().svg()))
        }),
        Verb::new("compare", |request, options: &CompareOptions, run| {
            Ok(Outcome::of(request, abbe::compare(&request.machine_files(), options, run)?).0)
        }),
        Verb::new("budget", budget),
        Verb::new("enumerate", enumerate),
        Verb::new("instrument", |request, options: &InstrumentOptions, run| {
            let (outcome, result) = Outcome::of(request, abbe::instrument(request.machine()?, options, run)?);
            Ok(outcome.text("readings.svg", result.picture().svg()))
        }),
        Verb::new("identify", identify),
        Verb::new("fit_monomials", |request, options: &IdentifyOptions, run| {
            Ok(Outcome::of(request, abbe::fit_monomials(request.machine()?, options, run)?).0)
        }),
        Verb::new("plan", |request, options: &PlanOptions, run| {
            let (outcome, plan) = Outcome::of(request, abbe::plan_measurements(request.machine()?, options, run)?);
            Ok(outcome.text("plan.csv", plan.csv))
        }),
        Verb::new("import_readings", |request, options: &ImportOptions, run| {
            let (outcome, result) = Outcome::of(request, abbe::import(request.path(0)?, options, run)?);
            Ok(outcome.text("table.csv", result.table))
        }),
        Verb::new("figures", |request, options: &FiguresOptions, run| {
            let (outcome, result) = Outcome::of(request, abbe::figures(request.path(0)?, options, run)?);
            Ok(outcome.text("figures.svg", result.picture().svg()))
        }),
        Verb::new("locate", |request, options: &LocateOptions, run| {
            let (outcome, result) =
                Outcome::of(request, abbe::locate(request.machine()?, Some(request.path(0)?), options, run)?);
            Ok(outcome.text("machine.yaml", result.machine_file))
        }),
        Verb::new("record", |request, options: &RecordOptions, run| {
            let (outcome, record) = Outcome::of(request, abbe::record(request.path(0)?, options, run)?);
            Ok(Outcome { files: record.files, ..outcome })
        }),
        Verb::new("record_trend", |request, options: &RecordOptions, run| {
            let folders: Vec<PathBuf> = request.words.iter().map(PathBuf::from).collect();
            let (outcome, trend) = Outcome::of(request, abbe::record_trend(&folders, options, run)?);
            Ok(outcome.text("trend.svg", trend.picture().svg()))
        }),
        Verb::new("compile", compile),
        Verb::new("verify", |request, options: &VerifyOptions, run| {
            let answer = abbe::verify(request.machine()?, request.path(0)?, options, run)?;
            Ok(Outcome::of(request, answer).0)
        }),
        Verb::new("diff_sets", |request, options: &DiffOptions, run| {
            let answer = abbe::diff(request.machine()?, request.path(0)?, request.path(1)?, options, run)?;
            Ok(Outcome::of(request, answer).0)
        }),
        Verb::new("diff", |request, options: &DiffMachinesOptions, run| {
            Ok(Outcome::of(request, abbe::diff_machines(&request.machine_files(), options, run)?).0)
        }),
        Verb::new("report", report),
    ]
}

/// Verbs without a machine and without a struct of options.
fn plain(name: &str, request: &Request, run: Run<'_>) -> Option<Found> {
    Some(match name {
        "check" => Ok(Outcome::plain(json!(abbe::check(&request.words, run)))),
        "classify" => classify(request, run),
        "check_record" => check_record(request, run),
        "targets" => Ok(Outcome::plain(json!({"targets": abbe::targets()}))),
        "schema" => Ok(Outcome::plain(abbe::schema())),
        "explain" => explain(request),
        "starter" => request.options::<Kind>().map(|of| Outcome::plain(json!(abbe::starter(of.kind)))),
        _ => return None,
    })
}

/// Options of `starter`.
#[derive(serde::Deserialize)]
struct Kind {
    kind: Starter,
}

fn explain(request: &Request) -> Found {
    Ok(Outcome::plain(json!(abbe::explain(request.word(0)?).map_err(Diagnostics::from)?)))
}

fn classify(request: &Request, run: Run<'_>) -> Found {
    let options: ClassifyOptions = request.options()?;
    Ok(Outcome::of(request, abbe::classify(request.path(0)?, &options, run)?).0)
}

fn check_record(request: &Request, run: Run<'_>) -> Found {
    Ok(Outcome::of(request, abbe::check_record(request.path(0)?, run)?).0)
}

fn equations(request: &Request, options: &EquationsOptions, run: Run<'_>) -> Found {
    let (outcome, result) = Outcome::of(request, abbe::equations(request.machine()?, options, run)?);
    Ok(outcome.text("equations.txt", result.text()).text("equations.tex", result.latex()))
}

fn convert(request: &Request, options: &ConvertOptions, run: Run<'_>) -> Found {
    let (outcome, result) = Outcome::of(request, abbe::convert(request.machine()?, options, run)?);
    Ok(outcome.text("machine.yaml", result.machine_file))
}

fn map(request: &Request, options: &MapOptions, run: Run<'_>) -> Found {
    let mut rows = Cursor::new(Vec::new());
    let mut tables = Vec::new();
    if request.rows {
        tables.push(MapTable { name: "the array".to_owned(), form: TableForm::Npy, sink: Box::new(&mut rows) });
    }
    let answer = abbe::map_tables(request.machine()?, options, tables, run)?;
    let (outcome, result) = Outcome::of(request, answer);
    let mut outcome = Outcome { rows: request.rows.then(|| rows.into_inner()), ..outcome };
    outcome.texts.extend(result.picture.map(|picture| ("map.svg".to_owned(), picture.svg())));
    outcome.texts.extend(result.grid.map(|counts| ("grid".to_owned(), json!(counts).to_string())));
    Ok(outcome)
}

fn budget(request: &Request, options: &BudgetOptions, run: Run<'_>) -> Found {
    if options.shard.is_some() {
        let answer = abbe::budget_part(request.machine()?, options, run)?;
        let state = answer.value.to_text();
        let progress = json!({"samples": answer.value.samples, "drawn": answer.value.count()});
        return Ok(Outcome::of(request, Answer { value: progress, warnings: answer.warnings }).0.text(STATE, state));
    }
    let (outcome, result) = Outcome::of(request, abbe::budget(request.machine()?, options, run)?);
    Ok(outcome.text("pareto.svg", result.pareto(TOP).svg()).text("waterfall.svg", result.waterfall(TOP).svg()))
}

/// Keeps the results of a study in memory.
struct State(Mutex<String>);

impl StudyFile for State {
    fn keep(&self, text: &dyn Fn() -> String, last: bool) -> Result<(), Diagnostic> {
        if last {
            *self.0.lock().unwrap_or_else(PoisonError::into_inner) = text();
        }
        Ok(())
    }
}

fn enumerate(request: &Request, options: &EnumerateOptions, run: Run<'_>) -> Found {
    let state = State(Mutex::default());
    let (outcome, _) = Outcome::of(request, abbe::enumerate(request.machine()?, options, Some(&state), run)?);
    Ok(outcome.text(STATE, state.0.into_inner().unwrap_or_else(PoisonError::into_inner)))
}

fn identify(request: &Request, options: &IdentifyOptions, run: Run<'_>) -> Found {
    let (mut outcome, result) = Outcome::of(request, abbe::identify(request.machine()?, options, run)?);
    outcome.texts.extend(result.machine_file.map(|text| ("machine.yaml".to_owned(), text)));
    outcome.texts.extend(result.pictures.into_iter().map(|picture| (picture.name, picture.svg)));
    Ok(outcome)
}

fn compile(request: &Request, options: &CompileOptions, run: Run<'_>) -> Found {
    let (outcome, set) = Outcome::of(request, abbe::compile(request.machine()?, options, run)?);
    let lock = (LOCK_NAME.to_owned(), set.lock.to_text().into_bytes());
    let files = set.files.into_iter().map(|file| (file.name, file.bytes)).chain([lock]).collect();
    Ok(Outcome { files, ..outcome })
}

fn report(request: &Request, options: &ReportOptions, run: Run<'_>) -> Found {
    let answer = abbe::report(&request.machine_files(), options, run)?;
    let page = answer.value.page(&[]).map_err(Diagnostics::from)?.text;
    let bytes = Answer { value: json!({"bytes": page.len()}), warnings: answer.warnings };
    Ok(Outcome::of(request, bytes).0.text("report.html", page))
}

/// Runs a verb. `options` is a JSON object, `words` are paths or names, `texts` are files by name that come before
/// those of the disk, `rows` asks for every pose as an array, `threads` is 0 for the default.
#[pyfunction]
#[pyo3(signature = (verb, machines, words, options, texts, rows, threads))]
#[allow(clippy::too_many_arguments, reason = "one call for all verbs")]
pub fn run(
    py: Python<'_>,
    verb: String,
    machines: Vec<PyRef<'_, NativeMachine>>,
    words: Vec<String>,
    options: String,
    texts: Vec<(String, String)>,
    rows: bool,
    threads: usize,
) -> PyResult<NativeOutcome> {
    let machines = machines.iter().map(|machine| machine.loaded.clone()).collect();
    let request = Request { machines, words, options, texts, rows };
    let name = verb.clone();
    let found = run_owned(py, threads, move |monitor| {
        let files = TextsAndDisk::of(&request);
        let run = files.run(monitor);
        let by_table = || table().into_iter().find(|known| known.name == verb).map(|known| (known.run)(&request, run));
        plain(&verb, &request, run).or_else(by_table)
    })?;
    let found = found.ok_or_else(|| PyKeyError::new_err(name))?;
    found.map(NativeOutcome).map_err(|diagnostics| refusal(py, &diagnostics))
}

/// Returns the verbs with options as JSON: by name, the JSON Schema of their options, and their default.
#[pyfunction]
pub fn verbs() -> String {
    let entry = |verb: Verb| (verb.name.to_owned(), (verb.schema)());
    Value::Object(table().into_iter().map(entry).collect()).to_string()
}
