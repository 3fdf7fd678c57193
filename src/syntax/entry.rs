//! One entry of the tree to a typed struct. serde stops at the first thing that does not fit; here
//! that part is reported, cut out, and the rest is tried again, so that all of it is found.

use super::places::{Keys, Places, below};
use crate::diagnostic::{Diagnostic, Diagnostics, Place, codes, did_you_mean, shown};
use serde::de::DeserializeOwned;
use serde_path_to_error::Segment;
use serde_yaml::Value;

/// Most mistakes reported in one entry.
const MISTAKES: usize = 50;

/// Deserialises the entry at `at`; what does not fit is reported and left out.
pub fn entry<T: DeserializeOwned>(
    mut value: Value,
    at: &Keys,
    places: &mut Places,
    diagnostics: &mut Diagnostics,
) -> Option<T> {
    for _ in 0..MISTAKES {
        let failure = match serde_path_to_error::deserialize(value.clone()) {
            Ok(entry) => return Some(entry),
            Err(failure) => failure,
        };
        let mut path: Keys = failure.path().iter().filter_map(segment).collect();
        let message = failure.inner().to_string();
        if let Some(key) = unknown_field(&message).filter(|key| path.last().map(String::as_str) != Some(*key)) {
            path.push(key.to_owned());
        }
        let keys: Keys = at.iter().chain(&path).cloned().collect();
        // A key that was cut out is not missing.
        let is_cut = quotation_after(&message, "missing field ").is_some_and(|key| places.is_lost(&below(&keys, key)));
        if !is_cut {
            diagnostics.push(explain(&message, &keys, places));
        }
        places.mar(&keys);
        if !cut(&mut value, &path) {
            return None;
        }
    }
    None
}

fn segment(segment: &Segment) -> Option<String> {
    match segment {
        Segment::Seq { index } => Some(index.to_string()),
        Segment::Map { key } | Segment::Enum { variant: key } => Some(key.clone()),
        Segment::Unknown => None,
    }
}

/// The text between the first pair of backticks after the prefix.
fn quotation_after<'a>(message: &'a str, prefix: &str) -> Option<&'a str> {
    message.strip_prefix(prefix)?.strip_prefix('`')?.split('`').next()
}

fn unknown_field(message: &str) -> Option<&str> {
    quotation_after(message, "unknown field ")
}

/// All that stands in backticks after the first pair.
fn candidates(message: &str) -> Vec<&str> {
    message.split('`').skip(1).step_by(2).skip(1).collect()
}

fn explain(message: &str, keys: &Keys, places: &Places) -> Diagnostic {
    let name = keys.last().map_or("", String::as_str);
    let owner = keys.len().checked_sub(2).map(|n| format!(" in `{}`", keys[..=n].join("."))).unwrap_or_default();
    if unknown_field(message).is_some() {
        let help = did_you_mean(name, &candidates(message));
        return Diagnostic::new(codes::E0201, format!("unknown key `{}`{owner}", shown(name)))
            .at(places.key(keys), "")
            .help(help);
    }
    if let Some(word) = quotation_after(message, "unknown variant ") {
        let help = did_you_mean(word, &candidates(message));
        return Diagnostic::new(codes::E0210, format!("`{}` is not a choice for `{name}`", shown(word)))
            .at(places.value(keys), "")
            .help(help);
    }
    if let Some(key) = quotation_after(message, "missing field ") {
        let whole = if keys.is_empty() { "the file".to_owned() } else { format!("`{}`", shown(&keys.join("."))) };
        let start = places.value(keys).map(|place| Place { range: place.range.start..place.range.start, ..place });
        let sample = sample(key).map_or_else(String::new, |sample| format!(": {sample}"));
        return Diagnostic::new(codes::E0202, format!("{whole} has no `{key}`"))
            .at(start, "")
            .help(format!("add `{key}{sample}`"));
    }
    let wrong = Diagnostic::new(codes::E0202, format!("`{}` does not have the right form", shown(&keys.join("."))));
    let found = found_value(message);
    let letter = |letter: &&str| found.as_ref().is_some_and(|found| found.ends_with(&format!("\"{letter}\"")));
    let in_points = keys.len() > 1 && keys[keys.len() - 2] == "points" && name.parse::<usize>().is_ok();
    let form = match ["X", "Y", "Z"].iter().position(letter) {
        Some(i) if name == "direction" => Some(["[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]"][i]),
        _ => sample(name),
    };
    if in_points && found.is_some() {
        let help = "write each point as [position, value], `points: [[0 mm, 0 um], [500 mm, 3 um]]`";
        return wrong.at(places.value(keys), found.unwrap_or_default()).help(help);
    }
    match (found, form) {
        // A reason in words of its own.
        (None, _) => wrong.at(places.value(keys), "").help(message),
        (Some(found), Some(sample)) => {
            wrong.at(places.value(keys), found).help(format!("write it as `{name}: {sample}`"))
        }
        (Some(found), None) => wrong.at(places.value(keys), found).help(expected_form(message)),
    }
}

/// Returns the value that serde found, in plain words; `None` of a reason that a type of ours gives.
fn found_value(message: &str) -> Option<String> {
    let (found, _) = message.split_once(", expected ")?;
    let found = found.trim_start_matches("invalid type: ").trim_start_matches("invalid value: ");
    if let Some(length) = found.strip_prefix("invalid length ") {
        return Some(format!("this has the length {length}"));
    }
    let words = [("sequence", "a list"), ("map", "a mapping"), ("unit value", "nothing"), ("string ", "the text ")];
    let word = words.iter().find_map(|(from, to)| found.strip_prefix(from).map(|rest| format!("{to}{rest}")));
    let number =
        ["integer ", "floating point "].iter().find_map(|p| found.strip_prefix(p)).map(|n| format!("the number {n}"));
    Some(format!("this is {}", shown(&word.or(number).unwrap_or_else(|| found.to_owned()))))
}

/// Returns the form that serde expected.
fn expected_form(message: &str) -> String {
    let expected = message.split_once(", expected ").map_or("something else", |(_, expected)| expected);
    // Names of types are serde's.
    let whole =
        |name: &str| name.starts_with(['u', 'i']) && (name.ends_with("size") || name[1..].parse::<u8>().is_ok());
    match expected {
        "f64" => "write a number".to_owned(),
        "a boolean" => "write `true` or `false`".to_owned(),
        name if name.starts_with("struct ") => "write a mapping of keys to values".to_owned(),
        name if whole(name) => "write a whole number".to_owned(),
        _ => format!(
            "write {}",
            expected
                .replace("a sequence", "a list")
                .replace("a mapping", "a map")
                .replace("a map", "a mapping")
                .replace("a string", "text")
        ),
    }
}

/// The form of an entry by its key.
fn sample(key: &str) -> Option<&'static str> {
    Some(match key {
        "machine" => "Trunnion five-axis centre",
        "chain" => "\"w C' A' Y' b X Z t\"",
        "branches" => "{ workpiece: [Y, A, C], tool: [X, Z] }",
        "travel" => "[0 mm, 500 mm]",
        "home" => "0 mm",
        "direction" => "[0, 1, 0]",
        "origin" | "gauge" | "offset" => "[250, 225, 0]",
        "from" => "gauge",
        "at" => "[0, 0, 180]",
        "length" => "120 mm",
        "table" => "errors/x.csv",
        "points" => "[[0 mm, 0 um], [500 mm, 3 um]]",
        "polynomial" => "[0 um, 3 um/m]",
        "harmonics" => "{ 1: [2 urad, -1 urad] }",
        "bspline" => "{ knots: [0 mm, 500 mm], coefficients: [0 um, 1 um, 2 um, 1 um] }",
        "class" => "premium",
        "measured" => "[errors/x.csv, errors/y.csv]",
        "range" => "[0, 500]",
        "step" => "25 mm",
        "degree" => "2",
        "vanish" => "[EXX*EYX, EXX^2]",
        "fit" => "[location, EXX:poly3]",
        "fixed" => "[EC0Y]",
        "basis" => "{ EYX: poly3 }",
        "job" => "{ tool_poses: part.csv }",
        "tool_poses" => "part.csv",
        "place" => "{ origin: [120, 80, 40], rotation: [0, 0, 90] }",
        "limit" => "30 um",
        "features" => "{ base: { kind: flatness, tolerance: 10 um } }",
        "normal" => "[0, 0, 1]",
        "point" => "[100, 0, 20]",
        _ => return None,
    })
}

/// Cuts the part out; false if there is no such part.
fn cut(value: &mut Value, path: &[String]) -> bool {
    let Some((last, parents)) = path.split_last() else { return false };
    let mut at = &mut *value;
    for key in parents {
        let next = match at {
            Value::Mapping(map) => map.get_mut(key.as_str()),
            Value::Sequence(list) => key.parse::<usize>().ok().and_then(|i| list.get_mut(i)),
            _ => None,
        };
        match next {
            Some(next) => at = next,
            None => return false,
        }
    }
    match at {
        Value::Mapping(map) => map.remove(last.as_str()).is_some(),
        // A list with a hole would be another list: the whole of it goes.
        Value::Sequence(_) => cut(value, parents),
        _ => false,
    }
}
