//! `compile` and `verify` for targets that replace the controller's kinematics.

use super::certificate_output::{Shown, warnings};
use super::session::Session;
use super::{Outcome, Stop, compile, detect, file_set, verify};
use crate::compensation::Tables;
use crate::diagnostic::Diagnostic;
use crate::machine::Machine;
use crate::target::{Carried, Depth, Hashed, Limits, Lock, ReadBack, RenderedFile, Target, certify_kinematics};
use std::path::Path;
use std::sync::Arc;

pub(super) fn compile(
    session: &mut Session,
    args: &compile::Args,
    machine: &Machine,
    target: &Target,
    inputs: Vec<Hashed>,
) -> Outcome {
    let orientation = args.options.how.orientation();
    let limits = args.max_correction.unwrap_or_default();
    let Module { rendered, carried, beside } = made(session, machine, target, orientation, limits)?;
    let certificate = certify_kinematics(machine, target, (&carried, &beside), depth(&args.options));
    limits.exceeded_by(&certificate).into_iter().for_each(|refusal| session.diagnostics.push(refusal));
    warnings(&certificate).into_iter().for_each(|warning| session.diagnostics.push(warning));
    session.checked()?;
    let files = rendered.iter().map(|file| Hashed::new(&file.name, &file.bytes)).collect();
    let goal = if orientation { "correct pose" } else { "correct position" };
    let lock = Lock::new(&args.target, machine, vec![goal.to_owned()], inputs, files);
    if let Err(refusal) = file_set::write(&args.out, &rendered, &lock) {
        return session.refuse(refusal);
    }
    let names = rendered.iter().map(|file| file.name.clone()).collect();
    Shown { machine, target, certificate: &certificate, files: names, folder: &args.out }.print(session);
    Ok(())
}

/// The files of a module, and what the controller reads from them.
pub(super) struct Module {
    rendered: Vec<RenderedFile>,
    /// What the module carries.
    pub(super) carried: Carried,
    /// The tables beside it.
    pub(super) beside: Tables,
}

/// Renders a module and reads it back.
pub(super) fn made(
    session: &mut Session,
    machine: &Machine,
    target: &Target,
    orientation: bool,
    limits: Limits,
) -> Result<Module, Stop> {
    let meant = carried(session, machine, target, orientation)?;
    session.checked()?;
    let reversal = Arc::new(target.reversal_tables(machine));
    limits.exceeded(machine, &reversal).into_iter().for_each(|refusal| session.diagnostics.push(refusal));
    session.checked()?;
    let rendered = target.render_kinematics(machine, &meant, &reversal, &mut session.diagnostics);
    let rendered = rendered.ok_or(Stop::Refused)?;
    session.checked()?;
    let (carried, beside) = read_back(session, machine, target, &rendered, (&meant, &reversal))?;
    Ok(Module { rendered, carried, beside })
}

pub(super) fn verify(
    session: &mut Session,
    args: &verify::Args,
    machine: &Machine,
    target: &Target,
    texts: &[ReadBack],
) -> Outcome {
    if args.replay.is_some() {
        return session.usage("--replay: a kinematics module has no tables that hold for a joint alone");
    }
    let (read, beside) = found(session, machine, target, &args.folder, &args.options.how, texts)?;
    let certificate = certify_kinematics(machine, target, (&read, &beside), depth(&args.options));
    warnings(&certificate).into_iter().for_each(|warning| session.diagnostics.push(warning));
    session.checked()?;
    let files = texts.iter().map(|file| file.found.clone()).collect();
    Shown { machine, target, certificate: &certificate, files, folder: &args.folder }.print(session);
    Ok(())
}

/// A module's numbers and the tables beside it, read from the files of a folder.
pub(super) fn found(
    session: &mut Session,
    machine: &Machine,
    target: &Target,
    folder: &Path,
    how: &compile::How,
    texts: &[ReadBack],
) -> Result<(Carried, Tables), Stop> {
    if texts.is_empty() {
        return session.refuse(detect::nothing_found(folder));
    }
    let meant = carried(session, machine, target, how.orientation())?;
    let Some(read) = target.read_kinematics(machine, &meant, texts, &mut session.diagnostics) else {
        return Err(Stop::Refused);
    };
    let beside = beside(session, machine, target, texts)?;
    Ok((read.with_tool_of(machine), beside))
}

fn depth(options: &compile::Options) -> Depth {
    Depth { poses: options.poses as usize, seed: options.seed }
}

fn carried(session: &mut Session, machine: &Machine, target: &Target, orientation: bool) -> Result<Carried, Stop> {
    match Carried::of(machine, target, orientation) {
        Ok(carried) => {
            carried.warnings(machine).into_iter().for_each(|warning| session.diagnostics.push(warning));
            Ok(carried)
        }
        Err(refusal) => session.refuse(refusal),
    }
}

/// The tables of the files beside a module; none if there are no such files.
fn beside(session: &mut Session, machine: &Machine, target: &Target, texts: &[ReadBack]) -> Result<Tables, Stop> {
    let tables = target.read_beside(machine, texts, &mut session.diagnostics);
    session.checked()?;
    Ok(tables)
}

/// Reads the rendered bytes back as `verify` would, and insists that they are what was meant.
fn read_back(
    session: &mut Session,
    machine: &Machine,
    target: &Target,
    files: &[RenderedFile],
    (meant, reversal): (&Carried, &Tables),
) -> Result<(Carried, Tables), Stop> {
    let text = |file: &RenderedFile| ReadBack::new(&*file.name, String::from_utf8_lossy(&file.bytes));
    let texts: Vec<_> = files.iter().map(text).collect();
    let read = target.read_kinematics(machine, meant, &texts, &mut session.diagnostics);
    session.checked()?;
    let beside = beside(session, machine, target, &texts)?;
    match read {
        Some(read) if read == *meant && beside.same_effect(reversal) => Ok((read, beside)),
        _ => session.refuse(
            Diagnostic::new(
                "E0707",
                format!("the files of target `{}` do not read back as what was to be written", target.manifest.target),
            )
            .help("its templates do not write what its manifest says; nothing was written"),
        ),
    }
}
