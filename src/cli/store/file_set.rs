//! A set of compensation files on disk: which of its files may be replaced. How they are, [`commit`] knows.
//!
//! Files that the manifest in the folder lists with their present bytes are ours and are replaced;
//! a file of the same name that is not is foreign or hand-edited and is refused; others are left alone.

use super::commit::{self, Decided};
use super::files::{SET_LIMIT, read_at_most};
use super::write;
use crate::cli::Outcome;
use crate::cli::output::session::Session;
use crate::controller::{ControllerTarget, Hashed, LOCK_NAME, Lock, ReadBack, RenderedFile};
use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use crate::syntax::ReadFailure;
use std::fs;
use std::path::Path;

/// Writes a set into a folder (made if it is not there), then its manifest.
pub(crate) fn write(folder: &Path, files: &[RenderedFile], lock: &Lock) -> Result<(), Diagnostic> {
    write::make_folder(folder)?;
    let _guard = commit::exclusive(folder).map_err(|failure| write::unwritable_folder(folder, &failure.to_string()))?;
    let readable = existing_lock(folder);
    // What a killed run had decided is ours too.
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
    gone.filter(|old| crate::controller::is_plain_name(&old.name)).cloned().collect()
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

/// The text of those of the named files that are in a folder, as the controller finds it: a byte order
/// mark is no letter of ours to take away.
pub(crate) fn read(folder: &Path, names: &[String], diagnostics: &mut Diagnostics) -> Vec<ReadBack> {
    let present = |name: &&String| fs::symlink_metadata(folder.join(name)).is_ok();
    let mut found = Vec::new();
    for name in names.iter().filter(present) {
        let text = read_at_most(&folder.join(name), SET_LIMIT)
            .map_err(|failure| unreadable(&failure))
            .and_then(|bytes| String::from_utf8(bytes).map_err(|_| "is not text in UTF-8".to_owned()));
        match text {
            Ok(text) => found.push(ReadBack::new(name, text)),
            Err(why) => diagnostics.push(
                Diagnostic::new(codes::E0704, format!("`{name}` {why}"))
                    .help("compile the file set again; do not edit compensation files by hand"),
            ),
        }
    }
    found
}

fn unreadable(failure: &ReadFailure) -> String {
    match failure {
        ReadFailure::NotAFile(word) => format!("is {word}, not a file"),
        ReadFailure::TooLarge(size, limit) => format!("has {size} bytes; no set has a file of more than {limit}"),
        ReadFailure::NotFound => "is a link to nothing".to_owned(),
        ReadFailure::Denied => "may not be read".to_owned(),
        ReadFailure::Other(words) => format!("cannot be read: {words}"),
    }
}

/// Finishes what a killed run left in a folder.
pub(crate) fn settle(session: &mut Session, folder: &Path) -> Outcome {
    match commit::settle(folder, &mut session.diagnostics) {
        Ok(()) => Ok(()),
        Err(refusal) => session.refuse(refusal),
    }
}

/// Every file read so far, by name, with its hash.
pub(crate) fn inputs(session: &Session) -> Vec<Hashed> {
    let sources = session.diagnostics.sources.iter();
    let plain = |name: &str| Path::new(name).file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    sources.map(|(name, text)| Hashed::new(plain(name), text.as_bytes())).collect()
}

/// Of rendered files that do not say what was meant.
pub(crate) fn misread(target: &ControllerTarget) -> Diagnostic {
    let name = &target.manifest.target;
    Diagnostic::new(codes::E0707, format!("the files of target `{name}` do not read back as what was to be written"))
        .help("its templates do not write what its manifest says; nothing was written")
}
