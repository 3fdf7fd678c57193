//! Collects the start of a report's workbench: the files, the questions that the page asks, and their answers.
//!
//! The page looks a question up here by its content; what is not here it asks its engine, if it has one.

use super::report_options::ReportOptions;
use super::workbench::workbench;
use crate::api::sources::SourcesOptions;
use crate::api::{MachineFile, MapOptions};
use crate::job::job_file::NO_JOB;
use crate::job::machine_file::{Overlay, bounded_only, sources_of};
use crate::machine::Travel;
use crate::run::{Call, Run};
use crate::syntax::{Files, MemoryFiles};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Maximum number of poses whose deviations the page knows by itself.
const MAX_POSES: usize = 200;

/// Number of machines that the page draws for what bounds lead to at a pose.
const POSE_SAMPLES: usize = 300;

/// Maximum number of triangles by which a mailed machine is drawn: half a megabyte at most.
const MAX_TRIANGLES: usize = 20_000;

/// Maximum number of machines with which the page compares another.
const MAX_COMPARED: usize = 6;

/// Returns the content of the element `start` of a page with these machines.
///
/// `job_files` are the names of the files that make the job.
pub(crate) fn start(
    call: &Call<'_>,
    files: &[MachineFile],
    options: &ReportOptions,
    job_files: &BTreeSet<String>,
) -> Value {
    let mut texts: Map<String, Value> =
        sources_of(files).iter().map(|(name, text)| (name.to_owned(), json!(text))).collect();
    for name in job_files {
        if let Ok(bytes) = call.run.files.read(Path::new(name)) {
            let _ = texts.insert(name.clone(), json!(String::from_utf8_lossy(&bytes)));
        }
    }
    let memory = texts
        .iter()
        .fold(MemoryFiles::new(), |memory, (name, text)| memory.with(name.as_str(), text.as_str().unwrap_or_default()));
    let files_of = Overlay { text: memory, files: call.run.files };
    let settings = settings(options);
    // Those behind it, then those before it: so each machine is once the first, which the others are compared with.
    let asked = |(at, file): (usize, &MachineFile)| {
        let others = files.iter().skip(at + 1).chain(files.iter().take(at)).map(MachineFile::path).take(MAX_COMPARED);
        asked(file, &others.collect::<Vec<_>>(), options, &settings, &files_of)
    };
    let asked: Vec<Value> = files.iter().enumerate().map(asked).collect();
    let work = job_file(options).or(options.tool_poses.as_ref());
    let place = json!({"work": work, "target": options.targets.first(), "asked": asked_part(options)});
    json!({"abbe": env!("CARGO_PKG_VERSION"), "settings": settings, "files": texts, "machines": asked, "place": place})
}

/// Options of the figures that the page shows first, in the words of the questions.
fn settings(options: &ReportOptions) -> Value {
    let ReportOptions { seed, order, approach, poses, samples, .. } = options;
    let bounds = json!(options.tolerances);
    let with_bounds = |mut of: Value| {
        if let (Some(of), Some(bounds)) = (of.as_object_mut(), bounds.as_object()) {
            of.extend(bounds.clone());
        }
        of
    };
    json!({
        "poses": poses, "samples": samples,
        "map": with_bounds(json!({"seed": seed, "order": order, "approach": approach})),
        "sources": {"seed": seed, "order": order, "approach": approach},
        "budget": with_bounds(json!({"seed": seed, "poses": poses})),
        "look": {"max_triangles": MAX_TRIANGLES},
        "compare": with_bounds(json!({"seed": seed, "poses": poses, "samples": samples})),
    })
}

/// A machine with the answers to what the page asks of it.
///
/// `others` are the names of those that it is compared with.
fn asked(file: &MachineFile, others: &[&str], options: &ReportOptions, settings: &Value, files: &dyn Files) -> Value {
    let tool = (file.tools().len() > 1).then(|| file.tool().name.clone());
    let ask = |questions: &[Value], over: &Value| -> Vec<Value> {
        let request = json!({"machine": file.path(), "tool": tool, "questions": questions, "over": over});
        match workbench(&request.to_string(), Run::with(files))["answers"].take() {
            Value::Array(answers) => answers,
            _ => Vec::new(),
        }
    };
    let (mut questions, over) = (questions(options, settings), over(options));
    if let [first, more @ ..] = others {
        questions.push(json!({"compare": {"first": first, "more": more, "options": settings["compare"]}}));
    }
    if !file.look.meshes.is_empty() {
        questions.push(json!({"look": settings["look"]}));
    }
    if bounded_only(file).is_some() {
        let repair = |name: &String| json!({"repair": {"target": name, "machines": DRAWN_MACHINES}});
        questions.extend(options.targets.iter().map(repair));
    }
    let known = |questions: &[Value], over: &Value| -> Vec<Value> {
        let pairs = questions.iter().zip(ask(questions, over));
        pairs.map(|(question, answer)| json!({"question": question, "answer": answer, "over": over})).collect()
    };
    let mut all = known(&questions, &over);
    // Beside a job the page shows the volume, too.
    if file.job.is_some() || job_file(options).is_some() || options.tool_poses.is_some() {
        let scoped = ["map", "sources", "budget", "reach", "compare", "repair"];
        questions.retain(|question| scoped.iter().any(|of| question[of].is_object()));
        all.extend(known(&questions, &Value::Null));
    }
    let poses = poses(file, &all);
    let deviations = ask(&[json!({"eval": {"poses": poses}})], &Value::Null).pop();
    let rows = json!({"rows": {"poses": {"listed": poses}, "samples": POSE_SAMPLES}});
    let rows = bounded_only(file).and_then(|_| ask(&[rows], &Value::Null).pop());
    let text = file.sources().iter().next().map_or("", |(_, text)| text);
    json!({"machine": file.path(), "tool": tool, "text": text, "known": all,
        "eval": {"poses": poses, "answer": deviations, "samples": POSE_SAMPLES, "rows": rows}})
}

/// Number of machines drawn between bounds that the page corrects.
const DRAWN_MACHINES: usize = 11;

/// Returns the job file of a report.
fn job_file(options: &ReportOptions) -> Option<&PathBuf> {
    options.job.as_ref().filter(|path| *path != Path::new(NO_JOB))
}

/// Returns what the report states of the part besides its file.
fn asked_part(options: &ReportOptions) -> Value {
    let reference = options.reference.as_ref().map(|reference| ("reference".to_owned(), json!(reference)));
    let path = options.path.map(|path| ("path".to_owned(), json!(path)));
    Value::Object(reference.into_iter().chain(path).collect())
}

/// Returns the part that questions are over, as the page names it.
fn over(options: &ReportOptions) -> Value {
    let mut part = asked_part(options);
    match (job_file(options), &options.tool_poses) {
        (Some(job), _) => part["job"] = json!(job),
        (None, Some(tool_poses)) => part["tool_poses"] = json!(tool_poses),
        (None, None) => (),
    }
    part
}

/// Returns the question about the part, as its panel asks it.
fn part(options: &ReportOptions, settings: &Value) -> Value {
    let mut part = over(options);
    part["samples"] = json!(options.samples);
    part["map"] = settings["map"].clone();
    json!({"work": part})
}

/// Returns the questions of the page when it is opened, and those of its panels.
fn questions(options: &ReportOptions, settings: &Value) -> Vec<Value> {
    let of = |key: &str, own: Value| {
        let mut all = settings[key].clone();
        if let (Some(all), Value::Object(own)) = (all.as_object_mut(), own) {
            all.extend(own);
        }
        json!({key: all})
    };
    let (poses, samples) = (options.poses, options.samples);
    let worst = MapOptions::default().worst;
    let mut questions = vec![
        json!("show"),
        json!("words"),
        json!("numbers"),
        of("map", json!({"poses": {"random": poses}, "worst": worst, "samples": samples})),
        of("sources", json!({"poses": poses.min(SourcesOptions::MAX_POSES)})),
        of("budget", json!({"samples": samples})),
        json!({"reach": {}}),
        json!("targets"),
        json!("schema"),
    ];
    // The panels ask for as many poses as the page does of a machine that is edited.
    let few = ReportOptions::default().poses;
    questions.extend(options.targets.iter().map(|name| json!({"map": {"poses": {"random": few}, "target": name}})));
    let instruments = ["ball_bar", "r_test", "diagonals"];
    questions.extend(instruments.map(|instrument| json!({"instrument": {"instrument": instrument}})));
    questions.push(part(options, settings));
    questions
}

/// Poses that the page leads to: zero, the worst of the volume, those of the part.
fn poses(file: &MachineFile, known: &[Value]) -> Vec<Vec<f64>> {
    let row = |at: &Value| -> Vec<f64> {
        file.axes().iter().map(|axis| at[axis.name.as_str()].as_f64().unwrap_or_default()).collect()
    };
    let zero = file.axes().iter().map(|axis| match axis.travel {
        Travel::Range(min, max) => 0.0_f64.max(min).min(max),
        Travel::Continuous => 0.0,
    });
    let mut poses = vec![zero.collect()];
    let lists = ["/answer/worst", "/answer/bounds/worst", "/answer/rows/poses"];
    for entry in lists.iter().flat_map(|list| known.iter().filter_map(|of| of.pointer(list)?.as_array())) {
        poses.extend(entry.iter().map(|of| &of["axes"]).filter(|at| at.is_object()).map(row));
    }
    poses.truncate(MAX_POSES);
    poses
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LoadOptions, load, report};

    #[test]
    fn a_page_knows_the_answers_of_the_workbench() {
        let machine = load("configs/trunnion.yaml", &LoadOptions::default(), Run::on_disk()).unwrap().value;
        let options = ReportOptions { poses: 30, samples: 20, ..ReportOptions::default() };
        let report = report(std::slice::from_ref(&machine), &options, Run::on_disk()).unwrap();
        let start = report.value.start();
        let known = start["machines"][0]["known"].as_array().unwrap();
        assert!(
            known.len() == 13
                && known.iter().all(|of| of["answer"]["refused"].is_null() || of["question"]["budget"].is_object())
        );
        let map = &known.iter().find(|of| of["question"]["map"].is_object()).unwrap();
        let own = crate::map(
            &machine,
            &MapOptions { poses: crate::options::MapPoses::Random(30), ..MapOptions::default() },
            Run::default(),
        );
        assert_eq!(map["answer"]["position_um"], json!(own.unwrap().value.position_um));
        let eval = &start["machines"][0]["eval"];
        assert_eq!(eval["poses"].as_array().unwrap().len(), eval["answer"]["poses"].as_array().unwrap().len());
        assert!(start["files"].as_object().unwrap().len() > 5, "the tables travel with the page");
    }
}
