//! Machine files checked one by one.

use super::look::{LookOptions, look};
use super::summary::{MachineSummary, summary};
use super::tolerances::class_without_rotary;
use crate::diagnostic::{Diagnostics, WarningRecord};
use crate::job::job_file::{Job, JobPaths};
use crate::job::machine_file::{LoadOptions, MachineFile, load};
use crate::run::{Answer, Call, Run};
use serde::{Serialize, Serializer};
use std::path::Path;

/// A machine file with everything that was found wrong with it.
///
/// Serialises to the machine in short, with its warnings, or to the diagnostics that refuse it, each with the name of
/// the file.
#[derive(Debug, Clone)]
pub struct CheckedFile {
    /// The file as it was named.
    pub file: String,
    /// The machine; none if the file is refused.
    pub machine: Option<MachineFile>,
    /// Everything found wrong.
    pub diagnostics: Diagnostics,
}

impl CheckedFile {
    /// True if the file is refused.
    pub fn refused(&self) -> bool {
        self.machine.is_none()
    }
}

#[derive(Serialize)]
#[serde(untagged)]
enum Contract<'a> {
    Accepted {
        file: &'a str,
        #[serde(flatten)]
        summary: Box<MachineSummary>,
        #[serde(skip_serializing_if = "Vec::is_empty")]
        warnings: Vec<WarningRecord>,
    },
    Refused {
        file: &'a str,
        #[serde(flatten)]
        diagnostics: &'a Diagnostics,
    },
}

impl Serialize for CheckedFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (file, diagnostics) = (self.file.as_str(), &self.diagnostics);
        let contract = match &self.machine {
            Some(machine) => Contract::Accepted {
                file,
                summary: Box::new(summary(machine)),
                warnings: diagnostics.warning_records(),
            },
            None => Contract::Refused { file, diagnostics },
        };
        contract.serialize(serializer)
    }
}

/// Reads machine files through `run.files` and checks each, whether the others are refused or not.
pub fn check<P: AsRef<Path>>(paths: impl IntoIterator<Item = P>, run: Run) -> Vec<CheckedFile> {
    paths.into_iter().map(|path| one(path.as_ref(), run)).collect()
}

fn one(path: &Path, run: Run) -> CheckedFile {
    let file = path.display().to_string();
    // Warnings are denied once all of them are there.
    let warned = Run { deny_warnings: false, ..run };
    let mut checked = match load(path, &LoadOptions::default(), warned) {
        Ok(answer) => with_job(file, answer, warned),
        Err(diagnostics) => CheckedFile { file, machine: None, diagnostics },
    };
    if run.deny_warnings && checked.diagnostics.warnings() > 0 {
        checked.diagnostics.deny_warnings();
        checked.machine = None;
    }
    checked
}

/// Returns a checked file with what is wrong with the job that it states.
fn with_job(file: String, answer: Answer<MachineFile>, run: Run) -> CheckedFile {
    let Answer { value: machine, warnings: mut diagnostics } = answer;
    machine.questions.iter().for_each(|question| diagnostics.push(question.clone()));
    let found = Call::answer(run, machine.sources(), |call| {
        call.extend(class_without_rotary(&machine));
        let paths = JobPaths::default();
        paths.with_tool(call, &machine, |call, machine| {
            let Some(job) = paths.read(call, machine)? else { return Ok(()) };
            let reached = job.poses.reached(call, machine)?;
            let _ = Job::set_up(Some(&job), call, machine, None, &reached.poses)?;
            Job::characteristics(Some(&job), call, machine, Some(&reached)).map(|_| ())
        })
    });
    let (machine, of_job) = match found {
        Ok(answer) => (Some(machine), answer.warnings),
        Err(refusal) => (None, refusal),
    };
    diagnostics.absorb(of_job);
    // Its warnings count.
    let drawn = machine.as_ref().map(|machine| look(machine, &LookOptions { max_triangles: usize::MAX }, run));
    match drawn {
        Some(Ok(answer)) => diagnostics.absorb(answer.warnings),
        Some(Err(failure)) => diagnostics.absorb(failure),
        None => (),
    }
    CheckedFile { file, machine, diagnostics }
}

/// Returns the diagnostics of checked files as one SARIF 2.1.0 log, relative file names as relative URIs.
pub fn annotations(files: &[CheckedFile]) -> serde_json::Value {
    crate::diagnostic::sarif(files.iter().map(|checked| (checked.file.as_str(), &checked.diagnostics)))
}
