//! The rows of a file of tool poses behind the poses of a table: their lines, features, and those that are not reached.

use crate::job::path::PathResult;
use crate::job::tool_poses::{MissedToolPose, ReachedToolPoses};
use nalgebra::Vector3;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// A row of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkRow {
    /// Line of the file, from 1.
    pub line: usize,
    /// Name of its feature.
    pub feature: Option<String>,
}

/// A row that the machine does not reach.
#[derive(Debug, Clone, PartialEq)]
pub struct UnreachedRow {
    /// Line of the file, from 1.
    pub line: usize,
    /// Name of its feature.
    pub feature: Option<String>,
    /// The missing reach, in words.
    pub words: String,
    /// The same for JSON: an object with its line.
    pub json: Value,
}

/// The rows of a file, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkRows {
    /// Those of the poses of the table.
    pub(super) reached: Vec<WorkRow>,
    /// The others.
    unreached: Vec<UnreachedRow>,
    features: bool,
    /// The events of a path by line; `None` for single poses.
    events: Option<BTreeMap<usize, String>>,
    /// The normals of the surface at the poses, unturned workpiece frame; `None` where the file has none.
    pub(super) normals: Option<Vec<Vector3<f64>>>,
}

impl WorkRows {
    /// Returns the rows of the file behind the poses of a table.
    pub fn of(tool_poses: &ReachedToolPoses) -> Self {
        let row = |(line, feature): &(usize, Option<String>)| WorkRow { line: *line, feature: feature.clone() };
        let unreached = |miss: &MissedToolPose| UnreachedRow {
            line: miss.line,
            feature: miss.feature.clone(),
            words: miss.words(),
            json: json!(miss),
        };
        let (reached, unreached) = (tool_poses.lines.iter().map(row), tool_poses.rows.iter().map(unreached));
        let events = tool_poses.path.as_ref().map(PathResult::words_by_line);
        let normals = tool_poses.surface.iter().map(|point| point.normal).collect();
        Self { events, normals, ..Self::new(reached.collect(), unreached.collect()) }
    }

    /// Returns the rows of the poses of a table, and the others; both in the order of the file.
    pub fn new(reached: Vec<WorkRow>, unreached: Vec<UnreachedRow>) -> Self {
        let of_others = unreached.iter().any(|row| row.feature.is_some());
        let features = of_others || reached.iter().any(|row| row.feature.is_some());
        Self { reached, unreached, features, events: None, normals: None }
    }

    /// Returns the header before the positions, with its comma.
    pub(super) fn head(&self) -> String {
        let [feature, event] = [(self.features, "feature,"), (self.events.is_some(), "event,")]
            .map(|(has, name)| if has { name } else { "" });
        format!("line,{feature}{event}")
    }

    /// Returns the unreached rows between the pose before an index and that pose; after the last pose all the
    /// rest.
    pub(super) fn misses_before(&self, index: usize) -> &[UnreachedRow] {
        let until = |end: usize| match self.reached.get(end) {
            Some(row) => self.unreached.partition_point(|missed| missed.line < row.line),
            None => self.unreached.len(),
        };
        let from = index.checked_sub(1).map_or(0, until);
        self.unreached.get(from..until(index)).unwrap_or_default()
    }

    /// Returns the cells of a row before the positions, with their comma.
    pub(super) fn lead(&self, line: usize, feature: Option<&str>) -> String {
        let feature = if self.features { format!("{},", cell(feature.unwrap_or_default())) } else { String::new() };
        let event = |of: &BTreeMap<usize, String>| format!("{},", of.get(&line).map_or("", String::as_str));
        format!("{line},{feature}{}", self.events.as_ref().map_or_else(String::new, event))
    }

    /// Returns the line of an unreached row in a table with so many numbers.
    pub(super) fn csv_line(&self, row: &UnreachedRow, numbers: usize) -> String {
        format!("{}{}{}\n", self.lead(row.line, row.feature.as_deref()), ",".repeat(numbers), cell(&row.words))
    }

    /// Returns the entries of a row for JSON.
    pub(super) fn json_lead(row: &WorkRow) -> Map<String, Value> {
        let mut lead = Map::new();
        let _ = lead.insert("line".to_owned(), json!(row.line));
        if let Some(feature) = &row.feature {
            let _ = lead.insert("feature".to_owned(), json!(feature));
        }
        lead
    }
}

/// Returns a cell of a CSV file, quoted where it has to be. Text that a spreadsheet would run as a formula, because of
/// its first character, stands behind an apostrophe; numbers with a sign and a unit do not.
pub fn cell(text: &str) -> String {
    let number = |rest: &str| {
        rest.starts_with(|c: char| c.is_ascii_digit() || c == '.') && !rest.contains(['=', '|', '!', '(', '@'])
    };
    let signed = text.strip_prefix(['+', '-']).is_some_and(|rest| !number(rest));
    let runs = signed || text.starts_with(['=', '@', '\t', '\r']);
    let text = if runs { format!("'{text}") } else { text.to_owned() };
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_cell_runs_as_a_formula() {
        for (text, safe) in [
            ("=1+1", "'=1+1"),
            ("@SUM(A1)", "'@SUM(A1)"),
            ("+cmd", "'+cmd"),
            ("-2+3|'x'!A0", "'-2+3|'x'!A0"),
            ("=A,B", "\"'=A,B\""),
            ("-12 um", "-12 um"),
            ("+.5", "+.5"),
            ("bore 1", "bore 1"),
        ] {
            assert_eq!(cell(text), safe);
        }
    }

    #[test]
    fn unreached_rows_stand_in_their_places() {
        let missed = |line| UnreachedRow { line, feature: None, words: "x, y".to_owned(), json: json!({}) };
        let row = |line| WorkRow { line, feature: None };
        let work = WorkRows::new([3, 6].map(row).to_vec(), [2, 4, 5, 9].map(missed).to_vec());
        let lines = |index| work.misses_before(index).iter().map(|row| row.line).collect::<Vec<_>>();
        assert_eq!((lines(0), lines(1), lines(2)), (vec![2], vec![4, 5], vec![9]));
        assert_eq!(work.csv_line(&work.unreached[0], 3), "2,,,,\"x, y\"\n");
    }
}
