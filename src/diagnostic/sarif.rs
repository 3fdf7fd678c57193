//! Diagnostics in the Static Analysis Results Interchange Format (SARIF) 2.1.0 of OASIS, for annotations in reviews.

use super::{Code, DiagnosticRecord, Diagnostics, PlaceRecord, Severity};
use serde_json::{Value, json};
use std::path::{Component, Path, Prefix};

/// Schema of the format.
const SCHEMA: &str = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json";

/// Returns a log of one run over files, each with its diagnostics.
///
/// A diagnostic without a place is reported for its file. One that several files share, because they extend the same
/// file, is reported once. Relative names of files become relative URIs.
pub fn sarif<'a>(checks: impl IntoIterator<Item = (&'a str, &'a Diagnostics)>) -> Value {
    let mut rules: Vec<Code> = Vec::new();
    let mut results: Vec<Value> = Vec::new();
    let mut seen = std::collections::BTreeSet::new();
    for (file, diagnostics) in checks {
        for record in diagnostics.records() {
            let known = rules.iter().position(|rule| *rule == record.code);
            let index = known.unwrap_or_else(|| {
                rules.push(record.code);
                rules.len() - 1
            });
            let result = result(file, &record, index);
            if seen.insert(result.to_string()) {
                results.push(result);
            }
        }
    }
    let driver = json!({
        "name": "abbe", "version": env!("CARGO_PKG_VERSION"), "semanticVersion": env!("CARGO_PKG_VERSION"),
        "rules": rules.iter().map(|rule| describe(*rule)).collect::<Vec<_>>(),
    });
    let run = json!({"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "results": results});
    json!({"$schema": SCHEMA, "version": "2.1.0", "runs": [run]})
}

fn level(severity: Severity) -> &'static str {
    match severity {
        Severity::Refusal => "error",
        Severity::Warning => "warning",
    }
}

fn describe(rule: Code) -> Value {
    let severity = if rule.is_warning() { Severity::Warning } else { Severity::Refusal };
    json!({
        "id": rule.id, "shortDescription": {"text": rule.title},
        "help": {"text": rule.explanation.trim(), "markdown": rule.explanation.trim()},
        "defaultConfiguration": {"level": level(severity)},
    })
}

fn result(file: &str, record: &DiagnosticRecord, rule: usize) -> Value {
    let help = record.help.iter().map(|help| format!(" (help: {help})")).collect::<String>();
    let mut result = json!({
        "ruleId": record.code.id, "ruleIndex": rule, "level": level(record.severity),
        "message": {"text": format!("{}{help}", record.message)},
    });
    let (first, others) = match record.places.split_first() {
        Some((first, others)) => (location(first), others),
        None => (json!({"physicalLocation": {"artifactLocation": {"uri": uri(file)}}}), &[][..]),
    };
    result["locations"] = json!([first]);
    if !others.is_empty() {
        result["relatedLocations"] = others.iter().map(location).collect();
    }
    result
}

fn location(place: &PlaceRecord) -> Value {
    let region = json!({
        "startLine": place.line, "startColumn": place.column,
        "endLine": place.end_line, "endColumn": place.end_column,
    });
    let mut location = json!({"physicalLocation": {"artifactLocation": {"uri": uri(&place.file)}, "region": region}});
    if !place.text.is_empty() {
        location["message"] = json!({"text": place.text});
    }
    location
}

/// The URI of a file: relative for a relative path, without `.` and inner `..`, with forward slashes, percent-encoded.
fn uri(name: &str) -> String {
    let mut steps: Vec<String> = Vec::new();
    let mut root = "";
    for step in Path::new(name).components() {
        match step {
            Component::CurDir => {}
            Component::RootDir => root = "file:///",
            Component::Prefix(prefix) => steps.push(drive(prefix.kind(), &prefix.as_os_str().to_string_lossy())),
            Component::ParentDir if steps.last().is_some_and(|last| last != "..") => drop(steps.pop()),
            Component::ParentDir => steps.push("..".to_owned()),
            Component::Normal(step) => steps.push(percent_encode(&step.to_string_lossy())),
        }
    }
    format!("{root}{}", steps.join("/"))
}

/// A drive keeps its colon.
fn drive(kind: Prefix<'_>, text: &str) -> String {
    match kind {
        Prefix::Disk(letter) | Prefix::VerbatimDisk(letter) => format!("{}:", char::from(letter)),
        _ => percent_encode(text),
    }
}

/// Everything but the unreserved characters of RFC 3986, byte by byte.
fn percent_encode(text: &str) -> String {
    let byte = |byte: u8| match byte {
        b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' => char::from(byte).to_string(),
        _ => format!("%{byte:02X}"),
    };
    text.bytes().map(byte).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_become_uris() {
        for (name, expected) in [
            ("machine.yaml", "machine.yaml"),
            ("./configs/../configs/a b.yaml", "configs/a%20b.yaml"),
            ("../shared/µ%:#?.yaml", "../shared/%C2%B5%25%3A%23%3F.yaml"),
        ] {
            assert_eq!(uri(name), expected);
        }
        #[cfg(unix)]
        assert_eq!(uri("/home/me/x.yaml"), "file:///home/me/x.yaml");
    }
}
