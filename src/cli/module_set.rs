//! Kinematics modules, for targets that replace the controller's kinematics: rendered and read back, or found in a folder.

use super::how::CompensationOptions;
use super::output::session::Session;
use super::store::file_set;
use super::{Exit, Outcome, detect};
use crate::compensation::CorrectionTables;
use crate::controller::{ControllerTarget, KinematicsModule, Limits, ReadBack, RenderedFile};
use crate::machine::Machine;
use std::path::Path;
use std::sync::Arc;

/// The files of a module, and what the controller reads from them.
pub(super) struct Module {
    pub(super) rendered: Vec<RenderedFile>,
    /// What the module carries.
    pub(super) carried: KinematicsModule,
    /// The tables beside it.
    pub(super) beside: CorrectionTables,
}

/// Renders a module and reads it back.
pub(super) fn made(
    session: &mut Session,
    machine: &Machine,
    target: &ControllerTarget,
    orientation: bool,
    limits: Limits,
) -> Result<Module, Exit> {
    let meant = carried(session, machine, target, orientation)?;
    session.checked()?;
    let reversal = Arc::new(target.reversal_tables(machine));
    limits.exceeded(machine, &reversal).into_iter().for_each(|refusal| session.diagnostics.push(refusal));
    session.checked()?;
    let rendered = target.render_kinematics(machine, &meant, &reversal, &mut session.diagnostics);
    let rendered = rendered.ok_or(Exit::Refused)?;
    session.checked()?;
    let (carried, beside) = read_back(session, machine, target, &rendered, (&meant, &reversal))?;
    Ok(Module { rendered, carried, beside })
}

/// A module takes the place of another one, and nothing adds up.
pub(super) fn refuse_installed(session: &Session, given: bool) -> Outcome {
    if given { session.usage("--installed: a kinematics module is not written on top of tables") } else { Ok(()) }
}

/// A module's numbers and the tables beside it, read from the files of a folder.
pub(super) fn found(
    session: &mut Session,
    machine: &Machine,
    target: &ControllerTarget,
    folder: &Path,
    how: &CompensationOptions,
    texts: &[ReadBack],
) -> Result<(KinematicsModule, CorrectionTables), Exit> {
    if texts.is_empty() {
        return session.refuse(detect::nothing_found(folder));
    }
    let meant = carried(session, machine, target, how.orientation())?;
    let Some(read) = target.read_kinematics(machine, &meant, texts, &mut session.diagnostics) else {
        return Err(Exit::Refused);
    };
    let beside = beside(session, machine, target, texts)?;
    Ok((read.with_tool_of(machine), beside))
}

fn carried(
    session: &mut Session,
    machine: &Machine,
    target: &ControllerTarget,
    orientation: bool,
) -> Result<KinematicsModule, Exit> {
    match KinematicsModule::of(machine, target, orientation) {
        Ok(carried) => {
            carried.warnings(machine).into_iter().for_each(|warning| session.diagnostics.push(warning));
            Ok(carried)
        }
        Err(refusal) => session.refuse(refusal),
    }
}

/// The tables of the files beside a module; none if there are no such files.
fn beside(
    session: &mut Session,
    machine: &Machine,
    target: &ControllerTarget,
    texts: &[ReadBack],
) -> Result<CorrectionTables, Exit> {
    let tables = target.read_beside(machine, texts, &mut session.diagnostics);
    session.checked()?;
    Ok(tables)
}

/// Reads the rendered bytes back as `verify` would, and insists that they are what was meant.
fn read_back(
    session: &mut Session,
    machine: &Machine,
    target: &ControllerTarget,
    files: &[RenderedFile],
    (meant, reversal): (&KinematicsModule, &CorrectionTables),
) -> Result<(KinematicsModule, CorrectionTables), Exit> {
    let text = |file: &RenderedFile| ReadBack::new(&*file.name, String::from_utf8_lossy(&file.bytes));
    let texts: Vec<_> = files.iter().map(text).collect();
    let read = target.read_kinematics(machine, meant, &texts, &mut session.diagnostics);
    session.checked()?;
    let beside = beside(session, machine, target, &texts)?;
    match read {
        Some(read) if read == *meant && beside.same_effect(reversal) => Ok((read, beside)),
        _ => session.refuse(file_set::misread(target)),
    }
}
