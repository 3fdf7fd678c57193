//! Tables with a column for each target and a row for each run, as ISO 230-2 prints them: turned into a row for each
//! target and a column for each run.

use super::form::TableForm;
use super::layout::{ColumnMeaning, GENERAL};
use crate::syntax::sheet::{self, SheetLine};

/// Returns the lines with the table turned, if its targets stand in a row.
pub(super) fn transpose(lines: &[SheetLine]) -> Option<Vec<SheetLine>> {
    let at = (0..lines.len().saturating_sub(1)).find(|at| is_head(&lines[*at], &lines[at + 1]))?;
    let separator = sheet::separator(&lines[at].text);
    let mut rows: Vec<Vec<String>> = Vec::new();
    for line in &lines[at..] {
        let mut cells = sheet::cells(&line.text, separator);
        sheet::drop_empty(&mut cells, 1);
        // A note below the table.
        if cells.len() > 1 {
            rows.push(cells);
        }
    }
    let columns = rows.iter().map(Vec::len).max()?;
    // A target above two columns stands above the first.
    let mut target = String::new();
    for cell in rows[0].iter_mut().skip(1) {
        if cell.is_empty() { cell.clone_from(&target) } else { target.clone_from(cell) }
    }
    let missing = columns.saturating_sub(rows[0].len());
    rows[0].extend(std::iter::repeat_n(target, missing));
    let quoted = |cell: &str| if cell.contains(separator) { format!("\"{cell}\"") } else { cell.to_owned() };
    let turned = (0..columns).map(|k| {
        let cells: Vec<String> = rows.iter().map(|row| quoted(row.get(k).map_or("", String::as_str))).collect();
        SheetLine { place: lines[at].place.clone(), number: lines[at].number, text: cells.join(&separator.to_string()) }
    });
    Some(lines[..at].iter().cloned().chain(turned).collect())
}

/// True if a line holds targets side by side and the next one directions or readings with a label in words.
fn is_head(line: &SheetLine, next: &SheetLine) -> bool {
    let separator = sheet::separator(&line.text);
    let (head, below) = (sheet::cells(&line.text, separator), sheet::cells(&next.text, separator));
    let title = |cell: &str| sheet::title(cell).0.to_lowercase();
    let is_number = |cell: &String| sheet::number(cell, separator).is_ok();
    let targets = head.iter().skip(1).filter(|cell| is_number(cell)).count();
    let numbers = head.iter().skip(1).all(|cell| cell.is_empty() || is_number(cell));
    let label = below.first().map(|cell| title(cell)).unwrap_or_default();
    let direction = GENERAL.meaning(&label, TableForm::Runs) == Some(ColumnMeaning::Direction);
    let run = sheet::number(&label, separator).is_err()
        && GENERAL.run(&label, true).is_some()
        && below.iter().skip(1).all(|cell| cell.is_empty() || is_number(cell));
    head.first().is_some_and(|cell| GENERAL.is_position(&title(cell))) && targets > 1 && numbers && (direction || run)
}
