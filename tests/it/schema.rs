//! The JSON Schema: accepts every machine file there is, refuses the examples it can refuse. An
//! independent validator (Python's jsonschema) judges; without it the test says that it was left
//! out, and fails if ABBE_TEST_ALL is set.

use super::language::TRUNNION;
use abbe::machine::Conventions;
use abbe::syntax::schema;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// Examples of tests/diagnostics that a schema can refuse: form, words, units of single values.
const REFUSED: [&str; 22] = [
    "E0109-empty", "E0201-unknown-keys", "E0202-wrong-forms", "E0203-missing", "E0204-no-unit", "E0205-wrong-unit",
    "E0206-not-quantities", "E0207-points", "E0209-rivals", "E0209-tools", "E0210-choices", "E0211-version",
    "E0212-names", "E0213-implausible", "E0215-words", "E0301-words", "E0302-backwards", "E0302-no-bed",
    "E0305-primes", "E0306-axis-name", "E0402-directions", "E0405-names",
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn document(path: &Path) -> Value {
    serde_yaml::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// YAML files of a folder and those below it.
fn machines(folder: &Path, found: &mut BTreeMap<String, Value>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            machines(&path, found);
        } else if path.extension().is_some_and(|e| e == "yaml") {
            found.insert(path.strip_prefix(root()).unwrap().display().to_string(), document(&path));
        }
    }
}

/// Runs the validator; `None` if there is none.
fn validate(task: &Value) -> Option<String> {
    let mut python = Command::new("python3")
        .arg(root().join("tests/schema/check.py"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .ok()?;
    // It may have ended already if the package is missing.
    let _ = python.stdin.take()?.write_all(task.to_string().as_bytes());
    let output = python.wait_with_output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    match output.status.code() {
        Some(77) => None,
        Some(0) => Some(text),
        _ => panic!("{text}"),
    }
}

#[test]
fn the_schema_accepts_what_is_right_and_refuses_what_it_can() {
    let mut accept = BTreeMap::new();
    machines(&root().join("configs"), &mut accept);
    machines(&root().join("tests/data"), &mut accept);
    accept.insert("the whole language".to_owned(), serde_yaml::from_str(TRUNNION).unwrap());
    for name in ["W0401-left-out", "W0402-inert", "W0403-repeats", "E0409-travel-not-covered"] {
        accept.insert(name.to_owned(), document(&root().join("tests/diagnostics").join(name).join("machine.yaml")));
    }
    let read = |name: &&str| {
        let path = root().join("tests/diagnostics").join(name).join("machine.yaml");
        ((*name).to_owned(), document(&path))
    };
    let refuse: BTreeMap<String, Value> = REFUSED.iter().map(read).collect();
    match validate(&json!({ "schema": schema(), "accept": accept, "refuse": refuse })) {
        Some(text) => println!("{text}"),
        None => {
            assert!(std::env::var_os("ABBE_TEST_ALL").is_none(), "python3 with jsonschema is missing");
            println!("LEFT OUT: schema validation needs python3 with the package jsonschema");
        }
    }
}

#[test]
fn the_schema_knows_the_words_of_the_machine() {
    let schema = schema();
    let presets = &schema["properties"]["conventions"]["anyOf"][0]["enum"];
    assert!(Conventions::PRESETS.iter().all(|p| presets.as_array().unwrap().contains(&json!(p))));
    let conventions = &schema["definitions"]["ConventionsEntry"]["properties"];
    let words = serde_json::to_value(Conventions::default()).unwrap();
    for (key, word) in words.as_object().unwrap().iter().filter(|(key, _)| *key != "default_order") {
        assert!(conventions[key]["enum"].as_array().unwrap().contains(word), "{key}: {word}");
    }
}

#[test]
fn the_schema_is_draft_07_and_describes_its_keys() {
    let schema = schema();
    assert_eq!(schema["$schema"], "http://json-schema.org/draft-07/schema#");
    assert_eq!(schema["additionalProperties"], false);
    assert_eq!(schema["properties"].as_object().unwrap().len(), 17);
    assert!(schema["definitions"]["AxisEntry"]["properties"]["travel"]["description"].is_string());
}
