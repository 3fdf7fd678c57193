//! The target of the files in a folder: the one that is named, or that the set's manifest names; else the one whose
//! files are there by name; else the one that their content identifies.

use super::folder::{Folder, ignore_file};
use super::options::CompensationOptions;
use crate::controller::{ControllerTarget, LOCK_NAME, Lock, NAMES, ReadBack, RecognisedSet, recognise};
use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use crate::machine::Machine;
use crate::run::{Call, Refused};
use std::path::Path;

/// A set's files, in their places.
pub(crate) struct FoundSet {
    pub target: ControllerTarget,
    pub files: Vec<ReadBack>,
    /// The options that the caller states, and those of the set's manifest where he does not.
    pub options: CompensationOptions,
}

/// Finds the set in a folder; `named` is its target if the caller knows it.
pub(crate) fn find_set(
    call: &mut Call,
    machine: &Machine,
    path: &Path,
    named: Option<&str>,
    options: &CompensationOptions,
) -> Result<FoundSet, Refused> {
    let folder = Folder::new(path, call.run.files);
    let lock = folder.lock();
    if let Some(lock) = &lock {
        folder.refuse_odd(lock, &mut call.diagnostics);
        call.check()?;
    }
    let options = options.as_in(lock.as_ref());
    let (target, files) = target_and_files(call, machine, &folder, lock.as_ref(), named, &options)?;
    Ok(FoundSet { target, files, options })
}

fn target_and_files(
    call: &mut Call,
    machine: &Machine,
    folder: &Folder,
    lock: Option<&Lock>,
    named: Option<&str>,
    options: &CompensationOptions,
) -> Result<(ControllerTarget, Vec<ReadBack>), Refused> {
    let candidates = match named.or_else(|| lock.map(|lock| lock.target.as_str())) {
        Some(name) => vec![options.target(call, name)?],
        None => all_targets(call, options)?,
    };
    if let [target] = &candidates[..] {
        refuse_assumed_axes(call, machine, target)?;
    }
    if let ([target], Some(lock)) = (&candidates[..], lock) {
        let tables = target.table_files(machine);
        refuse_incomplete(call, folder, lock, &tables)?;
        // A set that had nothing to compensate.
        if lock.target == target.manifest.target
            && !lock.files.iter().any(|file| tables.contains(&file.name))
            && !tables.iter().any(|name| folder.has(name))
        {
            return Ok((target.clone(), Vec::new()));
        }
    }
    let there = |target: &&ControllerTarget| target.table_files(machine).iter().any(|name| folder.has(name));
    let by_name: Vec<&ControllerTarget> = candidates.iter().filter(there).collect();
    if let [target] = by_name[..] {
        refuse_assumed_axes(call, machine, target)?;
        let files = read_by_name(call, machine, folder, target)?;
        for name in target.foreign_files(machine).into_iter().filter(|name| folder.has(name)) {
            call.warn(ignore_file(&name, "the machine has no axis for it"));
        }
        return Ok((target.clone(), files));
    }
    // Several targets by their names: those are the ones to choose from.
    let candidates = if by_name.is_empty() { candidates } else { by_name.into_iter().cloned().collect() };
    by_content(call, machine, folder, candidates)
}

/// The files of a target by their names, and those by their content that put others in force.
fn read_by_name(
    call: &mut Call,
    machine: &Machine,
    folder: &Folder,
    target: &ControllerTarget,
) -> Result<Vec<ReadBack>, Refused> {
    let named = target.index_files();
    let wanted = [target.table_files(machine), named.clone(), target.code_files()].concat();
    let mut files = folder.read(&wanted, &mut call.diagnostics);
    if !named.is_empty() {
        let (own, others): (Vec<_>, Vec<_>) = folder
            .texts(&mut Diagnostics::default())
            .into_iter()
            .filter(|(name, _)| named.contains(name) || !wanted.contains(name))
            .partition(|(name, _)| named.contains(name));
        let texts = [own, others].concat();
        let found = target.find_indices(machine, &texts, &mut call.diagnostics).ok_or(Refused)?;
        files.extend(found.into_iter().map(|index| index.file).filter(|file| file.found != file.name));
        // One that says the same as the controller's own takes its place.
        let mut names: Vec<String> = Vec::new();
        files.retain(|file| {
            !names.contains(&file.name) && {
                names.push(file.name.clone());
                true
            }
        });
    }
    Ok(files)
}

/// Returns the target of the tables in a folder, by its manifest or by the names of the files;
/// `None` if there are none.
pub(crate) fn tables_there(
    call: &mut Call,
    machine: &Machine,
    path: &Path,
    options: &CompensationOptions,
) -> Result<Option<String>, Refused> {
    let folder = Folder::new(path, call.run.files);
    let lock = folder.lock();
    let there = |target: &ControllerTarget| match &lock {
        Some(lock) => lock.target == target.manifest.target,
        None => target.table_files(machine).iter().any(|name| folder.has(name)),
    };
    let all = all_targets(call, options)?;
    let tables = all.into_iter().find(|target| target.manifest.kinematics().is_none() && there(target));
    Ok(tables.map(|target| target.manifest.target))
}

/// Those of the binary, then those of the user's folder.
fn all_targets(call: &mut Call, options: &CompensationOptions) -> Result<Vec<ControllerTarget>, Refused> {
    let mut names: Vec<String> = NAMES.iter().map(|name| (*name).to_owned()).collect();
    names.extend(options.own_targets(call.run.files).into_iter().filter(|own| !NAMES.contains(&&**own)));
    // Files say their scales themselves, and most targets have none.
    let options = &CompensationOptions { scale: Vec::new(), ..options.clone() };
    names.into_iter().map(|name| options.target(call, &name)).collect()
}

/// Refuses axes of the machine whose letter or number in the target's files would be an assumption.
pub(crate) fn refuse_assumed_axes(
    call: &mut Call,
    machine: &Machine,
    target: &ControllerTarget,
) -> Result<(), Refused> {
    let Some(letters) = &target.manifest.axis_letters else { return Ok(()) };
    call.extend(letters.refusal(machine, &target.manifest.target));
    call.check()
}

/// A table that the set's manifest lists is part of it, whether or not its target could do without.
fn refuse_incomplete(call: &mut Call, folder: &Folder, lock: &Lock, tables: &[String]) -> Result<(), Refused> {
    let listed = lock.files.iter().filter(|file| tables.contains(&file.name));
    for file in listed.filter(|file| !folder.has(&file.name)) {
        let message = format!("the file `{}` is missing", file.name);
        let help = format!("{LOCK_NAME} lists it: a set of compensation files is only whole with all of them");
        call.diagnostics.push(Diagnostic::new(codes::E0705, message).help(help));
    }
    call.check()
}

/// Files of any name.
fn by_content(
    call: &mut Call,
    machine: &Machine,
    folder: &Folder,
    targets: Vec<ControllerTarget>,
) -> Result<(ControllerTarget, Vec<ReadBack>), Refused> {
    let only = match &targets[..] {
        [target] => Some((target.manifest.target.clone(), target.table_files(machine).join(", "))),
        _ => None,
    };
    let texts = folder.texts(&mut call.diagnostics);
    if let Some(RecognisedSet { target, files }) = recognise(machine, targets, &texts, &mut call.diagnostics) {
        refuse_assumed_axes(call, machine, &target)?;
        return Ok((target, files));
    }
    call.check()?;
    let Some((target, files)) = only else { return call.refuse(nothing_found(folder.path)) };
    let message =
        format!("there are no files of target `{target}` in `{}`, by name or by content", folder.path.display());
    call.refuse(Diagnostic::new(codes::E0705, message).help(format!("its tables are in {files}")))
}

/// Refuses a folder without a set.
pub(crate) fn nothing_found(folder: &Path) -> Diagnostic {
    Diagnostic::new(
        codes::E0705,
        format!("there are no compensation files of a known target in `{}`", folder.display()),
    )
    .help("name the folder that `compile --out` was given, and the target with --target")
}
