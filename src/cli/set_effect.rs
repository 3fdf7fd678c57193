//! What a set of files does to a machine: one that `compile` would write, or one found in a folder.

use super::how::{CompensationOptions, Options};
use super::output::certificate::warnings;
use super::output::session::Session;
use super::table_set::{self, FoundTables};
use super::{Exit, detect, module_set};
use crate::controller::{
    Certificate, ControllerTarget, Depth, Effect, JudgedTables, Limits, certify, certify_kinematics,
};
use crate::machine::Machine;
use std::path::Path;

/// What a target does to a machine by the files that `compile` would write, and the certificate over so many
/// poses; nothing is written.
pub(super) fn compiled(
    session: &mut Session,
    machine: &Machine,
    target: &ControllerTarget,
    how: &CompensationOptions,
    (poses, seed): (usize, u64),
) -> Result<(Effect, Certificate), Exit> {
    let (effect, certificate) = if target.manifest.kinematics().is_some() {
        let module = module_set::made(session, machine, target, how.orientation(), Limits::default())?;
        let (carried, beside) = (module.carried, module.beside);
        let certificate = certify_kinematics(machine, target, (&carried, &beside), Depth { poses, seed });
        (Effect::Module(Box::new(carried), beside), certificate)
    } else {
        let limits = Limits::default();
        let tables = table_set::made(session, machine, target, (&[], usize::MAX), how.scope(), limits, None)?.tables;
        let judged = JudgedTables { target, tables: &tables, installed: None };
        let certificate = certify(machine, judged, how.scope(), poses, seed);
        (Effect::CorrectionTables(tables), certificate)
    };
    warnings(&certificate).into_iter().for_each(|warning| session.diagnostics.push(warning));
    session.checked()?;
    Ok((effect, certificate))
}

/// What the set in a folder does, of whatever target it is.
pub(super) fn found(
    session: &mut Session,
    machine: &Machine,
    folder: &Path,
    options: &Options,
) -> Result<(ControllerTarget, Effect), Exit> {
    let set = detect::any_set(session, machine, folder, &options.how)?;
    if set.target.manifest.kinematics().is_none() {
        let FoundTables { target, tables, .. } = table_set::tables_of(session, machine, folder, set)?;
        return Ok((target, Effect::CorrectionTables(tables)));
    }
    let (carried, beside) = module_set::found(session, machine, &set.target, folder, &options.how, &set.files)?;
    Ok((set.target, Effect::Module(Box::new(carried), beside)))
}
