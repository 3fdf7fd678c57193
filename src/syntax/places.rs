//! Places by path: `["axes", "X", "travel", "0"]` -> where its key and its value stand.

use crate::diagnostic::{Place, SourceId};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Keys and indices from the top of the document.
pub type Keys = Vec<String>;

/// The place of an entry.
#[derive(Debug, Clone)]
pub struct Spot {
    /// Its key; none for members of lists and the document itself.
    pub key: Option<Place>,
    /// Its value.
    pub value: Place,
}

/// The place of every entry of a document, in any of its files.
#[derive(Debug, Clone, Default)]
pub struct Places {
    spots: BTreeMap<Keys, Spot>,
    files: BTreeMap<SourceId, PathBuf>,
    marred: BTreeSet<Keys>,
}

impl Places {
    pub(super) fn add_file(&mut self, source: SourceId, path: &Path) {
        self.files.insert(source, path.to_owned());
    }

    pub(super) fn insert(&mut self, keys: Keys, spot: Spot) {
        self.spots.insert(keys, spot);
    }

    /// Remembers that part of an entry was refused, so that what is missing there is not asked for.
    pub(super) fn mar(&mut self, keys: &[String]) {
        self.marred.insert(keys.to_vec());
    }

    /// True if the entry or part of it was refused.
    pub fn is_marred(&self, keys: &[String]) -> bool {
        let from = self.marred.range(keys.to_vec()..).next();
        from.is_some_and(|k| k.starts_with(keys)) || self.is_lost(keys)
    }

    /// True if the entry as a whole, or its container, was refused.
    pub fn is_lost(&self, keys: &[String]) -> bool {
        (1..=keys.len()).any(|n| self.marred.contains(&keys[..n]))
    }

    /// True if there is an entry.
    pub fn has(&self, keys: &[String]) -> bool {
        self.spots.contains_key(keys)
    }

    /// The entry, or else the nearest that contains it.
    fn nearest(&self, keys: &[String]) -> Option<&Spot> {
        (0..=keys.len()).rev().find_map(|n| self.spots.get(&keys[..n]))
    }

    /// Returns the place of the value.
    pub fn value(&self, keys: &[String]) -> Option<Place> {
        self.nearest(keys).map(|spot| spot.value.clone())
    }

    /// Returns the place of the key, or of the value if there is no key.
    pub fn key(&self, keys: &[String]) -> Option<Place> {
        self.nearest(keys).map(|spot| spot.key.as_ref().unwrap_or(&spot.value).clone())
    }

    /// The file that a place is in.
    pub fn file(&self, place: &Place) -> Option<&Path> {
        self.files.get(&place.source).map(PathBuf::as_path)
    }

    /// A path written in the entry, relative to the file that names it.
    pub fn resolve_path(&self, keys: &[String], written: &str) -> PathBuf {
        let folder = self.value(keys).and_then(|place| self.file(&place)?.parent().map(Path::to_owned));
        folder.unwrap_or_default().join(written)
    }

    /// Forgets an entry and all below it.
    pub(super) fn remove(&mut self, keys: &[String]) {
        let below: Vec<Keys> =
            self.spots.range(keys.to_vec()..).map(|(k, _)| k).take_while(|k| k.starts_with(keys)).cloned().collect();
        below.iter().for_each(|k| {
            self.spots.remove(k);
        });
    }

    /// Takes over an entry and all below it.
    pub(super) fn adopt(&mut self, keys: &[String], other: &Self) {
        self.remove(keys);
        let below = other.spots.range(keys.to_vec()..).take_while(|(k, _)| k.starts_with(keys));
        self.spots.extend(below.map(|(k, s)| (k.clone(), s.clone())));
    }

    /// Returns the same places where files have other numbers: the first is now `ids[0]`, and so on.
    pub(super) fn renumber(&self, ids: &[SourceId]) -> Self {
        let id = |source: &SourceId| ids.get(source.0).copied().unwrap_or(*source);
        let place = |place: &Place| Place { source: id(&place.source), range: place.range.clone() };
        let spot = |spot: &Spot| Spot { key: spot.key.as_ref().map(place), value: place(&spot.value) };
        Self {
            spots: self.spots.iter().map(|(keys, of)| (keys.clone(), spot(of))).collect(),
            files: self.files.iter().map(|(source, path)| (id(source), path.clone())).collect(),
            marred: self.marred.clone(),
        }
    }

    /// Takes over the other document's files.
    pub(super) fn adopt_files(&mut self, other: &Self) {
        self.files.extend(other.files.iter().map(|(k, v)| (*k, v.clone())));
    }
}

/// Keys from string slices.
pub fn keys<const N: usize>(parts: [&str; N]) -> Keys {
    parts.iter().map(|p| (*p).to_owned()).collect()
}

/// `keys` with one more.
pub fn below(keys: &[String], key: impl ToString) -> Keys {
    let mut keys = keys.to_vec();
    keys.push(key.to_string());
    keys
}
