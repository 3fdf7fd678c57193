//! The set that a run of `compile` replaces, kept in a folder of the calibration.

use super::tree::write_new_folder;
use crate::cli::Outcome;
use crate::cli::output::session::Session;
use abbe::sets::{LOCK_NAME, RESTORE_FOLDER, SetFault, set_files, sha256};
use abbe::{Diagnostic, Disk, codes};
use std::path::{Component, Path, PathBuf};

/// Folder of archived sets.
const REPLACED: &str = "replaced";

/// Refuses, before any work, an archive that lies in the folder of the set.
pub(crate) fn refuse_inside(session: &Session, record: &Path, out: &Path) -> Outcome {
    if !resolve(record).starts_with(resolve(out)) {
        return Ok(());
    }
    session.usage("--record lies in --out: what is archived there would lie among the files of the controller")
}

/// Copies the set in `out`, with the one that takes it back, into `record`, to `replaced/` and the first 16 digits of
/// the hash of its manifest. Nothing is copied if there is no set, or if it is there already.
pub(crate) fn keep(session: &mut Session, record: &Path, out: &Path) -> Outcome {
    match archive_folder(record, out) {
        Ok(Some(folder)) => session.say(&format!("archived the set that is replaced: {}", folder.display())),
        Ok(None) => {}
        Err(refusal) => return session.refuse(refusal),
    }
    Ok(())
}

fn archive_folder(record: &Path, out: &Path) -> Result<Option<PathBuf>, Diagnostic> {
    if out.join(LOCK_NAME).symlink_metadata().is_err() {
        return Ok(None);
    }
    let set = set_files(&Disk, out).map_err(|fault| unwhole(out, &fault))?;
    let digits: String = set.files.first().map(|(_, lock)| sha256(lock)).unwrap_or_default().chars().take(16).collect();
    let folder = record.join(REPLACED).join(digits);
    let mut files = set.files;
    let restore = out.join(RESTORE_FOLDER);
    match set_files(&Disk, &restore) {
        Ok(back) => {
            files.extend(back.files.into_iter().map(|(name, bytes)| (format!("{RESTORE_FOLDER}/{name}"), bytes)))
        }
        // Sets of earlier versions have none.
        Err(SetFault::NoManifest) => {}
        Err(fault) => return Err(unwhole(&restore, &fault)),
    }
    write_new_folder(&folder, &files).map(|()| Some(folder))
}

fn unwhole(out: &Path, fault: &SetFault) -> Diagnostic {
    let message = format!("`{}` {fault}: it cannot be archived", out.display());
    Diagnostic::new(codes::E0706, message)
        .help("move its files away by hand, or leave --record out; nothing was written")
}

/// A path with links resolved as far as it is there, and the rest by name.
fn resolve(path: &Path) -> PathBuf {
    let mut rest: Vec<Component<'_>> = path.components().collect();
    let mut beyond = Vec::new();
    loop {
        let head: PathBuf = rest.iter().collect();
        let head = if head.as_os_str().is_empty() { PathBuf::from(".") } else { head };
        if let Ok(found) = head.canonicalize() {
            return beyond.iter().rev().fold(found, |mut path, part: &Component<'_>| {
                match part {
                    Component::ParentDir => drop(path.pop()),
                    part => path.push(part),
                }
                path
            });
        }
        match rest.pop() {
            Some(part) => beyond.push(part),
            None => return path.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_that_are_not_there_yet_are_placed() {
        let top = std::env::temp_dir().canonicalize().unwrap();
        assert_eq!(resolve(&top.join("no-such/./a/../b")), top.join("no-such/b"));
        assert!(resolve(Path::new("no-such/x")).is_absolute());
        assert!(resolve(&top.join("none/deep")).starts_with(resolve(&top.join("none"))));
        assert!(!resolve(&top.join("none2")).starts_with(resolve(&top.join("none"))));
    }
}
