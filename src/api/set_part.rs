//! Sets in subfolders of a set: the parts of a composed one, and those that take a set back.

use crate::controller::{ControllerTarget, Lock, RenderedFile};
use crate::file_set::restore::RESTORE_FOLDER;
use crate::job::machine_file::MachineFile;
use crate::run::Hashed;

/// The set of one target in a subfolder of another set.
#[derive(Debug, Clone)]
pub struct ComposedPart {
    /// Path of its subfolder: the target's name, or `restore` for the set that takes the other one back.
    pub folder: String,
    /// The files, without the manifest.
    pub files: Vec<RenderedFile>,
    /// The manifest of the part.
    pub lock: Lock,
}

impl ComposedPart {
    /// Returns the part of a composed set, in the folder of its target.
    pub(super) fn of_target(
        file: &MachineFile,
        target: &ControllerTarget,
        words: Vec<String>,
        files: Vec<RenderedFile>,
    ) -> Self {
        let hashes = files.iter().map(|file| Hashed::new(&file.name, &file.bytes)).collect();
        let lock = Lock::new(&target.manifest.target, file, words, file.inputs(), hashes);
        Self { folder: target.manifest.target.clone(), files, lock }
    }

    /// Returns the part in the folder of restore sets.
    pub(super) fn of_restore(self) -> Self {
        Self { folder: RESTORE_FOLDER.to_owned(), ..self }
    }

    /// Returns the part below the folder of restore sets.
    pub(super) fn below_restore(self) -> Self {
        Self { folder: format!("{RESTORE_FOLDER}/{}", self.folder), ..self }
    }
}
