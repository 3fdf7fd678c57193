//! Lines of known patterns, such as `$AN_CEC[<table>,<index>]=<value>`.
//!
//! Fields `table`, `error` and `reversal` begin a record, or go on with the one of that name; lines without go to the
//! last record.

use super::patterns::{PatternPiece, match_pattern, pieces};
use super::{Fault, archive, number, patterns};
use crate::controller::manifest::{ArchiveForm, Edge, LineSpec};
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
    /// True if the control's archive has it, with other data besides.
    pub archive: bool,
}

/// Fields that a point has, besides the index.
const OF_POINTS: [&str; 9] =
    ["position", "position_2", "position_3", "value", "value_2", "value_3", "forward", "reverse", "increment"];

/// Larger indices are no table's.
const MAX_POINTS: usize = 5_000_000;

/// The lines of a format, and the axis whose lines of an archive are read.
#[derive(Clone, Copy)]
pub(super) struct LineFormat<'a> {
    pub comment: Option<&'a str>,
    pub lines: &'a [LineSpec],
    pub archive: Option<&'a ArchiveForm>,
    /// The number of the file's axis; none if it is unknown.
    pub axis: Option<usize>,
}

/// The state of reading a text.
#[derive(Default)]
struct Progress {
    /// True for each pattern that was met.
    met: Vec<bool>,
    /// Pattern and record, for each line that fitted.
    of_record: Vec<(usize, usize)>,
    /// The line of the block that is open.
    open: Option<usize>,
    /// The line at which the controller stops reading.
    ended: Option<usize>,
    current: usize,
    records: Vec<TableFields>,
}

pub(super) fn records(format: LineFormat, text: &str) -> Result<Vec<TableFields>, Fault> {
    // Comments that a manifest reads: numbers that the controller has no place for.
    let kept = format.lines.iter().map(|spec| &*spec.line);
    let kept: Vec<&str> = kept.filter(|line| format.comment.is_some_and(|mark| line.starts_with(mark))).collect();
    let opened = archive::open_with(format.archive, format.comment, &kept, text)?;
    let form = format.archive.filter(|_| opened.archive);
    let specs: Vec<&LineSpec> = format.lines.iter().chain(form.iter().flat_map(|form| &form.lines)).collect();
    let patterns: Vec<Vec<PatternPiece>> = specs.iter().map(|spec| pieces(&spec.line)).collect();
    let mut progress = Progress { met: vec![false; specs.len()], ..Progress::default() };
    for (number, bare) in &opened.lines {
        let fits = |(pieces, spec): (&Vec<PatternPiece>, &&LineSpec)| {
            spec.at.is_none_or(|at| at == number + 1).then(|| match_pattern(pieces, bare)).flatten()
        };
        match patterns.iter().zip(&specs).enumerate().find_map(|(i, p)| Some((i, fits(p)?))) {
            Some((which, fields)) if form.is_none() || format.is_of_axis(&fields) => {
                progress.take(specs[which], which, *number, fields)?;
            }
            Some(_) => {}
            None if form.is_some_and(|form| form.skip.iter().any(|pattern| patterns::fits(pattern, bare))) => {}
            None => return Err(Fault::new(*number, "the controller would not understand this line")),
        }
    }
    let end = text.lines().count().saturating_sub(1);
    progress.finish(&specs, form.is_some(), end)
}

impl LineFormat<'_> {
    /// False for a line of another axis.
    fn is_of_axis(&self, fields: &[(String, String)]) -> bool {
        let named = fields.iter().find(|(name, _)| name == "axis_number").map(|(_, value)| value.parse().ok());
        named.is_none_or(|named| self.axis.is_none() || named == self.axis)
    }
}

impl Progress {
    /// Takes a line of this number that fits a pattern.
    fn take(
        &mut self,
        spec: &LineSpec,
        which: usize,
        number: usize,
        fields: Vec<(String, String)>,
    ) -> Result<(), Fault> {
        self.met[which] = true;
        if let Some(reason) = &spec.refuse {
            return Err(Fault::new(number, &**reason));
        }
        match self.ended {
            Some(_) if spec.end => return Ok(()),
            Some(end) => {
                let message = format!("the controller stops reading at line {}: this is not in force", end + 1);
                return Err(Fault::new(number, message));
            }
            None if spec.end => self.ended = Some(number),
            None => {}
        }
        self.open = match (spec.block, self.open) {
            (Some(Edge::Begin), Some(_)) => return Err(Fault::new(number, "the block before is not closed")),
            (Some(Edge::Begin), None) => Some(number),
            (Some(Edge::End), None) => return Err(Fault::new(number, "there is no block to close")),
            (Some(Edge::End), Some(_)) => None,
            (None, open) => open,
        };
        if spec.first && !self.records.is_empty() {
            return Err(Fault::new(number, "this line would take away tables that stand before it"));
        }
        let set = spec.set.iter().map(|(name, value)| (name.clone(), value.clone()));
        take(&mut self.records, &mut self.current, set.chain(fields), number)?;
        self.of_record.push((which, self.current));
        Ok(())
    }

    /// The records, if everything is there. An archive has other heads than a set.
    fn finish(mut self, specs: &[&LineSpec], archive: bool, end: usize) -> Result<Vec<TableFields>, Fault> {
        if let Some(line) = self.open {
            return Err(Fault::new(line, "the block that begins here is not closed: the file was cut off"));
        }
        let wanted = |spec: &LineSpec| spec.required && (!archive || spec.end || spec.block.is_some());
        if let Some((spec, _)) = specs.iter().zip(&self.met).find(|(spec, met)| wanted(spec) && !**met) {
            return Err(Fault::new(end, format!("there is no line `{}`", spec.line)));
        }
        let each = specs.iter().enumerate().filter(|(_, spec)| spec.each);
        for (which, spec) in each {
            let missing = |(at, _): &(usize, &TableFields)| !self.of_record.contains(&(which, *at));
            if let Some((_, record)) = self.records.iter().enumerate().find(missing) {
                let message = format!("no line `{}` for this table: the controller would keep what it had", spec.line);
                return Err(Fault::new(record.line, message));
            }
        }
        self.records.iter_mut().for_each(|record| record.archive = archive);
        Ok(self.records)
    }
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
        let numbers: Result<Vec<f64>, _> = if row.contains(',') {
            row.split(',').map(number).collect()
        } else {
            row.split_whitespace().map(number).collect()
        };
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
        let digits = text.trim().bytes().all(|byte| byte.is_ascii_digit());
        let parsed: Option<usize> = text.trim().parse().ok().filter(|i| digits && *i < MAX_POINTS);
        *slot = parsed.ok_or_else(|| Fault::new(line, format!("`{text}` is no number of a point")))?;
    }
    Ok(if given { index } else { [next, 0, 0] })
}
