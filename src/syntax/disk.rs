//! Files on disk. What is not a regular file of tolerable size is refused before it is opened: opening a FIFO blocks,
//! reading a device never ends.

use super::files::{EntryKind, Files, FolderEntry, ReadFailure};
use std::fs::{self, FileType};
use std::io::{ErrorKind, Read};
use std::path::Path;

/// The file system. Reads regular files of at most 16 MiB.
#[derive(Debug, Clone, Copy, Default)]
pub struct Disk;

impl Disk {
    /// Size of the largest file that [`Files::read`] takes, in bytes.
    pub const MAX_BYTES: u64 = 16 * 1024 * 1024;
}

impl Files for Disk {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadFailure> {
        self.read_at_most(path, Self::MAX_BYTES)
    }

    fn read_at_most(&self, path: &Path, limit: u64) -> Result<Vec<u8>, ReadFailure> {
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

    fn entries(&self, folder: &Path) -> Vec<FolderEntry> {
        let listed = fs::read_dir(folder).into_iter().flatten().flatten();
        let mut entries: Vec<FolderEntry> = listed.map(|entry| described(&entry)).collect();
        entries.sort_by(|a, b| a.name.cmp(&b.name));
        entries
    }
}

fn described(entry: &fs::DirEntry) -> FolderEntry {
    let kind = match entry.file_type() {
        Ok(kind) if kind.is_file() => EntryKind::File,
        Ok(kind) if kind.is_symlink() => EntryKind::Link,
        _ => EntryKind::Other,
    };
    let size = entry.metadata().map_or(0, |metadata| metadata.len());
    FolderEntry { name: entry.file_name().to_string_lossy().into_owned(), kind, size }
}

fn failure(error: &std::io::Error) -> ReadFailure {
    match error.kind() {
        ErrorKind::NotFound => ReadFailure::NotFound,
        ErrorKind::PermissionDenied => ReadFailure::Denied,
        _ => ReadFailure::Other(error.to_string()),
    }
}

/// Returns the word for a file that is neither regular nor a link to a regular one.
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
