//! Files of a record: copies in memory, by their names within the record.

use super::description::unfit;
use super::{CopiedFile, Line, MachineState};
use crate::controller::{LOCK_NAME, Lock, is_plain_name};
use crate::diagnostic::shown;
use crate::file_set::folder::SET_LIMIT;
use crate::job::machine_file::{LoadOptions, MachineFile, load};
use crate::run::{Call, Hashed, Refused, Run, sha256};
use crate::syntax::{Files, MemoryFiles, ReadFailure};
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// The list of the hashes of a record.
pub const SUMS_NAME: &str = "SHA256SUMS";

/// The machine-readable content of a record.
pub(crate) const JSON_NAME: &str = "record.json";

/// Maximum number of bytes of all files together: they are held in memory.
const MAX_BYTES: usize = 256 << 20;

/// Files by name, `/` between folders.
#[derive(Debug, Default)]
pub(crate) struct RecordFiles {
    files: BTreeMap<String, Vec<u8>>,
    bytes: usize,
}

impl RecordFiles {
    /// Adds a file; returns its hash.
    pub fn add(&mut self, call: &mut Call, name: String, bytes: Vec<u8>) -> Result<Hashed, Refused> {
        self.bytes += bytes.len();
        if self.bytes > MAX_BYTES {
            let message = format!("the files of the record have more than {} MB together", MAX_BYTES >> 20);
            return call.refuse(unfit(message, "make a record for each part of the calibration"));
        }
        let hash = Hashed::new(&name, &bytes);
        let _ = self.files.insert(name, bytes);
        Ok(hash)
    }

    /// Returns the hashes of all of them.
    pub fn hashes(&self) -> Vec<Hashed> {
        self.files.iter().map(|(name, bytes)| Hashed::new(name, bytes)).collect()
    }

    /// Returns all of them, and the list of their hashes as `sha256sum --check` reads it.
    pub fn finish(mut self) -> Vec<(String, Vec<u8>)> {
        let line = |(name, bytes): (&String, &Vec<u8>)| format!("{}  {name}\n", sha256(bytes));
        let list: String = self.files.iter().map(line).collect();
        let _ = self.files.insert(SUMS_NAME.to_owned(), list.into_bytes());
        self.files.into_iter().collect()
    }

    /// Copies a file that the description names into a folder of the record.
    pub fn copy(
        &mut self,
        call: &mut Call,
        base: &Path,
        source: &Line,
        folder: &str,
    ) -> Result<(CopiedFile, Vec<u8>), Refused> {
        let path = base.join(source.as_str());
        let bytes = match call.run.files.read_at_most(&path, SET_LIMIT) {
            Ok(bytes) => bytes,
            Err(failure) => return call.refuse(unreadable(&path, &failure)),
        };
        let name = tame(&path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default());
        let file = self.free(folder, &name);
        let hash = self.add(call, file, bytes.clone())?;
        let source = source.to_string();
        Ok((CopiedFile { source, file: hash.name, bytes: bytes.len(), sha256: hash.sha256 }, bytes))
    }

    /// A name in a folder that no file has: of two files of one name the second is numbered.
    fn free(&self, folder: &str, name: &str) -> String {
        let numbered = |n: usize| if n == 1 { format!("{folder}/{name}") } else { format!("{folder}/{n}-{name}") };
        (1..).map(numbered).find(|name| !self.files.contains_key(name)).unwrap_or_default()
    }

    /// Copies a machine file with the files that it is read from; they keep their places to each other. The copy is
    /// read back.
    pub fn machine(
        &mut self,
        call: &mut Call,
        file: &MachineFile,
        options: &LoadOptions,
        folder: &str,
    ) -> Result<MachineState, Refused> {
        let resolved = |name: &str| call.run.files.resolve(Path::new(name)).unwrap_or_else(|| PathBuf::from(name));
        let paths: Vec<PathBuf> = file.input_files().iter().map(|input| resolved(&input.file)).collect();
        let top = common(&paths);
        let mut memory = MemoryFiles::default();
        let (mut inputs, mut first) = (Vec::new(), String::new());
        for (path, (name, text)) in paths.iter().zip(file.sources().iter()) {
            let within = path.strip_prefix(&top).ok().and_then(plain);
            let Some(within) = within else {
                let message = format!("`{}` has a name that a record cannot hold", shown(name));
                return call.refuse(unfit(message, "rename the file: letters, digits, `-`, `_` and `.`"));
            };
            let place = format!("{folder}/{within}");
            memory = memory.with(&place, text);
            let hash = self.add(call, place, text.as_bytes().to_vec())?;
            if first.is_empty() {
                first.clone_from(&hash.name);
            }
            inputs.push(hash);
        }
        let copy = load(&first, options, Run::with(&memory));
        if copy.is_ok_and(|copy| copy.inputs() == file.inputs()) {
            return Ok(MachineState { file: first, inputs });
        }
        let message = format!("`{}` does not read back from its copy in the record", shown(file.path()));
        call.refuse(unfit(message, "name the files that it extends and reads by relative paths"))
    }

    /// Copies a set of compensation files with its manifest, and the sets in its subfolders.
    pub fn set(&mut self, call: &mut Call, path: &Path, folder: &str) -> Result<(Lock, Vec<Hashed>), Refused> {
        let found = match set_files(call.run.files, path) {
            Ok(found) => found,
            Err(fault) => {
                let help = "name a folder that `compile` wrote, as it wrote it";
                return call.refuse(unfit(format!("`{}` {fault}", shown(&path.display().to_string())), help));
            }
        };
        let mut files = Vec::new();
        for (name, bytes) in found.files {
            files.push(self.add(call, format!("{folder}/{name}"), bytes)?);
        }
        Ok((found.lock, files))
    }
}

/// A set with the files in its folder and its subfolders.
#[derive(Debug, Clone)]
pub struct SetFiles {
    /// The manifest.
    pub lock: Lock,
    /// Name within the folder, and bytes; the manifest is one of them.
    pub files: Vec<(String, Vec<u8>)>,
}

/// Reason why a folder holds no whole set.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SetFault {
    /// It has no manifest that abbe wrote.
    #[error("holds no set with a manifest that abbe wrote")]
    NoManifest,
    /// A file of the manifest is missing, or has other bytes.
    #[error("holds a set whose `{}` is missing or was edited", shown(.0))]
    Changed(String),
    /// Its files have more bytes than any set.
    #[error("holds a set of more than {} MB", SET_LIMIT >> 20)]
    TooLarge,
}

/// Reads a whole set: the files that its manifest lists with the bytes that it lists, and those of its parts.
///
/// Fails if there is no manifest, if a file is missing or was edited, and if the files are larger than any set.
pub fn set_files(files: &dyn Files, folder: &Path) -> Result<SetFiles, SetFault> {
    let mut set = files_of(files, folder, &mut 0)?;
    for part in set.lock.parts.clone() {
        let changed = || SetFault::Changed(part.name.clone());
        if !is_plain_name(&part.name) {
            return Err(changed());
        }
        let mut bytes = set.files.iter().map(|(_, bytes)| bytes.len() as u64).sum();
        let inner = files_of(files, &folder.join(&part.name), &mut bytes)?;
        // Parts of parts are not written.
        if !inner.lock.parts.is_empty() || inner.files.first().is_none_or(|(_, lock)| sha256(lock) != part.sha256) {
            return Err(changed());
        }
        set.files.extend(inner.files.into_iter().map(|(name, bytes)| (format!("{}/{name}", part.name), bytes)));
    }
    Ok(set)
}

/// Reads the manifest of a folder and the files that it lists; `total` counts the bytes.
fn files_of(files: &dyn Files, folder: &Path, total: &mut u64) -> Result<SetFiles, SetFault> {
    let bytes = files.read_at_most(&folder.join(LOCK_NAME), SET_LIMIT).map_err(|_| SetFault::NoManifest)?;
    let lock = std::str::from_utf8(&bytes).ok().and_then(Lock::from_text).ok_or(SetFault::NoManifest)?;
    let mut all = vec![(LOCK_NAME.to_owned(), bytes)];
    for file in &lock.files {
        let changed = || SetFault::Changed(file.name.clone());
        if !is_plain_name(&file.name) {
            return Err(changed());
        }
        let bytes = files.read_at_most(&folder.join(&file.name), SET_LIMIT).map_err(|_| changed())?;
        *total += bytes.len() as u64;
        if *total > SET_LIMIT {
            return Err(SetFault::TooLarge);
        }
        if sha256(&bytes) != file.sha256 {
            return Err(changed());
        }
        all.push((file.name.clone(), bytes));
    }
    Ok(SetFiles { lock, files: all })
}

fn unreadable(path: &Path, failure: &ReadFailure) -> crate::diagnostic::Diagnostic {
    crate::syntax::unreadable(path, failure)
}

/// A plain name: other characters become `_`.
fn tame(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.') { c } else { '_' };
    let mut tame: String = name.chars().map(plain).collect();
    // The ending stays.
    let excess = tame.len().saturating_sub(80);
    drop(tame.drain(..excess));
    if tame.is_empty() || tame.starts_with('.') { format!("_{}", tame.get(1..).unwrap_or_default()) } else { tame }
}

/// The folder in which all files are, directly or below it.
fn common(paths: &[PathBuf]) -> PathBuf {
    let folder = |path: &PathBuf| path.parent().map(Path::to_owned).unwrap_or_default();
    let mut top = paths.first().map(folder).unwrap_or_default();
    while !paths.iter().all(|path| path.starts_with(&top)) {
        if !top.pop() {
            return PathBuf::new();
        }
    }
    top
}

/// A relative path of plain names, `/` between them.
fn plain(path: &Path) -> Option<String> {
    let part = |part: Component<'_>| match part {
        Component::Normal(name) => name.to_str().filter(|name| is_plain_name(name)).map(str::to_owned),
        _ => None,
    };
    path.components().map(part).collect::<Option<Vec<_>>>().map(|parts| parts.join("/"))
}
