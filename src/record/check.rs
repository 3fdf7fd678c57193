//! A record on disk against the list of its hashes.

use super::data::{MachineState, RecordSignature};
use super::files::{JSON_NAME, SUMS_NAME, set_files};
use super::sign::{SIGNATURE_NAME, refuse_changed, verify};
use crate::controller::is_plain_name;
use crate::diagnostic::{Diagnostic, Sources, codes, shown};
use crate::file_set::folder::SET_LIMIT;
use crate::run::{Call, Hashed, Refused, Reply, Run, sha256};
use crate::syntax::{EntryKind, Files, ReadFailure, unreadable};
use serde::Deserialize;
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
    /// The signature, which holds; `null` if the record is not signed.
    pub signature: Option<RecordSignature>,
    /// True if the signature is of the key that was given.
    pub of_given_key: bool,
    /// SHA-256 of the list itself: who notes it elsewhere notices a change of any file.
    pub sha256: String,
}

/// What `record.json` states of the files. Records of earlier versions have neither signature nor `files`.
#[derive(Deserialize)]
struct StatedFiles {
    data: Vec<StatedCopy>,
    figures: Vec<StatedCopy>,
    as_found: MachineState,
    as_left: Option<MachineState>,
    sets: Vec<StatedSet>,
    signature: Option<RecordSignature>,
    files: Option<Vec<Hashed>>,
}

#[derive(Deserialize)]
struct StatedCopy {
    file: String,
    sha256: String,
}

#[derive(Deserialize)]
struct StatedSet {
    files: Vec<Hashed>,
}

impl StatedFiles {
    /// Names and hashes, a file as often as it is stated.
    fn all(&self) -> impl Iterator<Item = (&str, &str)> {
        let copies = self.data.iter().chain(&self.figures).map(|of| (of.file.as_str(), of.sha256.as_str()));
        let states = std::iter::once(&self.as_found).chain(&self.as_left).flat_map(|state| &state.inputs);
        let sets = self.sets.iter().flat_map(|set| &set.files);
        let hashed = states.chain(sets).chain(self.files.iter().flatten());
        copies.chain(hashed.map(|of| (of.name.as_str(), of.sha256.as_str())))
    }
}

/// Compares every file of a record with its SHA-256, in the list and in `record.json`, and the signature, if there is
/// one; with the file of a public key it has to be of this key.
///
/// Fails if the folder is no record, if a file is missing or has changed, and if the signature does not hold.
pub fn check_record(folder: &Path, key: Option<&Path>, run: Run) -> Reply<RecordCheck> {
    Call::answer(run, &Sources::default(), |call| check(call, folder, key))
}

pub(crate) fn check(call: &mut Call, folder: &Path, key: Option<&Path>) -> Result<RecordCheck, Refused> {
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
    let signature = compare_stated(call, folder, &list, key)?;
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
    let of_given_key = key.is_some();
    Ok(RecordCheck { folder: name, files: list.len(), replaced_sets, unlisted, signature, of_given_key, sha256 })
}

/// Compares the list with what `record.json` states, which whoever writes the list anew forgets or cannot sign.
fn compare_stated(
    call: &mut Call,
    folder: &Path,
    list: &BTreeMap<String, String>,
    key: Option<&Path>,
) -> Result<Option<RecordSignature>, Refused> {
    let name = shown(&folder.display().to_string());
    let read = |name: &str| call.run.files.read_at_most(&folder.join(name), SET_LIMIT).unwrap_or_default();
    let (json, signature) = (read(JSON_NAME), read(SIGNATURE_NAME));
    let Ok(stated) = serde_json::from_slice::<StatedFiles>(&json) else {
        return call.refuse(refuse_changed(format!("`{JSON_NAME}` of `{name}` is no record of version 1")));
    };
    verify(call, &name, stated.signature.as_ref(), &json, &signature, key)?;
    let hashes: BTreeMap<&str, &str> = stated.all().collect();
    let differs = |(file, hash): (&str, &str)| list.get(file).is_none_or(|listed| listed != hash);
    let changed = stated.all().filter(|of| differs(*of)).map(|(file, _)| file);
    let own = [JSON_NAME, SIGNATURE_NAME];
    let named = |file: &&str| own.contains(file) || stated.files.is_none() || hashes.contains_key(file);
    let strange = list.keys().map(String::as_str).filter(|file| !named(file));
    for file in changed.chain(strange).collect::<std::collections::BTreeSet<_>>() {
        let message = format!("`{}` of `{name}` is not the file that `{JSON_NAME}` states", shown(file));
        call.extend([refuse_changed(message)]);
    }
    call.check()?;
    Ok(stated.signature)
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
