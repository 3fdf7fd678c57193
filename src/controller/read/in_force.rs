//! The tables of a set that are in force.

use super::activation::Activation;
use super::{Fault, ReadBack, ReadContext, assignment, sections};
use crate::controller::manifest::{FileSpec, Index, Per};
use crate::diagnostic::{Diagnostic, Diagnostics, codes};

/// Reads what a text puts in force; none if it is no file of this form. A fault: the controller would not start with
/// it, or reads the tables differently than it is done here.
pub(super) fn activation(reading: &ReadContext, spec: &FileSpec, text: &str) -> Result<Option<Activation>, Fault> {
    match &spec.index {
        Some(Index::Sections { .. }) => sections::activation(reading, spec, text),
        Some(Index::Columns { .. }) => assignment::columns(reading, spec, text),
        Some(Index::Settings { .. }) => assignment::settings(reading, spec, text),
        None => Ok(None),
    }
}

/// A table in force: the axis over which it is looked up, and the number of its file.
#[derive(Debug, Clone, Copy)]
pub(super) struct TableInForce {
    pub axis: usize,
    pub file: usize,
}

/// The number of rows for which a controller has room.
#[derive(Debug, Clone, Copy)]
struct Room {
    rows: usize,
    /// The file that says so, and its line.
    file: usize,
    line: usize,
}

/// The tables, units and senses that the files of a set put in force.
#[derive(Debug, Clone)]
pub(super) struct InForce {
    /// The tables of axes; none if no file says so.
    pub tables: Option<Vec<TableInForce>>,
    /// The mm and deg of a unit in tables.
    pub units: [f64; 2],
    /// Factors of the corrections of axes.
    pub senses: Vec<(usize, f64)>,
    room: Option<Room>,
}

/// Reads the files of a set that put others in force. Diagnostics: one that the controller would not start with
/// (E0704), one of its files that is not there (E0705), none of them that says what is in force (W0715).
pub(super) fn in_force(reading: &ReadContext, files: &[ReadBack], diagnostics: &mut Diagnostics) -> Option<InForce> {
    let mut all = InForce { tables: None, units: [1.0; 2], senses: Vec::new(), room: None };
    for spec in reading.target.manifest.files.iter().filter(|spec| spec.index.is_some()) {
        let Some(at) = files.iter().position(|file| file.name == spec.path) else {
            if names_tables(reading, spec) && !files.is_empty() {
                diagnostics.push(unstated_warning(&spec.path));
            }
            continue;
        };
        let read = activation(reading, spec, &files[at].text);
        match read.and_then(|read| read.ok_or_else(|| Fault::new(0, "it puts no file in force"))) {
            Err(fault) => {
                fault.report(&files[at], diagnostics);
                return None;
            }
            Ok(read) => all.add(spec, &read, at, files, diagnostics)?,
        }
    }
    Some(all)
}

/// True if it puts files with tables in force.
fn names_tables(reading: &ReadContext, spec: &FileSpec) -> bool {
    let Some(Index::Settings { names, .. }) = &spec.index else { return true };
    reading.target.manifest.files.iter().any(|other| other.path == *names && other.layout.is_some())
}

impl InForce {
    /// Adds what the file of number `at` puts in force. None: a refusal was reported.
    fn add(
        &mut self,
        spec: &FileSpec,
        read: &Activation,
        at: usize,
        files: &[ReadBack],
        diagnostics: &mut Diagnostics,
    ) -> Option<()> {
        let mut tables = Vec::new();
        for named in &read.files {
            // Under the name by which it was found, or under that of its place in the set.
            let found = files.iter().position(|file| file.found == named.file);
            let Some(file) = found.or_else(|| files.iter().position(|file| file.name == named.file)) else {
                let message = format!("the file `{}` is missing", named.file);
                let help = format!("line {} of `{}` puts it in force", named.line + 1, files[at].found);
                diagnostics.push(Diagnostic::new(codes::E0705, message).help(help));
                return None;
            };
            if let Some(Index::Settings { names, .. }) = &spec.index
                && files[file].name != *names
            {
                let message = format!("`{}` is put in force and not the file of the set", named.file);
                Fault::new(named.line, message).report(&files[at], diagnostics);
                return None;
            }
            tables.extend(named.axis.map(|axis| TableInForce { axis, file }));
        }
        if !matches!(spec.index, Some(Index::Settings { .. })) {
            self.tables = Some(tables);
        }
        self.units = std::array::from_fn(|i| self.units[i] * read.units[i]);
        self.senses.extend(&read.senses);
        self.room = read.room.map(|(rows, line)| Room { rows, file: at, line }).or(self.room);
        Some(())
    }

    /// Warns of the files of a part of the set that nothing puts in force.
    pub fn report_idle(
        &self,
        spec: &FileSpec,
        names: &[(Option<usize>, String)],
        files: &[ReadBack],
        diagnostics: &mut Diagnostics,
    ) {
        let Some(tables) = self.tables.as_ref().filter(|_| is_assigned(spec)) else { return };
        for (at, file) in files.iter().enumerate() {
            if names.iter().any(|(_, name)| *name == file.name) && !tables.iter().any(|table| table.file == at) {
                diagnostics.push(idle_warning(&file.found));
            }
        }
    }

    /// Refuses tables of more rows than the controller has room for.
    pub fn check_room(&self, files: &[ReadBack], tables: &[usize], diagnostics: &mut Diagnostics) {
        let Some(room) = self.room else { return };
        let number = |line: &&str| line.split_whitespace().next().is_some_and(|word| word.parse::<f64>().is_ok());
        let rows: usize = tables.iter().map(|file| files[*file].text.lines().filter(number).count()).sum();
        if rows > room.rows {
            let message = format!("the tables have {rows} rows: the controller has room for {}", room.rows);
            Fault::new(room.line, message).report(&files[room.file], diagnostics);
        }
    }
}

/// True for files of axes, which a file assigns to them.
pub(super) fn is_assigned(spec: &FileSpec) -> bool {
    matches!(spec.per, Per::Axis | Per::Input) && spec.of.is_none()
}

/// Warns of a table that nothing puts in force.
pub(super) fn idle_warning(name: &str) -> Diagnostic {
    let message = format!("`{name}` is not in force: no file of the set puts it in force, so it corrects nothing");
    Diagnostic::new(codes::W0714, message).help("if the controller uses it, the file that says so is another one")
}

fn unstated_warning(name: &str) -> Diagnostic {
    let message = format!("`{name}` is not there: the tables count as in force, each for the axis of its name");
    Diagnostic::new(codes::W0715, message).help("put the controller's own file of that kind beside them")
}
