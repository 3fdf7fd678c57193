//! Compensation of a machine: options, rendered sets of files, and the sets in folders.
//!
//! - `options`: goal, axes and target of the correction;
//! - `table_set`, `module_set`: sets of tables and kinematics modules, rendered and read back;
//! - `pole_zone`: the zone of a module by the limits of the drives;
//! - `restore`: the sets that take these back;
//! - `folder`, `found_set`: sets found in a folder, of whatever target;
//! - `composition`: sets of two targets, kinematic parameters and tables for what they leave;
//! - `effect`: the effect of any of them on a machine; `verdict`: the warnings of its certificate; `differences`:
//!   those of a set that is no longer as its manifest states.

pub(crate) mod composition;
pub(crate) mod differences;
pub(crate) mod effect;
pub(crate) mod folder;
pub(crate) mod found_set;
pub(crate) mod module_set;
pub(crate) mod options;
mod pole_zone;
pub(crate) mod restore;
pub(crate) mod table_set;
pub(crate) mod verdict;

use crate::controller::ControllerTarget;
use crate::diagnostic::{Diagnostic, codes};

/// Refuses rendered files that do not read back as the intended set.
pub(crate) fn misread(target: &ControllerTarget) -> Diagnostic {
    let name = &target.manifest.target;
    Diagnostic::new(codes::E0707, format!("the files of target `{name}` do not read back as the intended set"))
        .help("its templates and its manifest disagree; nothing was written")
}
