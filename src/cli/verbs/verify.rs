//! `abbe verify`: replay files as the controller would and certify what they leave.

use crate::cli::how::Options;
use crate::cli::output::certificate::{CertificateView, warnings};
use crate::cli::output::session::Session;
use crate::cli::store::file_set;
use crate::cli::store::files::{SET_LIMIT, read_at_most};
use crate::cli::table_set;
use crate::cli::table_set::FoundTables;
use crate::cli::{Exit, Outcome, detect, load, module_set};
use crate::controller::{
    ControllerTarget, JudgedTables, LOCK_NAME, Lock, ReadBack, Replay, certify_kinematics, is_plain_name,
};
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::{Approach, Machine};
use crate::syntax::Disk;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
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

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    file_set::settle(session, &args.folder)?;
    let lock = file_set::existing_lock(&args.folder);
    // The tables hold for the tool they were made for.
    let made_for = lock.as_ref().map(|lock| lock.tool.clone()).filter(|name| !name.is_empty());
    let machine = load::machine(session, &args.machine, args.options.tool.clone().or(made_for).as_deref())?;
    warn_other_inputs(session, lock.as_ref());
    let set = detect::set(session, &machine, &args.folder, args.target.as_deref(), &args.options.how)?;
    session.checked()?;
    warn_edited(session, &args.folder, lock.as_ref());
    if set.target.manifest.kinematics().is_some() {
        return module(session, args, &machine, &set.target, &set.files);
    }
    let FoundTables { target, tables, files } = table_set::tables_of(session, &machine, &args.folder, set)?;
    warn_other_tool(session, &machine, &target, lock.as_ref());
    target.unplaced(&machine).into_iter().for_each(|warning| session.diagnostics.push(warning));
    let installed = table_set::installed(session, &machine, &target, &args.options, args.installed.as_deref())?;
    session.checked()?;
    if let Some(path) = &args.replay {
        let replay = Replay::new(&machine, &target, &tables);
        return print_replay(session, &machine, &target, &replay, path);
    }
    let judged = JudgedTables { target: &target, tables: &tables, installed: installed.as_ref() };
    let certificate = args.options.certificate(&machine, judged);
    warnings(&certificate).into_iter().for_each(|warning| session.diagnostics.push(warning));
    session.checked()?;
    CertificateView { machine: &machine, target: &target, certificate: &certificate, files, folder: &args.folder }
        .print(session);
    Ok(())
}

/// The certificate of a kinematics module.
fn module(
    session: &mut Session,
    args: &Args,
    machine: &Machine,
    target: &ControllerTarget,
    texts: &[ReadBack],
) -> Outcome {
    module_set::refuse_installed(session, args.installed.is_some())?;
    if args.replay.is_some() {
        return session.usage("--replay: a kinematics module has no tables that hold for a joint alone");
    }
    let (read, beside) = module_set::found(session, machine, target, &args.folder, &args.options.how, texts)?;
    let certificate = certify_kinematics(machine, target, (&read, &beside), args.options.depth());
    warnings(&certificate).into_iter().for_each(|warning| session.diagnostics.push(warning));
    session.checked()?;
    let files = texts.iter().map(|file| file.found.clone()).collect();
    CertificateView { machine, target, certificate: &certificate, files, folder: &args.folder }.print(session);
    Ok(())
}

/// Tables made from other files than those just read are judged all the same, and that is said.
fn warn_other_inputs(session: &mut Session, lock: Option<&Lock>) {
    let same = lock.is_none_or(|lock| lock.inputs == file_set::inputs(session));
    if !same {
        let message = "the tables were made from another machine file, or from other error tables, than these";
        session
            .diagnostics
            .push(Diagnostic::new(codes::W0702, message).help("compile again if the machine file has changed"));
    }
}

/// Tables that hold for one tool, judged with another.
fn warn_other_tool(session: &mut Session, machine: &Machine, target: &ControllerTarget, lock: Option<&Lock>) {
    let Some(lock) = lock else { return };
    let name = &machine.tool().name;
    if target.manifest.tool_dependent() && lock.tool != *name {
        let message = format!("the tables were made for the tool `{}` and are judged with `{name}`", lock.tool);
        let help = "the figures are those of the wrong tool at the machine; to load tables for it, compile with --tool";
        session.diagnostics.push(Diagnostic::new(codes::W0706, message).help(help));
    }
}

/// Files of the set that no longer are what its manifest says are said; its tables are read all the same.
fn warn_edited(session: &mut Session, folder: &Path, lock: Option<&Lock>) {
    let Some(lock) = lock else {
        let message =
            format!("`{}` has no readable {LOCK_NAME}: whether its files were edited cannot be told", folder.display());
        session
            .diagnostics
            .push(Diagnostic::new(codes::W0703, message).help("files found on a machine are judged as they are"));
        return;
    };
    for file in lock.files.iter().filter(|file| is_plain_name(&file.name)) {
        // A missing file has been said.
        let Ok(bytes) = read_at_most(&folder.join(&file.name), SET_LIMIT) else { continue };
        if !lock.wrote(&file.name, &bytes) {
            session
                .diagnostics
                .push(Diagnostic::new(codes::W0701, format!("`{}` has been edited since abbe wrote it", file.name)));
        }
    }
}

/// The replay at single positions: what a test of a real controller compares with.
fn print_replay(
    session: &mut Session,
    machine: &Machine,
    target: &ControllerTarget,
    replay: &Replay,
    path: &Path,
) -> Outcome {
    let read = crate::syntax::read_text(path, None, &Disk, &mut session.diagnostics);
    let Some((_, text)) = read else { return Err(Exit::Refused) };
    let letters =
        crate::controller::assigned_letters(machine, target.manifest.axis_letters.as_ref(), None).unwrap_or_default();
    let mut out = String::from("joint,direction,position,correction\n");
    let mut lines = text.lines();
    let header = lines.next().unwrap_or_default();
    if !header.replace(' ', "").starts_with("joint,direction,position") {
        let message = format!("`{}` does not begin with the header joint,direction,position", path.display());
        return session
            .refuse(Diagnostic::new(codes::E0802, message).help("further columns may follow; one position a line"));
    }
    for line in lines {
        let mut cells = line.split(',');
        let parsed = parse_replay_row(&mut cells, &letters);
        let Some((joint, axis, approach, position)) = parsed else {
            let message = format!("`{}`: `{line}` is not joint,direction,position", path.display());
            return session.refuse(
                Diagnostic::new(codes::E0802, message)
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
