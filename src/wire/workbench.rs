//! The workbench: questions about one machine in one request, answered in one JSON document.
//!
//! A face that holds the text of a machine file in an editor sends that text with its questions. The machine is read
//! once, and every answer has the shape that the verb of the program prints with `--format json`.

use super::share::{MapPart, MapShare};
use crate::api::certificate::CertifiedWork;
use crate::api::look::{LookOptions, LookResult, look};
use crate::api::map::map_of_parts;
use crate::api::map_result::MapPoses;
use crate::api::map_tables::MapTable;
use crate::api::results::{MapResult, PlacementResult, ReachResult};
use crate::api::sources::all_words;
use crate::api::summary::error_numbers;
use crate::api::{
    BudgetOptions, CompareOptions, CompareTargetsOptions, EvalOptions, InstrumentOptions, MapOptions, PlacementOptions,
    ReachOptions, SourcesOptions, budget, compare, compare_targets, eval, instrument, machine_dialogue, map_tables,
    place, reach, schema, show, sources, summary, targets,
};
use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use crate::job::job_file::{JobPaths, NO_JOB};
use crate::job::limit::LimitVerdict;
use crate::job::machine_file::{LoadOptions, MachineFile, Overlay, load};
use crate::job::played::PlayedRow;
use crate::job::reference::Reference;
use crate::job::tool_poses::RowTip;
use crate::report::RowFormat;
use crate::run::{Answer, Call, Refused, Reply, Run};
use crate::syntax::MemoryFiles;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Questions about one machine.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WorkbenchRequest {
    /// Name of the machine file.
    pub machine: String,
    /// Files by name and text; they come before those of [`Run::files`].
    pub texts: BTreeMap<String, String>,
    /// Tool of the machine; the first by default.
    pub tool: Option<String>,
    /// The part that maps, sources, budgets, reach and comparisons are over; the volume without one.
    pub over: Option<PartScope>,
    /// Answers to the questions that make a machine file. The one answer is then what they lead to, and no machine is
    /// read.
    pub dialogue: Option<BTreeMap<String, String>>,
    /// The questions, in the order in which they are answered.
    pub questions: Vec<Question>,
}

impl WorkbenchRequest {
    fn load_options(&self) -> LoadOptions {
        LoadOptions { tool: self.tool.clone() }
    }
}

/// A part in place of the volume: its file with what is stated of it, or by default the job of the machine file. For a
/// machine file without one the reference is of the volume.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PartScope {
    /// The file of tool poses.
    pub tool_poses: Option<PathBuf>,
    /// A job file in its place.
    pub job: Option<PathBuf>,
    /// Motion that the part's set-up takes out; by default what the job states, or else the zero at the part's origin.
    pub reference: Option<Reference>,
    /// True if the tool poses are one continuous path; by default CL data are.
    pub path: Option<bool>,
}

impl PartScope {
    fn map_poses(&self) -> MapPoses {
        match (&self.job, &self.tool_poses) {
            (Some(job), _) => MapPoses::Job(job.clone()),
            (None, Some(tool_poses)) => MapPoses::ToolPoses(tool_poses.clone()),
            (None, None) => MapPoses::Grid,
        }
    }

    /// True if it names no part, and the machine file has none.
    fn is_absent(&self, machine: &MachineFile) -> bool {
        self.tool_poses.is_none() && self.job.is_none() && machine.job.is_none()
    }

    /// Returns a question over this part.
    fn of(&self, question: &Question) -> Question {
        let Self { tool_poses, job, reference, path } = self.clone();
        match question {
            Question::Map(of) if !matches!(of.poses, MapPoses::Listed(_)) => {
                Question::Map(MapOptions { poses: self.map_poses(), reference, path, ..of.clone() })
            }
            Question::Sources(of) => {
                Question::Sources(SourcesOptions { tool_poses, job, reference, path, ..of.clone() })
            }
            Question::Budget(of) => Question::Budget(BudgetOptions { tool_poses, job, reference, path, ..of.clone() }),
            Question::Reach(of) => Question::Reach(ReachOptions { tool_poses, job, reference, path, ..of.clone() }),
            Question::Repair(of) => {
                let work = CertifiedWork { tool_poses, job, path, reference };
                Question::Repair(CompareTargetsOptions { work, ..of.clone() })
            }
            Question::Compare(with) => {
                let options = CompareOptions { tool_poses, job, reference, path, ..with.options.clone() };
                Question::Compare(Box::new(CompareWith { options, ..*with.clone() }))
            }
            other => other.clone(),
        }
    }

    /// Returns a question over the volume with a reference, whatever job the machine file states.
    fn volume(asked: Option<&Reference>, question: &Question) -> Question {
        let none = Some(PathBuf::from(NO_JOB));
        let stated = |own: &Option<Reference>| own.as_ref().or(asked).cloned();
        match question {
            Question::Map(of) if !matches!(of.poses, MapPoses::Listed(_)) => {
                Question::Map(MapOptions { reference: stated(&of.reference), ..of.clone() })
            }
            Question::Sources(of) if of.tool_poses.is_none() && of.job.is_none() => {
                Question::Sources(SourcesOptions { job: none, reference: stated(&of.reference), ..of.clone() })
            }
            // The page shows one reference of a volume.
            Question::Budget(of) if of.tool_poses.is_none() && of.job.is_none() => {
                let reference = Some(stated(&of.reference).unwrap_or_default());
                Question::Budget(BudgetOptions { job: none, reference, ..of.clone() })
            }
            Question::Repair(of) if of.work.tool_poses.is_none() && of.work.job.is_none() => {
                let work = CertifiedWork { job: none, ..of.work.clone() };
                Question::Repair(CompareTargetsOptions { work, ..of.clone() })
            }
            Question::Reach(of) if of.tool_poses.is_none() && of.job.is_none() => {
                Question::Reach(ReachOptions { job: none, ..of.clone() })
            }
            Question::Compare(with) if with.options.tool_poses.is_none() && with.options.job.is_none() => {
                let reference = stated(&with.options.reference).or_else(|| Some(Reference::machine_less_unheld()));
                let options = CompareOptions { job: none, reference, ..with.options.clone() };
                Question::Compare(Box::new(CompareWith { options, ..*with.clone() }))
            }
            other => other.clone(),
        }
    }
}

/// A question: a verb with its options.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Question {
    /// The machine in short, as `check` prints it.
    Check,
    /// The chain, as `show` prints it.
    Show,
    /// Deviations at poses.
    Eval(EvalOptions),
    /// The error over a volume.
    Map(MapOptions),
    /// A map with its table, as `map --json` writes it: `{"map": {...}, "rows": {...}}`.
    Rows(MapOptions),
    /// Each error alone over the volume.
    Sources(SourcesOptions),
    /// Tolerances to the volumetric error.
    Budget(BudgetOptions),
    /// The share of tips and directions of the tool that the nominal machine reaches, with `reasons` in words.
    Reach(ReachOptions),
    /// A map at the tool poses of a file with its table, as `map --json` writes it, and the tips of all rows:
    /// `{"map": {...}, "rows": {...}, "tips": [...]}`.
    Work(Box<WorkOptions>),
    /// The part of a job at places of the table, as `map --place` tries them, with its picture:
    /// `{"placement": {...}, "svg": "...", "over": "..."}`.
    Place(PlacementOptions),
    /// This machine beside another, which is the first of the comparison.
    Compare(Box<CompareWith>),
    /// Readings of a measuring instrument.
    Instrument(InstrumentOptions),
    /// The meshes that the machine is drawn by, with a sentence on their size.
    Look(LookOptions),
    /// The controllers, in short.
    Targets,
    /// Fractions that the files of a target take off machines drawn between bounds.
    Repair(CompareTargetsOptions),
    /// The errors that are one number, wherever it stands, by name.
    Numbers,
    /// Words for each error of the axes and the spindle, by name.
    Words,
    /// The JSON Schema of machine files; null without the feature `schema`.
    Schema,
}

/// The other machines of a comparison.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CompareWith {
    /// Name of its file.
    pub first: String,
    /// Names of further files, which are compared with the first before this machine is.
    pub more: Vec<String>,
    /// Options of the comparison.
    pub options: CompareOptions,
}

/// Options of [`Question::Work`].
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WorkOptions {
    /// The file of tool poses; without it and a job file the job of the machine file, whose lack is answered by null.
    pub tool_poses: Option<PathBuf>,
    /// A job file in its place.
    pub job: Option<PathBuf>,
    /// Motion that the part's set-up takes out of the deviations; by default what the job states, or else the zero at
    /// the part's origin.
    pub reference: Option<Reference>,
    /// True if the tool poses are one continuous path; by default CL data are.
    pub path: Option<bool>,
    /// Number of machines that are drawn where errors are only bounded.
    pub samples: usize,
    /// Maps what the compensation of this target leaves, where errors are measured.
    pub target: Option<String>,
    /// Further options of the map.
    pub map: MapOptions,
}

impl Default for WorkOptions {
    fn default() -> Self {
        let map = MapOptions::default();
        Self { tool_poses: None, job: None, reference: None, path: None, samples: map.samples, target: None, map }
    }
}

impl WorkOptions {
    /// True if they name no part, and the machine file has none.
    fn is_absent(&self, machine: &MachineFile) -> bool {
        self.tool_poses.is_none() && self.job.is_none() && machine.job.is_none()
    }
}

/// Maximum number of questions of a request: a turn of the page asks about twenty.
const MAX_QUESTIONS: usize = 200;

/// Maximum number of rows of a volume in an answer: their JSON takes 4 kB each while it is made. A field takes 126.
const MAX_ROWS: usize = 20_000;

/// Maximum number of worst poses of a map in an answer.
const MAX_WORST: usize = 10_000;

/// Computes part `index`, from 0, of `count` of the deviations of the first map of a request, and returns its bytes:
/// all parts, one behind the other, are given to [`workbench_of_parts`] with the same request.
///
/// Without such a map, and for one of bounds or of more than [`MapPoses::MAX_HELD`] poses, there are none.
pub fn workbench_part(request: &str, index: usize, count: usize, run: Run) -> Vec<u8> {
    let part = MapPart::new(index, count);
    if let Ok(mut request) = parse(request) {
        request.questions.retain(|question| matches!(question, Question::Map(_)));
        request.questions.truncate(1);
        let _ = answer(&request, &MapShare::Part(&part), run);
    }
    part.bytes.into_inner()
}

/// Answers a request of JSON by JSON: `{"diagnostics": [...], "answers": [...]}`.
///
/// `diagnostics` are those of reading the machine, with their places. Without a machine `answers` is empty. Otherwise
/// it has an entry for each question, the result or `{"refused": true, "diagnostics": [...]}`.
pub fn workbench(request: &str, run: Run) -> Value {
    workbench_of_parts(request, Vec::new(), run)
}

/// Answers a request as [`workbench`] does; `parts` holds the bytes of all parts of its first map, one behind the
/// other. The map is computed if they are not those of all its poses.
pub fn workbench_of_parts(request: &str, parts: Vec<u8>, run: Run) -> Value {
    match parse(request) {
        Ok(request) => answer(&request, &MapShare::Given(RefCell::new(parts)), run),
        Err(diagnostic) => refusal(&diagnostic.into()),
    }
}

fn parse(request: &str) -> Result<WorkbenchRequest, Diagnostic> {
    let refusal = |message: String| Err(Diagnostic::new(codes::E0818, message));
    let mut json = serde_json::Deserializer::from_str(request);
    match serde_path_to_error::deserialize::<_, WorkbenchRequest>(&mut json) {
        Ok(request) if request.questions.len() > MAX_QUESTIONS => {
            refusal(format!("request: {} questions, at most {MAX_QUESTIONS}", request.questions.len()))
        }
        Ok(request) if request.questions.iter().any(|question| question.worst() > MAX_WORST) => {
            refusal(format!("request: a map names {MAX_WORST} worst poses at most"))
        }
        Ok(request) => Ok(request),
        Err(failure) => refusal(format!("request, at `{}`: {}", failure.path(), failure.inner())),
    }
}

fn refusal(diagnostics: &Diagnostics) -> Value {
    json!({"diagnostics": diagnostics.records(), "answers": []})
}

fn answer(request: &WorkbenchRequest, share: &MapShare<'_>, run: Run) -> Value {
    if let Some(answers) = &request.dialogue {
        return json!({"diagnostics": [], "answers": [machine_dialogue(answers)]});
    }
    let text = request.texts.iter().fold(MemoryFiles::new(), |files, (name, text)| files.with(name, text.as_str()));
    let files = Overlay { text, files: run.files };
    let run = Run { files: &files, ..run };
    match load(Path::new(&request.machine), &request.load_options(), run) {
        Ok(Answer { value: machine, warnings }) => {
            let scoped = |question| match &request.over {
                Some(part) if !part.is_absent(&machine) => part.of(question),
                absent => PartScope::volume(absent.as_ref().and_then(|of| of.reference.as_ref()), question),
            };
            let answers: Vec<Value> =
                request.questions.iter().map(|of| scoped(of).answer(&machine, request, share, run)).collect();
            json!({"diagnostics": warnings.records(), "answers": answers})
        }
        Err(diagnostics) => refusal(&diagnostics),
    }
}

impl Question {
    /// Returns the number of worst poses that are to be named.
    fn worst(&self) -> usize {
        match self {
            Self::Map(map) | Self::Rows(map) => map.worst,
            Self::Work(work) => work.map.worst,
            _ => 0,
        }
    }

    fn answer(&self, machine: &MachineFile, request: &WorkbenchRequest, share: &MapShare<'_>, run: Run) -> Value {
        match self {
            Self::Check => json!(summary(machine)),
            Self::Show => json!(show(machine)),
            Self::Eval(options) => document(eval(machine, options, run)),
            Self::Map(options) => document(map_of_parts(machine, options, share, run)),
            Self::Rows(options) => document(rows(machine, options, run)),
            Self::Sources(options) => document(sources(machine, options, run)),
            Self::Budget(options) => document(budget(machine, options, run)),
            Self::Reach(options) => document(reach(machine, options, run).map(with_reasons)),
            Self::Work(options) if options.is_absent(machine) => Value::Null,
            Self::Work(options) => document(work(machine, options, run)),
            Self::Place(options) => document(placed(machine, options, run)),
            Self::Compare(with) => {
                let names = std::iter::once(&with.first).chain(&with.more);
                let others = names.map(|name| Ok(load(Path::new(name), &request.load_options(), run)?.value));
                match others.collect::<Result<Vec<MachineFile>, Diagnostics>>() {
                    Ok(others) => {
                        let all = [&others[..], std::slice::from_ref(machine)].concat();
                        document(compare(&all, &with.options, run))
                    }
                    Err(diagnostics) => json!(diagnostics),
                }
            }
            Self::Instrument(options) => document(instrument(machine, options, run)),
            Self::Look(options) => document(look(machine, options, run).map(with_size)),
            Self::Targets => json!(targets()),
            Self::Repair(options) => document(compare_targets(machine, options, run)),
            Self::Numbers => json!(error_numbers(machine)),
            Self::Words => json!(all_words(machine)),
            Self::Schema if cfg!(feature = "schema") => schema(),
            Self::Schema => Value::Null,
        }
    }
}

/// The reach of a machine, with what stops the rest in words.
#[derive(Serialize)]
struct ReasonedReach {
    #[serde(flatten)]
    reach: ReachResult,
    reasons: Vec<String>,
}

fn with_reasons(answer: Answer<ReachResult>) -> Answer<ReasonedReach> {
    let reasons = answer.value.lacks.iter().map(|lack| lack.words("tool pose")).collect();
    Answer { value: ReasonedReach { reach: answer.value, reasons }, warnings: answer.warnings }
}

/// Meshes, with a sentence on their size.
#[derive(Serialize)]
struct SizedLook {
    #[serde(flatten)]
    look: LookResult,
    words: Option<String>,
}

fn with_size(answer: Answer<LookResult>) -> Answer<SizedLook> {
    let words = answer.value.words();
    Answer { value: SizedLook { look: answer.value, words }, warnings: answer.warnings }
}

#[derive(Serialize)]
struct MapRows {
    map: MapResult,
    rows: Value,
}

fn rows(machine: &MachineFile, options: &MapOptions, run: Run) -> Reply<MapRows> {
    let count = options.poses.count(machine).unwrap_or(0);
    if count > MAX_ROWS {
        let message = format!("{count} rows: {MAX_ROWS} are held in memory at most");
        let help = "take fewer random poses, or larger steps under `volume`; `abbe map --csv` writes any number";
        let refusal = Diagnostic::new(codes::E0812, message).help(help);
        return Call::answer(run, machine.sources(), |call| call.refuse(refusal));
    }
    let mut bytes = Cursor::new(Vec::new());
    let table = MapTable { name: "rows".to_owned(), form: RowFormat::Json, sink: Box::new(&mut bytes) };
    let Answer { value: map, warnings } = map_tables(machine, options, vec![table], run)?;
    let rows = serde_json::from_slice(bytes.get_ref()).unwrap_or_default();
    Ok(Answer { value: MapRows { map, rows }, warnings })
}

/// A map at tool poses, row by row.
#[derive(Serialize)]
struct WorkRows {
    #[serde(flatten)]
    found: MapRows,
    tips: Vec<RowTip>,
    /// The reached rows one by one; empty where errors are only bounded.
    played: Vec<PlayedRow>,
    /// Poses and reference of the figures, in words.
    over: String,
    /// The verdict of the limit of the job, in words.
    limit: Option<String>,
}

fn work(machine: &MachineFile, options: &WorkOptions, run: Run) -> Reply<WorkRows> {
    let WorkOptions { tool_poses, job, samples, target, reference, path, map } = options.clone();
    let paths = JobPaths { job: job.as_deref(), tool_poses: tool_poses.as_deref(), axis_poses: None, path };
    let tips = Call::answer(run, machine.sources(), |call| tips(call, machine, paths))?.value;
    let (poses, reference) = match (job, tool_poses) {
        (Some(job), _) => (MapPoses::Job(job), reference),
        (None, Some(tool_poses)) => (MapPoses::ToolPoses(tool_poses), reference),
        (None, None) => (MapPoses::Grid, reference),
    };
    let options = MapOptions { poses, samples, target, reference, path, played: true, ..map };
    let Answer { value: mut found, warnings } = rows(machine, &options, run)?;
    let played = std::mem::take(&mut found.map.played);
    let (over, limit) = (found.map.over.line(), found.map.limit.as_ref().map(LimitVerdict::words));
    Ok(Answer { value: WorkRows { found, tips, played, over, limit }, warnings })
}

/// A part at places of the table, with the picture.
#[derive(Serialize)]
struct PlacedPart {
    placement: PlacementResult,
    svg: String,
    /// Poses and reference of the figures, in words.
    over: String,
}

fn placed(machine: &MachineFile, options: &PlacementOptions, run: Run) -> Reply<PlacedPart> {
    let Answer { value: placement, warnings } = place(machine, options, run)?;
    let (svg, over) = (placement.picture().svg(), placement.over.line());
    Ok(Answer { value: PlacedPart { placement, svg, over }, warnings })
}

/// Returns the place of every row of a job, reached or not.
fn tips(call: &mut Call<'_>, machine: &MachineFile, paths: JobPaths<'_>) -> Result<Vec<RowTip>, Refused> {
    Ok(paths.read(call, machine)?.map(|job| job.poses.row_tips()).unwrap_or_default())
}

fn document<T: Serialize>(answer: Reply<T>) -> Value {
    match answer {
        Ok(answer) => answer.warnings.document(json!(answer.value)),
        Err(diagnostics) => json!(diagnostics),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MACHINE: &str = "abbe: 1
machine: M
chain: w b X Y Z t
axes:
  X: { travel: [0, 400], origin: [0, 0, 0] }
  Y: { travel: [0, 400], origin: [0, 0, 0] }
  Z: { travel: [0, 400], origin: [0, 0, 0] }
errors: { EC0Y: 20 urad, EB0Z: 5 urad }
";

    fn ask(text: &str, questions: Value) -> Value {
        let request = json!({"machine": "m.yaml", "texts": {"m.yaml": text}, "questions": questions});
        workbench(&request.to_string(), Run::default())
    }

    #[test]
    fn the_job_of_the_machine_file_is_the_part_that_nobody_names() {
        assert_eq!(ask(MACHINE, json!([{"work": {}}]))["answers"], json!([null]));
        let text = format!("{MACHINE}job: {{ tool_poses: w.csv, limit: 1 um }}\n");
        let texts = json!({"m.yaml": text, "w.csv": "X,Y,Z\n0,0,0\n0,100,0\n"});
        let questions =
            json!([{"work": {}}, {"compare": {"first": "m.yaml"}}, {"map": {"poses": {"random": 9}}}, {"sources": {}}]);
        let ask = |over: Value| {
            let request = json!({"machine": "m.yaml", "texts": texts, "questions": questions, "over": over});
            workbench(&request.to_string(), Run::default())["answers"].clone()
        };
        let [answers, volume] = [ask(json!({})), ask(Value::Null)];
        // The zero at the origin leaves 20 urad over 100 mm.
        let um = answers[0]["map"]["position_um"]["max"].as_f64().unwrap();
        assert!((um - 2.0).abs() < 1e-6, "{answers}");
        assert_eq!(answers[0]["limit"], json!("limit 1 um: exceeded; largest deviation 2 um"));
        for of in 1..4 {
            assert_eq!(answers[of]["over"], answers[0]["map"]["over"], "{of}");
            assert_eq!(volume[of]["over"]["kind"], json!("volume"), "{of}");
        }
        assert_eq!(answers[2]["limit"], answers[0]["map"]["limit"]);
        assert!((answers[3]["errors"][0]["max_um"].as_f64().unwrap() - 2.0).abs() < 1e-6, "{answers}");
    }

    #[test]
    fn questions_are_answered_in_their_order() {
        let found = ask(MACHINE, json!(["show", {"map": {"poses": {"random": 50}}}, {"budget": {}}]));
        let answers = found["answers"].as_array().unwrap();
        assert_eq!((answers.len(), &answers[0]["chain"]), (3, &json!("w b X Y Z t")));
        assert_eq!(answers[1]["poses"], 50);
        assert_eq!((&answers[2]["refused"], &answers[2]["diagnostics"][0]["code"]), (&json!(true), &json!("E0604")));
    }

    #[test]
    fn counts_beyond_what_is_held_are_refused() {
        let bounded = MACHINE.replace("EB0Z: 5 urad", "EB0Z: { tolerance: 5 urad }");
        for count in [0, 10_000_000, u64::MAX] {
            // A map of ten million poses is a fair one.
            let poses = if count == 10_000_000 { u64::MAX } else { count };
            let questions = json!([
                {"map": {"samples": count, "poses": {"random": 3}}},
                {"map": {"poses": {"random": poses}}},
                {"budget": {"samples": count}},
                {"budget": {"poses": count}},
                {"sources": {"poses": count}},
                {"reach": {"directions": count}},
                {"compare": {"first": "m.yaml", "options": {"poses": count}}},
                {"compare": {"first": "m.yaml", "options": {"samples": count}}},
                {"compare": {"first": "m.yaml", "options": {"max_samples": count}}},
                {"instrument": {"points": count}},
                {"repair": {"poses": count}},
            ]);
            let found = ask(&bounded, questions.clone());
            let answers = found["answers"].as_array().unwrap();
            assert_eq!(answers.len(), 11);
            for (answer, question) in answers.iter().zip(questions.as_array().unwrap()) {
                assert_eq!(answer["refused"], true, "{question}: {answer}");
            }
        }
    }

    /// Returns the answer to a request whose map is given in a number of parts, and the number of their bytes.
    fn together(request: &str, count: usize, change: impl FnOnce(&mut Vec<u8>)) -> (Value, usize) {
        let parts = (0..count).flat_map(|index| workbench_part(request, index, count, Run::default()));
        let mut bytes: Vec<u8> = parts.collect();
        let length = bytes.len();
        change(&mut bytes);
        (workbench_of_parts(request, bytes, Run::default()), length)
    }

    #[test]
    fn a_map_in_parts_is_the_map() {
        let maps = [
            (json!({"poses": {"random": 1999}}), 1999),
            (json!({"poses": {"random": 700}, "order": "1", "frame": "machine", "approach": "forward"}), 700),
            (json!({"poses": {"listed": [[1.0, 2.0, 3.0]]}}), 1),
            (json!({"poses": {"random": 1_000_001}}), 0),
            (json!({"poses": {"random": 0}}), 0),
        ];
        for (map, poses) in maps {
            let other = json!({"map": {"poses": {"random": 50}}});
            let questions = json!(["show", {"rows": {"poses": {"random": 9}}}, {"map": map}, other]);
            let request =
                json!({"machine": "m.yaml", "texts": {"m.yaml": MACHINE}, "questions": questions}).to_string();
            let whole = workbench(&request, Run::default());
            for count in [1, 2, 7] {
                let (found, bytes) = together(&request, count, |_| ());
                assert_eq!((bytes, found.to_string()), (48 * poses, whole.to_string()), "{map} in {count}");
            }
            assert_eq!(together(&request, 2, |bytes| bytes.push(0)).0, whole, "{map}");
        }
        // They are taken from the bytes.
        let questions = json!([{"map": {"poses": {"random": 100}}}]);
        let request = json!({"machine": "m.yaml", "texts": {"m.yaml": MACHINE}, "questions": questions}).to_string();
        assert_eq!(together(&request, 1, |bytes| bytes.fill(0)).0["answers"][0]["position_um"]["max"], 0.0);
    }

    #[test]
    fn a_map_of_bounds_has_no_parts() {
        let bounded = MACHINE.replace("20 urad, EB0Z: 5 urad", "{ tolerance: 5 urad }");
        let request =
            json!({"machine": "m.yaml", "texts": {"m.yaml": bounded}, "questions": [{"map": {}}]}).to_string();
        assert_eq!(together(&request, 2, |_| ()), (workbench(&request, Run::default()), 0));
        assert_eq!(workbench_part("{", 0, 2, Run::default()), Vec::<u8>::new());
    }

    #[test]
    fn a_refused_machine_has_places_and_no_answers() {
        let found = ask(&MACHINE.replace("20 urad", "20 furlongs"), json!(["check"]));
        assert_eq!(found["answers"], json!([]));
        assert_eq!(found["diagnostics"][0]["places"][0]["line"], 8);
        let found = ask(MACHINE, json!([{"map": {"poses": "all"}}]));
        assert_eq!(found["diagnostics"][0]["code"], "E0818");
        assert!(found["diagnostics"][0]["message"].as_str().unwrap().contains("questions[0]"), "{found}");
    }

    #[test]
    fn a_request_has_a_number_of_questions() {
        let found = ask(MACHINE, json!(vec!["check"; 201]));
        assert_eq!(found["diagnostics"][0]["message"], "request: 201 questions, at most 200");
        assert_eq!(ask(MACHINE, json!(vec!["check"; 200]))["answers"].as_array().unwrap().len(), 200);
    }

    #[test]
    fn another_text_is_the_first_of_a_comparison() {
        let machine = MACHINE.replace("20 urad", "30 urad");
        let request = json!({
            "machine": "m.yaml", "texts": {"m.yaml": machine, "a.yaml": MACHINE},
            "questions": [
                {"compare": {"first": "a.yaml", "options": {"poses": 200}}}, {"compare": {"first": "b.yaml"}},
                {"compare": {"first": "a.yaml", "more": ["m.yaml"], "options": {"poses": 200}}},
            ],
        });
        let found = workbench(&request.to_string(), Run::default());
        let [compared, missing] = [&found["answers"][0], &found["answers"][1]];
        assert_eq!(compared["machines"][0]["file"], "a.yaml");
        let um = |i: usize| compared["machines"][i]["position_um"]["p95"].as_f64().unwrap();
        assert!(um(1) > um(0), "{compared}");
        assert_eq!(compared["machines"][1]["minus_first"]["position_um"]["p95"], json!(um(1) - um(0)));
        assert_eq!(missing["refused"], true);
        // Several are compared with the first.
        let three = &found["answers"][2];
        assert_eq!(
            (three["machines"].as_array().unwrap().len(), &three["machines"][2]["position_um"]["p95"]),
            (3, &json!(um(1)))
        );
    }

    #[test]
    fn rows_that_are_held_are_bounded() {
        let found = ask(MACHINE, json!([{"rows": {"poses": {"random": 20_001}}}]));
        assert!(found["answers"][0].to_string().contains("E0812"), "{found}");
        for question in [json!({"map": {"worst": 10_001}}), json!({"work": {"map": {"worst": 10_001}}})] {
            let found = ask(MACHINE, json!([question, "check"]));
            assert_eq!(found["diagnostics"][0]["message"], "request: a map names 10000 worst poses at most");
        }
        assert_eq!(ask(MACHINE, json!([{"map": {"worst": 10_000, "poses": {"random": 3}}}]))["answers"][0]["poses"], 3);
    }

    #[test]
    fn the_rows_of_a_file_of_tool_poses_have_a_deviation_or_what_is_missing() {
        let work = "X, Y, Z\n100, 0, 0\n100, 200, 0\n900, 0, 0\n";
        let request = json!({
            "machine": "m.yaml", "texts": {"m.yaml": MACHINE, "work.csv": work},
            "questions": [{"work": {"tool_poses": "work.csv"}}],
        });
        let found = workbench(&request.to_string(), Run::default());
        let [map, rows] = [&found["answers"][0]["map"], &found["answers"][0]["rows"]["poses"]];
        assert_eq!((&map["poses"], rows.as_array().unwrap().len()), (&json!(2), 3), "{found}");
        // A tip 200 mm along Y stands 200 mm x 20 urad off in X.
        let dx = |row: usize| rows[row]["deviation_um"][0].as_f64().unwrap();
        assert!((dx(0) - dx(1) - 4.0).abs() < 1e-3, "{rows}");
        assert_eq!(found["answers"][0]["tips"][2], json!({"line": 4, "tip_mm": [900.0, 0.0, 0.0]}));
        assert_eq!((&rows[2]["line"], &rows[2]["beyond"][0]["axis"]), (&json!(4), &json!("X")));
    }

    #[test]
    fn listed_poses_have_rows_and_parts_of_each_error() {
        let at = json!([100.0, 200.0, 300.0]);
        let questions = json!([
            {"rows": {"poses": {"listed": [at, [0.0, 0.0, 0.0]]}}}, {"sources": {"poses": 10, "at": at}}, "numbers",
            {"rows": {"poses": {"listed": [[1.0]]}}},
        ]);
        let found = ask(MACHINE, questions);
        let [rows, sources, numbers, wrong] = [0, 1, 2, 3].map(|i| &found["answers"][i]);
        let um: Vec<f64> = serde_json::from_value(rows["rows"]["poses"][0]["deviation_um"].clone()).unwrap();
        // Y is 200 mm x 20 urad off in X, the tip at 300 mm of a Z that leans 5 urad.
        assert!((um[0] - -2.5).abs() < 1e-3 && um[1].abs() < 1e-3, "{um:?}");
        assert_eq!(rows["map"]["poses"], 2);
        let parts: f64 = sources["errors"].as_array().unwrap().iter().map(|e| e["at_um"].as_f64().unwrap()).sum();
        assert!((parts - 2.5).abs() < 1e-3 && sources["at"]["Z"] == 300.0, "{sources}");
        let number = |error: &str| numbers[error]["value"].as_f64().unwrap();
        assert!((number("EC0Y") - 20.0).abs() < 1e-9 && (number("EB0Z") - 5.0).abs() < 1e-9, "{numbers}");
        assert_eq!(wrong["refused"], true);
    }

    #[test]
    fn answers_make_a_file_without_a_machine() {
        let ask = |answers: Value| {
            let request = json!({"machine": "m.yaml", "texts": {"m.yaml": ":"}, "dialogue": answers});
            workbench(&request.to_string(), Run::default())["answers"][0].clone()
        };
        let keys = |found: &Value| -> Vec<String> {
            let questions = found["questions"].as_array().unwrap();
            questions.iter().map(|of| of["key"].as_str().unwrap().to_owned()).collect()
        };
        let proposed = ask(json!({}));
        assert_eq!(keys(&proposed)[..3], ["kind", "travel X", "travel Y"]);
        assert!(proposed["file"].as_str().unwrap().contains("C' A'"), "{proposed}");
        let wrong = ask(json!({"kind": "1", "travel X": "5 0", "known": "2", "accuracy Y": "8"}));
        assert_eq!((&wrong["file"], &wrong["questions"][1]["is_understood"]), (&Value::Null, &json!(false)));
        assert_eq!(keys(&wrong).last().unwrap(), "class");
        assert_eq!(keys(&ask(json!({"kind": "7"}))), ["kind"]);
        assert_eq!(ask(json!({"kind": "0"}))["questions"][0]["is_understood"], false);
        assert_eq!(ask(json!({"known": "3"}))["file"], Value::Null);
    }

    #[test]
    fn every_error_of_the_chain_has_words() {
        const EYX: &str = "Straightness error of X in Y: across its direction, at its position.";
        let found = ask(MACHINE, json!(["words", "schema", {"reach": {"step_mm": 100.0}}]));
        let words = found["answers"][0].as_object().unwrap();
        assert_eq!((words.len(), &words["EYX"]), (36, &json!(EYX)));
        assert!(found["answers"][1]["properties"]["axes"].is_object());
        assert_eq!(found["answers"][2]["share"], 1.0);
    }

    #[test]
    fn sources_name_the_errors_in_words_and_add_up_at_the_worst_pose() {
        let found = ask(MACHINE, json!([{"sources": {"poses": 300}}, {"map": {"poses": {"random": 300}}}]));
        let [sources, map] = [&found["answers"][0], &found["answers"][1]];
        assert_eq!(sources["errors"][0]["words"], "Orientation of Y about Z: its squareness to X.");
        let sum: f64 = sources["errors"].as_array().unwrap().iter().map(|e| e["at_um"].as_f64().unwrap()).sum();
        let max = map["position_um"]["max"].as_f64().unwrap();
        assert!((sum - max).abs() < 1e-3 * max, "{sum} {max}");
    }
}
