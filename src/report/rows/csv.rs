//! CSV: a header with units, one pose a line.

use super::table::{RowBlock, Rows, Stream};
use std::fmt::Write as _;
use std::io::{self, Write};

pub(super) struct Csv<W> {
    out: W,
}

/// The line of a row, with its end.
pub(super) fn line(row: &[f64], text: &mut String) {
    for (i, x) in row.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(text, "{}{x}", if i == 0 { "" } else { "," });
    }
    text.push('\n');
}

impl<W: Write> Csv<W> {
    pub(super) fn new(rows: &Rows<'_>, mut out: W) -> io::Result<Self> {
        writeln!(out, "{}", rows.columns().join(","))?;
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
