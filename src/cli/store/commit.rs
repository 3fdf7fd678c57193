//! Several files replaced as one: after a kill at any moment, the folder holds the old set or can be brought to the new
//! one.
//!
//! 1. Every file is written under a temporary name beside its place, and synced.
//! 2. One rename puts in place a list of the replacements: from here on the new set is decided.
//! 3. The files are renamed, those that the new set no longer has are removed, and last the list.
//!
//! A run killed before 2 has changed nothing. One killed after it is finished by [`settle`] as soon as the folder
//! is read, or replaced by the next set. Whoever does any of this holds the folder ([`exclusive`]).

use super::files::{SET_LIMIT, read_at_most};
use super::write::unwritable_folder;
use abbe::sets::{Hashed, RenderedFile, is_plain_name, sha256};
use abbe::{Diagnostic, Diagnostics, codes};
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Name of the list of a decided replacement.
const LIST_NAME: &str = ".abbe-set.json";

/// A replacement that is decided.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Decided {
    /// Number of the run that decided it: part of its temporary names.
    run: u32,
    files: Vec<Replaced>,
    /// Files that the new set does not have, with their bytes.
    removed: Vec<Hashed>,
}

#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
struct Replaced {
    name: String,
    sha256: String,
    /// Hash of the file that was there before, if there was one.
    before: Option<String>,
}

/// Holds the folder until it is dropped: two runs at once would mix their sets.
pub(crate) fn exclusive(folder: &Path) -> std::io::Result<fs::File> {
    let handle = fs::File::open(folder)?;
    match handle.lock() {
        // A file system without locks: nothing to hold.
        Err(failure) if failure.kind() != ErrorKind::Unsupported => Err(failure),
        _ => Ok(handle),
    }
}

/// Replaces files and removes others. The folder is held.
pub(crate) fn replace(folder: &Path, files: &[&RenderedFile], removed: &[Hashed]) -> Result<(), Diagnostic> {
    let before = left_over(folder);
    // No number of the process: in a container that is always the same.
    let run = before.iter().map(|(run, _)| *run).max().unwrap_or(0).saturating_add(1);
    let staged = Staged::write(folder, files, run)?;
    let entry = |file: &&RenderedFile| Replaced {
        name: file.name.clone(),
        sha256: sha256(&file.bytes),
        before: hash(&folder.join(&file.name)),
    };
    let decided = Decided { run, files: files.iter().map(entry).collect(), removed: removed.to_vec() };
    staged.decide(folder, &decided)?;
    let half = |(name, failure): (String, std::io::Error)| {
        Diagnostic::new(codes::E0810, format!("cannot replace `{name}`: {failure}")).help(
            "the set in this folder is half replaced: the next `verify` or `compile` that can write there finishes it",
        )
    };
    decided.carry_out(folder).map_err(half)?;
    before.iter().for_each(|(_, path)| drop(fs::remove_file(path)));
    Ok(())
}

/// Finishes a set that a killed run had decided (W0712), or reports that the run had decided nothing (W0713). Refuses a
/// set that cannot be finished (E0733).
pub(crate) fn settle(folder: &Path, diagnostics: &mut Diagnostics) -> Result<(), Diagnostic> {
    let list = folder.join(LIST_NAME);
    if list.symlink_metadata().is_err() && left_over(folder).is_empty() {
        return Ok(());
    }
    // A run that is still at work is waited for.
    let _guard = exclusive(folder).map_err(|failure| unfinished(folder, &failure.to_string()))?;
    if list.symlink_metadata().is_ok() {
        let decided =
            Decided::of(folder).ok_or_else(|| unfinished(folder, &format!("`{LIST_NAME}` is not readable")))?;
        decided.possible(folder)?;
        decided.carry_out(folder).map_err(|(name, failure)| unfinished(folder, &format!("`{name}`: {failure}")))?;
        let message = format!("a run was killed while it replaced the set in `{}`", folder.display());
        let help = "all of the new set had been written: it has been put in place";
        diagnostics.push(Diagnostic::new(codes::W0712, message).help(help));
    }
    let left = left_over(folder);
    if !left.is_empty() {
        let message = format!("a run was killed before it had written the whole of its set to `{}`", folder.display());
        let help =
            format!("the set that was there is as it was; {} temporary files go with the next compile", left.len());
        diagnostics.push(Diagnostic::new(codes::W0713, message).help(help));
    }
    Ok(())
}

fn unfinished(folder: &Path, why: &str) -> Diagnostic {
    Diagnostic::new(
        codes::E0733,
        format!("the set in `{}` is half replaced, a run was killed: {why}", folder.display()),
    )
    .help("load none of its files; compile again into this folder, or make it writable and verify again")
}

impl Decided {
    /// Returns the decided set of a folder, if there is one.
    pub(crate) fn of(folder: &Path) -> Option<Self> {
        let bytes = read_at_most(&folder.join(LIST_NAME), SET_LIMIT).ok()?;
        let decided: Self = serde_json::from_slice(&bytes).ok()?;
        let names = decided.files.iter().map(|file| &file.name).chain(decided.removed.iter().map(|file| &file.name));
        names.into_iter().all(|name| is_plain_name(name)).then_some(decided)
    }

    /// Files of the new set: ours, under their temporary or final name.
    pub(crate) fn files(&self) -> impl Iterator<Item = Hashed> {
        self.files.iter().map(|file| Hashed { name: file.name.clone(), sha256: file.sha256.clone() })
    }

    /// Checks that every file needed to finish is there, and that nothing was touched since.
    fn possible(&self, folder: &Path) -> Result<(), Diagnostic> {
        for file in &self.files {
            let there = hash(&folder.join(&file.name));
            if there.as_ref() == Some(&file.sha256) {
                continue;
            }
            if there != file.before {
                return Err(unfinished(folder, &format!("`{}` has been changed since", file.name)));
            }
            if hash(&self.temporary(folder, &file.name)).as_ref() != Some(&file.sha256) {
                return Err(unfinished(folder, &format!("its new `{}` is lost", file.name)));
            }
        }
        Ok(())
    }

    fn temporary(&self, folder: &Path, name: &str) -> PathBuf {
        folder.join(temporary_name(name, self.run))
    }

    /// Brings the folder to the new set, from any state in between.
    fn carry_out(&self, folder: &Path) -> Result<(), (String, std::io::Error)> {
        for file in &self.files {
            match fs::rename(self.temporary(folder, &file.name), folder.join(&file.name)) {
                // Renamed by the run that was killed.
                Err(failure) if failure.kind() != ErrorKind::NotFound => return Err((file.name.clone(), failure)),
                _ => {}
            }
        }
        for old in &self.removed {
            let path = folder.join(&old.name);
            let untouched = hash(&path).is_some_and(|there| there == old.sha256);
            if untouched {
                // A file that will not go stays: it is only not ours any more.
                let _ = fs::remove_file(&path);
            }
        }
        sync(folder);
        fs::remove_file(folder.join(LIST_NAME)).map_err(|failure| (LIST_NAME.to_owned(), failure))
    }
}

/// SHA-256 of a regular file; none if there is no such file.
fn hash(path: &Path) -> Option<String> {
    let regular = fs::symlink_metadata(path).is_ok_and(|metadata| metadata.is_file());
    regular.then(|| read_at_most(path, SET_LIMIT).ok()).flatten().map(|bytes| sha256(&bytes))
}

/// Makes renames last. A file system that cannot do it for folders does it on its own terms.
fn sync(folder: &Path) {
    let _ = fs::File::open(folder).and_then(|handle| handle.sync_all());
}

const TEMPORARY: &str = ".abbe-set";

fn temporary_name(name: &str, run: u32) -> String {
    format!(".{name}.{run}{TEMPORARY}")
}

/// Temporary files of runs that were killed, with the numbers of the runs. Whoever holds the folder has no other.
fn left_over(folder: &Path) -> Vec<(u32, PathBuf)> {
    let run = |name: &str| {
        let (name, run) = name.strip_prefix('.')?.strip_suffix(TEMPORARY)?.rsplit_once('.')?;
        run.parse().ok().filter(|_| !name.is_empty())
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let regular = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file()));
    regular.filter_map(|entry| Some((run(&entry.file_name().to_string_lossy())?, entry.path()))).collect()
}

/// Files under temporary names, removed when it is dropped undecided.
struct Staged {
    run: u32,
    paths: Vec<PathBuf>,
}

impl Staged {
    fn write(folder: &Path, files: &[&RenderedFile], run: u32) -> Result<Self, Diagnostic> {
        let mut staged = Self { run, paths: Vec::new() };
        for file in files {
            staged
                .add(folder, &file.name, &file.bytes)
                .map_err(|failure| unwritable_folder(folder, &failure.to_string()))?;
        }
        Ok(staged)
    }

    fn add(&mut self, folder: &Path, name: &str, bytes: &[u8]) -> std::io::Result<PathBuf> {
        let path = folder.join(temporary_name(name, self.run));
        let mut handle = fs::OpenOptions::new().write(true).create_new(true).open(&path)?;
        self.paths.push(path.clone());
        handle.write_all(bytes)?;
        handle.sync_all()?;
        Ok(path)
    }

    /// The list in its place: the files are the new set's from now on.
    fn decide(mut self, folder: &Path, decided: &Decided) -> Result<(), Diagnostic> {
        let text = serde_json::to_vec_pretty(decided).unwrap_or_default();
        let listed = self.add(folder, LIST_NAME, &text).and_then(|path| fs::rename(path, folder.join(LIST_NAME)));
        listed.map_err(|failure| unwritable_folder(folder, &failure.to_string()))?;
        sync(folder);
        self.paths.clear();
        Ok(())
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        for path in &self.paths {
            let _ = fs::remove_file(path);
        }
    }
}
