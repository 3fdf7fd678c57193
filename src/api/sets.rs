//! A set of compensation files in a folder, for programs that write and replace sets.

pub use super::restore_check::restore_warning;
pub use super::verify::set_manifest;
pub use crate::controller::{LOCK_NAME, Lock, MAX_FILE_BYTES, RenderedFile, is_plain_name};
pub use crate::file_set::folder::{STALE_HELP, refuse_outside};
pub use crate::file_set::restore::RESTORE_FOLDER;
pub use crate::record::files::{SetFault, SetFiles, set_files};
pub use crate::run::{Hashed, sha256};

use super::options::CompensationOptions;
use crate::controller::ControllerTarget;
use crate::diagnostic::Diagnostics;
use crate::run::Run;

/// True if the named target writes files of this name for some machine.
pub fn target_writes(options: &CompensationOptions, target: &str, name: &str, run: Run) -> bool {
    let found = ControllerTarget::find(target, options.templates.as_deref(), run.files, &mut Diagnostics::default());
    found.is_some_and(|target| target.writes(name))
}
