//! Which target's files a folder holds: the one that is named, or that the set's manifest names; else the one whose
//! files are there by name; else the one that their content tells.

use super::Exit;
use super::how::{CompensationOptions, StoredArg};
use super::output::session::Session;
use super::store::file_set;
use super::store::files::{SET_LIMIT, read_at_most};
use crate::controller::{ControllerTarget, LOCK_NAME, Lock, NAMES, ReadBack, RecognisedSet, recognise};
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::Machine;
use std::path::Path;

/// A set's files, in their places.
pub(super) struct Set {
    pub target: ControllerTarget,
    pub files: Vec<ReadBack>,
}

/// The set in a folder, of whatever target it is, after a killed run is finished there.
pub(super) fn any_set(
    session: &mut Session,
    machine: &Machine,
    folder: &Path,
    how: &CompensationOptions,
) -> Result<Set, Exit> {
    file_set::settle(session, folder)?;
    let set = set(session, machine, folder, None, how)?;
    session.checked()?;
    Ok(set)
}

/// More files than any set has are not looked at, nor more bytes.
const MAX_FILES: usize = 200;
const MAX_BYTES: u64 = 4 * SET_LIMIT;

/// The set in a folder.
pub(super) fn set(
    session: &mut Session,
    machine: &Machine,
    folder: &Path,
    named: Option<&str>,
    how: &CompensationOptions,
) -> Result<Set, Exit> {
    let lock = file_set::existing_lock(folder);
    let stored = lock.as_ref().and_then(|lock| how.stored.or_else(|| StoredArg::of(&lock.options)));
    let named = named.map(str::to_owned).or_else(|| lock.as_ref().map(|lock| lock.target.clone()));
    let candidates = match named {
        Some(name) => vec![how.target(session, &name, stored)?],
        None => all_targets(session, how)?,
    };
    if let ([target], Some(lock)) = (&candidates[..], &lock) {
        let tables = target.table_files(machine);
        refuse_incomplete(session, folder, lock, &tables)?;
        // A set that had nothing to compensate.
        if lock.target == target.manifest.target
            && !lock.files.iter().any(|file| tables.contains(&file.name))
            && !tables.iter().any(|name| is_there(folder, name))
        {
            return Ok(Set { target: target.clone(), files: Vec::new() });
        }
    }
    let there = |target: &&ControllerTarget| target.table_files(machine).iter().any(|name| is_there(folder, name));
    let by_name: Vec<&ControllerTarget> = candidates.iter().filter(there).collect();
    if let [target] = by_name[..] {
        let mut wanted = target.table_files(machine);
        wanted.extend(target.index_files());
        wanted.retain(|name| is_there(folder, name));
        let files = file_set::read(folder, &wanted, &mut session.diagnostics);
        for name in target.foreign_files(machine).into_iter().filter(|name| is_there(folder, name)) {
            session.diagnostics.push(left_alone(&name, "the machine has no axis for it"));
        }
        return Ok(Set { target: target.clone(), files });
    }
    // Several targets by their names: those are the ones to choose from.
    let candidates = if by_name.is_empty() { candidates } else { by_name.into_iter().cloned().collect() };
    by_content(session, machine, folder, candidates)
}

fn is_there(folder: &Path, name: &str) -> bool {
    folder.join(name).symlink_metadata().is_ok()
}

/// Those of the binary, then those of the user's folder.
fn all_targets(session: &mut Session, how: &CompensationOptions) -> Result<Vec<ControllerTarget>, Exit> {
    let mut names: Vec<String> = NAMES.iter().map(|name| (*name).to_owned()).collect();
    names.extend(how.own_targets().into_iter().filter(|own| !NAMES.contains(&&**own)));
    names.into_iter().map(|name| how.target(session, &name, None)).collect()
}

/// A table that the set's manifest lists is part of it, whether or not its target could do without.
fn refuse_incomplete(session: &mut Session, folder: &Path, lock: &Lock, wanted: &[String]) -> Result<(), Exit> {
    let listed = lock.files.iter().filter(|file| wanted.contains(&file.name));
    let missing: Vec<&str> = listed.map(|file| &*file.name).filter(|name| !is_there(folder, name)).collect();
    for name in &missing {
        let message = format!("the file `{name}` is missing");
        let help = format!("{LOCK_NAME} lists it: a set of compensation files is only whole with all of them");
        session.diagnostics.push(Diagnostic::new(codes::E0705, message).help(help));
    }
    session.checked()
}

/// Files of any name.
fn by_content(
    session: &mut Session,
    machine: &Machine,
    folder: &Path,
    targets: Vec<ControllerTarget>,
) -> Result<Set, Exit> {
    let only = match &targets[..] {
        [target] => Some((target.manifest.target.clone(), target.table_files(machine).join(", "))),
        _ => None,
    };
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let regular = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file()));
    let mut names: Vec<String> = regular.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.retain(|name| name != LOCK_NAME && !name.starts_with('.'));
    names.sort();
    let (mut texts, mut bytes) = (Vec::new(), 0);
    for (number, name) in names.into_iter().enumerate() {
        let size = folder.join(&name).metadata().map_or(0, |metadata| metadata.len());
        if number >= MAX_FILES || bytes + size > MAX_BYTES {
            session.diagnostics.push(left_alone(&name, "the files before it are more than any set has"));
            break;
        }
        bytes += size;
        let text = read_at_most(&folder.join(&name), SET_LIMIT).ok().and_then(|bytes| String::from_utf8(bytes).ok());
        match text {
            Some(text) => texts.push((name, text)),
            None => session.diagnostics.push(left_alone(&name, "it is no text that can be read")),
        }
    }
    match recognise(machine, targets, &texts, &mut session.diagnostics) {
        Some(RecognisedSet { target, files }) => Ok(Set { target, files }),
        None => {
            session.checked()?;
            let Some((target, files)) = only else { return session.refuse(nothing_found(folder)) };
            let message =
                format!("there are no files of target `{target}` in `{}`, by name or by content", folder.display());
            session.refuse(Diagnostic::new(codes::E0705, message).help(format!("its tables are in {files}")))
        }
    }
}

fn left_alone(name: &str, why: &str) -> Diagnostic {
    let message = format!("`{}` is left alone: {why}", crate::diagnostic::shown(name));
    Diagnostic::new(codes::W0711, message).help("what is certified is the set without this file")
}

pub(super) fn nothing_found(folder: &Path) -> Diagnostic {
    Diagnostic::new(
        codes::E0705,
        format!("there are no compensation files of a known target in `{}`", folder.display()),
    )
    .help("name the folder that `compile --out` was given, and the target with --target")
}
