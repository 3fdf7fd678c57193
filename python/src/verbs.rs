//! The verbs: each is one call of the façade. Their table is what the methods of the package are generated from.

use crate::diagnostics::refusal;
use crate::interrupt::run_owned;
use crate::machine::NativeMachine;
use crate::outcome::{NativeOutcome, Outcome};
use crate::request::{Request, TextsAndDisk};
use abbe::options::{MapTable, Starter, StudyFile, TableForm};
use abbe::results::{
    BudgetResult, CertificateReport, ChainResult, Classification, CompareResult, CompiledSet, ComposedPart,
    ConvertResult, EquationsResult, ErrorSources, EvalResult, IdentifyResult, ImportResult, InstrumentResult,
    LocateResult, MachineDifference, MachineSummary, MapResult, MeasurementPlan, MonomialFit, RankedArrangements,
    ReachResult, Record as CalibrationRecord, RecordCheck, RecordTrend, SetDifference, TargetSummary, TestFigures,
};
use abbe::sets::LOCK_NAME;
use abbe::{
    Answer, BudgetOptions, ClassifyOptions, CompareOptions, CompileOptions, ConvertOptions, Diagnostic, Diagnostics,
    DiffMachinesOptions, DiffOptions, EnumerateOptions, EquationsOptions, EvalOptions, FiguresOptions, IdentifyOptions,
    ImportOptions, InstrumentOptions, LocateOptions, MapOptions, PlanOptions, ReachOptions, RecordOptions,
    ReportOptions, Run, VerifyOptions,
};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema, SchemaGenerator, schema_for};
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
    result: fn(&mut SchemaGenerator) -> Schema,
    run: Box<Dispatch>,
}

impl Verb {
    fn new<O, R>(name: &'static str, job: Job<O>) -> Self
    where
        O: DeserializeOwned + Default + Serialize + JsonSchema + 'static,
        R: JsonSchema,
    {
        let schema = || json!({"schema": schema_for!(O), "default": O::default()});
        let run = Box::new(move |request: &Request, run: Run<'_>| job(request, &request.options()?, run));
        Self { name, schema, result: SchemaGenerator::subschema_for::<R>, run }
    }
}

/// Rows of the pictures of a budget: as many as the program draws.
const TOP: usize = 12;

/// Name of the study's results.
const STATE: &str = "state";

/// Returns all verbs.
fn table() -> [Verb; 22] {
    [
        Verb::new::<EvalOptions, EvalResult>("eval", |request, options, run| {
            Ok(Outcome::of(request, abbe::eval(request.machine()?, options, run)?).0)
        }),
        Verb::new::<EquationsOptions, EquationsResult>("equations", equations),
        Verb::new::<ConvertOptions, ConvertResult>("convert", convert),
        Verb::new::<MapOptions, MapResult>("map", map),
        Verb::new::<ReachOptions, ReachResult>("reach", |request, options, run| {
            let (outcome, result) = Outcome::of(request, abbe::reach(request.machine()?, options, run)?);
            Ok(outcome.text("reach.svg", result.picture().svg()))
        }),
        Verb::new::<CompareOptions, CompareResult>("compare", |request, options, run| {
            Ok(Outcome::of(request, abbe::compare(&request.machine_files(), options, run)?).0)
        }),
        Verb::new::<BudgetOptions, BudgetResult>("budget", budget),
        Verb::new::<EnumerateOptions, RankedArrangements>("enumerate", enumerate),
        Verb::new::<InstrumentOptions, InstrumentResult>("instrument", |request, options, run| {
            let (outcome, result) = Outcome::of(request, abbe::instrument(request.machine()?, options, run)?);
            Ok(outcome.text("readings.svg", result.picture().svg()))
        }),
        Verb::new::<IdentifyOptions, IdentifyResult>("identify", identify),
        Verb::new::<IdentifyOptions, MonomialFit>("fit_monomials", |request, options, run| {
            let options = with_texts(request, options);
            Ok(Outcome::of(request, abbe::fit_monomials(request.machine()?, &options, run)?).0)
        }),
        Verb::new::<PlanOptions, MeasurementPlan>("plan", |request, options, run| {
            let (outcome, plan) = Outcome::of(request, abbe::plan_measurements(request.machine()?, options, run)?);
            Ok(outcome.text("plan.csv", plan.csv))
        }),
        Verb::new::<ImportOptions, ImportResult>("import_readings", |request, options, run| {
            let (outcome, result) = Outcome::of(request, abbe::import(request.path(0)?, options, run)?);
            Ok(outcome.text("table.csv", result.table))
        }),
        Verb::new::<FiguresOptions, TestFigures>("figures", |request, options, run| {
            let (outcome, result) = Outcome::of(request, abbe::figures(request.path(0)?, options, run)?);
            Ok(outcome.text("figures.svg", result.picture().svg()))
        }),
        Verb::new::<LocateOptions, LocateResult>("locate", |request, options, run| {
            let (outcome, result) =
                Outcome::of(request, abbe::locate(request.machine()?, Some(request.path(0)?), options, run)?);
            Ok(outcome.text("machine.yaml", result.machine_file))
        }),
        Verb::new::<RecordOptions, CalibrationRecord>("record", |request, options, run| {
            let (outcome, record) = Outcome::of(request, abbe::record(request.path(0)?, options, run)?);
            Ok(Outcome { files: record.files, ..outcome })
        }),
        Verb::new::<RecordOptions, RecordTrend>("record_trend", |request, options, run| {
            let folders: Vec<PathBuf> = request.words.iter().map(PathBuf::from).collect();
            let (outcome, trend) = Outcome::of(request, abbe::record_trend(&folders, options, run)?);
            Ok(outcome.text("trend.svg", trend.picture().svg()))
        }),
        Verb::new::<CompileOptions, CompiledSet>("compile", compile),
        Verb::new::<VerifyOptions, CertificateReport>("verify", |request, options, run| {
            let answer = abbe::verify(request.machine()?, request.path(0)?, options, run)?;
            Ok(Outcome::of(request, answer).0)
        }),
        Verb::new::<DiffOptions, SetDifference>("diff_sets", |request, options, run| {
            let answer = abbe::diff(request.machine()?, request.path(0)?, request.path(1)?, options, run)?;
            Ok(Outcome::of(request, answer).0)
        }),
        Verb::new::<DiffMachinesOptions, MachineDifference>("diff", |request, options, run| {
            Ok(Outcome::of(request, abbe::diff_machines(&request.machine_files(), options, run)?).0)
        }),
        Verb::new::<ReportOptions, PageSize>("report", report),
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

/// Measurements from memory come beside the options: JSON would hold them twice.
fn with_texts(request: &Request, options: &IdentifyOptions) -> IdentifyOptions {
    IdentifyOptions { texts: request.texts.clone(), ..options.clone() }
}

fn identify(request: &Request, options: &IdentifyOptions, run: Run<'_>) -> Found {
    let options = with_texts(request, options);
    let (mut outcome, result) = Outcome::of(request, abbe::identify(request.machine()?, &options, run)?);
    outcome.texts.extend(result.machine_file.map(|text| ("machine.yaml".to_owned(), text)));
    outcome.texts.extend(result.pictures.into_iter().map(|picture| (picture.name, picture.svg)));
    Ok(outcome)
}

/// Compiles for the targets that the words name; a part of a set for several is a folder.
fn compile(request: &Request, options: &CompileOptions, run: Run<'_>) -> Found {
    if request.words.len() > 1 {
        let answer = abbe::compile_composed(request.machine()?, &request.words, options, run)?;
        let (outcome, set) = Outcome::of(request, answer);
        let below = |part: ComposedPart| {
            let name = move |name: &str| format!("{}/{name}", part.folder);
            let lock = (name(LOCK_NAME), part.lock.to_text().into_bytes());
            part.files.into_iter().map(|file| (name(&file.name), file.bytes)).chain([lock]).collect::<Vec<_>>()
        };
        let lock = (LOCK_NAME.to_owned(), set.lock.to_text().into_bytes());
        let files = set.parts.into_iter().flat_map(below).chain([lock]).collect();
        return Ok(Outcome { files, ..outcome });
    }
    let (outcome, set) = Outcome::of(request, abbe::compile(request.machine()?, options, run)?);
    let lock = (LOCK_NAME.to_owned(), set.lock.to_text().into_bytes());
    let files = set.files.into_iter().map(|file| (file.name, file.bytes)).chain([lock]).collect();
    Ok(Outcome { files, ..outcome })
}

fn report(request: &Request, options: &ReportOptions, run: Run<'_>) -> Found {
    let answer = abbe::report(&request.machine_files(), options, run)?;
    let page = answer.value.page(&[]).map_err(Diagnostics::from)?.text;
    let size = Answer { value: PageSize { bytes: page.len() }, warnings: answer.warnings };
    Ok(Outcome::of(request, size).0.text("report.html", page))
}

/// Size of a page.
#[derive(Debug, Serialize, JsonSchema)]
struct PageSize {
    /// Number of its bytes.
    bytes: usize,
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

/// Returns the JSON Schema of the result of every verb by its name, with the definitions that they refer to.
#[pyfunction]
pub fn results() -> String {
    let mut generator = SchemaSettings::draft2020_12().for_serialize().into_generator();
    let mut found: serde_json::Map<String, Value> =
        table().iter().map(|verb| (verb.name.to_owned(), (verb.result)(&mut generator).to_value())).collect();
    for (name, result) in besides() {
        let _ = found.insert(name.to_owned(), result(&mut generator).to_value());
    }
    json!({"results": found, "definitions": generator.take_definitions(true)}).to_string()
}

/// Returns the JSON Schemas of the answers that the page of the workbench gets, by the names of their types.
#[pyfunction]
pub fn answers() -> String {
    let mut generator = SchemaSettings::draft2020_12().for_serialize().into_generator();
    for result in [
        SchemaGenerator::subschema_for::<MachineSummary> as fn(&mut SchemaGenerator) -> Schema,
        SchemaGenerator::subschema_for::<ChainResult>,
        SchemaGenerator::subschema_for::<MapResult>,
        SchemaGenerator::subschema_for::<ErrorSources>,
        SchemaGenerator::subschema_for::<BudgetResult>,
        SchemaGenerator::subschema_for::<EvalResult>,
        SchemaGenerator::subschema_for::<ReachResult>,
        SchemaGenerator::subschema_for::<CompareResult>,
        SchemaGenerator::subschema_for::<InstrumentResult>,
        SchemaGenerator::subschema_for::<TargetSummary>,
    ] {
        let _ = result(&mut generator);
    }
    Value::Object(generator.take_definitions(true)).to_string()
}

/// Results of calls without options, by name.
fn besides() -> [(&'static str, fn(&mut SchemaGenerator) -> Schema); 5] {
    [
        ("show", SchemaGenerator::subschema_for::<ChainResult>),
        ("check", SchemaGenerator::subschema_for::<MachineSummary>),
        ("classify", SchemaGenerator::subschema_for::<Classification>),
        ("check_record", SchemaGenerator::subschema_for::<RecordCheck>),
        ("targets", SchemaGenerator::subschema_for::<TargetSummary>),
    ]
}
