//! The JSON Schema: accepts every machine file there is, refuses the examples it can refuse.
//! Judged by a small validator here and, where Python's jsonschema is installed (`tests/run`), by
//! that one too.

use super::language::TRUNNION;
use abbe::machine::Conventions;
use abbe::syntax::schema;
use regex_lite::Regex;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// Examples of tests/diagnostics that a schema can refuse: form, words, units of single values.
const REFUSED: [&str; 22] = [
    "E0109-empty",
    "E0201-unknown-keys",
    "E0202-wrong-forms",
    "E0203-missing",
    "E0204-no-unit",
    "E0205-wrong-unit",
    "E0206-not-quantities",
    "E0207-points",
    "E0209-rivals",
    "E0209-tools",
    "E0210-choices",
    "E0211-version",
    "E0212-names",
    "E0213-implausible",
    "E0215-words",
    "E0301-words",
    "E0302-backwards",
    "E0302-no-bed",
    "E0305-primes",
    "E0306-axis-name",
    "E0402-directions",
    "E0405-names",
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

/// Python's verdict.
fn python(task: &Value) {
    let script = root().join("tests/schema/check.py");
    let program = std::env::var("ABBE_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let mut python = Command::new(program).arg(script).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    python.stdin.take().unwrap().write_all(task.to_string().as_bytes()).unwrap();
    let output = python.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}

/// Documents to be accepted and documents to be refused, by name.
fn cases() -> (BTreeMap<String, Value>, BTreeMap<String, Value>) {
    let mut accept = BTreeMap::new();
    machines(&root().join("configs"), &mut accept);
    machines(&root().join("tests/data"), &mut accept);
    accept.insert("the whole language".to_owned(), serde_yaml::from_str(TRUNNION).unwrap());
    let read = |name: &&str| {
        let path = root().join("tests/diagnostics").join(name).join("machine.yaml");
        ((*name).to_owned(), document(&path))
    };
    accept.extend(["W0401-left-out", "W0402-inert", "W0403-repeats", "E0409-travel-not-covered"].iter().map(read));
    (accept, REFUSED.iter().map(read).collect())
}

#[test]
fn the_schema_accepts_what_is_right_and_refuses_what_it_can() {
    let schema = schema();
    let (accept, refuse) = cases();
    assert!(accept.len() > 30);
    for (name, document) in accept {
        let faults = faults(&schema, &schema, &document, "");
        assert!(faults.is_empty(), "{name}: {}", faults.join("\n"));
    }
    for (name, document) in refuse {
        assert!(!faults(&schema, &schema, &document, "").is_empty(), "{name} is accepted");
    }
}

#[test]
#[ignore = "needs python3 with the package jsonschema; tests/run installs it"]
fn another_validator_agrees() {
    let (accept, refuse) = cases();
    python(&json!({ "schema": schema(), "accept": accept, "refuse": refuse }));
}

/// Faults of a value by the keywords of draft-07 that the schema uses; an unknown keyword fails.
fn faults(root: &Value, schema: &Value, value: &Value, at: &str) -> Vec<String> {
    let Some(map) = schema.as_object() else {
        return if schema == &json!(false) { vec![format!("{at} may not be there")] } else { Vec::new() };
    };
    map.iter().flat_map(|(keyword, rule)| keyword_faults(root, map, keyword, rule, value, at)).collect()
}

fn keyword_faults(
    root: &Value,
    schema: &serde_json::Map<String, Value>,
    keyword: &str,
    rule: &Value,
    value: &Value,
    at: &str,
) -> Vec<String> {
    let valid = |schema: &Value| faults(root, schema, value, at).is_empty();
    let count = |list: &Value| list.as_array().unwrap().iter().filter(|s| valid(s)).count();
    let bound = |n: Option<f64>, fits: fn(f64, f64) -> bool| n.is_none_or(|n| fits(n, rule.as_f64().unwrap()));
    let items = value.as_array();
    let has = |key: &Value| value.as_object().is_none_or(|o| o.contains_key(key.as_str().unwrap()));
    let length = value.as_str().map(|s| s.chars().count() as f64);
    let fits = match keyword {
        "$schema" | "title" | "description" | "definitions" | "format" | "examples" | "patternErrorMessage" => true,
        // Judged with `if`; without it they say nothing.
        "then" | "else" => true,
        "if" => {
            let branch = if valid(rule) { "then" } else { "else" };
            return schema.get(branch).map_or_else(Vec::new, |branch| faults(root, branch, value, at));
        }
        "$ref" => return faults(root, root.pointer(&rule.as_str().unwrap()[1..]).unwrap(), value, at),
        "properties" | "patternProperties" | "additionalProperties" => {
            return member_faults(root, schema, keyword, value, at);
        }
        "items" => return item_faults(root, rule, items, at),
        "type" => rule.as_array().map_or_else(|| is(value, rule), |any| any.iter().any(|t| is(value, t))),
        "enum" => rule.as_array().unwrap().contains(value),
        "const" => rule == value || rule.as_f64().is_some_and(|n| value.as_f64() == Some(n)),
        "pattern" => value.as_str().is_none_or(|s| Regex::new(rule.as_str().unwrap()).unwrap().is_match(s)),
        "required" => rule.as_array().unwrap().iter().all(has),
        "anyOf" => count(rule) > 0,
        "allOf" => count(rule) == rule.as_array().unwrap().len(),
        "oneOf" => count(rule) == 1,
        "not" => !valid(rule),
        "dependencies" => rule.as_object().unwrap().iter().all(|(k, s)| value.get(k).is_none() || valid(s)),
        "minimum" => bound(value.as_f64(), |n, r| n >= r),
        "maximum" => bound(value.as_f64(), |n, r| n <= r),
        "exclusiveMinimum" => bound(value.as_f64(), |n, r| n > r),
        "minLength" => bound(length, |n, r| n >= r),
        "maxLength" => bound(length, |n, r| n <= r),
        "minItems" => bound(items.map(|i| i.len() as f64), |n, r| n >= r),
        "maxItems" => bound(items.map(|i| i.len() as f64), |n, r| n <= r),
        "minProperties" => bound(value.as_object().map(|o| o.len() as f64), |n, r| n >= r),
        other => panic!("the validator does not know `{other}`"),
    };
    if fits { Vec::new() } else { vec![format!("{at}: {keyword} {rule}: {value}")] }
}

fn is(value: &Value, name: &Value) -> bool {
    match name.as_str().unwrap() {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|n| n.fract() == 0.0),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        other => panic!("unknown type `{other}`"),
    }
}

/// The members that one of the three keywords about members is about.
fn member_faults(
    root: &Value,
    schema: &serde_json::Map<String, Value>,
    keyword: &str,
    value: &Value,
    at: &str,
) -> Vec<String> {
    let named = |key: &str| schema.get("properties").and_then(|p| p.get(key));
    let matching = |key: &str| -> Vec<&Value> {
        let patterns = schema.get("patternProperties").and_then(Value::as_object).into_iter().flatten();
        patterns.filter(|(p, _)| Regex::new(p).unwrap().is_match(key)).map(|(_, s)| s).collect()
    };
    let rules = |key: &str| match keyword {
        "properties" => named(key).into_iter().collect(),
        "patternProperties" => matching(key),
        _ if named(key).is_none() && matching(key).is_empty() => vec![&schema["additionalProperties"]],
        _ => Vec::new(),
    };
    let members = value.as_object().into_iter().flatten();
    members
        .flat_map(|(key, member)| {
            let here = format!("{at}/{key}");
            rules(key).into_iter().flat_map(move |rule| faults(root, rule, member, &here)).collect::<Vec<_>>()
        })
        .collect()
}

fn item_faults(root: &Value, rule: &Value, items: Option<&Vec<Value>>, at: &str) -> Vec<String> {
    let rule_of = |i: usize| rule.as_array().map_or(Some(rule), |rules| rules.get(i));
    let items = items.into_iter().flatten().enumerate();
    items.flat_map(|(i, item)| rule_of(i).map_or(Vec::new(), |r| faults(root, r, item, &format!("{at}/{i}")))).collect()
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
    assert_eq!(schema["properties"].as_object().unwrap().len(), 23);
    assert!(schema["definitions"]["AxisEntry"]["properties"]["travel"]["description"].is_string());
}
