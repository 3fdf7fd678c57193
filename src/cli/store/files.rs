//! Files on disk. What is not a regular file of tolerable size is refused before it is opened:
//! opening a FIFO blocks, reading a device never ends.

use crate::controller::sha256;
use crate::syntax::{Files, ReadFailure};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs::{self, FileType};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

/// Largest file that is read, in bytes.
pub const LIMIT: u64 = 16 * 1024 * 1024;

/// Largest file of a compensation set that is read back: as large as one is written.
pub const SET_LIMIT: u64 = crate::controller::MAX_FILE_BYTES as u64;

/// The file system.
#[derive(Debug, Clone, Copy, Default)]
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadFailure> {
        read_at_most(path, LIMIT)
    }
}

/// The disk, remembering what was read from it: also files that are missing, for they may appear.
#[derive(Default)]
pub(crate) struct Recorded {
    seen: RefCell<BTreeMap<PathBuf, Option<String>>>,
}

impl Files for Recorded {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadFailure> {
        let result = Disk.read(path);
        let state = result.as_ref().ok().map(|bytes| sha256(bytes));
        let _ = self.seen.borrow_mut().insert(path.to_owned(), state);
        result
    }
}

impl Recorded {
    /// SHA-256 of what was read from a file, if anything was.
    pub fn hash(&self, path: &Path) -> Option<String> {
        self.seen.borrow().get(path).cloned().flatten()
    }

    /// Has any of the files another content by now? By content: times of modification are coarse on some
    /// file systems, and an editor may write the same again.
    pub fn changed(&self) -> bool {
        let now = |path: &PathBuf| Disk.read(path).ok().map(|bytes| sha256(&bytes));
        self.seen.borrow().iter().any(|(path, before)| now(path) != *before)
    }
}

/// The bytes of a regular file that has no more than so many.
pub(crate) fn read_at_most(path: &Path, limit: u64) -> Result<Vec<u8>, ReadFailure> {
    let metadata = fs::metadata(path).map_err(|e| failure(&e))?;
    if let Some(word) = irregular(metadata.file_type()) {
        return Err(ReadFailure::NotAFile(word));
    }
    if metadata.len() > limit {
        return Err(ReadFailure::TooLarge(metadata.len(), limit));
    }
    let mut bytes = Vec::new();
    let file = fs::File::open(path).map_err(|e| failure(&e))?;
    // The file may have grown since its size was asked for.
    file.take(limit + 1).read_to_end(&mut bytes).map_err(|e| failure(&e))?;
    if bytes.len() as u64 > limit { Err(ReadFailure::TooLarge(bytes.len() as u64, limit)) } else { Ok(bytes) }
}

fn failure(error: &std::io::Error) -> ReadFailure {
    match error.kind() {
        ErrorKind::NotFound => ReadFailure::NotFound,
        ErrorKind::PermissionDenied => ReadFailure::Denied,
        _ => ReadFailure::Other(error.to_string()),
    }
}

/// The word for what is neither file nor link to one.
fn irregular(kind: FileType) -> Option<&'static str> {
    if kind.is_file() {
        return None;
    }
    Some(if kind.is_dir() { "a directory" } else { special(kind) })
}

#[cfg(unix)]
fn special(kind: FileType) -> &'static str {
    use std::os::unix::fs::FileTypeExt;
    if kind.is_fifo() {
        "a FIFO"
    } else if kind.is_socket() {
        "a socket"
    } else {
        "a device"
    }
}

#[cfg(not(unix))]
fn special(_: FileType) -> &'static str {
    "not a regular file"
}
