//! What a verb is asked: machines, paths, options as JSON, and the files that it may read.

use crate::machine::Loaded;
use abbe::results::FolderEntry;
use abbe::results::ReadFailure;
use abbe::{Diagnostic, Diagnostics, Disk, Files, MachineFile, MemoryFiles, Run, codes};
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A request to a verb.
pub struct Request {
    /// The machines, in the order named.
    pub machines: Vec<Arc<Loaded>>,
    /// Files, folders or words besides, in the order named.
    pub words: Vec<String>,
    /// Files by name and text; they come before those of the disk.
    pub texts: Vec<(String, String)>,
    /// The options as a JSON object.
    pub options: String,
    /// True if every pose is to come back as an array.
    pub rows: bool,
}

impl Request {
    /// Reads the options.
    pub fn options<T: DeserializeOwned>(&self) -> Result<T, Diagnostics> {
        let mut json = serde_json::Deserializer::from_str(&self.options);
        serde_path_to_error::deserialize(&mut json).map_err(|failure| {
            let message = format!("option `{}`: {}", failure.path(), failure.inner());
            Diagnostic::new(codes::E0818, message).into()
        })
    }

    /// Returns the only machine.
    pub fn machine(&self) -> Result<&MachineFile, Diagnostics> {
        self.machines.first().map(|loaded| &loaded.file).ok_or_else(|| unfit("a machine is missing"))
    }

    /// Returns copies of all machines.
    pub fn machine_files(&self) -> Vec<MachineFile> {
        self.machines.iter().map(|loaded| loaded.file.clone()).collect()
    }

    /// Returns a word by its index.
    pub fn word(&self, index: usize) -> Result<&str, Diagnostics> {
        self.words.get(index).map(String::as_str).ok_or_else(|| unfit("a path or a name is missing"))
    }

    /// Returns a path by its index.
    pub fn path(&self, index: usize) -> Result<&Path, Diagnostics> {
        self.word(index).map(Path::new)
    }
}

fn unfit(message: &str) -> Diagnostics {
    Diagnostic::new(codes::E0818, message).into()
}

/// The texts of machines that are in memory, and the disk behind them.
pub struct TextsAndDisk(MemoryFiles);

impl TextsAndDisk {
    /// Returns the files of the machines and those of the request, and the disk behind them.
    pub fn of(request: &Request) -> Self {
        let sources = request.machines.iter().flat_map(|loaded| loaded.file.sources().iter());
        let sources = sources.map(|(name, text)| (name.to_owned(), text.to_owned()));
        Self::with(sources.chain(request.texts.iter().cloned()))
    }

    /// Returns texts by name, and the disk behind them.
    pub fn with(texts: impl IntoIterator<Item = (String, String)>) -> Self {
        Self(texts.into_iter().fold(MemoryFiles::new(), |files, (name, text)| files.with(name, text)))
    }

    /// Returns the surroundings of a call that reads through these files.
    pub fn run<'a>(&'a self, monitor: &'a dyn abbe::Monitor) -> Run<'a> {
        Run { monitor, ..Run::with(self) }
    }
}

impl Files for TextsAndDisk {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadFailure> {
        self.0.read(path).or_else(|_| Disk.read(path))
    }

    fn read_at_most(&self, path: &Path, limit: u64) -> Result<Vec<u8>, ReadFailure> {
        self.0.read_at_most(path, limit).or_else(|_| Disk.read_at_most(path, limit))
    }

    fn resolved(&self, path: &Path) -> Option<PathBuf> {
        Disk.resolved(path).or_else(|| self.0.resolved(path))
    }

    fn entries(&self, folder: &Path) -> Vec<FolderEntry> {
        Disk.entries(folder)
    }
}
