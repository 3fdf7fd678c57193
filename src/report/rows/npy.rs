//! NumPy: the columns of the CSV as a structured array of doubles, in the format `.npy`, version 1.0.

use super::table::{RowBlock, Rows, Stream};
use std::io::{self, Write};

pub(super) struct Npy<W> {
    out: W,
}

/// Bytes before the header: the magic number, the version and the length of the header.
const LEAD: usize = 10;

/// Data begin at a multiple of this.
const ALIGNMENT: usize = 64;

impl<W: Write> Npy<W> {
    pub(super) fn new(rows: &Rows<'_>, mut out: W) -> io::Result<Self> {
        out.write_all(&header(&rows.columns(), rows.poses.len())?)?;
        Ok(Self { out })
    }
}

impl<W: Write> Stream for Npy<W> {
    fn put(&mut self, rows: &RowBlock) -> io::Result<()> {
        let bytes: Vec<u8> = rows.rows.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        self.out.write_all(&bytes)
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        self.out.flush()
    }
}

fn header(columns: &[String], rows: usize) -> io::Result<Vec<u8>> {
    let fields: Vec<String> = columns.iter().map(|name| format!("('{name}', '<f8')")).collect();
    let text = format!("{{'descr': [{}], 'fortran_order': False, 'shape': ({rows},), }}", fields.join(", "));
    let length = (LEAD + text.len() + 1).next_multiple_of(ALIGNMENT) - LEAD;
    let short = u16::try_from(length).map_err(io::Error::other)?;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(short.to_le_bytes());
    bytes.extend(format!("{text:<width$}\n", width = length - 1).into_bytes());
    Ok(bytes)
}
