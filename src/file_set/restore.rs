//! Restore sets: the files that take a set back, in the same language and read back as the set is.

use super::{module_set, table_set};
use crate::compensation::CorrectionTables;
use crate::controller::{ControllerTarget, KinematicsModule, RenderedFile};
use crate::machine::Machine;
use crate::run::{Call, Refused};
use std::sync::Arc;

/// Name of the folder of a restore set in that of its set.
pub const RESTORE_FOLDER: &str = "restore";

/// Content of a restore set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Restored {
    /// The corrections that were in force when the machine was measured, read from its files.
    InForce,
    /// The numbers of the nominal machine: what was in force is not known.
    NominalNumbers,
    /// No corrections.
    NoCorrections,
}

impl Restored {
    /// Returns the content of the restore set of a target, if files in force were given or not.
    pub(crate) fn of(target: &ControllerTarget, installed: bool) -> Self {
        let parameters = target.manifest.kinematics().is_some_and(|mechanism| !mechanism.machines.is_empty());
        match (installed, parameters) {
            (true, _) => Self::InForce,
            (false, true) => Self::NominalNumbers,
            (false, false) => Self::NoCorrections,
        }
    }
}

/// Returns the machine under the name that stands in the heads of a restore set.
fn in_heads(machine: &Machine) -> Machine {
    machine.named(format!("restore set of {}", machine.name()))
}

/// Returns the files that put `installed` in force again in place of a set of tables; without them the set is off.
pub(crate) fn of_tables(
    call: &mut Call,
    machine: &Machine,
    target: &ControllerTarget,
    set: &CorrectionTables,
    installed: Option<&CorrectionTables>,
) -> Result<Vec<RenderedFile>, Refused> {
    let machine = &in_heads(machine);
    let tables = Arc::new(target.restored_tables(set, installed));
    let files = target.watch.during(|| target.render(machine, &tables, &mut call.diagnostics)).ok_or(Refused)?;
    call.check()?;
    table_set::read_back(call, machine, target, &files, &tables)?;
    Ok(files)
}

/// Returns the files that put the numbers before a module in force again, with zeros in the tables beside it.
pub(crate) fn of_module(
    call: &mut Call,
    machine: &Machine,
    target: &ControllerTarget,
    module: &KinematicsModule,
    beside: &CorrectionTables,
) -> Result<Vec<RenderedFile>, Refused> {
    let machine = &in_heads(machine);
    let restored = match module.restored(machine, target) {
        Ok(restored) => restored,
        Err(refusal) => return call.refuse(refusal),
    };
    let zeros = Arc::new(target.restored_tables(beside, None));
    let render = || target.render_kinematics(machine, &restored, &zeros, &mut call.diagnostics);
    let files = target.watch.during(render).ok_or(Refused)?;
    call.check()?;
    module_set::read_back(call, machine, target, &files, &restored, &zeros)?;
    Ok(files)
}
