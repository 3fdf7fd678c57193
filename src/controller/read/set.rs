//! The files of a set by their names, and their tables.

use super::in_force::{self, InForce};
use super::{Fault, ReadBack, ReadContext, place};
use crate::compensation::CorrectionTables;
use crate::controller::manifest::{ControllerTarget, FileSpec, Per, axis_letters, path_fits};
use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use crate::machine::Machine;

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

    /// True if a file of this name belongs to the target's set for some machine.
    pub fn writes(&self, name: &str) -> bool {
        self.manifest.files.iter().any(|spec| path_fits(&spec.path, name))
    }

    /// Names of the files that put others in force.
    pub fn index_files(&self) -> Vec<String> {
        self.manifest.files.iter().filter(|spec| spec.index.is_some()).map(|spec| spec.path.clone()).collect()
    }

    /// Names of the files of code without numbers.
    pub fn code_files(&self) -> Vec<String> {
        let code = self.manifest.files.iter().filter(|spec| spec.code && spec.layout.is_none());
        code.map(|spec| spec.path.clone()).collect()
    }

    pub(super) fn names(&self, machine: &Machine, spec: &FileSpec) -> Vec<(Option<usize>, String)> {
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

    /// Reads the tables beside a kinematics module: those of files that are there.
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
        let letters = axis_letters(machine, self.manifest.axis_letters.as_ref(), None).unwrap_or_default();
        let mut reading = ReadContext { target: self, machine, letters, axis: None, units: [1.0; 2] };
        let in_force = in_force::in_force(&reading, files, diagnostics)?;
        reading.units = in_force.units;
        let mut all = CorrectionTables::default();
        let mut any = in_force.tables.is_some();
        for spec in self.manifest.files.iter().filter(|spec| keep(spec)) {
            let Some(layout) = &spec.layout else { continue };
            let names = self.names(machine, spec);
            let tables = tables_of(spec, &names, &in_force, files, diagnostics);
            in_force.report_idle(spec, &names, files, diagnostics);
            in_force.check_room(files, &tables.iter().map(|(_, file)| *file).collect::<Vec<_>>(), diagnostics);
            for (axis, file) in tables.into_iter().map(|(axis, at)| (axis, &files[at])) {
                let own = names.iter().find(|(_, name)| *name == file.name).and_then(|(axis, _)| *axis);
                if let Some((line, told)) = place::by_frame(layout, &names, &file.text)
                    && Some(told) != own
                    && file.found == file.name
                {
                    let fault = "the first line names the table of another axis than the file's name does";
                    Fault::new(line, fault).report(file, diagnostics);
                    continue;
                }
                reading.axis = axis;
                any = true;
                layout.report_check_words(file, diagnostics);
                match reading.file(layout, &file.text) {
                    Ok(read) => {
                        all.tables.extend(read.tables);
                        all.errors.extend(read.errors);
                        all.scales.extend(read.scales);
                    }
                    Err(fault) => fault.report(file, diagnostics),
                }
            }
        }
        (!diagnostics.is_refused() && any).then(|| {
            let mut all = CorrectionTables { senses: in_force.senses, ..all.merge() };
            // A sum of rounded numbers is one of them again.
            self.manifest.mechanism.round_sums(machine, &mut all);
            all
        })
    }
}

/// The axis of a table of axes, and the number of its file.
type TableFile = (Option<usize>, usize);

/// The tables of a part of a set: those that a file puts in force, or those that are there by their names.
fn tables_of(
    spec: &FileSpec,
    names: &[(Option<usize>, String)],
    in_force: &InForce,
    files: &[ReadBack],
    diagnostics: &mut Diagnostics,
) -> Vec<TableFile> {
    if let Some(tables) = in_force.tables.as_ref().filter(|_| in_force::is_assigned(spec)) {
        return tables.iter().map(|table| (Some(table.axis), table.file)).collect();
    }
    let mut found = Vec::new();
    for (axis, name) in names {
        match files.iter().position(|file| file.name == *name) {
            Some(at) => found.push((*axis, at)),
            // A set with files of some axes only determines the axes that have tables.
            None if matches!(spec.per, Per::Axis | Per::Machine) && spec.of.is_none() => {
                diagnostics.push(missing(name));
            }
            None => {}
        }
    }
    found
}

fn missing(name: &str) -> Diagnostic {
    Diagnostic::new(codes::E0705, format!("the file `{name}` is missing"))
        .help("a set of compensation files is only whole with all of them")
}
