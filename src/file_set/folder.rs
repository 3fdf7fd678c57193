//! A folder with compensation files, as a controller finds it.

use crate::controller::{LOCK_NAME, Lock, MAX_FILE_BYTES, ReadBack, is_plain_name};
use crate::diagnostic::{Diagnostic, Diagnostics, codes, shown};
use crate::syntax::{EntryKind, Files, FolderEntry, ReadFailure};
use std::path::Path;

/// Largest file of a set that is read back: as large as one is written, in bytes.
pub(crate) const SET_LIMIT: u64 = MAX_FILE_BYTES as u64;

/// Maximum number of files that are searched for a set.
const MAX_FILES: usize = 200;

/// Maximum number of bytes of the files of a set together, by name and by content: what is read is held in memory.
const MAX_BYTES: u64 = SET_LIMIT;

pub(crate) struct Folder<'a> {
    pub path: &'a Path,
    files: &'a dyn Files,
    entries: Vec<FolderEntry>,
}

impl<'a> Folder<'a> {
    pub fn new(path: &'a Path, files: &'a dyn Files) -> Self {
        Self { path, files, entries: files.entries(path) }
    }

    /// True if there is a file, folder or link of a name.
    pub fn has(&self, name: &str) -> bool {
        self.entries.iter().any(|entry| entry.name == name)
    }

    /// True if the name is that of a symbolic link.
    fn is_link(&self, name: &str) -> bool {
        self.entries.iter().any(|entry| entry.name == name && entry.kind == EntryKind::Link)
    }

    /// Returns the manifest of the set in the folder; `None` if there is none that abbe wrote.
    pub fn lock(&self) -> Option<Lock> {
        if self.is_link(LOCK_NAME) {
            return None;
        }
        Lock::from_text(&String::from_utf8(self.bytes(LOCK_NAME)?).ok()?)
    }

    /// Returns the bytes of a file that can be read.
    pub fn bytes(&self, name: &str) -> Option<Vec<u8>> {
        self.files.read_at_most(&self.path.join(name), SET_LIMIT).ok()
    }

    /// Reads those of the named files that are there, as the controller finds them: with a byte order mark if they have
    /// one.
    pub fn read(&self, names: &[String], diagnostics: &mut Diagnostics) -> Vec<ReadBack> {
        let mut found = Vec::new();
        let mut bytes = 0;
        for name in names.iter().filter(|name| self.has(name)) {
            let size = self.entries.iter().filter(|entry| entry.name == *name).map(|entry| entry.size).sum::<u64>();
            bytes += size;
            if bytes > MAX_BYTES {
                let message = format!("`{name}`: the files of the set have more than {} MB together", MAX_BYTES >> 20);
                let help = "no set that abbe writes is so large; name the folder that `compile --out` was given";
                diagnostics.push(Diagnostic::new(codes::E0704, message).help(help));
                return Vec::new();
            }
            let text = self
                .files
                .read_at_most(&self.path.join(name), SET_LIMIT)
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

    /// Reads every text in the folder, up to a limit; warns of the files that are ignored.
    pub fn texts(&self, diagnostics: &mut Diagnostics) -> Vec<(String, String)> {
        let candidate = |entry: &&FolderEntry| {
            entry.kind == EntryKind::File && entry.name != LOCK_NAME && !entry.name.starts_with('.')
        };
        let (mut texts, mut bytes) = (Vec::new(), 0);
        for (number, entry) in self.entries.iter().filter(candidate).enumerate() {
            if number >= MAX_FILES || bytes + entry.size > MAX_BYTES {
                diagnostics.push(ignore_file(&entry.name, "the files before it are more than any set has"));
                break;
            }
            bytes += entry.size;
            match self.bytes(&entry.name).and_then(|bytes| String::from_utf8(bytes).ok()) {
                Some(text) => texts.push((entry.name.clone(), text)),
                None => diagnostics.push(ignore_file(&entry.name, "it is no text that can be read")),
            }
        }
        texts
    }
}

impl Folder<'_> {
    /// Refuses a manifest whose files are not all in the folder itself; warns of files of earlier sets that still are.
    pub fn refuse_odd(&self, lock: &Lock, diagnostics: &mut Diagnostics) {
        refuse_outside(lock, self.path).into_iter().for_each(|refusal| diagnostics.push(refusal));
        for file in lock.files.iter().filter(|file| self.is_link(&file.name)) {
            diagnostics.push(outside(self.path, &file.name, "is a link"));
        }
        for file in lock.stale.iter().filter(|file| self.has(&file.name)) {
            let message = format!("`{}` is of an earlier set and still there", shown(&file.name));
            diagnostics.push(Diagnostic::new(codes::W0707, message).help(STALE_HELP));
        }
    }
}

/// Remedy for a file of an earlier set.
pub const STALE_HELP: &str = "remove it by hand: a controller that loads the folder may load it with the set";

/// Refuses a manifest that lists a file outside its folder.
pub fn refuse_outside(lock: &Lock, folder: &Path) -> Option<Diagnostic> {
    let odd = lock.files.iter().chain(&lock.stale).find(|file| !is_plain_name(&file.name))?;
    Some(outside(folder, &odd.name, "is not the plain name of a file in it"))
}

fn outside(folder: &Path, name: &str, why: &str) -> Diagnostic {
    let message = format!("{LOCK_NAME} of `{}` lists `{}`, which {why}", folder.display(), shown(name));
    Diagnostic::new(codes::E0734, message)
        .help("abbe writes no such manifest; if the files are to be trusted, remove it and verify again")
}

/// Warns of a file that is not judged.
pub(crate) fn ignore_file(name: &str, why: &str) -> Diagnostic {
    let message = format!("`{}` is ignored: {why}", shown(name));
    Diagnostic::new(codes::W0711, message).help("the certificate is of the set without this file")
}

fn unreadable(failure: &ReadFailure) -> String {
    match failure {
        ReadFailure::NotAFile(word) => format!("is {word}, not a file"),
        ReadFailure::TooLarge(size, limit) => format!("has {size} bytes; no set has a file of more than {limit}"),
        ReadFailure::NotFound => "is a link to nothing".to_owned(),
        ReadFailure::Denied => "may not be read".to_owned(),
        ReadFailure::Outside(root) => format!("is outside `{}`, to which --confined limits this run", root.display()),
        ReadFailure::Other(words) => format!("cannot be read: {words}"),
    }
}
