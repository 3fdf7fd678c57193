//! The folder `restore` against the set beside it.

use crate::controller::{LOCK_NAME, Lock};
use crate::diagnostic::{Diagnostic, codes};
use crate::file_set::folder::Folder;
use crate::file_set::restore::RESTORE_FOLDER;
use crate::record::files::{SetFault, SetFiles, set_files};
use crate::run::Run;
use std::path::Path;

/// Returns a warning (W0720) if the set in a folder is one of ours and the one that takes it back is missing, was
/// edited or is that of another set. A folder of a restore set, or of a part of two targets, has none.
pub fn restore_warning(folder: &Path, run: Run) -> Option<Diagnostic> {
    let lock = Folder::new(folder, run.files).lock()?;
    if within_set(folder, run) {
        return None;
    }
    let place = folder.join(RESTORE_FOLDER);
    let shown = place.display();
    let message = match set_files(run.files, &place) {
        Ok(SetFiles { lock: back, .. }) => {
            let other = differs(&lock, &back)?;
            format!("`{shown}` takes another set back: its manifest has other {other}")
        }
        Err(SetFault::NoManifest) => format!("`{shown}` is missing: the set that takes this one back"),
        Err(fault) => format!("`{shown}` {fault}: what takes this set back is not as abbe wrote it"),
    };
    let help = "do not load it; compile the set again, with the --installed of then";
    Some(Diagnostic::new(codes::W0720, message).help(help))
}

/// True for a folder that a set above has written: its restore set, or one of its parts.
fn within_set(folder: &Path, run: Run) -> bool {
    let above = folder.join("..").join(LOCK_NAME);
    let lock = run.files.read(&above).ok().and_then(|bytes| Lock::from_text(std::str::from_utf8(&bytes).ok()?));
    let Some(lock) = lock else { return false };
    let part = |name: &str| name == RESTORE_FOLDER || lock.parts.iter().any(|part| part.name == name);
    folder.file_name().is_none_or(|name| name.to_str().is_some_and(part))
}

/// Returns the first property by which two manifests are not of one run.
fn differs(set: &Lock, back: &Lock) -> Option<&'static str> {
    let properties = [
        (set.abbe == back.abbe, "version"),
        (set.target == back.target, "target"),
        (set.machine == back.machine, "machine"),
        (set.tool == back.tool, "tool"),
        (set.inputs == back.inputs, "inputs"),
        (set.options == back.options, "options"),
    ];
    properties.into_iter().find(|(same, _)| !same).map(|(_, name)| name)
}
