//! Titles of columns: name and unit, and titles that stand in two rows.

use super::layout::ExportLayout;
use crate::identify::data::error_name::{parse_component_error, split_direction};
use crate::machine::{Approach, ErrorId};
use crate::syntax::sheet::{self, SheetLine};
use crate::units;

pub(super) struct Title {
    pub cell: String,
    pub name: String,
    pub lower: String,
    pub unit: Option<String>,
}

impl Title {
    pub fn new(cell: &str) -> Self {
        let (name, unit) = sheet::title(cell);
        Self { cell: cell.to_owned(), lower: name.to_lowercase(), name, unit }
    }

    /// Returns the error that the title names, and its direction.
    pub fn error(&self) -> Option<(ErrorId, Option<Approach>)> {
        let (bare, approach) = split_direction(&self.name);
        parse_component_error(bare).map(|error| (error, approach))
    }

    /// Returns the title with a word of another row before or after its name.
    fn join(first: &Self, second: &Self) -> Self {
        let name = format!("{} {}", first.name, second.name).trim().to_owned();
        let unit = second.unit.clone().or_else(|| first.unit.clone());
        let cell = unit.as_ref().map_or_else(|| name.clone(), |unit| format!("{name} [{unit}]"));
        Self { cell, lower: name.to_lowercase(), name, unit }
    }
}

/// Returns the titles of the columns of the header at a line, and the number of rows below it that belong to it: titles
/// may stand in two rows, run above direction, with empty cells where one goes on, and units in a row of their own.
pub(super) fn titles(
    lines: &[SheetLine],
    at: usize,
    cells: &[String],
    separator: char,
    layout: &ExportLayout,
) -> (Vec<Title>, usize) {
    let row = |line: Option<&SheetLine>| line.map(|line| sheet::cells(&line.text, separator)).unwrap_or_default();
    let mut titles: Vec<Title> = cells.iter().map(|cell| Title::new(cell)).collect();
    let above = at.checked_sub(1).map(|above| row(lines.get(above))).unwrap_or_default();
    if let Some(joined) = join_above(&titles, &above, layout) {
        titles = joined;
    }
    let mut below = 0;
    let read = |below: usize| row(lines.get(at + 1 + below));
    if let Some(joined) = join_below(&titles, &read(below), layout) {
        titles = joined;
        below += 1;
    }
    if add_units(&mut titles, &read(below), separator) {
        below += 1;
    }
    (titles, below)
}

fn bare(cell: &str) -> String {
    cell.trim_matches(['[', ']', '(', ')']).to_owned()
}

fn is_unit(cell: &str) -> bool {
    !cell.is_empty() && units::unit(&bare(cell)).is_ok()
}

/// Takes the units of a row below the titles; false if it is none.
fn add_units(titles: &mut [Title], below: &[String], separator: char) -> bool {
    let row_of_units = below.len() == titles.len()
        && below.iter().any(|cell| units::unit(&bare(cell)).is_ok())
        && below.iter().all(|cell| sheet::number(cell, separator).is_err());
    if row_of_units {
        for (title, cell) in titles.iter_mut().zip(below).filter(|(_, cell)| is_unit(cell)) {
            title.unit = title.unit.take().or_else(|| Some(bare(cell)));
        }
    }
    row_of_units
}

/// Fills empty cells by the cell before: it goes on over them.
fn fill(cells: impl Iterator<Item = String>) -> Vec<String> {
    let mut last = String::new();
    let go_on = |cell: String| {
        if !cell.is_empty() {
            last = cell;
        }
        last.clone()
    };
    cells.map(go_on).collect()
}

/// True if a title names a run, a direction or an error.
fn is_series(title: &Title, layout: &ExportLayout) -> bool {
    layout.run(&title.name, false).is_some() || title.error().is_some()
}

/// True if all titles that name a series differ.
fn differ(titles: &[Title], layout: &ExportLayout) -> bool {
    let mut names: Vec<&str> = titles.iter().filter(|t| is_series(t, layout)).map(|t| t.lower.as_str()).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    names.len() == count
}

/// Joins titles that are the same in several columns with those of the row above: `Run 1; ; Run 2; ` and `+; -; +; -`.
fn join_above(titles: &[Title], above: &[String], layout: &ExportLayout) -> Option<Vec<Title>> {
    let fits = above.len() > 2 && above.len() <= titles.len() && !differ(titles, layout);
    if !fits {
        return None;
    }
    let missing = titles.len() - above.len();
    let above = fill(above.iter().cloned().chain(std::iter::repeat_n(String::new(), missing)));
    let join = |(title, above): (&Title, &String)| {
        if is_series(title, layout) { Title::join(&Title::new(above), title) } else { Title::new(&title.cell) }
    };
    let joined: Vec<Title> = titles.iter().zip(&above).map(join).collect();
    let all = titles.iter().zip(&joined).all(|(title, joined)| !is_series(title, layout) || is_series(joined, layout));
    (all && differ(&joined, layout)).then_some(joined)
}

/// Joins titles with a row of directions or runs below them, whose cell of positions is empty or a unit.
fn join_below(titles: &[Title], below: &[String], layout: &ExportLayout) -> Option<Vec<Title>> {
    let position = titles.iter().position(|title| layout.is_position(&title.lower)).unwrap_or(0);
    let is_free = |cell: &String| cell.is_empty() || is_unit(cell);
    let is_label = |cell: &String| layout.run(&Title::new(cell).name, false).is_some();
    let fits = below.len() > 1
        && below.len() <= titles.len()
        && below.get(position).is_none_or(is_free)
        && below.iter().all(|cell| is_free(cell) || is_label(cell))
        && below.iter().filter(|cell| !is_free(cell)).count() > 1;
    if !fits {
        return None;
    }
    let above = fill(titles.iter().enumerate().map(
        |(k, title)| {
            if k == position { String::new() } else { title.cell.clone() }
        },
    ));
    let join = |(k, title): (usize, &Title)| match below.get(k).filter(|cell| !is_free(cell)) {
        Some(label) => Title::join(&Title::new(&above[k]), &Title::new(label)),
        None => {
            let own = Title::new(&title.cell);
            let unit = own.unit.clone().or_else(|| below.get(k).filter(|cell| is_unit(cell)).map(|cell| bare(cell)));
            Title { unit, ..own }
        }
    };
    let joined: Vec<Title> = titles.iter().enumerate().map(join).collect();
    let all = joined.iter().enumerate().all(|(k, t)| below.get(k).is_none_or(is_free) || is_series(t, layout));
    (all && differ(&joined, layout)).then_some(joined)
}
