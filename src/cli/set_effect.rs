//! What a set of files does to a machine: one that `compile` would write, or one found in a folder.

use super::certificate_output::warnings;
use super::how::{How, Options};
use super::session::Session;
use super::table_set::{self, Found};
use super::{Stop, detect, module_set};
use crate::controller::{Certificate, Depth, Effect, Judged, Limits, Target, certify, certify_kinematics};
use crate::machine::Machine;
use std::path::Path;

/// What a target does to a machine by the files that `compile` would write, and the certificate over so many
/// poses; nothing is written.
pub(super) fn compiled(
    session: &mut Session,
    machine: &Machine,
    target: &Target,
    how: &How,
    (poses, seed): (usize, u64),
) -> Result<(Effect, Certificate), Stop> {
    let (effect, certificate) = if target.manifest.kinematics().is_some() {
        let module = module_set::made(session, machine, target, how.orientation(), Limits::default())?;
        let (carried, beside) = (module.carried, module.beside);
        let certificate = certify_kinematics(machine, target, (&carried, &beside), Depth { poses, seed });
        (Effect::Module(Box::new(carried), beside), certificate)
    } else {
        let limits = Limits::default();
        let tables = table_set::made(session, machine, target, (&[], usize::MAX), how.scope(), limits, None)?.tables;
        let judged = Judged { target, tables: &tables, installed: None };
        let certificate = certify(machine, judged, how.scope(), poses, seed);
        (Effect::Tables(tables), certificate)
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
) -> Result<(Target, Effect), Stop> {
    let set = detect::any_set(session, machine, folder, &options.how)?;
    if set.target.manifest.kinematics().is_none() {
        let Found { target, tables, .. } = table_set::tables_of(session, machine, folder, set)?;
        return Ok((target, Effect::Tables(tables)));
    }
    let (carried, beside) = module_set::found(session, machine, &set.target, folder, &options.how, &set.files)?;
    Ok((set.target, Effect::Module(Box::new(carried), beside)))
}
