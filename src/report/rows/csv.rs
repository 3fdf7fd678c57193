//! CSV: a header with units, one pose a line.

use super::Rows;
use std::io::{self, Write};

impl Rows<'_> {
    /// Writes CSV.
    pub fn csv(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "{}", self.columns().join(","))?;
        for index in 0..self.deviations.len() {
            let cells: Vec<String> = self.row(index).iter().map(f64::to_string).collect();
            writeln!(out, "{}", cells.join(","))?;
        }
        Ok(())
    }
}
