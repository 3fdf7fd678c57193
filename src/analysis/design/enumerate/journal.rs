//! Results walk by walk as text: a line that identifies the study, then a line for each round and walk. Parts of a
//! study, made on other machines or before an interruption, are put together from these.

use super::ranking::ArrangementRow;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Result of one round for an arrangement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoundRecord {
    /// The arrangement; without a result, which needs all rounds.
    pub row: ArrangementRow,
    /// Position error of each machine drawn in the round, in their order, um; by the errors given a single one.
    pub values: Vec<f64>,
    /// The ranked value of the machine as its file has it, on the same tool poses and all machines drawn so far, um;
    /// `None` without values.
    pub file: Option<f64>,
}

/// A walk in a round, both from 0: the rounds in their order, and in each the walks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct RoundStep {
    /// The round.
    pub round: usize,
    /// The walk.
    pub step: usize,
}

/// Results of a study so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Journal {
    /// Fingerprint of the study: results with another one do not belong to it.
    pub fingerprint: String,
    /// Number of walks.
    pub steps: usize,
    /// Records of the finished walks.
    pub done: BTreeMap<RoundStep, Vec<RoundRecord>>,
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
struct JournalStep {
    round: usize,
    step: usize,
    records: Vec<RoundRecord>,
}

/// Version of the text's form.
const FORM: &str = "3";

impl Journal {
    /// Returns a journal without results.
    pub fn new(fingerprint: String, steps: usize) -> Self {
        Self { fingerprint, steps, done: BTreeMap::new() }
    }

    /// Returns the records of a round with their walks, walk by walk.
    pub fn round(&self, round: usize) -> impl Iterator<Item = (usize, &RoundRecord)> {
        let range = RoundStep { round, step: 0 }..RoundStep { round: round + 1, step: 0 };
        self.done.range(range).flat_map(|(at, records)| records.iter().map(|record| (at.step, record)))
    }

    /// Returns the journal as text; numbers are written so that they are read back to the last bit.
    pub fn to_text(&self) -> String {
        let head = Head { abbe_enumerate: FORM.to_owned(), fingerprint: self.fingerprint.clone(), steps: self.steps };
        let mut text = serde_json::json!(head).to_string() + "\n";
        for (RoundStep { round, step }, records) in &self.done {
            let step = JournalStep { round: *round, step: *step, records: records.clone() };
            text += &serde_json::json!(step).to_string();
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
            let JournalStep { round, step, records } =
                serde_json::from_str(line).map_err(|e| failure(number, e.to_string()))?;
            if step >= journal.steps {
                return Err(failure(number, format!("walk {step} of {}", journal.steps)));
            }
            if journal.done.insert(RoundStep { round, step }, records).is_some() {
                return Err(failure(number, format!("walk {step} of round {round} is there twice")));
            }
        }
        Ok(journal)
    }
}
