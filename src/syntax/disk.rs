//! Files on disk. What is not a regular file of tolerable size is refused before it is opened: opening a FIFO blocks,
//! reading a device never ends. So is what the kernel makes up (procfs, sysfs): it has no size, and some of it blocks.

use super::files::{EntryKind, Files, FolderEntry, ReadFailure};
use std::fs::{self, FileType};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

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
        if let Some(word) = kernel::made_up(path) {
            return Err(ReadFailure::NotAFile(word));
        }
        if metadata.len() > limit {
            return Err(ReadFailure::TooLarge(metadata.len(), limit));
        }
        let mut bytes = Vec::new();
        let file = kernel::open(path).map_err(|e| failure(&e))?;
        // Another file may stand there by now.
        if let Some(word) = file.metadata().ok().and_then(|metadata| irregular(metadata.file_type())) {
            return Err(ReadFailure::NotAFile(word));
        }
        // The file may have grown since its size was asked for.
        file.take(limit + 1).read_to_end(&mut bytes).map_err(|e| failure(&e))?;
        if bytes.len() as u64 > limit { Err(ReadFailure::TooLarge(bytes.len() as u64, limit)) } else { Ok(bytes) }
    }

    fn resolve(&self, path: &Path) -> Option<PathBuf> {
        fs::canonicalize(path).ok()
    }

    fn entries(&self, folder: &Path) -> Vec<FolderEntry> {
        let listed = fs::read_dir(folder).into_iter().flatten().flatten();
        let mut entries: Vec<FolderEntry> = listed.map(|entry| folder_entry(&entry)).collect();
        entries.sort_by(|a, b| a.name.cmp(&b.name));
        entries
    }
}

fn folder_entry(entry: &fs::DirEntry) -> FolderEntry {
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

/// Files of the kernel's own, and opening that does not wait.
#[cfg(unix)]
mod kernel {
    use rustix::fs::OFlags;
    use std::os::unix::fs::OpenOptionsExt;
    use std::path::Path;
    use std::{fs, io};

    pub(super) fn open(path: &Path) -> io::Result<fs::File> {
        let flags = i32::try_from(OFlags::NONBLOCK.bits()).unwrap_or(0);
        fs::OpenOptions::new().read(true).custom_flags(flags).open(path)
    }

    #[cfg(not(target_os = "linux"))]
    pub(super) fn made_up(_: &Path) -> Option<&'static str> {
        None
    }

    /// Returns the word for a file that is on no medium, by the file system's magic number (`linux/magic.h`).
    #[cfg(target_os = "linux")]
    pub(super) fn made_up(path: &Path) -> Option<&'static str> {
        let kind = rustix::fs::statfs(path).ok()?.f_type;
        // Some systems sign-extend the number.
        match (kind as u64) & 0xffff_ffff {
            0x9fa0 => Some("an entry of procfs"),
            0x6265_6572 => Some("an entry of sysfs"),
            0x6462_6720 | 0x7472_6163 => Some("an entry of debugfs or tracefs"),
            0x0027_e0eb | 0x6367_7270 => Some("an entry of cgroupfs"),
            0x7363_6673 | 0x6265_6570 | 0xf97c_ff8c | 0x4249_4e4d | 0xde5e_81e4 | 0x6165_676c | 0xcafe_4a11 => {
                Some("an entry of a file system of the kernel")
            }
            _ => None,
        }
    }
}

#[cfg(not(unix))]
mod kernel {
    use std::path::Path;
    use std::{fs, io};

    pub(super) fn open(path: &Path) -> io::Result<fs::File> {
        fs::File::open(path)
    }

    pub(super) fn made_up(_: &Path) -> Option<&'static str> {
        None
    }
}
