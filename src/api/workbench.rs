//! The workbench: questions about one machine in one request, answered in one JSON document.
//!
//! A face that holds the text of a machine file in an editor sends that text with its questions. The machine is read
//! once, and every answer has the shape that the verb of the program prints with `--format json`.

use super::budget::{BudgetOptions, budget};
use super::eval::{EvalOptions, eval};
use super::machine_file::{LoadOptions, MachineFile, Overlay, load};
use super::map::{MapOptions, map};
use super::run::{Answer, Run};
use super::show::show;
use super::sources::{SourcesOptions, sources};
use super::summary::summary;
use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use crate::syntax::MemoryFiles;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;

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
    /// The questions, in the order in which they are answered.
    pub questions: Vec<Question>,
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
    /// Each error alone over the volume.
    Sources(SourcesOptions),
    /// Tolerances to the volumetric error.
    Budget(BudgetOptions),
}

/// Answers a request of JSON by JSON: `{"diagnostics": [...], "answers": [...]}`.
///
/// `diagnostics` are those of reading the machine, with their places. Without a machine `answers` is empty. Otherwise
/// it has an entry for each question, the result or `{"refused": true, "diagnostics": [...]}`.
pub fn workbench(request: &str, run: Run<'_>) -> Value {
    let mut json = serde_json::Deserializer::from_str(request);
    match serde_path_to_error::deserialize(&mut json) {
        Ok(request) => answered(&request, run),
        Err(failure) => {
            let message = format!("request, at `{}`: {}", failure.path(), failure.inner());
            refused(&Diagnostic::new(codes::E0818, message).into())
        }
    }
}

fn refused(diagnostics: &Diagnostics) -> Value {
    json!({"diagnostics": diagnostics.records(), "answers": []})
}

fn answered(request: &WorkbenchRequest, run: Run<'_>) -> Value {
    let text = request.texts.iter().fold(MemoryFiles::new(), |files, (name, text)| files.with(name, text.as_str()));
    let files = Overlay { text, files: run.files };
    let run = Run { files: &files, ..run };
    match load(Path::new(&request.machine), &LoadOptions { tool: request.tool.clone() }, run) {
        Ok(Answer { value: machine, warnings }) => {
            let answers: Vec<Value> = request.questions.iter().map(|question| question.answer(&machine, run)).collect();
            json!({"diagnostics": warnings.records(), "answers": answers})
        }
        Err(diagnostics) => refused(&diagnostics),
    }
}

impl Question {
    fn answer(&self, machine: &MachineFile, run: Run<'_>) -> Value {
        match self {
            Self::Check => json!(summary(machine)),
            Self::Show => json!(show(machine)),
            Self::Eval(options) => document(eval(machine, options, run)),
            Self::Map(options) => document(map(machine, options, run)),
            Self::Sources(options) => document(sources(machine, options, run)),
            Self::Budget(options) => document(budget(machine, options, run)),
        }
    }
}

fn document<T: Serialize>(answer: Result<Answer<T>, Diagnostics>) -> Value {
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
    fn questions_are_answered_in_their_order() {
        let found = ask(MACHINE, json!(["show", {"map": {"poses": {"random": 50}}}, {"budget": {}}]));
        let answers = found["answers"].as_array().unwrap();
        assert_eq!((answers.len(), &answers[0]["chain"]), (3, &json!("w b X Y Z t")));
        assert_eq!(answers[1]["poses"], 50);
        assert_eq!((&answers[2]["refused"], &answers[2]["diagnostics"][0]["code"]), (&json!(true), &json!("E0604")));
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
    fn sources_name_the_errors_in_words_and_add_up_at_the_worst_pose() {
        let found = ask(MACHINE, json!([{"sources": {"poses": 300}}, {"map": {"poses": {"random": 300}}}]));
        let [sources, map] = [&found["answers"][0], &found["answers"][1]];
        assert_eq!(sources["errors"][0]["words"], "Orientation of Y about Z: its squareness to X.");
        let sum: f64 = sources["errors"].as_array().unwrap().iter().map(|e| e["at_worst_um"].as_f64().unwrap()).sum();
        let max = map["position_um"]["max"].as_f64().unwrap();
        assert!((sum - max).abs() < 1e-3 * max, "{sum} {max}");
    }
}
