//! The one way into the file system: implemented on disk in `cli`, in tests by a map.

use std::path::Path;

/// Reads whole files.
pub trait Files {
    /// The bytes of a regular file of tolerable size.
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadFailure>;
}

/// Why a file cannot be read.
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
    /// Anything else, in the system's words.
    Other(String),
}
