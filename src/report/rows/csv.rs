//! CSV: a header with units, one pose a line.

use super::{Rows, columns, six};
use crate::evaluate::Deviation;
use crate::machine::Machine;
use std::io::{self, Write};

/// The header, with the end of its line.
pub fn csv_header(machine: &Machine) -> String {
    columns(machine).join(",") + "\n"
}

/// The line of a pose (mm, deg) with its deviation (mm, rad), with its end.
pub fn csv_line(pose: impl IntoIterator<Item = f64>, deviation: &Deviation) -> String {
    // Adding zero turns -0 into 0.
    let cells = pose.into_iter().chain(six(deviation)).map(|x| (x + 0.0).to_string());
    cells.collect::<Vec<_>>().join(",") + "\n"
}

impl Rows<'_> {
    /// Writes CSV.
    pub fn csv(&self, out: &mut dyn Write) -> io::Result<()> {
        out.write_all(csv_header(self.machine).as_bytes())?;
        let lines = self.poses.iter().zip(self.deviations);
        lines.map(|(pose, deviation)| csv_line(pose, deviation)).try_for_each(|line| out.write_all(line.as_bytes()))
    }
}
