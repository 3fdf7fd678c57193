//! A set of compensation files on disk: the files that may be replaced. [`commit`] replaces them.
//!
//! Files that the manifest in the folder lists with their present bytes are ours and are replaced;
//! a file of the same name that is not is foreign or hand-edited and is refused; others are not touched.

use super::commit::{self, Decided};
use super::files::{SET_LIMIT, read_at_most};
use super::write;
use crate::cli::Outcome;
use crate::cli::output::session::Session;
use abbe::results::ReadFailure;
use abbe::sets::{Hashed, LOCK_NAME, Lock, RenderedFile, is_plain_name};
use abbe::{Diagnostic, codes};
use std::fs;
use std::path::Path;

/// Writes a set into a folder (made if it is not there), then its manifest.
pub(crate) fn write(folder: &Path, files: &[RenderedFile], lock: &Lock) -> Result<(), Diagnostic> {
    write::make_folder(folder)?;
    let _guard = commit::exclusive(folder).map_err(|failure| write::unwritable_folder(folder, &failure.to_string()))?;
    let readable = existing_lock(folder);
    // Files that a killed run had decided are ours too.
    let half_written: Vec<Hashed> = Decided::of(folder).iter().flat_map(Decided::files).collect();
    refuse_odd_manifest(folder, readable.is_some())?;
    let ours = [readable.map_or_else(Vec::new, |lock| lock.files), half_written].concat();
    for file in files {
        refuse_foreign(folder, file, &ours)?;
    }
    let manifest = RenderedFile { name: LOCK_NAME.to_owned(), bytes: lock.to_text().into_bytes() };
    let all: Vec<&RenderedFile> = files.iter().chain([&manifest]).collect();
    commit::replace(folder, &all, &stale(&ours, &all))
}

/// Our own earlier files that the new set does not have.
fn stale(ours: &[Hashed], files: &[&RenderedFile]) -> Vec<Hashed> {
    let gone = ours.iter().filter(|old| !files.iter().any(|new| new.name == old.name));
    gone.filter(|old| is_plain_name(&old.name)).cloned().collect()
}

/// The manifest of the set that is in the folder.
pub(crate) fn existing_lock(folder: &Path) -> Option<Lock> {
    lock_at(&folder.join(LOCK_NAME))
}

fn lock_at(path: &Path) -> Option<Lock> {
    let bytes = read_at_most(path, SET_LIMIT).ok()?;
    Lock::from_text(&String::from_utf8(bytes).ok()?)
}

fn refuse_foreign(folder: &Path, file: &RenderedFile, ours: &[Hashed]) -> Result<(), Diagnostic> {
    let path = folder.join(&file.name);
    let Ok(metadata) = fs::symlink_metadata(&path) else { return Ok(()) };
    if !metadata.is_file() {
        return Err(foreign(&path, "is not a regular file"));
    }
    match read_at_most(&path, SET_LIMIT) {
        // The bytes we would write anyway: nothing of anybody's is lost.
        Ok(bytes) if bytes == file.bytes => Ok(()),
        Ok(bytes) if ours.contains(&Hashed::new(&file.name, &bytes)) => Ok(()),
        Ok(_) if ours.iter().any(|known| known.name == file.name) => {
            Err(foreign(&path, "has been edited since abbe wrote it"))
        }
        Ok(_) => Err(foreign(&path, "was not written by abbe")),
        Err(ReadFailure::TooLarge(..)) => Err(foreign(&path, "is larger than anything abbe reads back")),
        Err(_) => Err(foreign(&path, "cannot be read")),
    }
}

/// A manifest that is not one of ours is somebody's file.
fn refuse_odd_manifest(folder: &Path, readable: bool) -> Result<(), Diagnostic> {
    let path = folder.join(LOCK_NAME);
    let there = fs::symlink_metadata(&path);
    match there {
        Ok(metadata) if !metadata.is_file() || !readable => Err(foreign(&path, "is no manifest that abbe wrote")),
        _ => Ok(()),
    }
}

fn foreign(path: &Path, why: &str) -> Diagnostic {
    Diagnostic::new(codes::E0706, format!("`{}` {why}", path.display()))
        .help("move it away, or give another folder to --out; nothing was written")
}

/// Finishes the set that a killed run began in a folder.
pub(crate) fn settle(session: &mut Session, folder: &Path) -> Outcome {
    match commit::settle(folder, &mut session.diagnostics) {
        Ok(()) => Ok(()),
        Err(refusal) => session.refuse(refusal),
    }
}
