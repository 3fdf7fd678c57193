//! The source of the numbers in a fitted file. No date: the same input gives the same bytes.

use super::accused::SuspectReadings;
use super::fitted::FitDiagnosis;
use super::inputs::FitInputs;
use super::result;
use crate::diagnostic::shown;
use crate::evaluate::{Frame, Order};
use crate::job::machine_file::MachineFile;
use crate::syntax::IdentifyEntry;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Digits of a hash that are written.
const HASH_DIGITS: usize = 16;
/// Maximum number of data files that are named one by one.
const MAX_NAMED: usize = 20;
/// Longest entry about the parameters, in characters.
const MAX_ENTRY_CHARACTERS: usize = 180;

/// Returns the entries that go to the section `provenance`, those of earlier fits kept apart by a number.
pub(crate) fn entries(
    file: &MachineFile,
    inputs: &FitInputs<'_>,
    request: &IdentifyEntry,
    hashes: &BTreeMap<PathBuf, String>,
    fitted: &FitDiagnosis<'_>,
    suspect: Option<&SuspectReadings>,
) -> Vec<(String, String)> {
    let mut entries = vec![
        ("by".to_owned(), format!("abbe {}", env!("CARGO_PKG_VERSION"))),
        ("machine".to_owned(), name_and_hash(&file.path, file.inputs().first().map_or("", |input| &input.sha256))),
    ];
    for (k, path) in inputs.paths.iter().take(MAX_NAMED).enumerate() {
        let hash = hashes.get(path).map_or("", String::as_str);
        entries.push((if k > 0 { format!("from.{}", k + 1) } else { "from".to_owned() }, name_and_hash(path, hash)));
    }
    if let Some(path) = inputs.axis_poses {
        let hash = hashes.get(path).map_or("", String::as_str);
        entries.push(("axis-poses".to_owned(), name_and_hash(path, hash)));
    }
    entries.push(("how".to_owned(), how(inputs, request).chars().take(MAX_ENTRY_CHARACTERS).collect()));
    if !inputs.accept.is_empty() {
        let words: Vec<&str> = inputs.accept.iter().map(|word| word.word()).collect();
        let suspect = suspect.map_or_else(String::new, |suspect| format!("; {}", suspect.words()));
        let entry = format!("{}{suspect}", words.join(", "));
        entries.push(("accepted".to_owned(), entry.chars().take(MAX_ENTRY_CHARACTERS).collect()));
    }
    entries.push(("fit".to_owned(), result::in_short(fitted)));
    let known = |key: &str| file.provenance().entries.iter().any(|(known, _)| known == key);
    let ending = |n: usize| if n > 1 { format!("-{n}") } else { String::new() };
    let time = (1..).find(|n| !known(&format!("identified-by{}", ending(*n)))).map_or_else(String::new, ending);
    entries.into_iter().map(|(key, value)| (format!("identified-{key}{time}"), value)).collect()
}

fn name_and_hash(path: &Path, hash: &str) -> String {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let hash: String = hash.chars().take(HASH_DIGITS).collect();
    format!("{} (sha256 {hash}...)", shown(&name))
}

fn how(inputs: &FitInputs<'_>, request: &IdentifyEntry) -> String {
    let order = match inputs.order {
        Order::Degree(n) => format!("order {n}"),
        Order::Exact => "exact".to_owned(),
    };
    let robust = if inputs.robust { "robust " } else { "" };
    let frame = match inputs.frame {
        Frame::Workpiece => "workpiece",
        Frame::Machine => "machine",
        Frame::Tool => "tool",
    };
    let fixed = &request.fixed;
    let fixed = if fixed.is_empty() { String::new() } else { format!("; fixed {}", fixed.join(", ")) };
    let list = request.fit.join(", ");
    format!("{robust}least squares on the {order} model, readings in the {frame} frame; fit {list}{fixed}")
}
