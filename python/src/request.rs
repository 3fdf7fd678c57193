//! What a verb is asked: machines, paths, options as JSON, and the files that it may read.

use crate::machine::Loaded;
use abbe::results::FolderEntry;
use abbe::results::ReadFailure;
use abbe::verbs::{Verb, VerbAnswer, VerbRequest};
use abbe::{Diagnostic, Diagnostics, Disk, Files, MemoryFiles, Run, codes};
use serde_json::Value;
use std::cell::RefCell;
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

/// Types as serde names what it expects, and as a Python caller does.
const RUST_TYPES: [(&str, &str); 6] = [
    ("expected usize", "expected a whole number from 0"),
    ("expected u64", "expected a whole number from 0"),
    ("expected u32", "expected a whole number from 0"),
    ("expected f64", "expected a number"),
    ("expected a sequence", "expected a list"),
    ("unknown variant", "unknown value"),
];

impl Request {
    /// Calls a verb. The document has the warnings of the reading of all machines too.
    pub fn ask(&self, verb: &Verb, run: Run<'_>) -> Result<VerbAnswer, Diagnostics> {
        // A value has no lines and columns, which nobody has written.
        let options: Value = serde_json::from_str(&self.options).map_err(|why| unfit("", &why.to_string()))?;
        let request = VerbRequest {
            machines: self.machines.iter().map(|loaded| &loaded.file).collect(),
            words: &self.words,
            texts: &self.texts,
            options: &options,
            rows: self.rows,
            unfit: &unfit,
        };
        let answer = (verb.run)(&request, run)?;
        let mut all = Diagnostics::default();
        for loaded in &self.machines {
            let count = all.count();
            all.absorb(loaded.warnings.clone());
            if self.machines.len() > 1 {
                all.name_file(count, loaded.file.path());
            }
        }
        all.absorb(answer.warnings.clone());
        Ok(VerbAnswer { document: all.document(answer.document), ..answer })
    }
}

/// Refuses an option by its path, or the request.
fn unfit(path: &str, why: &str) -> Diagnostic {
    if path.is_empty() {
        return Diagnostic::new(codes::E0818, why);
    }
    let why = RUST_TYPES.iter().fold(why.to_owned(), |why, (of, words)| why.replace(of, words));
    let help = "the method's docstring names its options and their values: `help(abbe.Machine)`";
    Diagnostic::new(codes::E0818, format!("option `{path}`: {why}")).help(help)
}

/// The texts of machines that are in memory, and the disk behind them.
pub struct TextsAndDisk {
    texts: MemoryFiles,
    read: RefCell<NamedTexts>,
}

/// Names and texts of files.
type NamedTexts = Vec<(String, String)>;

impl TextsAndDisk {
    /// Returns the files of the machines and those of the request, and the disk behind them.
    pub fn of(request: &Request) -> Self {
        let of_machines = request.machines.iter().flat_map(|loaded| loaded.texts.iter().cloned());
        Self::with(of_machines.chain(request.texts.iter().cloned()))
    }

    /// Returns texts by name, and the disk behind them.
    pub fn with(texts: impl IntoIterator<Item = (String, String)>) -> Self {
        let texts = texts.into_iter().fold(MemoryFiles::new(), |files, (name, text)| files.with(name, text));
        Self { texts, read: RefCell::default() }
    }

    /// Returns the files that were read, by the names that were asked for: the sources of diagnostics shorten theirs.
    pub fn into_read(self) -> NamedTexts {
        self.read.into_inner()
    }

    fn record(&self, path: &Path, bytes: &[u8]) {
        let (name, mut read) = (path.to_string_lossy(), self.read.borrow_mut());
        if !read.iter().any(|(known, _)| *known == name) {
            read.push((name.into_owned(), String::from_utf8_lossy(bytes).into_owned()));
        }
    }

    /// Returns the surroundings of a call that reads through these files.
    pub fn run<'a>(&'a self, monitor: &'a dyn abbe::Monitor) -> Run<'a> {
        Run { monitor, ..Run::with(self) }
    }
}

impl Files for TextsAndDisk {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadFailure> {
        let bytes = self.texts.read(path).or_else(|_| Disk.read(path))?;
        self.record(path, &bytes);
        Ok(bytes)
    }

    fn read_at_most(&self, path: &Path, limit: u64) -> Result<Vec<u8>, ReadFailure> {
        let bytes = self.texts.read_at_most(path, limit).or_else(|_| Disk.read_at_most(path, limit))?;
        self.record(path, &bytes);
        Ok(bytes)
    }

    fn resolve(&self, path: &Path) -> Option<PathBuf> {
        Disk.resolve(path).or_else(|| self.texts.resolve(path))
    }

    fn entries(&self, folder: &Path) -> Vec<FolderEntry> {
        let known = self.texts.entries(folder);
        if known.is_empty() { Disk.entries(folder) } else { known }
    }
}
