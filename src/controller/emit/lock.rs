//! `abbe.lock.json`: the files that belong to a set, the inputs it was made from, and their hashes. By it our own
//! earlier files are distinguished from foreign and hand-edited ones.

use crate::machine::Machine;
use crate::run::{Hashed, sha256};

/// Name of the manifest of a file set.
pub const LOCK_NAME: &str = "abbe.lock.json";

/// The manifest of a file set.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Lock {
    /// Version of the program.
    pub abbe: String,
    /// The target.
    pub target: String,
    /// Name of the machine.
    pub machine: String,
    /// The tool for which the tables hold; empty if the machine has one without a name.
    #[serde(default)]
    pub tool: String,
    /// The options of the compensation: `position` or `pose`, and the axes that correct.
    #[serde(default)]
    pub options: Vec<String>,
    /// Conventions in force.
    pub conventions: serde_json::Value,
    /// Files read: name and SHA-256.
    pub inputs: Vec<Hashed>,
    /// Files written: name and SHA-256.
    pub files: Vec<Hashed>,
    /// The subfolders of a composed set, each with the SHA-256 of the manifest in it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<Hashed>,
    /// Files of earlier sets that were still in the folder.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stale: Vec<Hashed>,
}

impl Lock {
    /// The manifest of a set.
    pub fn new(target: &str, machine: &Machine, options: Vec<String>, inputs: Vec<Hashed>, files: Vec<Hashed>) -> Self {
        Self {
            abbe: env!("CARGO_PKG_VERSION").to_owned(),
            target: target.to_owned(),
            machine: machine.name().to_owned(),
            tool: machine.tool().name.clone(),
            options,
            conventions: serde_json::to_value(machine.conventions()).unwrap_or_default(),
            inputs,
            files,
            parts: Vec::new(),
            stale: Vec::new(),
        }
    }

    /// Returns the text of the manifest.
    pub fn to_text(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// Reads the text of a manifest; `None` if it is none.
    pub fn from_text(text: &str) -> Option<Self> {
        serde_json::from_str(text).ok()
    }

    /// True if the set lists this file with these bytes.
    pub fn wrote(&self, name: &str, bytes: &[u8]) -> bool {
        let hash = sha256(bytes);
        self.files.iter().any(|file| file.name == name && file.sha256 == hash)
    }
}
