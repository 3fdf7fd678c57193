//! A set of compensation files on disk: the files that may be replaced. [`commit`] replaces them.
//!
//! Files that the manifest in the folder lists with their present bytes are ours and are replaced;
//! a file of the same name that is not is foreign or hand-edited and is refused; others are not touched.

use super::commit::{self, Decided, Replacement, StagedReplacement, Stale};
use super::files::{Recorded, SET_LIMIT, read_at_most};
use super::write;
use crate::cli::Outcome;
use crate::cli::output::session::Session;
use abbe::results::ReadFailure;
use abbe::sets::{Hashed, LOCK_NAME, Lock, RenderedFile, STALE_HELP, is_plain_name, refuse_outside};
use abbe::text::shown;
use abbe::{Diagnostic, codes};
use std::fs;
use std::path::{Path, PathBuf};

/// A set to be written, and what has to stay.
pub(crate) struct NewSet<'a> {
    pub files: &'a [RenderedFile],
    pub lock: &'a Lock,
    /// The files that were read in this run.
    pub read: &'a Recorded,
    /// True if the target writes files of this name.
    pub writes: &'a dyn Fn(&str, &str) -> bool,
    /// True if it may take the place of the set of another target or machine.
    pub other: bool,
}

impl NewSet<'_> {
    /// Writes sets into subfolders and this one above them, each with its manifest: all are replaced as one, and no
    /// other run writes there meanwhile. Returns warnings.
    pub(crate) fn write_above(
        &self,
        folder: &Path,
        parts: &[(&str, NewSet<'_>)],
    ) -> Result<Vec<Diagnostic>, Diagnostic> {
        let kept = |path: &Path| write::is_input(path, self.read);
        let staged = || {
            let above = self.prepare(folder)?;
            let prepared = parts.iter().map(|(name, part)| part.prepare(&folder.join(name)));
            let prepared = prepared.collect::<Result<Vec<_>, _>>()?;
            // All files are there before the first set is decided: a full disk changes none.
            let above = above.stage(&kept)?;
            let staged = prepared.into_iter().map(|part| part.stage(&kept)).collect::<Result<Vec<_>, _>>()?;
            Ok((above, staged))
        };
        let (above, staged) = staged().inspect_err(|_| {
            // Those that were made for this run are empty.
            parts.iter().for_each(|(name, _)| drop(fs::remove_dir(folder.join(name))));
        })?;
        let mut warnings = Vec::new();
        let own = above.carry_out(|| {
            for part in staged {
                warnings.extend(part.carry_out(|| Ok(()))?);
            }
            Ok(())
        })?;
        warnings.extend(own);
        Ok(warnings)
    }

    /// Refuses what may not be replaced, and holds the folder (made if it is not there).
    fn prepare<'s>(&'s self, folder: &Path) -> Result<Prepared<'s>, Diagnostic> {
        write::make_folder(folder)?;
        // A replacement goes through this name.
        write::refuse_input(&folder.join(commit::LIST_NAME), self.read)?;
        let guard =
            commit::exclusive(folder).map_err(|failure| write::unwritable_folder(folder, &failure.to_string()))?;
        let old = existing_lock(folder);
        refuse_odd_manifest(folder, old.is_some())?;
        if old.as_ref().is_some_and(|old| !old.parts.is_empty()) && self.lock.parts.is_empty() {
            return Err(foreign(folder, "holds the sets of two targets in subfolders"));
        }
        if let Some(refusal) = old.as_ref().and_then(|lock| refuse_outside(lock, folder)) {
            return Err(refusal);
        }
        let is_other = |old: &&Lock| (&old.target, &old.machine) != (&self.lock.target, &self.lock.machine);
        if let Some(old) = old.as_ref().filter(is_other).filter(|old| !self.other && !old.files.is_empty()) {
            let message =
                format!("`{}` holds the set of `{}` for `{}`", folder.display(), old.target, shown(&old.machine));
            let help = "give another folder to --out, or `--replace` to put this set in its place; nothing was written";
            return Err(Diagnostic::new(codes::E0706, message).help(help));
        }
        let half_replaced = commit::is_half_replaced(folder);
        // Files that a killed run had decided are ours too.
        let ours = [old.as_ref().map_or_else(Vec::new, |lock| lock.files.clone()), Decided::files(folder)].concat();
        for file in self.files {
            write::refuse_input(&folder.join(&file.name), self.read)?;
            refuse_foreign(folder, file, &ours)?;
        }
        let (removed, stale) = self.leftovers(folder, old.as_ref(), &ours);
        Ok(Prepared { set: self, folder: folder.to_owned(), removed, stale, half_replaced, _guard: guard })
    }

    /// Returns the files of the old set that the new one does not have: those to be removed, and those that stay.
    fn leftovers(&self, folder: &Path, old: Option<&Lock>, ours: &[Hashed]) -> (Vec<Hashed>, Vec<Stale>) {
        let target = old.map_or(self.lock.target.as_str(), |lock| lock.target.as_str());
        let stale = old.map_or(&[][..], |lock| &lock.stale);
        let (mut removed, mut kept): (Vec<Hashed>, Vec<Stale>) = (Vec::new(), Vec::new());
        for old in ours.iter().chain(stale).filter(|old| !self.files.iter().any(|new| new.name == old.name)) {
            let path = folder.join(&old.name);
            let known = removed.contains(old) || kept.iter().any(|kept| kept.file == *old);
            if known || path.symlink_metadata().is_err() {
                continue;
            }
            let why = if let Some(why) = commit::no_longer(&path, old) {
                why.to_owned()
            } else if write::is_input(&path, self.read) {
                "it is an input of this run".to_owned()
            } else if !(self.writes)(target, &old.name) {
                format!("it is no file that the target `{target}` writes")
            } else {
                removed.push(old.clone());
                continue;
            };
            kept.push(Stale { file: old.clone(), why });
        }
        // A file may be listed with the bytes of the old set and with those of a killed run.
        kept.retain(|kept| !removed.iter().any(|file| file.name == kept.file.name));
        (removed, kept)
    }
}

/// A set that may take its place.
struct Prepared<'s> {
    set: &'s NewSet<'s>,
    folder: PathBuf,
    /// Files of the old set that go.
    removed: Vec<Hashed>,
    /// Files of the old set that stay.
    stale: Vec<Stale>,
    half_replaced: bool,
    /// Holds the folder.
    _guard: fs::File,
}

impl<'s> Prepared<'s> {
    /// Writes the files of the set under temporary names.
    fn stage(self, kept: &'s dyn Fn(&Path) -> bool) -> Result<StagedSet<'s>, Diagnostic> {
        let mut lock = self.set.lock.clone();
        lock.stale = self.stale.iter().map(|stale| stale.file.clone()).collect();
        let replacement = Replacement { files: self.set.files, lock, removed: self.removed, kept };
        let Self { folder, stale, half_replaced, _guard, .. } = self;
        Ok(StagedSet { staged: replacement.stage(&folder)?, folder, stale, half_replaced, _guard })
    }
}

/// A set whose files are written under temporary names.
struct StagedSet<'s> {
    staged: StagedReplacement<'s>,
    folder: PathBuf,
    stale: Vec<Stale>,
    half_replaced: bool,
    /// Holds the folder.
    _guard: fs::File,
}

impl StagedSet<'_> {
    /// Replaces the old set, with other sets `between` decision and manifest. Returns warnings.
    fn carry_out(mut self, between: impl FnOnce() -> Result<(), Diagnostic>) -> Result<Vec<Diagnostic>, Diagnostic> {
        self.stale.extend(self.staged.carry_out(&self.folder, between)?);
        let mended = self.half_replaced.then(|| mend(&self.folder));
        Ok(mended.into_iter().chain(self.stale.iter().map(|stale| still_there(&self.folder, stale))).collect())
    }
}

fn mend(folder: &Path) -> Diagnostic {
    let message = format!("a run was killed while it replaced the set in `{}`", folder.display());
    Diagnostic::new(codes::W0712, message).help("the set of this run is in its place now, whole")
}

fn still_there(folder: &Path, stale: &Stale) -> Diagnostic {
    let path = folder.join(&stale.file.name);
    let message = format!("`{}` is of an earlier set and still there: {}", path.display(), stale.why);
    Diagnostic::new(codes::W0707, message).help(STALE_HELP)
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

/// Refuses a folder whose set, or a part of it in a subfolder, a killed run has half replaced.
pub(crate) fn check(session: &mut Session, folder: &Path) -> Outcome {
    if let Some(root) = session.files.outside(folder) {
        let message =
            format!("`{}` is outside `{}`, to which --confined limits this run", folder.display(), root.display());
        return session.refuse(Diagnostic::new(codes::E0819, message).help("name a folder that holds every file"));
    }
    if folder.is_file() {
        let message = format!("`{}` is a file, not a folder of compensation files", folder.display());
        return session.refuse(Diagnostic::new(codes::E0705, message).help("name the folder of `compile --out`"));
    }
    let lock = existing_lock(folder);
    let parts = lock.iter().flat_map(|lock| &lock.parts).filter(|part| is_plain_name(&part.name));
    let mut folders = std::iter::once(folder.to_owned()).chain(parts.map(|part| folder.join(&part.name)));
    match folders.try_for_each(|folder| commit::check(&folder, &mut session.diagnostics)) {
        Ok(()) => Ok(()),
        Err(refusal) => session.refuse(refusal),
    }
}
