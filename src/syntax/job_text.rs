//! A job as it is written, before its form is judged: a section of a machine file, or a file of its own.

use super::entry::entry;
use super::files::lexical;
use super::nulls::without_null;
use super::places::{Keys, Places, keys};
use crate::diagnostic::{Diagnostics, Place, Sources};
use serde::de::DeserializeOwned;
use serde_yaml::{Mapping, Value};
use std::path::PathBuf;

/// The key of a machine file under which its job stands.
pub(super) const SECTION: &str = "job";

/// The key of the file of tool poses.
pub(crate) const TOOL_POSES: &str = "tool_poses";

/// A job as it is written, with its places. What a job is stands in a later stage, which reads it.
#[derive(Debug, Clone)]
pub struct JobText {
    value: Value,
    places: Places,
    /// Its place in the file: under a key of a machine file, or at the top of a job file.
    at: Keys,
}

impl JobText {
    /// Takes the job of a machine file.
    pub(super) fn of_machine(value: Value, places: Places) -> Self {
        Self { value, places, at: keys([SECTION]) }
    }

    /// Takes the mapping of a job file.
    pub(super) fn of_file(map: Mapping, places: Places) -> Self {
        Self { value: without_null(Value::Mapping(map)), places, at: Keys::new() }
    }

    /// Reads the job; what does not fit is reported.
    pub fn read<T: DeserializeOwned>(&self, diagnostics: &mut Diagnostics) -> Option<T> {
        entry(self.value.clone(), &self.at, &mut self.places.clone(), diagnostics)
    }

    /// Returns the same job of a machine file that was read with some sources, for a run that has others.
    pub fn among(&self, own: &Sources, all: &mut Sources) -> Self {
        let ids = all.keep_all(own);
        Self { places: self.places.renumber(&ids), ..self.clone() }
    }

    /// Returns the file of the tool poses, from the folder of the file that names it.
    pub fn tool_poses(&self, written: &str) -> PathBuf {
        self.places.resolve_path(&self.below(&[TOOL_POSES]), written)
    }

    /// Returns the place of the value of an entry.
    pub fn value(&self, entry: &[&str]) -> Option<Place> {
        self.places.value(&self.below(entry))
    }

    /// Returns the place of the key of an entry.
    pub fn key(&self, entry: &[&str]) -> Option<Place> {
        self.places.key(&self.below(entry))
    }

    /// Returns the keys that an entry has as a mapping, in the order of the file.
    pub fn keys_of(&self, entry: &str) -> Vec<&str> {
        let entry = self.value.get(entry).and_then(Value::as_mapping);
        entry.into_iter().flat_map(|map| map.keys()).filter_map(Value::as_str).collect()
    }

    /// True if another job says the same, of the same file of tool poses.
    pub fn equals(&self, other: &Self) -> bool {
        let [own, others] = [self, other].map(|job| {
            let mut value = job.value.clone();
            let written = value.as_mapping_mut().and_then(|map| map.remove(TOOL_POSES));
            let file = written.as_ref().and_then(Value::as_str).map(|written| lexical(&job.tool_poses(written)));
            (value, written.filter(|_| file.is_none()), file)
        });
        own == others
    }

    fn below(&self, entry: &[&str]) -> Keys {
        self.at.iter().cloned().chain(entry.iter().map(|key| (*key).to_owned())).collect()
    }
}
