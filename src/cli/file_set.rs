//! A set of compensation files on disk: written beside what is there and renamed, manifest last.
//!
//! Files that the manifest in the folder lists with their present bytes are ours and are replaced;
//! a file of the same name that is not is foreign or hand-edited and is refused; others are left alone.

use super::files::{SET_LIMIT, read_at_most};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::syntax::ReadFailure;
use crate::target::{LOCK_NAME, Lock, RenderedFile};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes a set into a folder (made if it is not there), then its manifest.
pub(super) fn write(folder: &Path, files: &[RenderedFile], lock: &Lock) -> Result<(), Diagnostic> {
    fs::create_dir_all(folder).map_err(|failure| unwritable(folder, &failure.to_string()))?;
    let _guard = exclusive(folder)?;
    let mut old = existing_lock(folder);
    let left = left_over(folder);
    // A run that was killed between its renames: files that its manifest names are ours too.
    if let Some(lock) = &mut old {
        let half_written = left.iter().filter(|path| path.to_string_lossy().contains(LOCK_NAME));
        lock.files.extend(half_written.filter_map(|path| lock_at(path)).flat_map(|lock| lock.files));
    }
    let manifest = RenderedFile { name: LOCK_NAME.to_owned(), bytes: lock.to_text().into_bytes() };
    for file in files {
        refuse_foreign(folder, file, old.as_ref())?;
    }
    refuse_odd_manifest(folder, old.is_some())?;
    let all: Vec<&RenderedFile> = files.iter().chain([&manifest]).collect();
    Beside::write(folder, &all)?.rename(folder)?;
    left.iter().for_each(|path| drop(fs::remove_file(path)));
    // Last, so that whatever fails before leaves the old set whole.
    remove_stale(folder, files, old.as_ref());
    Ok(())
}

/// Holds the folder until it is dropped: two runs at once would mix their sets.
fn exclusive(folder: &Path) -> Result<fs::File, Diagnostic> {
    let handle = fs::File::open(folder).map_err(|failure| unwritable(folder, &failure.to_string()))?;
    match handle.lock() {
        Ok(()) => Ok(handle),
        // A file system without locks: nothing to hold, as before.
        Err(failure) if failure.kind() == std::io::ErrorKind::Unsupported => Ok(handle),
        Err(failure) => Err(unwritable(folder, &failure.to_string())),
    }
}

/// The manifest of the set that is in the folder.
pub(super) fn existing_lock(folder: &Path) -> Option<Lock> {
    lock_at(&folder.join(LOCK_NAME))
}

fn lock_at(path: &Path) -> Option<Lock> {
    let bytes = read_at_most(path, SET_LIMIT).ok()?;
    Lock::from_text(&String::from_utf8(bytes).ok()?)
}

/// Temporary files of runs that were killed: `.NAME.PID.tmp`. Whoever holds the folder has no other.
fn left_over(folder: &Path) -> Vec<PathBuf> {
    let ours = |name: &str| {
        let middle = name.strip_prefix('.').and_then(|n| n.strip_suffix(".tmp")).and_then(|n| n.rsplit_once('.'));
        middle.is_some_and(|(name, pid)| !name.is_empty() && pid.bytes().all(|b| b.is_ascii_digit()))
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let regular = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file()));
    regular.filter(|entry| ours(&entry.file_name().to_string_lossy())).map(|entry| entry.path()).collect()
}

fn refuse_foreign(folder: &Path, file: &RenderedFile, old: Option<&Lock>) -> Result<(), Diagnostic> {
    let path = folder.join(&file.name);
    let Ok(metadata) = fs::symlink_metadata(&path) else { return Ok(()) };
    if !metadata.is_file() {
        return Err(foreign(&path, "is not a regular file"));
    }
    match read_at_most(&path, SET_LIMIT) {
        // The bytes we would write anyway: nothing of anybody's is lost.
        Ok(bytes) if bytes == file.bytes => Ok(()),
        Ok(bytes) if old.is_some_and(|lock| lock.wrote(&file.name, &bytes)) => Ok(()),
        Ok(_) if old.is_some_and(|lock| lock.files.iter().any(|f| f.name == file.name)) => {
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
    Diagnostic::new("E0706", format!("`{}` {why}", path.display()))
        .help("move it away, or give another folder to --out; nothing was written")
}

fn unwritable(path: &Path, why: &str) -> Diagnostic {
    Diagnostic::new("E0810", format!("cannot write to `{}`: {why}", path.display()))
        .help("name a folder that you may write to; nothing was written")
}

/// Our own earlier files that the new set does not have, if nobody touched them.
fn remove_stale(folder: &Path, files: &[RenderedFile], old: Option<&Lock>) {
    let Some(lock) = old else { return };
    let gone = lock.files.iter().filter(|old| !files.iter().any(|new| new.name == old.name));
    for old in gone.filter(|old| crate::target::is_plain_name(&old.name)) {
        let path = folder.join(&old.name);
        let regular = fs::symlink_metadata(&path).is_ok_and(|m| m.is_file());
        if regular && read_at_most(&path, SET_LIMIT).is_ok_and(|bytes| lock.wrote(&old.name, &bytes)) {
            // A file that will not go stays: it is only not ours any more.
            let _ = fs::remove_file(&path);
        }
    }
}

/// Files written under temporary names; those not yet renamed are removed when it is dropped.
struct Beside(Vec<(PathBuf, String)>);

impl Beside {
    fn write(folder: &Path, files: &[&RenderedFile]) -> Result<Self, Diagnostic> {
        let mut beside = Self(Vec::new());
        for file in files {
            let path = folder.join(format!(".{}.{}.tmp", file.name, std::process::id()));
            let mut create = fs::OpenOptions::new();
            let made = create.write(true).create_new(true).open(&path);
            let mut handle = made.map_err(|failure| unwritable(folder, &failure.to_string()))?;
            beside.0.push((path, file.name.clone()));
            let written = handle.write_all(&file.bytes).and_then(|()| handle.sync_all());
            written.map_err(|failure| unwritable(folder, &failure.to_string()))?;
        }
        Ok(beside)
    }

    fn rename(mut self, folder: &Path) -> Result<(), Diagnostic> {
        for (temporary, name) in &self.0 {
            fs::rename(temporary, folder.join(name)).map_err(|failure| {
                Diagnostic::new("E0810", format!("cannot replace `{name}`: {failure}"))
                    .help("the set in this folder is incomplete: compile again before loading it")
            })?;
        }
        self.0.clear();
        Ok(())
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        for (temporary, _) in &self.0 {
            let _ = fs::remove_file(temporary);
        }
    }
}

/// The text of those of the named files that are in a folder, as the controller finds it: a byte order
/// mark is no letter of ours to take away.
pub(super) fn read(folder: &Path, names: &[String], diagnostics: &mut Diagnostics) -> Vec<(String, String)> {
    let present = |name: &&String| fs::symlink_metadata(folder.join(name)).is_ok();
    let mut found = Vec::new();
    for name in names.iter().filter(present) {
        let text = read_at_most(&folder.join(name), SET_LIMIT)
            .map_err(|failure| unreadable(&failure))
            .and_then(|bytes| String::from_utf8(bytes).map_err(|_| "is not text in UTF-8".to_owned()));
        match text {
            Ok(text) => found.push((name.clone(), text)),
            Err(why) => diagnostics.push(
                Diagnostic::new("E0704", format!("`{name}` {why}"))
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
