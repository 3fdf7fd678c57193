//! `abbe verify`: replay files as the controller would and certify what they leave.

use super::certificate_output::{Shown, warnings};
use super::compile::Options;
use super::files::{Disk, SET_LIMIT, read_at_most};
use super::session::Session;
use super::{Outcome, Stop, file_set, kinematics, load};
use crate::diagnostic::Diagnostic;
use crate::machine::{Approach, Machine};
use crate::target::{LOCK_NAME, Lock, NAMES, Replay, Target, certify, is_plain_name};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The machine file.
    machine: PathBuf,
    /// The folder with the compensation files.
    pub folder: PathBuf,
    /// The controller, if the folder has no manifest that says it.
    #[arg(long)]
    target: Option<String>,
    /// Instead of a certificate: what the controller adds at positions from a CSV file with the
    /// columns joint, direction, position (further columns are left alone), as CSV.
    #[arg(long, value_name = "FILE")]
    pub replay: Option<PathBuf>,
    #[command(flatten)]
    pub options: Options,
}

pub(super) fn run(session: &mut Session, args: &Args) -> Outcome {
    let lock = file_set::existing_lock(&args.folder);
    // The tables hold for the tool they were made for.
    let made_for = lock.as_ref().map(|lock| lock.tool.clone()).filter(|name| !name.is_empty());
    let machine = load::machine(session, &args.machine, args.options.tool.clone().or(made_for).as_deref())?;
    warn_other_inputs(session, lock.as_ref());
    let target = target(session, &machine, args)?;
    let names = target.table_files(&machine);
    let texts = file_set::read(&args.folder, &names, &mut session.diagnostics);
    session.checked()?;
    warn_edited(session, &args.folder);
    if target.manifest.kinematics().is_some() {
        return kinematics::verify(session, args, &machine, &target, &texts);
    }
    let Some(tables) = target.read(&machine, &texts, &mut session.diagnostics) else {
        session.checked()?;
        return session.refuse(nothing_found(&args.folder));
    };
    session.checked()?;
    if let Some(path) = &args.replay {
        let replay = Replay::new(&machine, &tables, target.manifest.controller);
        return print_replay(session, &machine, &target, &replay, path);
    }
    let certificate =
        certify(&machine, &target, &tables, args.options.how.scope(), args.options.poses as usize, args.options.seed);
    warnings(&certificate).into_iter().for_each(|warning| session.diagnostics.push(warning));
    session.checked()?;
    Shown { machine: &machine, target: &target, certificate: &certificate, files: names, folder: &args.folder }
        .print(session);
    Ok(())
}

/// The target named, else the manifest's, else the first whose files are there.
fn target(session: &mut Session, machine: &Machine, args: &Args) -> Result<Target, Stop> {
    let named = args.target.clone().or_else(|| file_set::existing_lock(&args.folder).map(|lock| lock.target));
    if let Some(name) = named {
        return args.options.how.target(session, &name);
    }
    let there = |target: &Target| target.table_files(machine).iter().any(|name| args.folder.join(name).exists());
    match NAMES.iter().filter_map(|name| Target::embedded(name)).find(there) {
        Some(target) => Ok(target),
        None => session.refuse(nothing_found(&args.folder)),
    }
}

pub(super) fn nothing_found(folder: &Path) -> Diagnostic {
    Diagnostic::new("E0705", format!("there are no compensation files of a known target in `{}`", folder.display()))
        .help("name the folder that `compile --out` was given, and the target with --target")
}

/// Tables made from other files than those just read are judged all the same, and that is said.
fn warn_other_inputs(session: &mut Session, lock: Option<&Lock>) {
    let same = lock.is_none_or(|lock| lock.inputs == super::compile::inputs(session));
    if !same {
        let message = "the tables were made from another machine file, or from other error tables, than these";
        session
            .diagnostics
            .push(Diagnostic::new("W0702", message).help("compile again if the machine file has changed"));
    }
}

/// Files of the set that no longer are what its manifest says are said; its tables are read all the same.
fn warn_edited(session: &mut Session, folder: &Path) {
    let Some(lock) = file_set::existing_lock(folder) else {
        let message =
            format!("`{}` has no readable {LOCK_NAME}: whether its files were edited cannot be told", folder.display());
        session
            .diagnostics
            .push(Diagnostic::new("W0703", message).help("files found on a machine are judged as they are"));
        return;
    };
    for file in lock.files.iter().filter(|file| is_plain_name(&file.name)) {
        // A missing file is the reader's to say.
        let Ok(bytes) = read_at_most(&folder.join(&file.name), SET_LIMIT) else { continue };
        if !lock.wrote(&file.name, &bytes) {
            session
                .diagnostics
                .push(Diagnostic::new("W0701", format!("`{}` has been edited since abbe wrote it", file.name)));
        }
    }
}

/// The replay at single positions: what a test of a real controller compares with.
fn print_replay(session: &mut Session, machine: &Machine, target: &Target, replay: &Replay, path: &Path) -> Outcome {
    let read = crate::syntax::read_text(path, None, &Disk, &mut session.diagnostics);
    let Some((_, text)) = read else { return Err(Stop::Refused) };
    let letters =
        crate::target::assigned_letters(machine, target.manifest.axis_letters.as_ref(), None).unwrap_or_default();
    let mut out = String::from("joint,direction,position,correction\n");
    let mut lines = text.lines();
    let header = lines.next().unwrap_or_default();
    if !header.replace(' ', "").starts_with("joint,direction,position") {
        let message = format!("`{}` does not begin with the header joint,direction,position", path.display());
        return session
            .refuse(Diagnostic::new("E0802", message).help("further columns may follow; one position a line"));
    }
    for line in lines {
        let mut cells = line.split(',');
        let parsed = parse_replay_row(&mut cells, &letters);
        let Some((joint, axis, approach, position)) = parsed else {
            let message = format!("`{}`: `{line}` is not joint,direction,position", path.display());
            return session.refuse(
                Diagnostic::new("E0802", message)
                    .help("write a joint of this machine, forward or reverse, and a number"),
            );
        };
        let mut command = vec![0.0; machine.axes().len()];
        command[axis] = position;
        let word = if approach == Approach::Forward { "forward" } else { "reverse" };
        let added = replay.added(&command, approach)[axis];
        out.push_str(&format!("{joint},{word},{position},{added}\n"));
    }
    session.print(&out);
    Ok(())
}

fn parse_replay_row<'a>(
    cells: &mut impl Iterator<Item = &'a str>,
    letters: &[(usize, String)],
) -> Option<(usize, usize, Approach, f64)> {
    let joint: usize = cells.next()?.trim().parse().ok()?;
    let (axis, _) = letters.get(joint)?;
    let approach = match cells.next()?.trim() {
        "forward" => Approach::Forward,
        "reverse" => Approach::Reverse,
        _ => return None,
    };
    Some((joint, *axis, approach, crate::units::number(cells.next()?).ok()?))
}
