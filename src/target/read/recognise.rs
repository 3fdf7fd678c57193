//! Formats told apart by content: which target reads a folder's files, whatever their names.

use super::{Fault, ReadBack, Reading};
use crate::compensation::Tables;
use crate::diagnostic::Diagnostics;
use crate::machine::Machine;
use crate::target::manifest::Layout;
use crate::target::render::assigned_letters;
use crate::target::{NAMES, Target};

/// Files that a target reads.
#[derive(Debug)]
pub struct Recognised {
    /// Which.
    pub target: Target,
    /// What they hold.
    pub tables: Tables,
    /// Their names.
    pub files: Vec<String>,
}

/// How far a target came with a file.
enum Tried {
    Read(Tables),
    Failed(Fault),
}

/// The target of the binary that reads most of the files; if none reads any, what is wrong with the one
/// that came furthest is said (E0704). None if the files are nothing that any target knows.
pub fn recognise(machine: &Machine, files: &[ReadBack], diagnostics: &mut Diagnostics) -> Option<Recognised> {
    let mut best: Option<Recognised> = None;
    let mut furthest: Option<(usize, Fault)> = None;
    for target in NAMES.iter().filter_map(|name| Target::embedded(name)) {
        let mut tables = Tables::default();
        let mut read = Vec::new();
        for (i, (name, text)) in files.iter().enumerate() {
            match tried(&target, machine, text) {
                Some(Tried::Read(found)) => {
                    tables.tables.extend(found.tables);
                    tables.errors.extend(found.errors);
                    read.push(name.clone());
                }
                Some(Tried::Failed(fault)) if furthest.as_ref().is_none_or(|(_, f)| fault.line > f.line) => {
                    furthest = Some((i, fault));
                }
                _ => {}
            }
        }
        if !read.is_empty() && best.as_ref().is_none_or(|b| b.files.len() < read.len()) {
            best = Some(Recognised { target, tables: tables.merged(), files: read });
        }
    }
    // Past the first line a reader has met something that it knows.
    if let (None, Some((i, fault))) = (&best, furthest.filter(|(_, fault)| fault.line > 0)) {
        let (name, text) = &files[i];
        let source = diagnostics.sources.add(&**name, &**text);
        diagnostics.push(fault.diagnostic(name, text, source));
    }
    best
}

/// Tries the layouts of a target that say by themselves what they are.
fn tried(target: &Target, machine: &Machine, text: &str) -> Option<Tried> {
    let letters = assigned_letters(machine, target.manifest.axis_letters.as_ref(), None)?;
    let reading = Reading { target, machine, letters, axis: None };
    let telling = |layout: &&Layout| {
        matches!(layout, Layout::Lines { .. } | Layout::ErrorColumns | Layout::CsvLattice | Layout::JsonLattice)
    };
    let mut failed: Option<Fault> = None;
    for layout in target.manifest.files.iter().filter_map(|spec| spec.layout.as_ref()).filter(telling) {
        match reading.file(layout, text) {
            Ok(tables) if !(tables.tables.is_empty() && tables.errors.is_empty()) => return Some(Tried::Read(tables)),
            Ok(_) => {}
            Err(fault) if failed.as_ref().is_none_or(|f| fault.line > f.line) => failed = Some(fault),
            Err(_) => {}
        }
    }
    failed.map(Tried::Failed)
}
