//! Lines of known patterns: text with fields in angle brackets, such as
//! `$AN_CEC[<table>,<index>]=<value>`.
//!
//! A blank in a pattern matches any blanks, at its ends none too; letters are as written. `<row>` takes the rest of the
//! line as numbers; `<any>` and its text are ignored. Fields `table`, `error` and `reversal` begin a record, or go on
//! with the one of that name; lines without go to the last record.

use super::{Fault, number};
use crate::controller::manifest::{Edge, LineSpec};
use std::collections::BTreeMap;

/// The value of a field, and its line (from 0).
pub(super) type FieldValue = (String, usize);

pub(super) type Fields = BTreeMap<String, FieldValue>;

#[derive(Debug, Default)]
pub(super) struct TableFields {
    /// Its name, empty if the file holds one only.
    pub name: String,
    /// The first line that spoke of it.
    pub line: usize,
    /// Fields of the table.
    pub fields: Fields,
    /// Fields of its points, by index.
    pub points: BTreeMap<[usize; 3], Fields>,
    /// Numbers from lines of numbers, row by row.
    pub rows: Vec<(Vec<f64>, usize)>,
}

/// Fields that a point has, besides the index.
const OF_POINTS: [&str; 9] =
    ["position", "position_2", "position_3", "value", "value_2", "value_3", "forward", "reverse", "increment"];

/// Larger indices are no table's.
const MAX_POINTS: usize = 5_000_000;

pub(super) fn records(comment: Option<&str>, specs: &[LineSpec], text: &str) -> Result<Vec<TableFields>, Fault> {
    let patterns: Vec<(Vec<PatternPiece>, &LineSpec)> = specs.iter().map(|spec| (pieces(&spec.line), spec)).collect();
    let mut met = vec![false; specs.len()];
    let mut records: Vec<TableFields> = Vec::new();
    let mut current = 0;
    let mut open: Option<usize> = None;
    for (number, line) in text.lines().enumerate() {
        let bare = comment.map_or(line, |mark| line.split(mark).next().unwrap_or_default()).trim();
        if bare.is_empty() && comment.is_some() {
            continue;
        }
        let fits = |(pieces, spec): &(Vec<PatternPiece>, &LineSpec)| {
            spec.at.is_none_or(|at| at == number + 1).then(|| match_pattern(pieces, bare)).flatten()
        };
        let Some((which, fields)) = patterns.iter().enumerate().find_map(|(i, p)| Some((i, fits(p)?))) else {
            return Err(Fault::new(number, "the controller would not understand this line"));
        };
        met[which] = true;
        open = match (specs[which].block, open) {
            (Some(Edge::Begin), Some(_)) => return Err(Fault::new(number, "the block before is not closed")),
            (Some(Edge::Begin), None) => Some(number),
            (Some(Edge::End), None) => return Err(Fault::new(number, "there is no block to close")),
            (Some(Edge::End), Some(_)) => None,
            (None, open) => open,
        };
        let set = specs[which].set.iter().map(|(name, value)| (name.clone(), value.clone()));
        take(&mut records, &mut current, set.chain(fields), number)?;
    }
    if let Some(line) = open {
        return Err(Fault::new(line, "the block that begins here is not closed: the file was cut off"));
    }
    if let Some((spec, _)) = specs.iter().zip(&met).find(|(spec, met)| spec.required && !**met) {
        let end = text.lines().count().saturating_sub(1);
        return Err(Fault::new(end, format!("there is no line `{}`", spec.line)));
    }
    Ok(records)
}

/// Puts the fields of a line where they belong: to the record that the line names, else to the last one.
fn take(
    records: &mut Vec<TableFields>,
    current: &mut usize,
    said: impl Iterator<Item = (String, String)>,
    line: usize,
) -> Result<(), Fault> {
    let mut said: BTreeMap<String, String> = said.filter(|(name, _)| name != "any").collect();
    if said.is_empty() {
        return Ok(());
    }
    let reversal = said.get("reversal").map(|axis| format!("reversal of {axis}"));
    let name = ["table", "error"].into_iter().find_map(|key| said.remove(key)).or(reversal);
    let known = match &name {
        Some(name) => records.iter().position(|record| record.name == *name),
        None => (*current < records.len()).then_some(*current),
    };
    let at = known.unwrap_or(records.len());
    if known.is_none() {
        records.push(TableFields { name: name.unwrap_or_default(), line, ..TableFields::default() });
    }
    *current = at;
    let record = &mut records[at];
    if let Some(row) = said.remove("row") {
        let cells = row.split([',', ' ', '\t']).filter(|cell| !cell.is_empty());
        let numbers: Result<Vec<f64>, _> = cells.map(number).collect();
        record.rows.push((numbers.map_err(|bad| Fault::new(line, bad))?, line));
    }
    let index = index(&mut said, record.points.len(), line)?;
    for (name, value) in said {
        let fields =
            if OF_POINTS.contains(&&*name) { record.points.entry(index).or_default() } else { &mut record.fields };
        // A constant field may be repeated: an axis by its letter and its number.
        if let Some((before, _)) = fields.insert(name.clone(), (value.clone(), line))
            && (before != value || OF_POINTS.contains(&&*name))
        {
            return Err(Fault::new(line, format!("`{name}` is given twice: the controller would take the last")));
        }
    }
    Ok(())
}

/// Returns the index of the point of a line; the next one if it names none.
fn index(said: &mut BTreeMap<String, String>, next: usize, line: usize) -> Result<[usize; 3], Fault> {
    let mut index = [0; 3];
    let mut given = false;
    for (slot, key) in index.iter_mut().zip(["index", "index_2", "index_3"]) {
        let Some(text) = said.remove(key) else { continue };
        given = true;
        let parsed: Option<usize> = text.trim().parse().ok().filter(|i| *i < MAX_POINTS);
        *slot = parsed.ok_or_else(|| Fault::new(line, format!("`{text}` is no number of a point")))?;
    }
    Ok(if given { index } else { [next, 0, 0] })
}

pub(super) fn fits(pattern: &str, line: &str) -> bool {
    match_pattern(&pieces(pattern), line).is_some()
}

/// The fields of a line that fits a pattern from end to end.
pub(super) fn fields(pattern: &str, line: &str) -> Option<Vec<(String, String)>> {
    match_pattern(&pieces(pattern), line)
}

#[derive(Debug, Clone, PartialEq)]
enum PatternPiece {
    /// Literal letters.
    Text(String),
    /// Any blanks.
    Blank,
    /// A field.
    Field(String),
}

fn pieces(pattern: &str) -> Vec<PatternPiece> {
    let mut pieces = Vec::new();
    let mut rest = pattern.trim();
    while let Some(first) = rest.chars().next() {
        if first.is_whitespace() {
            rest = rest.trim_start();
            pieces.push(PatternPiece::Blank);
        } else if let Some((field, after)) = rest.strip_prefix('<').and_then(|r| r.split_once('>')) {
            pieces.push(PatternPiece::Field(field.to_owned()));
            rest = after;
        } else {
            let tail = &rest[first.len_utf8()..];
            let end = tail.find(|c: char| c.is_whitespace() || c == '<').unwrap_or(tail.len()) + first.len_utf8();
            pieces.push(PatternPiece::Text(rest[..end].to_owned()));
            rest = &rest[end..];
        }
    }
    pieces
}

/// The fields of a line that fits a pattern from end to end.
fn match_pattern(pieces: &[PatternPiece], line: &str) -> Option<Vec<(String, String)>> {
    let mut fields = Vec::new();
    let mut rest = line;
    for (i, piece) in pieces.iter().enumerate() {
        match piece {
            PatternPiece::Text(text) => rest = rest.strip_prefix(&**text)?,
            PatternPiece::Blank => {
                let after = rest.trim_start();
                (after.len() < rest.len()).then_some(())?;
                rest = after;
            }
            PatternPiece::Field(name) => {
                let end = match pieces.get(i + 1) {
                    _ if name == "row" || name == "any" && i + 1 == pieces.len() => rest.len(),
                    Some(PatternPiece::Text(next)) => rest.find(&**next)?,
                    _ => rest.find(char::is_whitespace).unwrap_or(rest.len()),
                };
                let value = rest[..end].trim();
                (!value.is_empty()).then_some(())?;
                fields.push((name.clone(), value.to_owned()));
                rest = &rest[end..];
            }
        }
    }
    rest.trim().is_empty().then_some(fields)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_take_their_fields_and_nothing_else() {
        let found = fields("$AN_CEC[<table>,<index>]=<value>", "$AN_CEC[0,12]=-0.003").unwrap();
        let words: Vec<&str> = found.iter().flat_map(|(name, value)| [&**name, &**value]).collect();
        assert_eq!(words, ["table", "0", "index", "12", "value", "-0.003"]);
        assert_eq!(fields("$AN_CEC[<table>,<index>]=<value>", "$AN_CEC[0.12]=1"), None);
        assert_eq!(fields("kw.x <value>", "kw.x   7").unwrap()[0].1, "7");
        assert_eq!(fields("kw.x <value>", "kw.x"), None);
        assert_eq!(fields("M17", "M17 "), Some(Vec::new()));
        assert_eq!(fields("M17", "M170"), None);
        assert_eq!(fields("<row>", "1, 2,3").unwrap()[0].1, "1, 2,3");
        assert_eq!(fields("head <any>", "head what ever").unwrap()[0].1, "what ever");
    }
}
