//! The columns of an instrument's tables by hand: a small file that is kept with the instrument.

use super::layout::RunLabel;
use super::options::{FileContents, RunApproach};
use super::unit::{component_error, position_unit, reading_unit};
use crate::diagnostic::{Diagnostic, Diagnostics, Place, Reason, codes, shown};
use crate::machine::ErrorId;
use crate::syntax::{ColumnDirection, Files, YamlFailure, from_yaml, read_text};
use indexmap::IndexMap;
use serde::Deserialize;
use std::path::Path;

/// Largest file of a mapping, in bytes.
const MAX_MAP_BYTES: usize = 64 * 1024;

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
    columns: IndexMap<String, ColumnEntry>,
    holds: Option<FileContents>,
    runs: Option<RunApproach>,
}

#[derive(Deserialize)]
#[serde(untagged)]
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

#[derive(Deserialize)]
#[serde(untagged)]
enum ColumnEntry {
    Word(ColumnWord),
    Readings(ReadingsEntry),
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum ColumnWord {
    Run,
    Direction,
    Exclude,
    Ignore,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ReadingsEntry {
    error: String,
    unit: Option<String>,
    run: Option<RunName>,
    direction: Option<DirectionWord>,
    #[serde(default)]
    flip: bool,
    #[serde(default)]
    reached: bool,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum RunName {
    Number(u32),
    Text(String),
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum DirectionWord {
    Forward,
    Reverse,
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
    let map = entry
        .map_err(|failure| (failure.to_string(), failure.line.map(place)))
        .and_then(|entry| ColumnMap::of(entry).map_err(|why| (why.to_string(), None)));
    match map {
        Ok(map) => Some(map),
        Err((why, place)) => {
            diagnostics.push(refusal(&why).at(place, ""));
            None
        }
    }
}

fn refusal(why: &str) -> Diagnostic {
    let help = "write `position: TITLE` and `columns: { TITLE: { error: EXX, unit: um, run: 1, direction: forward } }`";
    Diagnostic::new(codes::E0512, format!("the mapping of columns cannot be read: {}", shown(why))).help(help)
}

impl ColumnMap {
    fn of(entry: MapEntry) -> Result<Self, Reason> {
        let (position, position_title_unit) = match entry.position {
            PositionColumnEntry::Title(title) => (title, None),
            PositionColumnEntry::WithUnit(column) => (column.column, column.unit),
        };
        let unit = position_title_unit.as_deref().map(position_unit).transpose();
        unit.map_err(Reason::new)?;
        let mut columns = Vec::new();
        for (title, column) in entry.columns {
            let column = match column {
                ColumnEntry::Word(ColumnWord::Run) => MappedColumn::Run,
                ColumnEntry::Word(ColumnWord::Direction) => MappedColumn::Direction,
                ColumnEntry::Word(ColumnWord::Exclude) => MappedColumn::Excluded,
                ColumnEntry::Word(ColumnWord::Ignore) => MappedColumn::Ignored,
                ColumnEntry::Readings(readings) => Self::readings(readings)?,
            };
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

    fn readings(entry: ReadingsEntry) -> Result<MappedColumn, Reason> {
        let error = component_error(&entry.error).map_err(Reason::new)?;
        let unit = entry.unit.as_deref().map(reading_unit).transpose().map_err(Reason::new)?;
        if unit.is_some_and(|unit| !unit.fits(&error)) {
            let unit = entry.unit.as_deref().unwrap_or_default();
            return Err(Reason::new(format!("`{unit}` is not a unit of `{error}`")));
        }
        let direction = entry.direction.map(|word| match word {
            DirectionWord::Forward => ColumnDirection::Forward,
            DirectionWord::Reverse => ColumnDirection::Reverse,
        });
        let run = match entry.run {
            None => String::new(),
            Some(RunName::Number(number)) => number.to_string(),
            Some(RunName::Text(text)) => text,
        };
        let (flip, reached) = (entry.flip, entry.reached);
        Ok(MappedColumn::Readings { error, unit: entry.unit, label: RunLabel { direction, run }, flip, reached })
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
