//! Warnings of what differs from the manifest of a set: its inputs, its tool, its files.

use super::folder::Folder;
use crate::controller::{ControllerTarget, LOCK_NAME, Lock, is_plain_name};
use crate::diagnostic::{Diagnostic, codes};
use crate::job::machine_file::MachineFile;
use crate::run::Call;

/// Tables made from other files than those just read are judged all the same.
pub(crate) fn warn_other_inputs(call: &mut Call, file: &MachineFile, lock: Option<&Lock>) {
    if lock.is_some_and(|lock| lock.inputs != file.inputs()) {
        let message = "the tables were made from another machine file, or from other error tables, than these";
        call.warn(Diagnostic::new(codes::W0702, message).help("compile again if the machine file has changed"));
    }
}

/// Tables that hold for one tool, judged with another.
pub(crate) fn warn_other_tool(call: &mut Call, file: &MachineFile, target: &ControllerTarget, lock: Option<&Lock>) {
    let Some(lock) = lock else { return };
    let name = &file.tool().name;
    if target.manifest.tool_dependent() && lock.tool != *name {
        let message = format!("the tables were made for the tool `{}` and are judged with `{name}`", lock.tool);
        let help = "the figures are those of the wrong tool at the machine; to load tables for it, compile with --tool";
        call.warn(Diagnostic::new(codes::W0706, message).help(help));
    }
}

/// Warns of files that are no longer as the manifest of the set states; they are read all the same.
pub(crate) fn warn_edited(call: &mut Call, folder: &Folder, lock: Option<&Lock>) {
    let Some(lock) = lock else {
        let message =
            format!("`{}` has no readable {LOCK_NAME}: edits of its files cannot be detected", folder.path.display());
        call.warn(Diagnostic::new(codes::W0703, message).help("files found on a machine are judged as they are"));
        return;
    };
    for file in lock.files.iter().filter(|file| is_plain_name(&file.name)) {
        // A missing file has been refused.
        let Some(bytes) = folder.bytes(&file.name) else { continue };
        if !lock.wrote(&file.name, &bytes) {
            call.warn(Diagnostic::new(codes::W0701, format!("`{}` has been edited since abbe wrote it", file.name)));
        }
    }
}
