//! The columns of an instrument's tables by hand: a small file that is kept with the instrument.

use super::layout::RunLabel;
use super::options::{FileContents, RunApproach};
use super::unit::{component_error, position_unit, reading_unit};
use crate::diagnostic::{Diagnostic, Diagnostics, Place, Reason, codes, shown};
use crate::machine::ErrorId;
use crate::syntax::{ColumnDirection, Files, YamlFailure, from_yaml, read_text};
use indexmap::IndexMap;
use serde::Deserialize;
use serde_yaml::{Mapping, Value};
use std::path::Path;

/// Largest file of a mapping, in bytes.
const MAX_MAP_BYTES: usize = 64 * 1024;
/// Words of a reason that a message repeats.
const MAX_WORDS: usize = 40;

/// A mapping of columns.
#[derive(Debug, Clone)]
pub struct ColumnMap {
    pub(super) axis: Option<String>,
    /// The title of the targets.
    pub(super) position: String,
    /// The unit of the targets, where their title has none.
    pub(super) position_unit: Option<String>,
    /// Titles and their roles, in the order of the file.
    pub(super) columns: Vec<(String, MappedColumn)>,
    pub(super) contents: Option<FileContents>,
    pub(super) approach: Option<RunApproach>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum MappedColumn {
    /// Deviations of an error, or positions that were reached.
    Readings {
        error: ErrorId,
        unit: Option<String>,
        label: RunLabel,
        flip: bool,
        reached: bool,
    },
    Run,
    Direction,
    Excluded,
    Ignored,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MapEntry {
    axis: Option<String>,
    position: PositionColumnEntry,
    columns: IndexMap<String, Value>,
    holds: Option<FileContents>,
    runs: Option<RunApproach>,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "a title is expected, or `{ column: TITLE, unit: mm }` with these two keys only")]
enum PositionColumnEntry {
    Title(String),
    WithUnit(PositionColumn),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PositionColumn {
    column: String,
    unit: Option<String>,
}

/// A column that the file cannot have, and the reason.
#[derive(Debug, thiserror::Error)]
#[error("column `{}`: {why}", shown(title))]
struct ColumnFailure {
    title: String,
    why: Reason,
}

/// Reads a mapping of columns.
pub fn read_columns(path: &Path, files: &dyn Files, diagnostics: &mut Diagnostics) -> Option<ColumnMap> {
    let (source, text) = read_text(path, None, files, diagnostics)?;
    let place = |line: usize| {
        let start = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum::<usize>();
        Place { source, range: start..start }
    };
    if text.len() > MAX_MAP_BYTES {
        diagnostics.push(refusal(&format!("the file has {} bytes; the limit is {MAX_MAP_BYTES}", text.len())));
        return None;
    }
    let entry: Result<MapEntry, YamlFailure> = from_yaml(&text);
    let map = entry.map_err(|failure| (failure.to_string(), failure.line.map(place))).and_then(|entry| {
        let line = |title: &str| Some(Place { source, range: text.find(title).map_or(0..0, |at| at..at) });
        ColumnMap::of(entry).map_err(|failure| (failure.to_string(), line(&failure.title)))
    });
    match map {
        Ok(map) => Some(map),
        Err((why, place)) => {
            diagnostics.push(refusal(&why).at(place, ""));
            None
        }
    }
}

/// Returns the refusal of a file; in its reason the terms of a library become words.
fn refusal(why: &str) -> Diagnostic {
    let words = why.replace("unknown variant", "unknown word").replace(" field", " entry");
    let words: Vec<String> = words.split(' ').take(MAX_WORDS).map(shown).collect();
    let help = "write `position: TITLE` and `columns: { TITLE: { error: EXX, unit: um, run: 1, direction: forward } }`";
    Diagnostic::new(codes::E0512, format!("the mapping of columns cannot be read: {}", words.join(" "))).help(help)
}

/// Returns the text of an entry; of a number, which may name a run, its digits.
fn text_of(key: &str, value: &Value) -> Result<String, Reason> {
    match value {
        Value::String(text) => Ok(text.clone()),
        Value::Number(number) => Ok(number.to_string()),
        _ => Err(Reason::new(format!("`{key}` is a word or a number"))),
    }
}

fn flag_of(key: &str, value: &Value) -> Result<bool, Reason> {
    value.as_bool().ok_or_else(|| Reason::new(format!("`{key}` is `true` or `false`")))
}

impl ColumnMap {
    fn of(entry: MapEntry) -> Result<Self, ColumnFailure> {
        let (position, position_title_unit) = match entry.position {
            PositionColumnEntry::Title(title) => (title, None),
            PositionColumnEntry::WithUnit(column) => (column.column, column.unit),
        };
        let fail = |title: &str, why: Reason| ColumnFailure { title: title.to_owned(), why };
        let unit = position_title_unit.as_deref().map(position_unit).transpose();
        unit.map_err(|failure| fail(&position, Reason::new(failure)))?;
        let mut columns = Vec::new();
        for (title, value) in entry.columns {
            let column = Self::column(&value).map_err(|why| fail(&title, why))?;
            columns.push((title, column));
        }
        Ok(Self {
            axis: entry.axis,
            position,
            position_unit: position_title_unit,
            columns,
            contents: entry.holds,
            approach: entry.runs,
        })
    }

    fn column(value: &Value) -> Result<MappedColumn, Reason> {
        let words = "`run`, `direction`, `exclude`, `ignore` or `{ error: EXX, unit: um }`";
        match value {
            Value::Mapping(entries) => Self::readings(entries),
            Value::String(word) => match word.as_str() {
                "run" => Ok(MappedColumn::Run),
                "direction" => Ok(MappedColumn::Direction),
                "exclude" => Ok(MappedColumn::Excluded),
                "ignore" => Ok(MappedColumn::Ignored),
                _ => Err(Reason::new(format!("`{}` is none of {words}", shown(word)))),
            },
            _ => Err(Reason::new(format!("it is {words}"))),
        }
    }

    fn readings(entries: &Mapping) -> Result<MappedColumn, Reason> {
        let (mut error, mut unit, mut label) = (None, None, RunLabel::default());
        let (mut flip, mut reached) = (false, false);
        for (key, value) in entries {
            let key = key.as_str().unwrap_or_default();
            match key {
                "error" => error = Some(component_error(&text_of(key, value)?).map_err(Reason::new)?),
                "unit" => unit = Some(text_of(key, value)?),
                "run" => label.run = text_of(key, value)?,
                "direction" => {
                    label.direction = Some(match text_of(key, value)?.as_str() {
                        "forward" => ColumnDirection::Forward,
                        "reverse" => ColumnDirection::Reverse,
                        other => {
                            let other = shown(other);
                            return Err(Reason::new(format!("`direction` is `forward` or `reverse`, not `{other}`")));
                        }
                    });
                }
                "flip" => flip = flag_of(key, value)?,
                "reached" => reached = flag_of(key, value)?,
                _ => {
                    let keys = "`error`, `unit`, `run`, `direction`, `flip`, `reached`";
                    return Err(Reason::new(format!("`{}` is no entry of a column; they are {keys}", shown(key))));
                }
            }
        }
        let error = error.ok_or_else(|| Reason::new("`error` is missing: the error that it shows, such as EXX"))?;
        let known = unit.as_deref().map(reading_unit).transpose().map_err(Reason::new)?;
        if known.is_some_and(|unit| !unit.fits(&error)) {
            let unit = unit.unwrap_or_default();
            return Err(Reason::new(format!("`{}` is not a unit of `{error}`", shown(&unit))));
        }
        Ok(MappedColumn::Readings { error, unit, label, flip, reached })
    }

    /// Returns the errors that columns show.
    pub(super) fn errors(&self) -> impl Iterator<Item = &ErrorId> {
        self.columns.iter().filter_map(|(_, column)| match column {
            MappedColumn::Readings { error, .. } => Some(error),
            _ => None,
        })
    }

    /// True if a title, with or without its unit, is this column.
    pub(super) fn names(mapped: &str, title: &str, cell: &str) -> bool {
        mapped.trim().eq_ignore_ascii_case(title.trim()) || mapped.trim().eq_ignore_ascii_case(cell.trim())
    }
}
