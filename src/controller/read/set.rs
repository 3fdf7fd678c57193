//! The files of a set by their names, and their tables.

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

    /// Names of the files that assign tables to axes.
    pub fn index_files(&self) -> Vec<String> {
        self.manifest.files.iter().filter(|spec| spec.index.is_some()).map(|spec| spec.path.clone()).collect()
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
        if let Some((at, fault)) = place::index_fault(self, &letters, files) {
            fault.report(&files[at], diagnostics);
        }
        let mut reading = ReadContext { target: self, machine, letters, axis: None };
        let mut all = CorrectionTables::default();
        let mut any = false;
        for spec in self.manifest.files.iter().filter(|spec| keep(spec)) {
            let Some(layout) = &spec.layout else { continue };
            let names = self.names(machine, spec);
            for (axis, name) in names.iter().cloned() {
                let Some(file) = files.iter().find(|file| file.name == name) else {
                    // A set with files of some axes only determines the axes that have tables.
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
                    Fault::new(line, fault).report(file, diagnostics);
                    continue;
                }
                reading.axis = axis;
                any = true;
                match reading.file(layout, &file.text) {
                    Ok(read) => {
                        all.tables.extend(read.tables);
                        all.errors.extend(read.errors);
                    }
                    Err(fault) => fault.report(file, diagnostics),
                }
            }
        }
        (!diagnostics.is_refused() && any).then(|| {
            let mut all = all.merge();
            // A sum of rounded numbers is one of them again.
            self.manifest.mechanism.round_sums(machine, &mut all);
            all
        })
    }
}

fn missing(name: &str) -> Diagnostic {
    Diagnostic::new(codes::E0705, format!("the file `{name}` is missing"))
        .help("a set of compensation files is only whole with all of them")
}
