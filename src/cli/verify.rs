//! `abbe verify`: replay files as the controller would and certify what they leave.

use super::certificate_output::{Shown, warnings};
use super::compile::{Options, StoredArg};
use super::files::{Disk, SET_LIMIT, read_at_most};
use super::session::Session;
use super::{Outcome, Stop, file_set, kinematics, load};
use crate::compensation::Tables;
use crate::diagnostic::Diagnostic;
use crate::machine::{Approach, Machine};
use crate::target::{Judged, LOCK_NAME, Lock, NAMES, Recognised, Replay, Target, is_plain_name, recognise};
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
    /// The compensation files that were in force when the machine was measured: what is judged here replaces them.
    #[arg(long, value_name = "DIR")]
    installed: Option<PathBuf>,
}

/// A set found in a folder.
pub(super) struct Found {
    pub target: Target,
    pub tables: Tables,
    pub files: Vec<String>,
}

pub(super) fn run(session: &mut Session, args: &Args) -> Outcome {
    let lock = file_set::existing_lock(&args.folder);
    // The tables hold for the tool they were made for.
    let made_for = lock.as_ref().map(|lock| lock.tool.clone()).filter(|name| !name.is_empty());
    let machine = load::machine(session, &args.machine, args.options.tool.clone().or(made_for).as_deref())?;
    warn_other_inputs(session, lock.as_ref());
    let known = known(session, &machine, &args.folder, args.target.as_deref(), &args.options)?;
    if let Some((target, present)) = known.as_ref().filter(|(target, _)| target.manifest.kinematics().is_some()) {
        let texts = file_set::read(&args.folder, present, &mut session.diagnostics);
        session.checked()?;
        warn_edited(session, &args.folder, lock.as_ref());
        return kinematics::verify(session, args, &machine, target, &texts);
    }
    let Found { target, tables, files } = tables_of(session, &machine, &args.folder, known)?;
    session.checked()?;
    warn_edited(session, &args.folder, lock.as_ref());
    let installed = installed(session, &machine, &target, &args.options, args.installed.as_deref())?;
    session.checked()?;
    if let Some(path) = &args.replay {
        let replay = Replay::new(&machine, &target, &tables);
        return print_replay(session, &machine, &target, &replay, path);
    }
    let judged = Judged { target: &target, tables: &tables, installed: installed.as_ref() };
    let certificate = args.options.certificate(&machine, judged);
    warnings(&certificate).into_iter().for_each(|warning| session.diagnostics.push(warning));
    session.checked()?;
    Shown { machine: &machine, target: &target, certificate: &certificate, files, folder: &args.folder }.print(session);
    Ok(())
}

/// The target of the files in a folder, and which of its files are there: the target named, else the
/// manifest's, else the first whose files are there by name.
fn known(
    session: &mut Session,
    machine: &Machine,
    folder: &Path,
    named: Option<&str>,
    options: &Options,
) -> Result<Option<(Target, Vec<String>)>, Stop> {
    let lock = file_set::existing_lock(folder);
    let named = named.map(str::to_owned).or_else(|| lock.as_ref().map(|lock| lock.target.clone()));
    let there = |target: &Target| target.table_files(machine).iter().any(|name| folder.join(name).exists());
    let by_name = || NAMES.iter().filter_map(|name| Target::embedded(name)).find(there).map(|t| t.manifest.target);
    let Some(name) = named.or_else(by_name) else { return Ok(None) };
    let stored = lock.and_then(|lock| options.how.stored.or_else(|| StoredArg::of(&lock.options)));
    let target = options.how.target(session, &name, stored)?;
    let mut present = target.table_files(machine);
    present.retain(|name| folder.join(name).symlink_metadata().is_ok());
    Ok(Some((target, present)))
}

/// The tables in a folder: of the target that is known by names, else of the one that their content tells.
pub(super) fn found(
    session: &mut Session,
    machine: &Machine,
    folder: &Path,
    named: Option<&str>,
    options: &Options,
) -> Result<Found, Stop> {
    let known = known(session, machine, folder, named, options)?;
    tables_of(session, machine, folder, known)
}

/// The tables in a folder of which this target is known by names.
fn tables_of(
    session: &mut Session,
    machine: &Machine,
    folder: &Path,
    known: Option<(Target, Vec<String>)>,
) -> Result<Found, Stop> {
    let Some((target, present)) = known else { return by_content(session, machine, folder) };
    if target.manifest.kinematics().is_some() {
        let message = format!("`{}` holds a kinematics module, which has no tables", folder.display());
        let help = "a module is written anew from the machine file, not on top of another one";
        return session.refuse(Diagnostic::new("E0711", message).help(help));
    }
    let texts = file_set::read(folder, &present, &mut session.diagnostics);
    session.checked()?;
    let read = target.read(machine, &texts, &mut session.diagnostics);
    session.checked()?;
    match read {
        Some(tables) => Ok(Found { target, tables, files: present }),
        None => session.refuse(nothing_found(folder)),
    }
}

/// Files of any name.
fn by_content(session: &mut Session, machine: &Machine, folder: &Path) -> Result<Found, Stop> {
    const MOST_FILES: usize = 100;
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let regular = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file()));
    let mut names: Vec<String> = regular.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort();
    names.truncate(MOST_FILES);
    let text = |name: String| {
        let bytes = read_at_most(&folder.join(&name), SET_LIMIT).ok()?;
        String::from_utf8(bytes).ok().map(|text| (name, text))
    };
    let texts: Vec<(String, String)> = names.into_iter().filter_map(text).collect();
    match recognise(machine, &texts, &mut session.diagnostics) {
        Some(Recognised { target, tables, files }) => Ok(Found { target, tables, files }),
        None => {
            session.checked()?;
            session.refuse(nothing_found(folder))
        }
    }
}

/// The tables that were in force when the machine was measured.
pub(super) fn installed(
    session: &mut Session,
    machine: &Machine,
    target: &Target,
    options: &Options,
    folder: Option<&Path>,
) -> Result<Option<Tables>, Stop> {
    let Some(folder) = folder else { return Ok(None) };
    let set = found(session, machine, folder, None, options)?;
    session.checked()?;
    if set.target.manifest.target == target.manifest.target {
        return Ok(Some(set.tables));
    }
    let (old, new) = (&set.target.manifest.target, &target.manifest.target);
    let message = format!("the files in `{}` are of target `{old}`, not of `{new}`", folder.display());
    let help = "only tables of the same target can be written on top of each other";
    session.refuse(Diagnostic::new("E0711", message).help(help))
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
fn warn_edited(session: &mut Session, folder: &Path, lock: Option<&Lock>) {
    let Some(lock) = lock else {
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
