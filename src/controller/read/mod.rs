//! Files of a target read back into tables. Whatever the controller would swallow in silence or
//! misread (comments, blank lines, commas, unsorted lines, NaN, too many points) is refused here
//! with its place.
//!
//! A manifest says how a file is laid out: lines of known patterns ([`lines`]), columns, or one of the
//! formats that have a reader of their own ([`named`], [`lattice`]). What is read becomes tables in
//! [`assemble`]. Files without a known name are told apart by their content ([`recognise()`]), their axes in [`place`].

mod assemble;
mod columns;
mod coverage;
mod lattice;
mod lines;
mod named;
mod place;
mod products;
mod recognise;
mod rolled;

pub use recognise::{Found, RecognisedSet, recognise};

use super::ControllerTarget;
use super::emit::render::assigned_letters;
use super::manifest::description::{FileSpec, Layout, Per};
use crate::compensation::CorrectionTables;
use crate::diagnostic::{Diagnostic, Diagnostics, Place, codes};
use crate::machine::Machine;
use crate::units;

/// A file of a set.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadBack {
    /// Its name in the set, by which its place is known.
    pub name: String,
    /// The name under which it was found.
    pub found: String,
    /// Its text.
    pub text: String,
}

impl ReadBack {
    /// A file found under the name that it has in the set.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        let name = name.into();
        Self { found: name.clone(), name, text: text.into() }
    }
}

/// What is known while a file is read.
pub(super) struct Reading<'a> {
    pub target: &'a ControllerTarget,
    pub machine: &'a Machine,
    /// (index of the axis, letter) in the controller's order.
    pub letters: Vec<(usize, String)>,
    /// The axis to which the file belongs by its name.
    pub axis: Option<usize>,
}

impl Reading<'_> {
    /// The axis with one of the controller's letters.
    pub fn by_letter(&self, letter: &str) -> Option<usize> {
        self.letters.iter().find(|(_, known)| known == letter).map(|(axis, _)| *axis)
    }

    /// The axis with one of the controller's numbers, from 1.
    pub fn by_number(&self, number: &str) -> Option<usize> {
        let number: usize = number.parse().ok()?;
        self.letters.get(number.checked_sub(1)?).map(|(axis, _)| *axis)
    }
}

impl ControllerTarget {
    /// Names of the files that a set for this machine can have tables in.
    pub fn table_files(&self, machine: &Machine) -> Vec<String> {
        let with_layout = self.manifest.files.iter().filter(|spec| spec.layout.is_some());
        with_layout.flat_map(|spec| self.names(machine, spec).into_iter().map(|(_, name)| name)).collect()
    }

    /// Names that files of axes would have which the machine does not have.
    pub fn foreign_files(&self, machine: &Machine) -> Vec<String> {
        let own = self.table_files(machine);
        let Some(letters) = self.manifest.axis_letters.as_ref() else { return Vec::new() };
        let per_axis = self.manifest.files.iter().filter(|spec| spec.layout.is_some() && spec.per != Per::Machine);
        let mut names: Vec<String> = per_axis.flat_map(|spec| self.names_of_letters(spec, &letters.order)).collect();
        names.retain(|name| !own.contains(name));
        names
    }

    /// Names of the files that say which table belongs to which axis.
    pub fn index_files(&self) -> Vec<String> {
        self.manifest.files.iter().filter(|spec| spec.index.is_some()).map(|spec| spec.path.clone()).collect()
    }

    fn names(&self, machine: &Machine, spec: &FileSpec) -> Vec<(Option<usize>, String)> {
        match spec.per {
            Per::Machine => vec![(None, spec.path.clone())],
            Per::Axis | Per::Input | Per::Output => {
                let named = self.axis_files(machine, spec).unwrap_or_default();
                named.into_iter().map(|(axis, name)| (Some(axis), name)).collect()
            }
        }
    }

    /// Reads the tables out of files with these names. Diagnostics: E0704 and its place.
    pub fn read(
        &self,
        machine: &Machine,
        files: &[ReadBack],
        diagnostics: &mut Diagnostics,
    ) -> Option<CorrectionTables> {
        self.read_of(machine, files, |_| true, diagnostics)
    }

    /// Reads the tables that stand beside a kinematics module: those of files that are there.
    pub fn read_beside(
        &self,
        machine: &Machine,
        files: &[ReadBack],
        diagnostics: &mut Diagnostics,
    ) -> CorrectionTables {
        self.read_of(machine, files, FileSpec::is_of_tables, diagnostics).unwrap_or_default()
    }

    fn read_of(
        &self,
        machine: &Machine,
        files: &[ReadBack],
        keep: impl Fn(&FileSpec) -> bool,
        diagnostics: &mut Diagnostics,
    ) -> Option<CorrectionTables> {
        let letters = assigned_letters(machine, self.manifest.axis_letters.as_ref(), None).unwrap_or_default();
        if let Some((at, fault)) = place::index_fault(self, &letters, files) {
            fault.said_of(&files[at], diagnostics);
        }
        let mut reading = Reading { target: self, machine, letters, axis: None };
        let mut all = CorrectionTables::default();
        let mut any = false;
        for spec in self.manifest.files.iter().filter(|spec| keep(spec)) {
            let Some(layout) = &spec.layout else { continue };
            let names = self.names(machine, spec);
            for (axis, name) in names.iter().cloned() {
                let Some(file) = files.iter().find(|file| file.name == name) else {
                    // Which axes have tables is for a set to say, if it has files of some only.
                    if matches!(spec.per, Per::Axis | Per::Machine) && spec.of.is_none() {
                        diagnostics.push(missing(&name));
                    }
                    continue;
                };
                if let Some((line, told)) = place::by_frame(layout, &names, &file.text)
                    && Some(told) != axis
                    && file.found == file.name
                {
                    let fault = "the first line names the table of another axis than the file's name does";
                    Fault::new(line, fault).said_of(file, diagnostics);
                    continue;
                }
                reading.axis = axis;
                any = true;
                match reading.file(layout, &file.text) {
                    Ok(read) => {
                        all.tables.extend(read.tables);
                        all.errors.extend(read.errors);
                    }
                    Err(fault) => fault.said_of(file, diagnostics),
                }
            }
        }
        (!diagnostics.refused() && any).then(|| {
            let mut all = all.merged();
            // A sum of rounded numbers is one of them again.
            self.manifest.mechanism.round_sums(machine, &mut all);
            all
        })
    }
}

impl Reading<'_> {
    fn file(&self, layout: &Layout, text: &str) -> Result<CorrectionTables, Fault> {
        if text.trim().is_empty() {
            return Err(Fault::new(
                0,
                "the file is empty: it was cut off, and the controller would have nothing of it",
            ));
        }
        let one = |table| CorrectionTables { tables: vec![table], errors: Vec::new() };
        match layout {
            Layout::Columns { columns } => columns::own_axis(self, columns, text).map(one),
            Layout::CsvLattice => lattice::csv(self.machine, text).map(one),
            Layout::JsonLattice => lattice::json(self.machine, text).map(one),
            // Those of kinematics modules have a reader of their own.
            Layout::CArrays | Layout::HalConstants => Ok(CorrectionTables::default()),
            Layout::Lines { comment, lines } => {
                let records = lines::records(comment.as_deref(), lines, text)?;
                assemble::tables(self, &records)
            }
            Layout::ErrorColumns => named::error_columns(self, text),
            Layout::AxisColumns { position, reversal, frame } => {
                named::axis_columns(self, &named::Header { position, reversal, frame }, text)
            }
        }
    }
}

impl Reading<'_> {
    /// Does a text without tables say by itself that it is of this layout?
    fn speaks(&self, layout: &Layout, text: &str) -> Result<bool, Fault> {
        match layout {
            Layout::Lines { comment, lines } => {
                let told = !lines::records(comment.as_deref(), lines, text)?.is_empty();
                Ok(told || lines.iter().any(|line| line.required))
            }
            Layout::ErrorColumns => {
                Ok(text.lines().any(|line| !line.trim_start().starts_with("//") && !line.trim().is_empty()))
            }
            _ => Ok(false),
        }
    }
}

/// A number of a compensation file, no larger than anything there is (a kilometre in nanometres).
fn number(cell: &str) -> Result<f64, String> {
    const LARGEST: f64 = 1e12;
    let value = units::number(cell).map_err(|failure| failure.to_string())?;
    if value.abs() <= LARGEST {
        Ok(value)
    } else {
        Err(format!("`{}` is no position or correction of a machine", cell.trim()))
    }
}

/// What is wrong with a line (counted from 0).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fault {
    line: usize,
    message: String,
}

impl Fault {
    fn new(line: usize, message: impl Into<String>) -> Self {
        Self { line, message: message.into() }
    }

    fn said_of(&self, file: &ReadBack, diagnostics: &mut Diagnostics) {
        let source = diagnostics.sources.add(&*file.found, &*file.text);
        diagnostics.push(self.diagnostic(&file.found, &file.text, source));
    }

    fn diagnostic(&self, name: &str, text: &str, source: crate::diagnostic::SourceId) -> Diagnostic {
        at_line(self.line, &self.message, name, text, source)
    }
}

/// What is wrong with a line (counted from 0) of a file.
pub(super) fn at_line(
    line: usize,
    message: &str,
    name: &str,
    text: &str,
    source: crate::diagnostic::SourceId,
) -> Diagnostic {
    let start: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
    let length = text.get(start..).and_then(|rest| rest.lines().next()).map_or(0, str::len);
    let place = Place { source, range: start..start + length };
    Diagnostic::new(codes::E0704, format!("`{name}`: {message}"))
        .at(Some(place), "")
        .help("compile the file set again; do not edit compensation files by hand")
}

fn missing(name: &str) -> Diagnostic {
    Diagnostic::new(codes::E0705, format!("the file `{name}` is missing"))
        .help("a set of compensation files is only whole with all of them")
}
