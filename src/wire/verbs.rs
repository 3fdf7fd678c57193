//! The verbs as data: name, options, result, the files beside the document, and the call.
//!
//! Whoever speaks JSON takes "verb plus options gives a document" from [`VERBS`]; so do the schemas of options and
//! results. A document is what the program prints with `--format json`.

use super::headline;
use super::report::report;
use super::report_options::ReportOptions;
use crate::api::map_tables::MapTable;
use crate::api::results::{
    BudgetResult, CertificateReport, ChainResult, Classification, CompareResult, CompiledSet, ComposedPart,
    ConvertResult, EquationsResult, ErrorSources, EvalResult, IdentifyResult, ImportResult, InstrumentResult,
    LocateResult, MachineDifference, MachineSummary, MapResult, MeasurementPlan, MeasuringProgram, MonomialFit,
    PlacementResult, PredictedReadings, RankedArrangements, ReachResult, Record, RecordCheck, RecordTrend,
    SetDifference, TargetComparison, TargetSummary, TestFigures, TestPiece, TouchImport,
};
use crate::api::starter::Starter;
use crate::api::{
    Answer, BudgetOptions, ClassifyOptions, CompareOptions, CompareTargetsOptions, CompileOptions, ConvertOptions,
    Diagnostic, Diagnostics, DiffMachinesOptions, DiffOptions, EnumerateOptions, EquationsOptions, EvalOptions,
    FiguresOptions, IdentifyOptions, ImportOptions, InstrumentOptions, LocateOptions, MachineFile, MapOptions,
    MeasureOptions, PlacementOptions, PlanOptions, PredictOptions, ReachOptions, RecordOptions, Run, TestPieceOptions,
    TouchOptions, VerifyOptions, budget, budget_part, check, check_record, classify, compare, compare_targets, compile,
    compile_composed, convert, diff, diff_machines, enumerate, equations, eval, explain, figures, fit_monomials,
    identify, import, import_touches, instrument, locate, map_tables, measure, place, plan_measurements, predict,
    reach, record, record_trend, schema, show, starter, targets, testpiece, verify,
};
use crate::controller::LOCK_NAME;
use crate::report::RowFormat;
use crate::shards::study::StudyFile;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema, SchemaGenerator, schema_for};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// What a verb is asked.
pub struct VerbRequest<'a> {
    /// The machines, in the order named.
    pub machines: Vec<&'a MachineFile>,
    /// Files, folders or words besides, in the order named.
    pub words: &'a [String],
    /// Measurements by name and text, which are none of the options: JSON would hold them twice.
    pub texts: &'a [(String, String)],
    /// The options, a JSON object.
    pub options: &'a Value,
    /// True if every pose of a map is to come back as an array.
    pub rows: bool,
    /// Refuses an option: its path, empty for the request itself, and the reason.
    pub unfit: &'a dyn Fn(&str, &str) -> Diagnostic,
}

/// What a verb gives.
#[derive(Default)]
pub struct VerbAnswer {
    /// The document, without the warnings.
    pub document: Value,
    /// The warnings of the call.
    pub warnings: Diagnostics,
    /// The first lines of the result as text; empty where nothing decides.
    pub headline: String,
    /// Texts by name: pictures, machine files, tables.
    pub texts: Vec<(String, String)>,
    /// Files by name.
    pub files: Vec<(String, Vec<u8>)>,
    /// A table of every pose as the bytes of a NumPy file.
    pub rows: Option<Vec<u8>>,
}

type Found = Result<VerbAnswer, Diagnostics>;

/// Returns the schema of a result.
pub type ResultSchema = fn(&mut SchemaGenerator) -> Schema;

/// The call of a verb.
pub type VerbCall = fn(&VerbRequest<'_>, Run<'_>) -> Result<VerbAnswer, Diagnostics>;

/// A verb.
pub struct Verb {
    /// Its name.
    pub name: &'static str,
    /// Returns `{"schema": ..., "default": ...}` of the options; `None` for a verb without a struct of options.
    pub options: Option<fn() -> Value>,
    /// Returns the schema of the result; `None` where the document has no type.
    pub result: Option<ResultSchema>,
    /// Names of the texts beside the document that have one; files of sets and records have names of their own.
    pub texts: &'static [&'static str],
    /// Calls it.
    pub run: VerbCall,
}

/// All verbs.
pub static VERBS: [Verb; 36] = [
    of::<EvalOptions, EvalResult>("eval", &[], |request, run| {
        Ok(headed(eval(request.machine()?, &request.options()?, run)?, headline::eval).0)
    }),
    of::<EquationsOptions, EquationsResult>("equations", &["equations.txt", "equations.tex"], |request, run| {
        let (answer, result) = headed(equations(request.machine()?, &request.options()?, run)?, headline::equations);
        Ok(answer.text("equations.txt", result.text()).text("equations.tex", result.latex()))
    }),
    of::<ConvertOptions, ConvertResult>("convert", &["machine.yaml"], |request, run| {
        let (answer, result) = answer(convert(request.machine()?, &request.options()?, run)?);
        Ok(answer.text("machine.yaml", result.machine_file))
    }),
    of::<MapOptions, MapResult>("map", &["map.svg", "grid"], run_map),
    of::<ReachOptions, ReachResult>("reach", &["reach.svg"], |request, run| {
        let (answer, result) = headed(reach(request.machine()?, &request.options()?, run)?, headline::reach);
        Ok(answer.text("reach.svg", result.picture().svg()))
    }),
    of::<PlacementOptions, PlacementResult>("place", &["place.svg"], |request, run| {
        let (answer, result) = answer(place(request.machine()?, &request.options()?, run)?);
        Ok(answer.text("place.svg", result.picture().svg()))
    }),
    of::<CompareOptions, CompareResult>("compare", &[], |request, run| {
        Ok(headed(compare(&request.machine_files(), &request.options()?, run)?, headline::compare).0)
    }),
    of::<BudgetOptions, BudgetResult>("budget", &["pareto.svg", "waterfall.svg", STATE], run_budget),
    of::<EnumerateOptions, RankedArrangements>("enumerate", &[STATE], run_enumerate),
    of::<InstrumentOptions, InstrumentResult>("instrument", &["readings.svg"], |request, run| {
        let (answer, result) = answer(instrument(request.machine()?, &request.options()?, run)?);
        Ok(answer.text("readings.svg", result.picture().svg()))
    }),
    of::<IdentifyOptions, IdentifyResult>(
        "identify",
        &["machine.yaml", "covariance.json", "residuals.json"],
        run_identify,
    ),
    of::<IdentifyOptions, MonomialFit>("fit_monomials", &[], |request, run| {
        Ok(answer(fit_monomials(request.machine()?, &request.with_texts()?, run)?).0)
    }),
    of::<PlanOptions, MeasurementPlan>("plan", &["plan.csv"], |request, run| {
        let (answer, plan) = headed(plan_measurements(request.machine()?, &request.options()?, run)?, headline::plan);
        Ok(answer.text("plan.csv", plan.csv))
    }),
    of::<PredictOptions, PredictedReadings>("predict", &[], |request, run| {
        let options = PredictOptions { texts: request.texts.to_vec(), ..request.options()? };
        Ok(headed(predict(request.machine()?, &options, run)?, headline::predict).0)
    }),
    of::<ImportOptions, ImportResult>("import_readings", &["table.csv"], |request, run| {
        let (answer, result) = answer(import(request.path(0)?, &request.options()?, run)?);
        Ok(answer.text("table.csv", result.table))
    }),
    of::<TouchOptions, TouchImport>("import_touches", &["table.csv"], |request, run| {
        let (machine, path) = (request.machine()?, request.path(0)?);
        let (answer, result) = answer(import_touches(machine, path, &request.options()?, run)?);
        Ok(answer.text("table.csv", result.table))
    }),
    of::<MeasureOptions, MeasuringProgram>("measure", &[], |request, run| {
        let (machine, path) = (request.machine()?, request.path(0)?);
        let (answer, program) = answer(measure(machine, path, &request.options()?, run)?);
        Ok(VerbAnswer { files: program.files, ..answer })
    }),
    of::<FiguresOptions, TestFigures>("figures", &["figures.svg"], |request, run| {
        let (answer, result) = answer(figures(request.path(0)?, &request.options()?, run)?);
        Ok(answer.text("figures.svg", result.picture().svg()))
    }),
    of::<TestPieceOptions, TestPiece>("testpiece", &[], |request, run| {
        let (answer, piece) = answer(testpiece(&request.options()?, run)?);
        Ok(VerbAnswer { files: piece.files, ..answer })
    }),
    of::<LocateOptions, LocateResult>("locate", &["machine.yaml"], |request, run| {
        let (machine, path) = (request.machine()?, request.path(0)?);
        let (answer, result) = answer(locate(machine, Some(path), &request.options()?, run)?);
        Ok(answer.text("machine.yaml", result.machine_file))
    }),
    of::<RecordOptions, Record>("record", &[], |request, run| {
        let (answer, record) = answer(record(request.path(0)?, &request.options()?, run)?);
        Ok(VerbAnswer { files: record.files, ..answer })
    }),
    of::<RecordOptions, RecordTrend>("record_trend", &["trend.svg"], |request, run| {
        let folders: Vec<PathBuf> = request.words.iter().map(PathBuf::from).collect();
        let (answer, trend) = answer(record_trend(&folders, &request.options()?, run)?);
        Ok(answer.text("trend.svg", trend.picture().svg()))
    }),
    of::<CompileOptions, CompiledSet>("compile", &[], run_compile),
    of::<CompareTargetsOptions, TargetComparison>("compare_targets", &[], |request, run| {
        Ok(headed(compare_targets(request.machine()?, &request.options()?, run)?, headline::compare_targets).0)
    }),
    of::<VerifyOptions, CertificateReport>("verify", &[], |request, run| {
        let found = verify(request.machine()?, request.path(0)?, &request.options()?, run)?;
        Ok(headed(found, headline::certificate).0)
    }),
    of::<DiffOptions, SetDifference>("diff_sets", &[], |request, run| {
        let folders = (request.path(0)?, request.path(1)?);
        let found = diff(request.machine()?, folders.0, folders.1, &request.options()?, run)?;
        Ok(headed(found, headline::diff_sets).0)
    }),
    of::<DiffMachinesOptions, MachineDifference>("diff", &[], |request, run| {
        Ok(headed(diff_machines(&request.machine_files(), &request.options()?, run)?, headline::diff).0)
    }),
    of::<ReportOptions, PageSize>("report", &["report.html"], run_report),
    plain("show", Some(SchemaGenerator::subschema_for::<ChainResult>), |request, _| {
        Ok(VerbAnswer::of(json!(show(request.machine()?))))
    }),
    plain("check", Some(SchemaGenerator::subschema_for::<MachineSummary>), |request, run| {
        Ok(VerbAnswer::of(json!(check(request.words, run))))
    }),
    plain("classify", Some(SchemaGenerator::subschema_for::<Classification>), |request, run| {
        let options: ClassifyOptions = request.options()?;
        Ok(answer(classify(request.path(0)?, &options, run)?).0)
    }),
    plain("check_record", Some(SchemaGenerator::subschema_for::<RecordCheck>), |request, run| {
        Ok(answer(check_record(request.path(0)?, None, run)?).0)
    }),
    plain("targets", Some(SchemaGenerator::subschema_for::<TargetSummary>), |_, _| {
        Ok(VerbAnswer::of(json!({"targets": targets()})))
    }),
    plain("schema", None, |_, _| Ok(VerbAnswer::of(schema()))),
    plain("explain", None, |request, _| {
        Ok(VerbAnswer::of(json!(explain(request.word(0)?).map_err(Diagnostics::from)?)))
    }),
    plain("starter", None, |request, _| {
        let of: StarterOptions = request.options()?;
        Ok(VerbAnswer::of(json!(starter(of.kind))))
    }),
];

impl Verb {
    /// Finds a verb by its name.
    pub fn find(name: &str) -> Option<&'static Self> {
        VERBS.iter().find(|verb| verb.name == name)
    }
}

/// Returns the verbs with options by name, each with the JSON Schema of its options and their default.
pub fn options() -> Value {
    let with_options = VERBS.iter().filter_map(|verb| Some((verb.name.to_owned(), verb.options?())));
    Value::Object(with_options.collect())
}

/// Returns the JSON Schema of the result of every verb by its name, with the definitions that they refer to.
pub fn results() -> Value {
    let mut generator = SchemaSettings::draft2020_12().for_serialize().into_generator();
    let of = |verb: &Verb| Some((verb.name.to_owned(), verb.result?(&mut generator).to_value()));
    let found: Map<String, Value> = VERBS.iter().filter_map(of).collect();
    json!({"results": found, "definitions": generator.take_definitions(true)})
}

/// Returns the JSON Schemas of the answers that the page of the workbench gets, by the names of their types.
pub fn answers() -> Value {
    let mut generator = SchemaSettings::draft2020_12().for_serialize().into_generator();
    let answers: [ResultSchema; 12] = [
        SchemaGenerator::subschema_for::<MachineSummary>,
        SchemaGenerator::subschema_for::<ChainResult>,
        SchemaGenerator::subschema_for::<MapResult>,
        SchemaGenerator::subschema_for::<ErrorSources>,
        SchemaGenerator::subschema_for::<BudgetResult>,
        SchemaGenerator::subschema_for::<EvalResult>,
        SchemaGenerator::subschema_for::<ReachResult>,
        SchemaGenerator::subschema_for::<PlacementResult>,
        SchemaGenerator::subschema_for::<CompareResult>,
        SchemaGenerator::subschema_for::<InstrumentResult>,
        SchemaGenerator::subschema_for::<TargetSummary>,
        SchemaGenerator::subschema_for::<TargetComparison>,
    ];
    for result in answers {
        let _ = result(&mut generator);
    }
    Value::Object(generator.take_definitions(true))
}

const fn of<O, R>(name: &'static str, texts: &'static [&'static str], run: VerbCall) -> Verb
where
    O: Default + Serialize + JsonSchema,
    R: JsonSchema,
{
    Verb { name, options: Some(describe::<O>), result: Some(SchemaGenerator::subschema_for::<R>), texts, run }
}

const fn plain(name: &'static str, result: Option<ResultSchema>, run: VerbCall) -> Verb {
    Verb { name, options: None, result, texts: &[], run }
}

fn describe<O: Default + Serialize + JsonSchema>() -> Value {
    json!({"schema": schema_for!(O), "default": O::default()})
}

impl VerbRequest<'_> {
    fn options<T: DeserializeOwned>(&self) -> Result<T, Diagnostics> {
        serde_path_to_error::deserialize(self.options)
            .map_err(|failure| (self.unfit)(&failure.path().to_string(), &failure.inner().to_string()).into())
    }

    fn with_texts(&self) -> Result<IdentifyOptions, Diagnostics> {
        Ok(IdentifyOptions { texts: self.texts.to_vec(), ..self.options()? })
    }

    fn machine(&self) -> Result<&MachineFile, Diagnostics> {
        self.machines.first().copied().ok_or_else(|| (self.unfit)("", "a machine is missing").into())
    }

    fn machine_files(&self) -> Vec<MachineFile> {
        self.machines.iter().map(|file| (*file).clone()).collect()
    }

    fn word(&self, index: usize) -> Result<&str, Diagnostics> {
        let word = self.words.get(index).map(String::as_str);
        word.ok_or_else(|| (self.unfit)("", "a path or a name is missing").into())
    }

    fn path(&self, index: usize) -> Result<&Path, Diagnostics> {
        self.word(index).map(Path::new)
    }
}

impl VerbAnswer {
    /// Returns the answer of a call that warns of nothing.
    fn of(document: Value) -> Self {
        Self { document, ..Self::default() }
    }

    fn text(mut self, name: &str, text: impl Into<String>) -> Self {
        self.texts.push((name.to_owned(), text.into()));
        self
    }
}

/// Returns the answer of a call, and its value.
fn answer<T: Serialize>(answer: Answer<T>) -> (VerbAnswer, T) {
    let Answer { value, warnings } = answer;
    (VerbAnswer { warnings, ..VerbAnswer::of(json!(value)) }, value)
}

/// Returns the same with the first lines of the result.
fn headed<T: Serialize>(found: Answer<T>, headline: impl Fn(&T) -> String) -> (VerbAnswer, T) {
    let (found, value) = answer(found);
    (VerbAnswer { headline: headline(&value), ..found }, value)
}

/// Rows of the pictures of a budget: as many as the program draws.
const TOP: usize = 12;

/// Name of the results of a study, or of the machines of a part.
const STATE: &str = "state";

/// Options of `starter`.
#[derive(serde::Deserialize)]
struct StarterOptions {
    kind: Starter,
}

fn run_map(request: &VerbRequest<'_>, run: Run) -> Found {
    let mut rows = Cursor::new(Vec::new());
    let mut tables = Vec::new();
    if request.rows {
        tables.push(MapTable { name: "the array".to_owned(), form: RowFormat::Npy, sink: Box::new(&mut rows) });
    }
    let (answer, result) = headed(map_tables(request.machine()?, &request.options()?, tables, run)?, headline::map);
    let mut answer = VerbAnswer { rows: request.rows.then(|| rows.into_inner()), ..answer };
    answer.texts.extend(result.picture.map(|picture| ("map.svg".to_owned(), picture.svg())));
    answer.texts.extend(result.grid.map(|counts| ("grid".to_owned(), json!(counts).to_string())));
    Ok(answer)
}

fn run_budget(request: &VerbRequest<'_>, run: Run) -> Found {
    let options: BudgetOptions = request.options()?;
    if options.shard.is_some() {
        let Answer { value: part, warnings } = budget_part(request.machine()?, &options, run)?;
        let progress = json!({"samples": part.samples, "drawn": part.count()});
        return Ok(answer(Answer { value: progress, warnings }).0.text(STATE, part.to_text()));
    }
    let (answer, result) = headed(budget(request.machine()?, &options, run)?, headline::budget);
    Ok(answer.text("pareto.svg", result.pareto(TOP).svg()).text("waterfall.svg", result.waterfall(TOP).svg()))
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

fn run_enumerate(request: &VerbRequest<'_>, run: Run) -> Found {
    let state = State(Mutex::default());
    let found = enumerate(request.machine()?, &request.options()?, Some(&state), run)?;
    let (answer, _) = headed(found, headline::study);
    Ok(answer.text(STATE, state.0.into_inner().unwrap_or_else(PoisonError::into_inner)))
}

fn run_identify(request: &VerbRequest<'_>, run: Run) -> Found {
    let (mut answer, result) = headed(identify(request.machine()?, &request.with_texts()?, run)?, headline::identify);
    answer.texts.push(("covariance.json".to_owned(), json!(result.covariance).to_string()));
    answer.texts.push(("residuals.json".to_owned(), json!(result.reading_residuals).to_string()));
    answer.texts.extend(result.machine_file.map(|text| ("machine.yaml".to_owned(), text)));
    answer.texts.extend(result.pictures.into_iter().map(|picture| (picture.name, picture.svg)));
    Ok(answer)
}

/// Compiles for the targets that the words name; a part of a set for several is a folder.
fn run_compile(request: &VerbRequest<'_>, run: Run) -> Found {
    let options: CompileOptions = request.options()?;
    if request.words.len() > 1 {
        let found = compile_composed(request.machine()?, request.words, &options, run)?;
        let (answer, set) = headed(found, |set| headline::certificate(&set.certificate));
        let lock = (LOCK_NAME.to_owned(), set.lock.to_text().into_bytes());
        let files = set.parts.into_iter().chain(set.restore).flat_map(below).chain([lock]).collect();
        return Ok(VerbAnswer { files, ..answer });
    }
    let (answer, set) =
        headed(compile(request.machine()?, &options, run)?, |set| headline::certificate(&set.certificate));
    let lock = (LOCK_NAME.to_owned(), set.lock.to_text().into_bytes());
    let files = set.files.into_iter().map(|file| (file.name, file.bytes)).chain([lock]);
    Ok(VerbAnswer { files: files.chain(set.restore.into_iter().flat_map(below)).collect(), ..answer })
}

/// Returns the files of a set in a subfolder, with their paths.
fn below(part: ComposedPart) -> Vec<(String, Vec<u8>)> {
    let name = |name: &str| format!("{}/{name}", part.folder);
    let lock = (name(LOCK_NAME), part.lock.to_text().into_bytes());
    part.files.into_iter().map(|file| (name(&file.name), file.bytes)).chain([lock]).collect()
}

fn run_report(request: &VerbRequest<'_>, run: Run) -> Found {
    let Answer { value: content, warnings } = report(&request.machine_files(), &request.options()?, run)?;
    let page = content.page(&[]).map_err(Diagnostics::from)?.text;
    Ok(answer(Answer { value: PageSize { bytes: page.len() }, warnings }).0.text("report.html", page))
}

/// Size of a page.
#[derive(Debug, Serialize, JsonSchema)]
struct PageSize {
    /// Number of its bytes.
    bytes: usize,
}
