//! The context of every pass of resolution: document, files and diagnostics.

use super::beyond::ShortCurve;
use crate::diagnostic::{Code, Diagnostic, Diagnostics, shown};
use crate::syntax::{CsvTable, Document, Files, Keys, below, read_table};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::rc::Rc;

/// Shared by the passes.
pub struct Context<'a> {
    pub document: &'a Document,
    pub diagnostics: &'a mut Diagnostics,
    /// Curves that go on beyond their points.
    pub short: Vec<ShortCurve>,
    files: &'a dyn Files,
    /// Tables are read once, however many errors they carry.
    tables: BTreeMap<PathBuf, Option<Rc<CsvTable>>>,
}

impl<'a> Context<'a> {
    pub fn new(document: &'a Document, files: &'a dyn Files, diagnostics: &'a mut Diagnostics) -> Self {
        Self { document, diagnostics, short: Vec::new(), files, tables: BTreeMap::new() }
    }

    /// Reports at the value of an entry.
    pub fn at_value(&mut self, code: Code, at: &Keys, message: impl Into<String>, help: impl Into<String>) {
        let place = self.document.places.value(at);
        self.diagnostics.push(Diagnostic::new(code, message).at(place, "").help(help));
    }

    /// Reports at the key of an entry.
    pub fn at_key(&mut self, code: Code, at: &Keys, message: impl Into<String>, help: impl Into<String>) {
        let place = self.document.places.key(at);
        self.diagnostics.push(Diagnostic::new(code, message).at(place, "").help(help));
    }

    /// Returns the keys of the value of an entry, short as `12 um` or long as `{ value: 12 um }`.
    pub fn value_of(&self, at: &Keys) -> Keys {
        let long = below(at, "value");
        if self.document.places.has(&long) { long } else { at.clone() }
    }

    /// Returns the table that an entry names.
    pub fn table(&mut self, at: &Keys, written: &str) -> Option<Rc<CsvTable>> {
        let path = self.document.places.resolve_path(at, written);
        if let Some(known) = self.tables.get(&path) {
            return known.clone();
        }
        let named = self.document.places.value(at);
        let table = read_table(&path, named, self.files, self.diagnostics).map(Rc::new);
        self.tables.insert(path, table.clone());
        table
    }
}

/// Returns an entry's path as people write it.
pub fn dotted_path(at: &[String]) -> String {
    shown(&at.join("."))
}
