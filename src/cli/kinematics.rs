//! `compile` and `verify` for targets that replace the controller's kinematics.

use super::certificate_output::{Shown, warnings};
use super::session::Session;
use super::{Outcome, Stop, compile, detect, file_set, verify};
use crate::diagnostic::Diagnostic;
use crate::machine::Machine;
use crate::target::{Carried, Depth, Hashed, Lock, ReadBack, RenderedFile, Target, certify_kinematics};

pub(super) fn compile(
    session: &mut Session,
    args: &compile::Args,
    machine: &Machine,
    target: &Target,
    inputs: Vec<Hashed>,
) -> Outcome {
    let orientation = args.options.how.orientation();
    let meant = carried(session, machine, target, orientation)?;
    session.checked()?;
    let rendered = target.render_kinematics(machine, &meant, &mut session.diagnostics).ok_or(Stop::Refused)?;
    session.checked()?;
    let read = read_back(session, machine, target, &rendered, &meant)?;
    let certificate = certify_kinematics(machine, target, &read, depth(&args.options));
    let limits = args.max_correction.unwrap_or_default();
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
    if texts.is_empty() {
        return session.refuse(detect::nothing_found(&args.folder));
    }
    let meant = carried(session, machine, target, args.options.how.orientation())?;
    let Some(read) = target.read_kinematics(machine, &meant, texts, &mut session.diagnostics) else {
        return Err(Stop::Refused);
    };
    let certificate = certify_kinematics(machine, target, &read, depth(&args.options));
    warnings(&certificate).into_iter().for_each(|warning| session.diagnostics.push(warning));
    session.checked()?;
    let files = texts.iter().map(|file| file.found.clone()).collect();
    Shown { machine, target, certificate: &certificate, files, folder: &args.folder }.print(session);
    Ok(())
}

fn depth(options: &compile::Options) -> Depth {
    Depth { poses: options.poses as usize, seed: options.seed }
}

fn carried(session: &mut Session, machine: &Machine, target: &Target, orientation: bool) -> Result<Carried, Stop> {
    match Carried::of(machine, target, orientation) {
        Ok(carried) => Ok(carried),
        Err(refusal) => session.refuse(refusal),
    }
}

/// Reads the rendered bytes back as `verify` would, and insists that they are what was meant.
fn read_back(
    session: &mut Session,
    machine: &Machine,
    target: &Target,
    files: &[RenderedFile],
    meant: &Carried,
) -> Result<Carried, Stop> {
    let text = |file: &RenderedFile| ReadBack::new(&*file.name, String::from_utf8_lossy(&file.bytes));
    let texts: Vec<_> = files.iter().map(text).collect();
    let read = target.read_kinematics(machine, meant, &texts, &mut session.diagnostics);
    session.checked()?;
    match read {
        Some(read) if read == *meant => Ok(read),
        _ => session.refuse(
            Diagnostic::new(
                "E0707",
                format!("the files of target `{}` do not read back as what was to be written", target.manifest.target),
            )
            .help("its templates do not write what its manifest says; nothing was written"),
        ),
    }
}
