//! Results walk by walk as text: a line that identifies the study, then a line for each walk. Parts of a study, made on
//! other machines or before an interruption, are put together from these.

use super::ranking::Row;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Results of a study so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Journal {
    /// Fingerprint of the study: results with another one do not belong to it.
    pub fingerprint: String,
    /// Number of walks.
    pub steps: usize,
    /// Rows of the finished walks, by index.
    pub done: BTreeMap<usize, Vec<Row>>,
}

/// The reason why text is not a journal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JournalFailure {
    /// The line, from 1.
    pub line: usize,
    /// The reason.
    pub why: String,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    abbe_enumerate: String,
    fingerprint: String,
    steps: usize,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Step {
    step: usize,
    rows: Vec<Row>,
}

/// Version of the text's form.
const FORM: &str = "2";

impl Journal {
    /// Returns a journal without results.
    pub fn new(fingerprint: String, steps: usize) -> Self {
        Self { fingerprint, steps, done: BTreeMap::new() }
    }

    /// True if all walks are finished.
    pub fn is_complete(&self) -> bool {
        self.done.len() == self.steps
    }

    /// Returns all rows, walk by walk.
    pub fn rows(&self) -> Vec<Row> {
        self.done.values().flatten().cloned().collect()
    }

    /// Returns the journal as text; numbers are written so that they are read back to the last bit.
    pub fn to_text(&self) -> String {
        let head = Head { abbe_enumerate: FORM.to_owned(), fingerprint: self.fingerprint.clone(), steps: self.steps };
        let mut text = serde_json::json!(head).to_string() + "\n";
        for (step, rows) in &self.done {
            text += &serde_json::json!(Step { step: *step, rows: rows.clone() }).to_string();
            text.push('\n');
        }
        text
    }

    /// Returns the journal written as text. Fails with the line and the reason.
    pub fn parse(text: &str) -> Result<Self, JournalFailure> {
        let failure = |line: usize, why: String| JournalFailure { line: line + 1, why };
        let mut lines = text.lines().enumerate();
        let (_, first) = lines.next().ok_or_else(|| failure(0, "the file is empty".to_owned()))?;
        let head: Head = serde_json::from_str(first).map_err(|e| failure(0, e.to_string()))?;
        if head.abbe_enumerate != FORM {
            return Err(failure(0, format!("it is of form `{}`, known is `{FORM}`", head.abbe_enumerate)));
        }
        let mut journal = Self::new(head.fingerprint, head.steps);
        for (number, line) in lines {
            let Step { step, rows } = serde_json::from_str(line).map_err(|e| failure(number, e.to_string()))?;
            if step >= journal.steps {
                return Err(failure(number, format!("walk {step} of {}", journal.steps)));
            }
            if journal.done.insert(step, rows).is_some() {
                return Err(failure(number, format!("walk {step} is there twice")));
            }
        }
        Ok(journal)
    }
}
