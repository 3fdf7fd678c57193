//! A text of a known layout to tables.

use super::{Fault, ReadContext, assemble, columns, lattice, lines, named};
use crate::compensation::CorrectionTables;
use crate::controller::manifest::FileLayout;

impl ReadContext<'_> {
    pub fn file(&self, layout: &FileLayout, text: &str) -> Result<CorrectionTables, Fault> {
        if text.trim().is_empty() {
            return Err(Fault::new(0, "the file is empty: it was cut off, and the controller would read no values"));
        }
        let one = |table| CorrectionTables { tables: vec![table], ..CorrectionTables::default() };
        match layout {
            FileLayout::Columns { columns } => columns::own_axis(self, columns, text).map(one),
            FileLayout::CsvLattice => lattice::csv(self.machine, text).map(one),
            FileLayout::JsonLattice => lattice::json(self.machine, text).map(one),
            // Those of kinematics modules have a reader of their own.
            FileLayout::CArrays | FileLayout::HalConstants | FileLayout::Parameters { .. } => {
                Ok(CorrectionTables::default())
            }
            FileLayout::Lines { .. } => assemble::tables(self, &lines::records(self.format(layout), text)?),
            FileLayout::ErrorColumns => named::error_columns(self, text),
            FileLayout::AxisColumns { position, reversal, frame } => {
                named::axis_columns(self, &named::CurveHeader { position, reversal, frame }, text)
            }
        }
    }
}

impl ReadContext<'_> {
    /// The lines of a layout for the axis of the file; none of another layout.
    fn format<'l>(&self, layout: &'l FileLayout) -> lines::LineFormat<'l> {
        let axis = self.axis.and_then(|axis| self.letters.iter().find(|known| known.axis == axis));
        let axis = axis.map(|known| known.number);
        match layout {
            FileLayout::Lines { comment, lines, archive } => {
                lines::LineFormat { comment: comment.as_deref(), lines, archive: archive.as_deref(), axis }
            }
            _ => lines::LineFormat { comment: None, lines: &[], archive: None, axis },
        }
    }

    /// True if a text without tables can be recognised as this layout.
    pub fn is_of_layout(&self, layout: &FileLayout, text: &str) -> Result<bool, Fault> {
        match layout {
            FileLayout::Lines { lines, .. } => {
                let told = !lines::records(self.format(layout), text)?.is_empty();
                // Nothing but other data of an archive is none of its files.
                Ok(told || lines.iter().any(|line| line.required) && !layout.is_archive(text))
            }
            FileLayout::ErrorColumns => {
                Ok(text.lines().any(|line| !line.trim_start().starts_with("//") && !line.trim().is_empty()))
            }
            _ => Ok(false),
        }
    }
}
