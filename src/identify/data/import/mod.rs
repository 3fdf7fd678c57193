//! Single-axis measurements as instruments export them, to a table of error curves and the figures of ISO 230-2.
//!
//! 1. `header`: where the table begins, the roles of its columns, the metadata before it; `layout` holds the words of
//!    titles and labels as tables of rules, `unit` the units.
//! 2. `gather`: rows to samples (error, position, direction, run); what is left out, and why.
//! 3. `order`: positions to targets, the order of the rows to passes and directions.
//! 4. `figures`: means by target and direction, reversal, repeatability, accuracy.
//! 5. `table`: the table that a machine file takes.

mod failure;
mod figures;
mod form;
mod gather;
mod header;
mod layout;
mod order;
mod sample;
mod table;
mod unit;

pub use figures::AccuracyFigures;
pub use sample::{Import, ImportRequest};

use crate::diagnostic::Diagnostics;
use crate::syntax::Files;
use crate::syntax::sheet::read_sheet;
use std::path::Path;

/// Most rows of a file.
const ROWS: usize = 200_000;

/// Reads an export; what cannot be understood as a whole is refused, single rows are left out.
pub fn import(path: &Path, wanted: &ImportRequest, files: &dyn Files, diagnostics: &mut Diagnostics) -> Option<Import> {
    let sheet = read_sheet(path, files, diagnostics)?;
    let lines = sheet.lines();
    let found = if lines.len() > ROWS {
        Err(Box::new(sample::refusal(format!("the file has {} rows; the limit is {ROWS}", lines.len()), None)))
    } else {
        header::find(&lines, wanted).and_then(|header| gather::gather(&lines, &header, wanted))
    };
    match found {
        Ok(import) => Some(import),
        Err(refused) => {
            diagnostics.push(*refused);
            None
        }
    }
}
