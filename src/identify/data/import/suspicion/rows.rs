//! Rows of a table that say more than their numbers: digits in groups, degrees with minutes and seconds, a row that
//! stands there twice, rows that are lost, and columns that are exchanged.

use super::finding::{ACCEPT, Finding, FindingEffect, FindingKind};
use crate::diagnostic::{Diagnostic, Place, shown};
use crate::identify::data::import::failure::SampleFailure;
use crate::identify::data::import::line::line;
use crate::identify::data::import::options::StraightnessLine;
use crate::identify::data::import::sample::{AxisSample, Import, refusal};
use crate::identify::thresholds::{
    MAX_AXIS_SLOPE, MAX_LOST_SHARE, MAX_RUN_NUMBER, MIN_AXIS_RISE, MIN_EQUAL_CELLS, MIN_EQUAL_NEIGHBOURS,
    MIN_EXCHANGED_ROWS, MIN_JUDGED_TARGETS, MIN_TURNED_SHARE,
};
use crate::syntax::ColumnDirection;
use crate::syntax::sheet::SheetLine;
use crate::units::counted;
use indexmap::IndexMap;

/// Marks between groups of three digits: blanks of several widths and apostrophes.
const GROUP_MARKS: [char; 7] = [' ', '\u{a0}', '\u{2009}', '\u{202f}', '\'', '\u{2019}', '_'];

/// The notation of a cell that is no plain number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Notation {
    GroupedDigits,
    Sexagesimal,
}

/// Returns the notation of a cell where a number belongs, if it is one that other programs write.
fn notation(cell: &str, separator: char) -> Option<Notation> {
    let bare = cell.trim().trim_start_matches(['+', '-', '\u{2212}']);
    let all_digits = |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_digit());
    let groups = |text: &str, marks: &[char]| {
        let groups: Vec<&str> = text.split(marks).collect();
        let (first, rest) = (groups[0], &groups[1..]);
        let fits = all_digits(first) && first.len() <= 3 && rest.iter().all(|g| all_digits(g) && g.len() == 3);
        if fits { rest.len() } else { 0 }
    };
    let before = |mark: char| bare.split(mark).next().unwrap_or_default();
    let whole = bare.split(['.', ',']).next().unwrap_or_default();
    let commas = groups(before('.'), &[',']);
    let points = groups(before(','), &['.']);
    // One comma between digits may be a decimal comma, unless commas separate cells and the cell stands in quotes.
    let grouped = groups(whole, &GROUP_MARKS) > 0
        || commas > 1
        || points > 1
        || (commas == 1 && (separator == ',' || bare.contains('.')));
    let pair = |text: &str| all_digits(text.split(['.', ',']).next().unwrap_or_default()) && text.len() <= 8;
    let parts: Vec<&str> = bare.split([':', ' ']).collect();
    let sexagesimal = parts.len() > 1
        && (bare.contains(':') || parts.len() == 3)
        && all_digits(parts[0])
        && parts[1..].iter().all(|part| pair(part) && part.split(['.', ',']).next().is_some_and(|p| p.len() <= 2));
    match (grouped, sexagesimal) {
        (true, _) => Some(Notation::GroupedDigits),
        (_, true) => Some(Notation::Sexagesimal),
        _ => None,
    }
}

/// True if a degree sign stands between digits: `12°30'`. The quotes of the seconds would join the cells of the row.
fn has_minutes(line: &str) -> bool {
    line.match_indices('°').any(|(at, sign)| {
        let after = line[at + sign.len()..].trim_start();
        line[..at].ends_with(|c: char| c.is_ascii_digit()) && after.starts_with(|c: char| c.is_ascii_digit())
    })
}

/// Refuses a row whose numbers are written in a way that is not read: each such row would be lost.
pub(in crate::identify::data::import) fn check_numbers<'c>(
    line: &SheetLine,
    mut cells: impl Iterator<Item = &'c String>,
    separator: char,
) -> Result<(), Box<Diagnostic>> {
    let sexagesimal = has_minutes(&line.text);
    let found = cells.find_map(|cell| Some((cell.as_str(), notation(cell, separator)?)));
    let (cell, notation) = match (sexagesimal, found) {
        (true, _) => (line.text.trim(), Notation::Sexagesimal),
        (false, Some(found)) => found,
        (false, None) => return Ok(()),
    };
    let (what, help) = match notation {
        Notation::GroupedDigits => (
            "has its digits in groups",
            "write numbers without marks between thousands: format the column as a plain number and export again",
        ),
        Notation::Sexagesimal => (
            "is degrees, minutes and seconds",
            "write decimal degrees: degrees + minutes / 60 + seconds / 3600 (in a spreadsheet, the time times 24)",
        ),
    };
    let message = format!("`{}` {what}", shown(cell));
    Err(Box::new(refusal(message, Some(line.place.clone())).help(help)))
}

/// Positions as they were read and as they would be without a mark before three digits.
#[derive(Default)]
pub(in crate::identify::data::import) struct PositionMarks {
    read: Vec<f64>,
    ungrouped: Vec<f64>,
    first: Option<(String, Place)>,
}

impl PositionMarks {
    /// Takes note of the position of a row.
    pub fn note(&mut self, cell: &str, read: f64, place: &Place) {
        let mark = cell.find([',', '.']).filter(|at| cell.len() - at == 4 && *at > 0);
        let whole = mark.and_then(|at| format!("{}{}", &cell[..at], &cell[at + 1..]).parse::<f64>().ok());
        if whole.is_some() && self.first.is_none() {
            self.first = Some((cell.to_owned(), place.clone()));
        }
        self.read.push(read);
        self.ungrouped.push(whole.unwrap_or(read));
    }

    /// Refuses positions that rise or fall row by row only if a mark groups their digits: 0, 500, 1,000, 1,500.
    pub fn check(&self) -> Result<(), Box<Diagnostic>> {
        let is_monotone =
            |values: &[f64]| values.windows(2).all(|w| w[1] > w[0]) || values.windows(2).all(|w| w[1] < w[0]);
        let Some((cell, place)) = &self.first else { return Ok(()) };
        if self.read.len() < 3 || is_monotone(&self.read) || !is_monotone(&self.ungrouped) {
            return Ok(());
        }
        let message = format!("`{}` has its digits in groups: the positions are in order only so", shown(cell));
        let help =
            "write numbers without marks between thousands: format the column as a plain number and export again";
        Err(Box::new(refusal(message, Some(place.clone())).help(help)))
    }
}

/// Rows that cannot be read, beside those that are not meant to be.
#[derive(Default)]
pub(in crate::identify::data::import) struct LostRows {
    lost: Vec<(Place, String)>,
    /// Those since the last row that was read: notes and statistics below the table, while they have no position.
    below: Vec<(Place, String)>,
    read: usize,
}

impl LostRows {
    /// Takes note of a row that was read.
    pub fn read(&mut self) {
        self.read += 1;
        self.lost.append(&mut self.below);
    }

    /// Takes note of a row that was not.
    pub fn lose(&mut self, failure: &SampleFailure, position: &str, place: &Place) {
        let meant = matches!(
            failure,
            SampleFailure::Excluded(_)
                | SampleFailure::OtherAxis(_)
                | SampleFailure::OtherError(_)
                | SampleFailure::Error(_)
                | SampleFailure::NoReading
        );
        let lost = (place.clone(), failure.to_string());
        match (meant, position.chars().any(|c| c.is_ascii_digit())) {
            (true, _) => {}
            (false, true) => {
                self.lost.append(&mut self.below);
                self.lost.push(lost);
            }
            (false, false) => self.below.push(lost),
        }
    }

    /// Returns a finding where the lost rows are more than a share of all.
    pub fn finding(self) -> Option<Finding> {
        let all = self.read + self.lost.len();
        if self.lost.len() as f64 <= MAX_LOST_SHARE * all as f64 {
            return None;
        }
        let (_, why) = self.lost.first()?;
        let message = format!("{} of {} cannot be read, the first one: {why}", self.lost.len(), counted(all, "row"));
        let help = format!(
            "correct the file: a table that is understood loses single rows only; mark rows not to be used in a \
             column `exclude`; {ACCEPT}"
        );
        let places = self.lost.into_iter().map(|(place, _)| place).collect();
        Some(Finding {
            kind: FindingKind::RowsLost,
            error: None,
            places,
            message,
            help,
            effect: FindingEffect::Refused,
        })
    }
}

/// Rows by their text, to find those that stand there twice.
#[derive(Default)]
pub(in crate::identify::data::import) struct RowTexts {
    known: IndexMap<String, (usize, SheetLine)>,
    row: usize,
    /// Places of rows that stand there again, and the lines that the first of them repeats.
    again: Vec<Place>,
    first: Option<(usize, usize)>,
}

impl RowTexts {
    /// True if an earlier row has the same cells, and so many readings agree in no two runs: the row before, or one
    /// with many readings, or one with runs and directions by name.
    pub fn is_again(&mut self, line: &SheetLine, cells: &[String], readings: usize, named: bool) -> bool {
        self.row += 1;
        let Some((before, earlier)) = self.known.insert(cells.join("\u{1f}"), (self.row, line.clone())) else {
            return false;
        };
        let next = before + 1 == self.row && readings >= MIN_EQUAL_NEIGHBOURS;
        let again = named || next || readings >= MIN_EQUAL_CELLS;
        if again {
            self.again.push(line.place.clone());
            self.first.get_or_insert((line.number, earlier.number));
        }
        again
    }

    /// Returns the finding of the rows that stand there twice.
    pub fn finding(self) -> Option<Finding> {
        let (line, earlier) = self.first?;
        let more = match self.again.len() - 1 {
            0 => String::new(),
            more => format!(", and {} more like it", counted(more, "row")),
        };
        Some(Finding {
            kind: FindingKind::Twice,
            error: None,
            places: self.again,
            message: format!("line {line} is line {earlier} again{more}"),
            help: "it counts once; delete it, or take it with `--accept suspect`".to_owned(),
            effect: FindingEffect::LeftOut,
        })
    }
}

/// Remarks on a target that is read twice in one pass by name, with different results.
pub(in crate::identify::data::import) fn targets_twice(import: &Import) -> Option<Finding> {
    let key = |s: &AxisSample| (s.error, s.run.clone(), s.direction.map(|way| way as u8), s.position.to_bits());
    let mut known: IndexMap<_, (&AxisSample, usize)> = IndexMap::new();
    for sample in import.samples.iter().filter(|s| s.direction.is_some() && !s.run.is_empty()) {
        known.entry(key(sample)).or_insert((sample, 0)).1 += 1;
    }
    let twice = || known.values().filter(|(_, count)| *count > 1).map(|(sample, _)| *sample);
    // Several readings at every target are a way to measure.
    let first = twice().next().filter(|_| 2 * twice().count() < known.len())?;
    let again = import.samples.iter().rev().find(|s| key(s) == key(first))?;
    let unit = if import.rotary { "deg" } else { "mm" };
    let message =
        format!("{} {unit} is there twice in run {}, with two readings", first.position + 0.0, shown(&first.run));
    let help =
        "correct the position of one of the rows, or mark one in a column `exclude`; their mean is used".to_owned();
    let places = vec![again.place.clone(), first.place.clone()];
    Some(Finding { kind: FindingKind::Twice, error: None, places, message, help, effect: FindingEffect::Used })
}

/// Looks for positions that stand in the column of readings or of runs.
pub(in crate::identify::data::import) fn exchanged_columns(import: &Import) -> Option<Finding> {
    let message = readings_as_positions(import).or_else(|| runs_as_positions(import))?;
    let help = format!("exchange the titles of these columns; {ACCEPT}");
    let places = import.samples.first().map(|sample| sample.place.clone()).into_iter().collect();
    Some(Finding {
        kind: FindingKind::ColumnsExchanged,
        error: None,
        places,
        message,
        help,
        effect: FindingEffect::Refused,
    })
}

/// Readings of one column that rise or fall row by row, where the positions do not.
fn readings_as_positions(import: &Import) -> Option<String> {
    let mut columns: IndexMap<_, Vec<(f64, f64)>> = IndexMap::new();
    for s in &import.samples {
        columns
            .entry((s.error, s.run.as_str(), s.direction.map(|way| way as u8)))
            .or_default()
            .push((s.position, s.value));
    }
    let turns = |values: &mut dyn Iterator<Item = f64>| {
        let values: Vec<f64> = values.collect();
        values.windows(3).filter(|w| (w[1] - w[0]) * (w[2] - w[1]) <= 0.0).count()
    };
    let exchanged = columns.iter().find(|(_, rows)| {
        rows.len() >= MIN_EXCHANGED_ROWS
            && turns(&mut rows.iter().map(|row| row.1)) == 0
            && turns(&mut rows.iter().map(|row| row.0)) as f64 > (MIN_TURNED_SHARE * rows.len() as f64).max(2.0)
    });
    // No screw is as steep as one column, and the others are not.
    let steep = |rows: &[(f64, f64)]| {
        rows.len() >= MIN_JUDGED_TARGETS
            && turns(&mut rows.iter().map(|row| row.1)) == 0
            && line(rows, StraightnessLine::LeastSquares).0.abs() > MAX_AXIS_SLOPE
    };
    let is_rise = |rows: &[(f64, f64)]| (rows[rows.len() - 1].1 - rows[0].1).abs() > MIN_AXIS_RISE;
    let steepest = || {
        let mut found = columns.iter().filter(|(_, rows)| steep(rows) && is_rise(rows));
        found.next().filter(|_| found.next().is_none() && columns.len() > 1)
    };
    let exchanged = exchanged.or_else(|| steepest().filter(|_| !import.rotary));
    let ((error, run, way), rows) = exchanged?;
    let way = way.map_or("", |way| if way == ColumnDirection::Forward as u8 { " forward" } else { " reverse" });
    let of = if run.is_empty() { way.to_owned() } else { format!(" of run {}{way}", shown(run)) };
    Some(format!(
        "the readings of `{}`{of} go one way in {} rows, as positions do, and the others do not: the column of \
         positions and this one are exchanged",
        import.errors[*error],
        rows.len()
    ))
}

/// Numbers of runs in the column of positions, and positions in that of runs.
fn runs_as_positions(import: &Import) -> Option<String> {
    let mut positions: Vec<f64> = import.samples.iter().map(|sample| sample.position).collect();
    positions.sort_unstable_by(f64::total_cmp);
    positions.dedup();
    let mut runs: Vec<f64> = Vec::new();
    for sample in &import.samples {
        runs.push(sample.run.replace(',', ".").parse().ok()?);
    }
    runs.sort_unstable_by(f64::total_cmp);
    runs.dedup();
    let counts =
        |values: &[f64]| values.iter().zip(1..).all(|(value, k)| *value == f64::from(k) || *value == f64::from(k - 1));
    let numbers = positions.len() > 1 && positions.len() as f64 <= MAX_RUN_NUMBER && counts(&positions);
    let beyond =
        runs.len() > 1 && !counts(&runs) && runs.iter().any(|run| run.abs() > MAX_RUN_NUMBER || run.fract() != 0.0);
    (numbers && beyond).then(|| {
        format!(
            "the positions are 1 to {} and the runs {} to {}: the two columns are exchanged",
            positions.len(),
            runs[0],
            runs[runs.len() - 1]
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notations_of_other_programs() {
        let grouped = Some(Notation::GroupedDigits);
        for cell in
            ["1 234,5", "1\u{a0}234.5", "1'234", "-12\u{2019}345.6", "1.234.567", "1,234,567", "1,234.5", "1_000"]
        {
            assert_eq!(notation(cell, ';'), grouped, "{cell}");
        }
        assert_eq!((notation("1,234", ','), notation("1,234", ';'), notation("1.234", ';')), (grouped, None, None));
        let sexagesimal = Some(Notation::Sexagesimal);
        for cell in ["12:30:00", "12:30", "-0:00:12.5", "12 30 00", "359 59 59,5"] {
            assert_eq!(notation(cell, ';'), sexagesimal, "{cell}");
        }
        for cell in ["", "12", "-12.345", "1e3", "1,5", "bump", "2026-11-26", "12 mm", "1.5E-3", "1 2"] {
            assert_eq!(notation(cell, ';'), None, "{cell}");
        }
        assert!(
            has_minutes("12°30'00\";1;2") && has_minutes("12° 30;1") && !has_minutes("12°;1") && !has_minutes("20 °C")
        );
    }
}
