//! Refusals for programs: as JSON on standard output, as SARIF, and of several files at once.

use crate::program::{Folder, abbe, abbe_on, json, refused, text};
use serde_json::Value;
use std::path::Path;

const WRONG: &str = "abbe: 1\nmachine: µ\nchain: \"w b X t\"\naxes:\n  X: { travle: [0 mm, 1 mm] }\n";

/// Exit code and standard output as JSON.
fn document(arguments: &[&str]) -> (i32, Value) {
    let output = abbe_on(2, arguments);
    let stdout = String::from_utf8(output.stdout).unwrap();
    let value = serde_json::from_str(&stdout).unwrap_or_else(|failure| panic!("{arguments:?}: {failure}: {stdout:?}"));
    (output.status.code().unwrap(), value)
}

fn codes(refusal: &Value) -> Vec<&str> {
    refusal["diagnostics"].as_array().unwrap().iter().map(|d| d["code"].as_str().unwrap()).collect()
}

#[test]
fn a_refused_input_is_json_with_places_as_the_text_has_them() {
    let folder = Folder::new("annotations-refused");
    let file = folder.with("wrong.yaml", WRONG);
    let (code, refusal) = document(&["check", text(&file), "--format", "json"]);
    assert_eq!((code, &refusal["refused"]), (1, &true.into()));
    let first = &refusal["diagnostics"][0];
    assert_eq!(first["severity"], "refusal");
    assert!(!first["message"].as_str().unwrap().is_empty() && first["help"].is_string(), "{first}");
    let place = &first["places"][0];
    assert_eq!((&place["file"], &place["line"], &place["end_line"]), (&text(&file).into(), &5.into(), &5.into()));
    let (start, end) = (place["column"].as_u64().unwrap() as usize, place["end_column"].as_u64().unwrap() as usize);
    let line: Vec<char> = WRONG.lines().nth(4).unwrap().chars().collect();
    assert_eq!(line[start - 1..end - 1].iter().collect::<String>(), "travle");
    let (_, shown) = refused(&["check", text(&file)]);
    assert!(shown.contains(&format!("wrong.yaml:5:{start}")), "{shown}");
    assert!(codes(&refusal).iter().all(|code| shown.contains(code)), "{shown}");
}

#[test]
fn every_verb_that_reads_a_file_refuses_in_json() {
    let folder = Folder::new("annotations-verbs");
    let file = folder.with("wrong.yaml", WRONG);
    let (wrong, good) = (text(&file), "trunnion.yaml");
    let out = text(&folder.0).to_owned() + "/out";
    for arguments in [
        &["show", wrong][..],
        &["eval", wrong, "--at", "X=1"],
        &["equations", wrong],
        &["classify", wrong],
        &["convert", wrong, "--to", "iso230"],
        &["map", wrong],
        &["compare", wrong, good],
        &["budget", wrong],
        &["enumerate", wrong],
        &["instrument", wrong, "ball-bar"],
        &["identify", wrong, "--data", "none.csv"],
        &["import", "none.csv"],
        &["compile", wrong, "--target", "grid-csv", "--out", &out],
        &["verify", wrong, &out],
        &["report", wrong, "--out", &out],
        &["diff", wrong, &out, &out],
        &["init", good],
    ] {
        let output = abbe_on(2, &[arguments, &["--format", "json"]].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        // Arguments that clap refuses have not been parsed.
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {said}");
        let refusal: Value = serde_json::from_slice(&output.stdout).unwrap_or_else(|f| panic!("{arguments:?}: {f}"));
        assert_eq!(refusal["refused"], true, "{arguments:?}");
        let codes = codes(&refusal);
        assert!(!codes.is_empty() && codes.iter().all(|code| said.contains(code)), "{arguments:?}: {codes:?}, {said}");
    }
}

#[test]
fn usage_after_parsing_is_json_too() {
    let (code, refusal) = document(&["classify", "trunnion.yaml", "--tolerance", "7", "--format", "json"]);
    assert_eq!((code, &refusal["refused"], codes(&refusal)), (2, &true.into(), vec!["E0818"]));
    let (code, refusal) = document(&["explain", "E9999", "--format", "json"]);
    assert_eq!((code, codes(&refusal)), (2, vec!["E0818"]));
    assert_eq!(refusal["diagnostics"][0]["places"], serde_json::json!([]));
    // Nothing on standard output in the other forms, as ever.
    assert!(abbe_on(2, &["explain", "E9999"]).stdout.is_empty());
}

#[test]
fn denied_warnings_refuse_in_json() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/diagnostics/W0402-inert/machine.yaml");
    let accepted = json_with_complaint(&["check", text(&file), "--format", "json"]);
    let warnings = accepted["warnings"].as_array().unwrap();
    let warned: Vec<&str> = warnings.iter().map(|warning| warning["code"].as_str().unwrap()).collect();
    let (code, refusal) = document(&["check", text(&file), "--format", "json", "--deny", "warnings"]);
    assert!(!warned.is_empty());
    assert_eq!((code, codes(&refusal)), (1, warned));
    assert_eq!(refusal["diagnostics"][0]["severity"], "refusal");
}

fn json_with_complaint(arguments: &[&str]) -> Value {
    let (code, value) = document(arguments);
    assert_eq!(code, 0);
    value
}

#[test]
fn check_takes_several_files() {
    let folder = Folder::new("annotations-several");
    let file = folder.with("wrong, too.yaml", WRONG);
    let list = ["check", "trunnion.yaml", text(&file), "gantry-3ax.yaml"];
    let output = abbe_on(2, &list);
    let (stdout, stderr) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr.contains("wrong, too.yaml:5:"), "{stderr}");
    let [first, third] = ["trunnion.yaml", "gantry-3ax.yaml"].map(|name| abbe(&["check", name]));
    let count = stderr.lines().last().unwrap();
    assert_eq!(stdout, format!("{first}\n{}\n  refused: {count}\n\n{third}", text(&file)));

    let (code, array) = document(&[&list[..], &["--format", "json"]].concat());
    let single = json(&["check", "trunnion.yaml", "--format", "json"]);
    assert_eq!((code, array.as_array().unwrap().len()), (1, 3));
    assert_eq!((&array[1]["file"], &array[1]["refused"]), (&text(&file).into(), &true.into()));
    assert!(!codes(&array[1]).is_empty());
    for (key, value) in single.as_object().unwrap() {
        assert_eq!(array[0][key], *value, "{key}");
    }
    assert_eq!((array[0]["file"].as_str(), single.get("file")), (Some("trunnion.yaml"), None));

    let csv = String::from_utf8(abbe_on(2, &[&list[..], &["--format", "csv"]].concat()).stdout).unwrap();
    let alone = abbe(&["check", "gantry-3ax.yaml", "--format", "csv"]);
    assert_eq!(csv.lines().next(), Some("file,error,kind,value"));
    for row in alone.lines().skip(1) {
        assert!(csv.contains(&format!("gantry-3ax.yaml,{row}")), "{row}");
    }
    let good = abbe_on(2, &["check", "trunnion.yaml", "gantry-3ax.yaml"]);
    assert_eq!(good.status.code(), Some(0));
}

/// Facts of the schema of SARIF 2.1.0: required properties and the values that enumerations allow.
fn sound(log: &Value) -> &Vec<Value> {
    assert_eq!(log["version"], "2.1.0");
    assert!(log["$schema"].as_str().unwrap().ends_with("sarif-schema-2.1.0.json"));
    let runs = log["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 1);
    let driver = &runs[0]["tool"]["driver"];
    assert_eq!(driver["name"], "abbe");
    assert_eq!(runs[0]["columnKind"], "unicodeCodePoints");
    let rules = driver["rules"].as_array().unwrap();
    for rule in rules {
        assert!(rule["shortDescription"]["text"].is_string() && rule["help"]["text"].is_string());
        assert_eq!(rules.iter().filter(|other| other["id"] == rule["id"]).count(), 1);
    }
    let results = runs[0]["results"].as_array().unwrap();
    for result in results {
        let rule = result["ruleIndex"].as_u64().unwrap() as usize;
        assert_eq!(rules[rule]["id"], result["ruleId"]);
        assert!(["error", "warning", "note", "none"].contains(&result["level"].as_str().unwrap()));
        assert!(!result["message"]["text"].as_str().unwrap().is_empty());
        let related = result.get("relatedLocations").and_then(Value::as_array).into_iter().flatten();
        for location in result["locations"].as_array().unwrap().iter().chain(related) {
            located(location);
        }
    }
    results
}

fn located(location: &Value) {
    let place = &location["physicalLocation"];
    let uri = place["artifactLocation"]["uri"].as_str().unwrap();
    let allowed = |c: char| c.is_ascii_alphanumeric() || "-._~/%:".contains(c);
    assert!(!uri.is_empty() && uri.chars().all(allowed), "{uri}");
    if let Some(region) = place.get("region") {
        let [line, column, end_line, end_column] =
            ["startLine", "startColumn", "endLine", "endColumn"].map(|key| region[key].as_u64().unwrap());
        assert!(line >= 1 && column >= 1 && (end_line, end_column) >= (line, column), "{region}");
    }
}

#[test]
fn sarif_has_what_its_schema_asks_for() {
    let folder = Folder::new("annotations-sarif");
    let _ = folder.with("wrong file.yaml", WRONG);
    let run = |arguments: &[&str]| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_abbe"));
        let output = command.args(arguments).args(["--format", "sarif"]).current_dir(&folder.0).output().unwrap();
        (output.status.code().unwrap(), serde_json::from_slice::<Value>(&output.stdout).unwrap())
    };
    let (code, log) = run(&["check", "./wrong file.yaml", "none.yaml"]);
    assert_eq!(code, 1);
    let results = sound(&log);
    let uri = |result: &Value| result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"].clone();
    assert_eq!((uri(&results[0]), &results[0]["level"]), ("wrong%20file.yaml".into(), &"error".into()));
    assert_eq!(results[0]["locations"][0]["physicalLocation"]["region"]["startLine"], 5);
    // A file that cannot be read has no region.
    let missing = results.iter().find(|result| uri(result) == "none.yaml").unwrap();
    assert!(missing["locations"][0]["physicalLocation"].get("region").is_none());
    // Twice the same file: every result once.
    let (_, twice) = run(&["check", "wrong file.yaml", "./wrong file.yaml", "none.yaml"]);
    assert_eq!(sound(&twice).len(), results.len());
}

#[test]
fn sarif_without_results_is_a_run_and_other_verbs_refuse_it() {
    let (code, log) = document(&["check", "trunnion.yaml", "--format", "sarif"]);
    assert_eq!((code, sound(&log).len()), (0, 0));
    let output = abbe_on(2, &["map", "trunnion.yaml", "--format", "sarif"]);
    assert_eq!((output.status.code(), output.stdout.is_empty()), (Some(2), true));
    assert!(String::from_utf8_lossy(&output.stderr).contains("check"));
}
