//! The only access to the file system: [`Disk`](super::Disk), or a map in memory.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// Reads files and lists folders.
pub trait Files {
    /// Returns the bytes of a regular file of tolerable size.
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadFailure>;

    /// Returns the bytes of a regular file of at most `limit` bytes.
    fn read_at_most(&self, path: &Path, limit: u64) -> Result<Vec<u8>, ReadFailure> {
        let bytes = self.read(path)?;
        let size = bytes.len() as u64;
        if size > limit { Err(ReadFailure::TooLarge(size, limit)) } else { Ok(bytes) }
    }

    /// Returns the path with links and `..` resolved, if the file is there; by default as far as the path alone tells.
    fn resolve(&self, path: &Path) -> Option<PathBuf> {
        Some(lexical(path))
    }

    /// Returns the entries of a folder, sorted by name; none if the folder is missing.
    fn entries(&self, _folder: &Path) -> Vec<FolderEntry> {
        Vec::new()
    }
}

/// An entry of a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FolderEntry {
    /// Name within the folder.
    pub name: String,
    /// Kind, without following links.
    pub kind: EntryKind,
    /// Size in bytes.
    pub size: u64,
}

/// Kind of a folder's entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EntryKind {
    /// A regular file.
    File,
    /// A symbolic link.
    Link,
    /// A folder, device, FIFO or socket.
    Other,
}

/// The reason for which a file cannot be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ReadFailure {
    /// There is none.
    NotFound,
    /// It is a directory, FIFO, device or socket: the word for it.
    NotAFile(&'static str),
    /// Larger than the limit: its size and the limit, in bytes.
    TooLarge(u64, u64),
    /// The permissions forbid it.
    Denied,
    /// Outside this folder, to which the run is confined.
    Outside(PathBuf),
    /// Anything else, in the system's words.
    Other(String),
}

/// `a/../b` is `b`: never used to open a file.
pub(crate) fn lexical(path: &Path) -> PathBuf {
    path.components().fold(PathBuf::new(), |mut tidy, component| {
        let folder = tidy.file_name().is_some();
        match component {
            Component::CurDir => {}
            Component::ParentDir if folder => {
                tidy.pop();
            }
            other => tidy.push(other),
        }
        tidy
    })
}

/// Files in memory, by path.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct MemoryFiles(BTreeMap<PathBuf, Vec<u8>>);

impl MemoryFiles {
    /// Returns no files.
    pub const fn new() -> Self {
        Self(BTreeMap::new())
    }

    /// Adds a file, or replaces it.
    #[must_use]
    pub fn with(mut self, path: impl Into<PathBuf>, bytes: impl Into<Vec<u8>>) -> Self {
        let _ = self.0.insert(path.into(), bytes.into());
        self
    }
}

impl Files for MemoryFiles {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadFailure> {
        self.0.get(path).or_else(|| self.0.get(&lexical(path))).cloned().ok_or(ReadFailure::NotFound)
    }

    fn entries(&self, folder: &Path) -> Vec<FolderEntry> {
        let within = self.0.iter().filter(|(path, _)| path.parent() == Some(folder));
        let entry = |(path, bytes): (&PathBuf, &Vec<u8>)| {
            let name = path.file_name()?.to_string_lossy().into_owned();
            Some(FolderEntry { name, kind: EntryKind::File, size: bytes.len() as u64 })
        };
        within.filter_map(entry).collect()
    }
}
