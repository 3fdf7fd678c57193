//! Several files replaced as one: after a kill at any moment, the folder holds the old set, or says that it is half
//! replaced until a set is compiled into it again.
//!
//! 1. Every file is written under a temporary name beside its place, and synced.
//! 2. One rename puts in place a list of the replacements: from here on the new set is decided.
//! 3. The tables are renamed, those that the new set no longer has are removed, then the manifest takes its place,
//!    and last the list goes.
//!
//! A run killed before 2 has changed nothing. After one killed later, the folder is refused ([`check`]) until a run
//! that may write there replaces the set. A reader changes nothing: whoever handed the folder over may have written the
//! list. Whoever does any of this holds the folder ([`exclusive`]).

use super::files::{SET_LIMIT, read_at_most};
use super::limited::LimitedWriter;
use super::write::unwritable_folder;
use abbe::sets::{Hashed, LOCK_NAME, Lock, RenderedFile, is_plain_name, sha256};
use abbe::{Diagnostic, Diagnostics, codes};
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Name of the list of a decided replacement.
pub(super) const LIST_NAME: &str = ".abbe-set.json";

#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Decided {
    /// Number of the run that decided it: part of its temporary names.
    run: u32,
    files: Vec<Hashed>,
}

/// Holds the folder until it is dropped: two runs at once would mix their sets. Windows locks no folders: there it is a
/// file that nobody else may open, and that goes with its handle.
#[cfg(windows)]
pub(crate) fn exclusive(folder: &Path) -> std::io::Result<fs::File> {
    use std::os::windows::fs::OpenOptionsExt;
    const WRITE_AND_DELETE: u32 = 0x4001_0000;
    const DELETE_ON_CLOSE: u32 = 0x0400_0000;
    const SHARING_VIOLATION: i32 = 32;
    let mut options = fs::OpenOptions::new();
    options.write(true).create(true).share_mode(0).access_mode(WRITE_AND_DELETE).custom_flags(DELETE_ON_CLOSE);
    loop {
        match options.open(folder.join(".abbe-held")) {
            Err(failure) if failure.raw_os_error() == Some(SHARING_VIOLATION) => {
                std::thread::sleep(std::time::Duration::from_millis(50));
            }
            opened => return opened,
        }
    }
}

/// Holds the folder until it is dropped: two runs at once would mix their sets.
#[cfg(not(windows))]
pub(crate) fn exclusive(folder: &Path) -> std::io::Result<fs::File> {
    let handle = fs::File::open(folder)?;
    match handle.lock() {
        // A file system without locks: nothing to hold.
        Err(failure) if failure.kind() != ErrorKind::Unsupported => Err(failure),
        _ => Ok(handle),
    }
}

/// A set that takes the place of another.
pub(crate) struct Replacement<'a> {
    pub files: &'a [RenderedFile],
    /// Its manifest.
    pub lock: Lock,
    /// Files of the old set, with their bytes, that the new set does not have.
    pub removed: Vec<Hashed>,
    /// True for a path that stays whatever its name.
    pub kept: &'a dyn Fn(&Path) -> bool,
}

/// A file of an old set that is still in the folder, and why.
pub(crate) struct Stale {
    pub file: Hashed,
    pub why: String,
}

/// A replacement whose files are written under temporary names; they go if it is not carried out.
pub(crate) struct StagedReplacement<'a> {
    replacement: Replacement<'a>,
    staged: StagedFiles,
    decided: Decided,
    /// Temporary files of runs that were killed.
    before: Vec<(u32, PathBuf)>,
}

impl StagedReplacement<'_> {
    /// Replaces files and removes others; returns those that could not be removed. The folder is held. What is done
    /// `between` decision and replacement is a part of it.
    pub(crate) fn carry_out(
        self,
        folder: &Path,
        between: impl FnOnce() -> Result<(), Diagnostic>,
    ) -> Result<Vec<Stale>, Diagnostic> {
        let Self { mut replacement, staged, decided, before } = self;
        staged.decide(folder, &decided)?;
        between().map_err(|refusal| refusal.help(HALF))?;
        let placed = replacement.put_in_place(folder, decided.run);
        let stale = placed.map_err(|(name, failure)| half_replaced(&name, &failure))?;
        let ours = before.iter().filter(|(_, path)| !(replacement.kept)(path));
        ours.for_each(|(_, path)| drop(fs::remove_file(path)));
        Ok(stale)
    }
}

impl<'a> Replacement<'a> {
    /// Writes every file under a temporary name. The folder is held.
    pub(crate) fn stage(self, folder: &Path) -> Result<StagedReplacement<'a>, Diagnostic> {
        let before = leftovers(folder);
        // No number of the process: in a container that is always the same.
        let run = before.iter().map(|(run, _)| *run).max().unwrap_or(0).saturating_add(1);
        let manifest = manifest(&self.lock);
        let all: Vec<&RenderedFile> = self.files.iter().chain([&manifest]).collect();
        let staged = StagedFiles::write(folder, &all, run)?;
        let files = all.iter().map(|file| Hashed::new(&file.name, &file.bytes)).collect();
        Ok(StagedReplacement { replacement: self, staged, decided: Decided { run, files }, before })
    }

    fn put_in_place(&mut self, folder: &Path, run: u32) -> Result<Vec<Stale>, (String, std::io::Error)> {
        let place = |name: &str| {
            fs::rename(folder.join(temporary_name(name, run)), folder.join(name)).map_err(|e| (name.to_owned(), e))
        };
        self.files.iter().try_for_each(|file| place(&file.name))?;
        let stale: Vec<Stale> = self.removed.iter().filter_map(|old| remove(folder, old)).collect();
        if !stale.is_empty() {
            self.lock.stale.extend(stale.iter().map(|stale| stale.file.clone()));
            let path = folder.join(temporary_name(LOCK_NAME, run));
            let written = fs::File::create(path).and_then(|handle| {
                LimitedWriter::new(&handle, 0).write_all(&manifest(&self.lock).bytes)?;
                handle.sync_all()
            });
            written.map_err(|failure| (LOCK_NAME.to_owned(), failure))?;
        }
        place(LOCK_NAME)?;
        sync(folder);
        fs::remove_file(folder.join(LIST_NAME)).map_err(|failure| (LIST_NAME.to_owned(), failure))?;
        Ok(stale)
    }
}

fn half_replaced(name: &str, failure: &std::io::Error) -> Diagnostic {
    Diagnostic::new(codes::E0810, format!("cannot replace `{name}`: {failure}")).help(HALF)
}

const HALF: &str =
    "the set in this folder is half replaced: load none of its files; the next `compile` into it mends it";

/// Removes a file if its bytes are those of the old set; returns the file if it stays.
fn remove(folder: &Path, old: &Hashed) -> Option<Stale> {
    let path = folder.join(&old.name);
    let stays = |why: String| Some(Stale { file: old.clone(), why });
    if let Some(why) = no_longer(&path, old) {
        return stays(why.to_owned()).filter(|_| path.symlink_metadata().is_ok());
    }
    match fs::remove_file(&path) {
        Err(failure) if failure.kind() != ErrorKind::NotFound => stays(format!("it cannot be removed: {failure}")),
        _ => None,
    }
}

/// Returns the reason why a file is not the one that was written, or cannot be told to be; `None` if it is.
pub(crate) fn no_longer(path: &Path, old: &Hashed) -> Option<&'static str> {
    match hash(path) {
        Some(hash) if hash == old.sha256 => None,
        Some(_) => Some("it has been changed since abbe wrote it"),
        None => Some("it cannot be read"),
    }
}

fn manifest(lock: &Lock) -> RenderedFile {
    RenderedFile { name: LOCK_NAME.to_owned(), bytes: lock.to_text().into_bytes() }
}

/// Refuses a set that a killed run has half replaced (E0733), and warns of a run that was killed before it changed
/// anything (W0713). Changes nothing.
pub(crate) fn check(folder: &Path, diagnostics: &mut Diagnostics) -> Result<(), Diagnostic> {
    if !is_half_replaced(folder) && leftovers(folder).is_empty() {
        return Ok(());
    }
    // A run that is still at work is waited for.
    let _guard = exclusive(folder).map_err(|failure| unfinished_diagnostic(folder, &format!(": {failure}")))?;
    if is_half_replaced(folder) {
        return Err(unfinished_diagnostic(folder, &format!(", by the list `{LIST_NAME}` in it")));
    }
    let left = leftovers(folder);
    if !left.is_empty() {
        let message = format!("a run was killed before it had written the whole of its set to `{}`", folder.display());
        let help =
            format!("the set that was there is as it was; {} temporary files go with the next compile", left.len());
        diagnostics.push(Diagnostic::new(codes::W0713, message).help(help));
    }
    Ok(())
}

/// True if a killed run has decided a set for the folder and not finished it.
pub(crate) fn is_half_replaced(folder: &Path) -> bool {
    folder.join(LIST_NAME).symlink_metadata().is_ok()
}

fn unfinished_diagnostic(folder: &Path, why: &str) -> Diagnostic {
    let message = format!("the set in `{}` is half replaced, a run was killed{why}", folder.display());
    Diagnostic::new(codes::E0733, message).help("load none of its files; compile again into this folder")
}

impl Decided {
    /// Returns the decided set of a folder, if there is one.
    fn of(folder: &Path) -> Option<Self> {
        let decided: Self = serde_json::from_slice(&regular(&folder.join(LIST_NAME))?).ok()?;
        decided.files.iter().all(|file| is_plain_name(&file.name)).then_some(decided)
    }

    /// Returns the files of the set that a killed run has decided for a folder: those that the manifest of that set
    /// lists too.
    pub(crate) fn files(folder: &Path) -> Vec<Hashed> {
        let Some(decided) = Self::of(folder) else { return Vec::new() };
        let staged = folder.join(temporary_name(LOCK_NAME, decided.run));
        let text = regular(&staged).or_else(|| regular(&folder.join(LOCK_NAME)));
        let lock = text.and_then(|bytes| Lock::from_text(&String::from_utf8(bytes).ok()?));
        let listed = |file: &Hashed| lock.as_ref().is_some_and(|lock| lock.files.contains(file));
        decided.files.into_iter().filter(listed).collect()
    }
}

/// Bytes of a regular file, links left aside; none if there is no such file.
fn regular(path: &Path) -> Option<Vec<u8>> {
    let regular = fs::symlink_metadata(path).is_ok_and(|metadata| metadata.is_file());
    regular.then(|| read_at_most(path, SET_LIMIT).ok()).flatten()
}

/// SHA-256 of a regular file; none if there is no such file.
fn hash(path: &Path) -> Option<String> {
    regular(path).map(|bytes| sha256(&bytes))
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
fn leftovers(folder: &Path) -> Vec<(u32, PathBuf)> {
    let run = |name: &str| {
        let (name, run) = name.strip_prefix('.')?.strip_suffix(TEMPORARY)?.rsplit_once('.')?;
        run.parse().ok().filter(|_| !name.is_empty())
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let regular = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file()));
    regular.filter_map(|entry| Some((run(&entry.file_name().to_string_lossy())?, entry.path()))).collect()
}

/// Files under temporary names, removed when it is dropped undecided.
struct StagedFiles {
    run: u32,
    paths: Vec<PathBuf>,
}

impl StagedFiles {
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
        let handle = fs::OpenOptions::new().write(true).create_new(true).open(&path)?;
        self.paths.push(path.clone());
        LimitedWriter::new(&handle, 0).write_all(bytes)?;
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

impl Drop for StagedFiles {
    fn drop(&mut self) {
        for path in &self.paths {
            let _ = fs::remove_file(path);
        }
    }
}
