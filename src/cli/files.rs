//! Files on disk. What is not a regular file of tolerable size is refused before it is opened:
//! opening a FIFO blocks, reading a device never ends.

use crate::syntax::{Files, ReadFailure};
use std::fs::{self, FileType};
use std::io::{ErrorKind, Read};
use std::path::Path;

/// Largest file that is read, in bytes.
pub const LIMIT: u64 = 16 * 1024 * 1024;

/// Largest file of a compensation set that is read back: as large as one is written.
pub const SET_LIMIT: u64 = crate::target::LARGEST_FILE as u64;

/// The file system.
#[derive(Debug, Clone, Copy, Default)]
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadFailure> {
        read_at_most(path, LIMIT)
    }
}

/// The bytes of a regular file that has no more than so many.
pub(super) fn read_at_most(path: &Path, limit: u64) -> Result<Vec<u8>, ReadFailure> {
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
