//! A record on disk against the list of its hashes.

use super::files::{JSON_NAME, SUMS_NAME, set_files};
use crate::controller::is_plain_name;
use crate::diagnostic::{Diagnostic, Sources, codes, shown};
use crate::file_set::folder::SET_LIMIT;
use crate::run::{Call, Refused, Reply, Run, sha256};
use crate::syntax::{EntryKind, Files, ReadFailure, unreadable};
use std::collections::BTreeMap;
use std::path::Path;

/// Folder of sets that `compile --record` archives beside a record.
const REPLACED: &str = "replaced";

/// Maximum number of files of a record.
const MOST: usize = 20_000;

/// Deepest folder of a record.
const DEPTH: usize = 16;

/// A record that is as it was written.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct RecordCheck {
    /// The folder.
    pub folder: String,
    /// Number of files that are as the list states.
    pub files: usize,
    /// Number of sets that `compile --record` archived beside them, whole by their manifests.
    pub replaced_sets: usize,
    /// Files that no list names.
    pub unlisted: Vec<String>,
    /// SHA-256 of the list itself: who notes it elsewhere notices a change of any file.
    pub sha256: String,
}

/// Compares every file of a record with its SHA-256.
///
/// Fails if the folder is no record, and if a file is missing or has changed.
pub fn check_record(folder: &Path, run: Run) -> Reply<RecordCheck> {
    Call::answer(run, &Sources::default(), |call| check(call, folder))
}

pub(crate) fn check(call: &mut Call, folder: &Path) -> Result<RecordCheck, Refused> {
    let files = call.run.files;
    let name = shown(&folder.display().to_string());
    let sums = folder.join(SUMS_NAME);
    let bytes = match files.read_at_most(&sums, SET_LIMIT) {
        Ok(bytes) => bytes,
        Err(ReadFailure::NotFound) => Vec::new(),
        Err(failure) => return call.refuse(unreadable(&sums, &failure)),
    };
    let sha256 = sha256(&bytes);
    let Some(list) = list_hashes(bytes) else {
        let message = format!("`{name}` is no record: it has no list `{SUMS_NAME}` that abbe wrote");
        return call.refuse(refuse_changed(message));
    };
    for (file, hash) in &list {
        let path = folder.join(file);
        let fault = match files.read_at_most(&path, SET_LIMIT) {
            Ok(bytes) if crate::run::sha256(&bytes) == *hash => continue,
            Ok(_) => refuse_changed(format!("`{file}` of `{name}` has changed since the record was made")),
            Err(ReadFailure::NotFound) => refuse_changed(format!("`{file}` of `{name}` is missing")),
            Err(failure) => unreadable(&path, &failure),
        };
        call.extend([fault]);
    }
    call.check()?;
    let mut unlisted = Vec::new();
    let mut replaced_sets = 0;
    for entry in files.entries(folder).into_iter().filter(|entry| entry.name != SUMS_NAME) {
        if entry.name == REPLACED {
            replaced_sets += count_replaced(call, &folder.join(REPLACED));
        } else {
            strangers(files, folder, &entry.name, entry.kind, &list, &mut unlisted);
        }
    }
    call.check()?;
    for file in &unlisted {
        let message = format!("`{}` is not of the record", shown(file));
        call.warn(Diagnostic::new(codes::W0711, message).help("keep other files elsewhere"));
    }
    call.check()?;
    Ok(RecordCheck { folder: name, files: list.len(), replaced_sets, unlisted, sha256 })
}

fn refuse_changed(message: String) -> Diagnostic {
    Diagnostic::new(codes::E0821, message).help("take the record from a copy, or make it again from its sources")
}

/// Returns the hash of each file by its name; `None` if the bytes are no list of a record.
fn list_hashes(bytes: Vec<u8>) -> Option<BTreeMap<String, String>> {
    let text = String::from_utf8(bytes).ok()?;
    let line = |line: &str| {
        let (hash, name) = line.split_once("  ")?;
        let whole = hash.len() == 64 && hash.bytes().all(|b| b.is_ascii_hexdigit());
        (whole && name.split('/').all(is_plain_name)).then(|| (name.to_owned(), hash.to_owned()))
    };
    let list: BTreeMap<String, String> = text.lines().map(line).collect::<Option<_>>()?;
    (list.contains_key(JSON_NAME) && list.len() <= MOST).then_some(list)
}

/// Files at or below an entry that the list does not name. Links are not followed.
fn strangers(
    files: &dyn Files,
    folder: &Path,
    name: &str,
    kind: EntryKind,
    list: &BTreeMap<String, String>,
    found: &mut Vec<String>,
) {
    if found.len() >= MOST || name.matches('/').count() > DEPTH {
        return;
    }
    if kind != EntryKind::Other {
        found.extend((!list.contains_key(name)).then(|| name.to_owned()));
        return;
    }
    for entry in files.entries(&folder.join(name)) {
        strangers(files, folder, &format!("{name}/{}", entry.name), entry.kind, list, found);
    }
}

/// Number of whole sets in the folder of replaced ones; refuses the others.
fn count_replaced(call: &mut Call, folder: &Path) -> usize {
    let mut count = 0;
    for entry in call.run.files.entries(folder) {
        match set_files(call.run.files, &folder.join(&entry.name)) {
            Ok(_) => count += 1,
            Err(fault) => call.extend([refuse_changed(format!("`{REPLACED}/{}` {fault}", shown(&entry.name)))]),
        }
    }
    count
}
