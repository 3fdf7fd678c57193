//! Files that a run has read from the disk.

use abbe::results::{FolderEntry, ReadFailure};
use abbe::sets::MAX_FILE_BYTES;
use abbe::{Disk, Files};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hasher};
use std::path::{Path, PathBuf};

/// Largest file of a compensation set that is read back: as large as one is written.
pub(crate) const SET_LIMIT: u64 = MAX_FILE_BYTES as u64;

/// The disk, remembering what was read from it: also files that are missing, for they may appear.
#[derive(Debug, Default)]
pub(crate) struct Recorded {
    /// By path: the limit under which it was read, and a hash of the content if it could be read.
    seen: RefCell<BTreeMap<PathBuf, (u64, Option<u64>)>>,
    /// The folder outside of which nothing is read, as it was named and resolved.
    root: Option<[PathBuf; 2]>,
}

impl Files for Recorded {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadFailure> {
        self.read_at_most(path, Disk::MAX_BYTES)
    }

    fn read_at_most(&self, path: &Path, limit: u64) -> Result<Vec<u8>, ReadFailure> {
        let result = self.read_confined(path, limit);
        let state = result.as_ref().ok().map(|bytes| content(bytes));
        let _ = self.seen.borrow_mut().insert(path.to_owned(), (limit, state));
        result
    }

    fn entries(&self, folder: &Path) -> Vec<FolderEntry> {
        if self.outside(folder).is_some() { Vec::new() } else { Disk.entries(folder) }
    }

    fn resolve(&self, path: &Path) -> Option<PathBuf> {
        Disk.resolve(path)
    }
}

impl Recorded {
    /// Reads files in a folder and below it only.
    pub(crate) fn within(root: Option<&Path>) -> Self {
        let resolved = |root: &Path| Disk.resolve(root).unwrap_or_else(|| root.to_owned());
        Self { root: root.map(|root| [root.to_owned(), resolved(root)]), ..Self::default() }
    }

    /// Returns the folder of `--confined` if the path leads outside of it.
    pub(crate) fn outside(&self, path: &Path) -> Option<PathBuf> {
        let [named, root] = self.root.as_ref()?;
        // Of a file that is not there its folder tells.
        let folder = path.parent().map(|folder| if folder == Path::new("") { Path::new(".") } else { folder });
        let resolved = Disk.resolve(path).or_else(|| Disk.resolve(folder?));
        (!resolved.is_some_and(|resolved| resolved.starts_with(root))).then(|| named.clone())
    }

    fn read_confined(&self, path: &Path, limit: u64) -> Result<Vec<u8>, ReadFailure> {
        match self.outside(path) {
            Some(root) => Err(ReadFailure::Outside(root)),
            None => Disk.read_at_most(path, limit),
        }
    }

    /// Takes over what another one has read.
    pub(crate) fn absorb(&self, other: Self) {
        self.seen.borrow_mut().extend(other.seen.into_inner());
    }

    /// The files that were read.
    pub fn paths(&self) -> Vec<PathBuf> {
        self.seen.borrow().iter().filter(|(_, (_, state))| state.is_some()).map(|(path, _)| path.clone()).collect()
    }

    /// True if any of the files has another content by now. Compares the content: times of modification are coarse on
    /// some file systems, and an editor may write the same again.
    pub fn has_changed(&self) -> bool {
        let now = |path: &PathBuf, limit: u64| self.read_confined(path, limit).ok().map(|bytes| content(&bytes));
        self.seen.borrow().iter().any(|(path, (limit, before))| now(path, *limit) != *before)
    }
}

/// A hash by which changes are told within one run; nobody has to be kept from forging it.
fn content(bytes: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    hasher.write(bytes);
    hasher.finish()
}

/// Returns the bytes of a regular file that has at most `limit` of them.
pub(crate) fn read_at_most(path: &Path, limit: u64) -> Result<Vec<u8>, ReadFailure> {
    Disk.read_at_most(path, limit)
}
