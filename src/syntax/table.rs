//! CSV tables of measured errors: `X [mm], EXX [um], EYX [um]`, then one position a line.
//!
//! The first column is the axis, its positions rise. Comma, semicolon or tab separate; `#` starts a
//! comment line; byte order mark, CRLF and blank lines are fine. Nothing else is.

use super::files::Files;
use super::read::read_table_text;
use super::sheet::separator;
use crate::diagnostic::{Diagnostic, Diagnostics, Place, SourceId, codes, shown};
use crate::units::{self, Dimension, Failure};
use std::ops::Range;
use std::path::Path;

/// Most rows.
const ROWS: usize = 100_000;

/// A table with at least one row, its first column strictly rising.
#[derive(Debug, Clone, PartialEq)]
pub struct CsvTable {
    /// The columns, the axis first; all of the same length.
    pub columns: Vec<CsvColumn>,
    /// The place of each row.
    pub rows: Vec<Place>,
}

/// A column.
#[derive(Debug, Clone, PartialEq)]
pub struct CsvColumn {
    /// Its name without direction and unit.
    pub name: String,
    /// Measured forward or reverse only.
    pub direction: Option<ColumnDirection>,
    /// The unit as written, its factor to mm and rad, and its dimension.
    pub unit: (String, f64, Dimension),
    /// Its place in the header.
    pub place: Place,
    /// As written, not converted.
    pub values: Vec<f64>,
}

/// `EXX+` or `EXX forward`, `EXX-` or `EXX reverse`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnDirection {
    /// Approached with rising position.
    Forward,
    /// Approached with falling position.
    Reverse,
}

/// Reads a table; `named` is where a machine file names it.
pub fn read_table(
    path: &Path,
    named: Option<Place>,
    files: &dyn Files,
    diagnostics: &mut Diagnostics,
) -> Option<CsvTable> {
    let (source, text) = read_table_text(path, named, files, diagnostics)?;
    let before = diagnostics.count();
    let table = TableReader { source, text: &text, diagnostics }.table();
    if diagnostics.count() > before { None } else { table }
}

struct TableReader<'a> {
    source: SourceId,
    text: &'a str,
    diagnostics: &'a mut Diagnostics,
}

/// After so many mistakes in one table the rest is of the same kind.
const MISTAKES: usize = 5;

impl TableReader<'_> {
    fn place(&self, range: Range<usize>) -> Option<Place> {
        Some(Place { source: self.source, range })
    }

    fn refuse(&mut self, code: codes::Code, message: impl Into<String>, at: Range<usize>, help: &str) {
        let place = self.place(at);
        self.diagnostics.push(Diagnostic::new(code, message).at(place, "").help(help));
    }

    fn table(mut self) -> Option<CsvTable> {
        let lines = lines(self.text);
        let Some((header, body)) = lines.split_first() else {
            let help = "start with a header such as `X [mm], EXX [um]`, then one position a line";
            self.refuse(codes::E0110, "the table is empty", 0..0, help);
            return None;
        };
        let separator = separator(&self.text[header.clone()]);
        let titles = cells(self.text, header.clone(), separator);
        if titles.iter().all(|cell| units::number(&self.text[cell.clone()]).is_ok()) {
            let help = "put a line such as `X [mm], EXX [um]` before it";
            self.refuse(codes::E0110, "the table has no header", header.clone(), help);
            return None;
        }
        let columns: Vec<Option<CsvColumn>> = titles.into_iter().map(|cell| self.column(cell)).collect();
        if body.is_empty() {
            self.refuse(
                codes::E0110,
                "the table has no rows",
                header.clone(),
                "add one position a line below the header",
            );
        }
        if body.len() > ROWS {
            let help = "thin it out, or split the measurement";
            self.refuse(
                codes::E0103,
                format!("the table has {} rows; the limit is {ROWS}", body.len()),
                body[ROWS].clone(),
                help,
            );
            return None;
        }
        let mut columns: Vec<CsvColumn> = columns.into_iter().collect::<Option<_>>()?;
        self.fill(&mut columns, body, separator);
        self.unique(&columns);
        self.rising(&columns[0].values, body);
        let rows = body.iter().filter_map(|r| self.place(r.clone())).collect();
        Some(CsvTable { columns, rows })
    }

    fn column(&mut self, cell: Range<usize>) -> Option<CsvColumn> {
        let text = &self.text[cell.clone()];
        let (title, unit) = units::header(text);
        let (name, direction) = direction(title);
        if name.is_empty() {
            self.refuse(codes::E0110, "a column without a name", cell, "the header is like `X [mm], EXX [um]`");
            return None;
        }
        let Some(unit) = unit else {
            let help = "write it as `EXX [um]`; positions as `X [mm]` or `C [deg]`";
            self.refuse(codes::E0110, format!("column `{}` has no unit", shown(name)), cell, help);
            return None;
        };
        match units::unit(unit) {
            Ok((factor, dimension)) => Some(CsvColumn {
                name: name.to_owned(),
                direction,
                unit: (unit.to_owned(), factor, dimension),
                place: Place { source: self.source, range: cell },
                values: Vec::new(),
            }),
            Err(_) => {
                let message = format!("unknown unit `{}` of column `{}`", shown(unit), shown(name));
                self.refuse(codes::E0206, message, cell, "lengths: nm um mm m in; angles: urad mrad rad arcsec deg");
                None
            }
        }
    }

    fn fill(&mut self, columns: &mut [CsvColumn], body: &[Range<usize>], separator: char) {
        let mut mistakes = 0;
        for row in body {
            if mistakes >= MISTAKES {
                return;
            }
            let cells = cells(self.text, row.clone(), separator);
            if cells.len() != columns.len() {
                mistakes += 1;
                self.report_ragged(row, cells.len(), columns.len());
                continue;
            }
            for (column, cell) in columns.iter_mut().zip(cells) {
                match units::number(&self.text[cell.clone()]) {
                    Ok(value) => column.values.push(value),
                    Err(failure) => {
                        mistakes += 1;
                        self.cell(&column.name, &failure, cell);
                    }
                }
            }
        }
    }

    fn report_ragged(&mut self, row: &Range<usize>, found: usize, expected: usize) {
        let cells = if found == 1 { "cell" } else { "cells" };
        let message = format!("this row has {found} {cells}, the header has {expected}");
        let help = if found > expected {
            "for decimal commas write decimal points, or let `abbe import` make the table of the instrument's file; \
             digits are not grouped, and comments begin with `#`"
        } else {
            "give every row a value for every column; leave out rows that were not measured"
        };
        self.refuse(codes::E0112, message, row.clone(), help);
    }

    fn cell(&mut self, column: &str, failure: &Failure, cell: Range<usize>) {
        let text = &self.text[cell.clone()];
        let point;
        let help = match failure {
            Failure::DecimalComma(_) => {
                point = format!(
                    "write `{}`, or let `abbe import` make the table of the instrument's file",
                    text.replace(',', ".")
                );
                &point
            }
            Failure::NotFinite(_) => "leave the row out if nothing was measured there",
            _ => "write a plain number; the unit stands in the header",
        };
        let message = if text.is_empty() {
            format!("column `{}` is empty here", shown(column))
        } else {
            shown(&failure.to_string())
        };
        self.refuse(codes::E0111, message, cell, help);
    }

    fn unique(&mut self, columns: &[CsvColumn]) {
        for (i, column) in columns.iter().enumerate() {
            let same = |c: &&CsvColumn| c.name == column.name && c.direction == column.direction;
            if let Some(first) = columns[..i].iter().find(same) {
                let message = format!("the column `{}` occurs twice", shown(&column.name));
                self.diagnostics.push(
                    Diagnostic::new(codes::E0107, message)
                        .at(Some(column.place.clone()), "again here")
                        .at(Some(first.place.clone()), "first here")
                        .help("keep one of them"),
                );
            }
        }
    }

    fn rising(&mut self, positions: &[f64], body: &[Range<usize>]) {
        if positions.len() != body.len() {
            return;
        }
        let Some(i) = positions.windows(2).position(|w| w[1] <= w[0]) else { return };
        let (before, here) = (positions[i], positions[i + 1]);
        let message = if before == here {
            format!("the position {here} occurs twice")
        } else {
            format!("the position {here} follows {before}: positions must rise")
        };
        let help = "sort the rows by position; put forward and reverse runs into columns `EXX+` and `EXX-`; \
                    `abbe import` makes such a table of bidirectional runs";
        self.refuse(codes::E0113, message, body[i + 1].clone(), help);
    }
}

/// The lines that count, without comments, blank lines and line ends.
fn lines(text: &str) -> Vec<Range<usize>> {
    let mut lines = Vec::new();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let content = line.trim();
        if !content.is_empty() && !content.starts_with('#') {
            lines.push(start..start + line.trim_end().len());
        }
        start += line.len();
    }
    lines
}

/// The cells of a line, trimmed, without the quotes that spreadsheets put around text.
fn cells(text: &str, line: Range<usize>, separator: char) -> Vec<Range<usize>> {
    let mut start = line.start;
    let cells = text[line].split(separator).map(|cell| {
        let range = trim(text, start..start + cell.len());
        start += cell.len() + separator.len_utf8();
        range
    });
    cells.collect()
}

fn trim(text: &str, range: Range<usize>) -> Range<usize> {
    let cell = &text[range.clone()];
    let start = range.start + (cell.len() - cell.trim_start().len());
    let end = range.end - (cell.len() - cell.trim_end().len());
    if start >= end {
        return range.start..range.start;
    }
    let quoted = text[start..end].len() >= 2 && text[start..end].starts_with('"') && text[start..end].ends_with('"');
    if quoted { start + 1..end - 1 } else { start..end }
}

fn direction(title: &str) -> (&str, Option<ColumnDirection>) {
    let cut = |suffix| title.strip_suffix(suffix).map(str::trim);
    let forward = cut("+").or_else(|| cut(" forward"));
    let reverse = cut("-").or_else(|| cut(" reverse"));
    match (forward, reverse) {
        (Some(name), _) => (name, Some(ColumnDirection::Forward)),
        (_, Some(name)) => (name, Some(ColumnDirection::Reverse)),
        _ => (title, None),
    }
}
