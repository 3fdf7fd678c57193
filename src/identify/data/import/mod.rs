//! Single-axis measurements as instruments export them, to a table of error curves and the figures of ISO 230-2.
//!
//! 0. `laser_text`, `entries`, `blocks`: files that are no tables, each with its own rules; `transposed`: tables with
//!    their targets in a row, turned.
//! 1. `header`: where the table begins, the roles of its columns, the metadata before it; `layout` holds the words of
//!    titles and labels as tables of rules, `channels` those of six-degree instruments, `columns` the user's own,
//!    `unit` the units.
//! 2. `gather`: rows to samples (error, position, direction, run); what is left out, and why.
//! 3. `order`: positions to targets, the order of the rows to passes and directions.
//! 4. `line`: the straight line of a straightness, taken off; `material`: positions at 20 deg C.
//! 5. `suspicion`: what the readings say against themselves.
//! 6. `table`: figures after ISO 230-2, and the table that a machine file takes.

mod blocks;
mod channels;
mod columns;
mod entries;
mod failure;
mod form;
mod gather;
mod header;
mod laser_text;
mod layout;
mod line;
mod material;
mod options;
mod order;
mod request;
mod sample;
mod suspicion;
mod table;
mod titles;
mod transposed;
mod unit;

pub use columns::read_columns;
pub use options::{Acceptance, FileContents, RunApproach, StraightnessLine};
pub use request::ImportRequest;
pub use sample::{AxisSample, Import, ReferenceLine, UnusedColumn};
pub use suspicion::{Finding, FindingEffect, FindingKind};

use super::tracker;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::identify::balls::TOUCH_LOG;
use crate::syntax::Files;
use crate::syntax::sheet::{SheetLine, read_sheet};
use std::path::Path;

const MAX_ROWS: usize = 200_000;

/// Reads an export; what cannot be understood as a whole is refused, single rows are left out.
pub fn import(path: &Path, wanted: &ImportRequest, files: &dyn Files, diagnostics: &mut Diagnostics) -> Option<Import> {
    let sheet = read_sheet(path, files, diagnostics)?;
    let lines = sheet.lines();
    let found = if lines.len() > MAX_ROWS {
        Err(Box::new(sample::refusal(format!("the file has {} rows; the limit is {MAX_ROWS}", lines.len()), None)))
    } else {
        read(&lines, path, wanted)
    };
    match found {
        Ok(mut import) => {
            suspicion::judge_repeats(&mut import, wanted.accepts_suspect);
            line::straighten(&mut import, wanted.line, wanted.keep_line);
            if let Some(material) = wanted.material {
                material::to_reference(&mut import, material);
            }
            suspicion::judge_axes(&mut import);
            if wanted.accepts_suspect {
                suspicion::accept(&mut import);
            }
            Some(import)
        }
        Err(refused) => {
            diagnostics.push(*refused);
            None
        }
    }
}

fn read(lines: &[SheetLine], path: &Path, wanted: &ImportRequest) -> Result<Import, Box<Diagnostic>> {
    if let (None, Some(SheetLine { place, text, .. })) = (&wanted.columns, lines.first()) {
        if text.trim() == TOUCH_LOG {
            let message = "this is a log of touches of balls, of no machine yet".to_owned();
            let help = "`abbe import LOG --machine MACHINE` reads it";
            return Err(Box::new(sample::refusal(message, Some(place.clone())).help(help)));
        }
        if laser_text::is(lines) {
            return laser_text::read(lines, place, wanted, path);
        }
        if entries::is(lines) {
            return entries::read(lines, place, wanted);
        }
        if blocks::is(lines) {
            return blocks::read(lines, place, wanted);
        }
    }
    let turned = if wanted.columns.is_none() { transposed::transpose(lines) } else { None };
    let lines = turned.as_deref().unwrap_or(lines);
    let found = header::find(lines, wanted).and_then(|header| gather::gather(lines, &header, wanted));
    found.map_err(|refused| if tracker::recognise(lines).is_some() { points(*refused) } else { refused })
}

/// Refuses points of a tracker: they are not readings of one error.
fn points(refused: Diagnostic) -> Box<Diagnostic> {
    let help = "points by name are places of the functional point, and no error of one axis: `abbe identify MACHINE \
                --data FILE --axis-poses POSES` fits errors to them";
    Box::new(refused.help(help))
}
