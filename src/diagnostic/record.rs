//! Diagnostics as values that serde can write; docs/formats/json.md describes their shape.

use super::{Code, Diagnostic, Diagnostics, Label, Place, Severity, SourceId};
use serde::ser::{Serialize, SerializeStruct, Serializer};
use std::collections::{BTreeMap, BTreeSet};

/// A diagnostic with its places by name, line and column.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct DiagnosticRecord {
    /// Code such as `E0203`.
    pub code: Code,
    /// `refusal` or `warning`.
    pub severity: Severity,
    /// The fault, with value and unit.
    pub message: String,
    /// The remedy.
    pub help: Option<String>,
    /// Places in files, the primary one first; empty for a diagnostic about no file.
    pub places: Vec<PlaceRecord>,
}

/// A place in a file. Lines and columns count from 1, columns in characters; the end is exclusive.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct PlaceRecord {
    /// Name of the file as the call named it.
    pub file: String,
    /// Line of the first character.
    pub line: usize,
    /// Column of the first character.
    pub column: usize,
    /// Line of the end.
    pub end_line: usize,
    /// Column after the last character.
    pub end_column: usize,
    /// Remark on the place; may be empty.
    pub text: String,
}

/// A diagnostic in the list `warnings` of a result.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct WarningRecord {
    /// Code such as `W0402`.
    pub code: Code,
    /// The fault, with value and unit.
    pub message: String,
    /// Start of the primary place.
    pub place: Option<PlaceStart>,
}

/// Start of a place in a file, counted as in [`PlaceRecord`].
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct PlaceStart {
    /// Name of the file as the call named it.
    pub file: String,
    /// Line of the first character.
    pub line: usize,
    /// Column of the first character.
    pub column: usize,
}

impl Diagnostics {
    /// Returns all of them with their places by name, line and column, in the order found.
    pub fn records(&self) -> Vec<DiagnosticRecord> {
        let positions = Positions::of(self);
        self.iter().map(|diagnostic| positions.record(diagnostic)).collect()
    }

    /// Returns the JSON document of a result: its value and, if there are warnings, the list `warnings` with the number
    /// `more_warnings` of those that were not kept. A value that is no object stays as it is.
    pub fn document(&self, value: serde_json::Value) -> serde_json::Value {
        let warnings = self.warning_records();
        let mut value = value;
        if let (Some(object), false) = (value.as_object_mut(), warnings.is_empty()) {
            let _ = object.insert("warnings".to_owned(), serde_json::json!(warnings));
            let more = self.more()[1];
            if more > 0 {
                let _ = object.insert("more_warnings".to_owned(), serde_json::json!(more));
            }
        }
        value
    }

    /// Returns all of them in the short form of the list `warnings` of a result.
    pub fn warning_records(&self) -> Vec<WarningRecord> {
        let positions = Positions::of(self);
        self.iter().map(|diagnostic| positions.warning(diagnostic)).collect()
    }
}

/// `{"refused": true, "diagnostics": [...]}`; with `more`, the number of those that are not in the list, if there are
/// any.
impl Serialize for Diagnostics {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let more = self.more()[0] + self.more()[1];
        let mut object = serializer.serialize_struct("Diagnostics", 2 + usize::from(more > 0))?;
        object.serialize_field("refused", &self.is_refused())?;
        object.serialize_field("diagnostics", &self.records())?;
        if more > 0 {
            object.serialize_field("more", &more)?;
        }
        object.end()
    }
}

/// Lines and columns of all places, found in one pass over each file.
struct Positions<'a> {
    diagnostics: &'a Diagnostics,
    known: BTreeMap<(SourceId, usize), (usize, usize)>,
}

impl<'a> Positions<'a> {
    fn of(diagnostics: &'a Diagnostics) -> Self {
        let mut offsets: BTreeMap<SourceId, BTreeSet<usize>> = BTreeMap::new();
        for place in diagnostics.iter().flat_map(|d| &d.labels).map(|label| &label.place) {
            offsets.entry(place.source).or_default().extend([place.range.start, place.range.end]);
        }
        let mut known = BTreeMap::new();
        for (source, offsets) in offsets {
            let text = diagnostics.sources.text(source);
            known.extend(line_columns(text, offsets).into_iter().map(|(offset, at)| ((source, offset), at)));
        }
        Self { diagnostics, known }
    }

    fn at(&self, place: &Place, offset: usize) -> (usize, usize) {
        self.known.get(&(place.source, offset)).copied().unwrap_or((1, 1))
    }

    fn record(&self, diagnostic: &Diagnostic) -> DiagnosticRecord {
        DiagnosticRecord {
            code: diagnostic.code,
            severity: diagnostic.severity,
            message: diagnostic.message.clone(),
            help: diagnostic.help.clone(),
            places: diagnostic.labels.iter().map(|label| self.place(label)).collect(),
        }
    }

    fn place(&self, Label { place, text }: &Label) -> PlaceRecord {
        let (line, column) = self.at(place, place.range.start);
        let (end_line, end_column) = self.at(place, place.range.end.max(place.range.start));
        let file = self.diagnostics.sources.name(place.source).to_owned();
        PlaceRecord { file, line, column, end_line, end_column, text: text.clone() }
    }

    fn warning(&self, diagnostic: &Diagnostic) -> WarningRecord {
        let place = diagnostic.labels.first().map(|Label { place, .. }| {
            let (line, column) = self.at(place, place.range.start);
            PlaceStart { file: self.diagnostics.sources.name(place.source).to_owned(), line, column }
        });
        WarningRecord { code: diagnostic.code, message: diagnostic.message.clone(), place }
    }
}

/// Line and column of byte offsets of a text; one within a character counts as its start.
fn line_columns(text: &str, offsets: BTreeSet<usize>) -> Vec<(usize, (usize, usize))> {
    let (mut at, mut line, mut column) = (0, 1, 1);
    let mut found = Vec::with_capacity(offsets.len());
    for offset in offsets {
        let end = (at..=offset.min(text.len())).rev().find(|i| text.is_char_boundary(*i)).unwrap_or(at);
        for character in text[at..end].chars() {
            (line, column) = if character == '\n' { (line + 1, 1) } else { (line, column + 1) };
        }
        at = end;
        found.push((offset, (line, column)));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::codes;
    use super::*;

    #[test]
    fn lines_and_columns_count_characters_from_one() {
        let offsets = BTreeSet::from([0, 1, 2, 3, 4, 7, 99]);
        let found = line_columns("aµ\nb\r\nc", offsets);
        let expected = [(0, (1, 1)), (1, (1, 2)), (2, (1, 2)), (3, (1, 3)), (4, (2, 1)), (7, (3, 1)), (99, (3, 2))];
        assert_eq!(found, expected);
    }

    #[test]
    fn records_agree_with_the_place_of_the_sources() {
        let mut diagnostics = Diagnostics::default();
        let source = diagnostics.sources.add("m.yaml", "name: µ\naxes:\n  X: 1\n");
        let place = Place { source, range: 17..21 };
        let (line, column) = diagnostics.sources.line_column(&place);
        diagnostics.push(Diagnostic::new(codes::E0203, "wrong").at(Some(place), "here").help("mend it"));
        let value = serde_json::json!(diagnostics);
        let place = &value["diagnostics"][0]["places"][0];
        assert_eq!((place["line"].as_u64(), place["column"].as_u64()), (Some(line as u64), Some(column as u64)));
        assert_eq!(place["end_column"], column + 4);
        assert_eq!((&value["refused"], &value["diagnostics"][0]["severity"]), (&true.into(), &"refusal".into()));
    }
}
