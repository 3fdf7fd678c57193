//! CSV: a header with units, one pose a line.

use super::table::{RowBlock, Rows, Stream};
use std::fmt::Write as _;
use std::io::{self, Write};

pub(super) struct Csv<W> {
    out: W,
}

/// The line of a row, with its end, after the unreached rows before it.
pub(super) fn line(rows: &Rows<'_>, index: usize, row: &[f64], text: &mut String) {
    let work = rows.work.and_then(|work| Some((work, work.reached.get(index)?)));
    if let Some((work, at)) = work {
        write_unreached(rows, index, text);
        text.push_str(&work.lead(at.line, at.feature.as_deref()));
    }
    for (i, x) in row.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(text, "{}{x}", if i == 0 { "" } else { "," });
    }
    if let Some(drawn) = rows.drawn {
        let _ = write!(text, ",bounds,{},{}", drawn.samples, drawn.seed);
    }
    text.push_str(if work.is_some() { ",\n" } else { "\n" });
}

/// The lines of the unreached rows before the pose with an index.
pub(super) fn write_unreached(rows: &Rows<'_>, index: usize, text: &mut String) {
    let Some(work) = rows.work else { return };
    let numbers = rows.columns().len() + if rows.drawn.is_some() { 3 } else { 0 };
    work.misses_before(index).iter().for_each(|row| text.push_str(&work.csv_line(row, numbers)));
}

impl<W: Write> Csv<W> {
    pub(super) fn new(rows: &Rows<'_>, mut out: W) -> io::Result<Self> {
        let (lead, end) = match rows.work {
            Some(work) => (work.head(), ",unreached"),
            None => (String::new(), ""),
        };
        let source = if rows.drawn.is_some() { ",from,samples,seed" } else { "" };
        writeln!(out, "{lead}{}{source}{end}", rows.columns().join(","))?;
        Ok(Self { out })
    }
}

impl<W: Write> Stream for Csv<W> {
    fn put(&mut self, rows: &RowBlock) -> io::Result<()> {
        self.out.write_all(rows.csv.as_bytes())
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        self.out.flush()
    }
}
