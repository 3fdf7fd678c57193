//! Results of a study walk by walk as text: a line that identifies the study, then a line for each round and walk.
//! Parts of a study, made on other machines or before an interruption, are put together from these.

use crate::analysis::enumerate::{Journal, RoundRecord, RoundStep};
use crate::run::sha256;
use serde::{Deserialize, Serialize};

/// The reason why text is not a journal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct JournalFailure {
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
    /// SHA-256 of the lines that follow.
    sha256: String,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Step {
    round: usize,
    step: usize,
    records: Vec<RoundRecord>,
}

/// Version of the text's form.
const FORM: &str = "4";

/// Returns the journal as text; numbers are written so that they are read back to the last bit.
pub(crate) fn to_text(journal: &Journal) -> String {
    let mut text = String::new();
    for (RoundStep { round, step }, records) in &journal.done {
        let step = Step { round: *round, step: *step, records: records.clone() };
        text += &serde_json::json!(step).to_string();
        text.push('\n');
    }
    let head = Head {
        abbe_enumerate: FORM.to_owned(),
        fingerprint: journal.fingerprint.clone(),
        steps: journal.steps,
        sha256: sha256(text.as_bytes()),
    };
    format!("{}\n{text}", serde_json::json!(head))
}

/// Returns the journal written as text. Fails with the line and the reason.
pub(crate) fn parse(text: &str) -> Result<Journal, JournalFailure> {
    let failure = |line: usize, why: String| JournalFailure { line: line + 1, why };
    let mut lines = text.lines().enumerate();
    let (_, first) = lines.next().ok_or_else(|| failure(0, "the file is empty".to_owned()))?;
    let head: Head = serde_json::from_str(first).map_err(|e| failure(0, e.to_string()))?;
    if head.abbe_enumerate != FORM {
        return Err(failure(0, format!("it is of form `{}`, known is `{FORM}`", head.abbe_enumerate)));
    }
    let mut journal = Journal::new(head.fingerprint.clone(), head.steps);
    for (number, line) in lines {
        let Step { round, step, records } = serde_json::from_str(line).map_err(|e| failure(number, e.to_string()))?;
        if records.iter().flat_map(|record| &record.values).any(|um| !um.is_finite() || *um < 0.0) {
            return Err(failure(number, "an error of a drawn machine is below zero".to_owned()));
        }
        if step >= journal.steps {
            return Err(failure(number, format!("walk {step} of {}", journal.steps)));
        }
        if journal.done.insert(RoundStep { round, step }, records).is_some() {
            return Err(failure(number, format!("walk {step} of round {round} is there twice")));
        }
    }
    if sha256(text.split_once('\n').map_or("", |(_, rest)| rest).as_bytes()) != head.sha256 {
        return Err(failure(0, "lines were altered or are missing: the checksum is of others".to_owned()));
    }
    Ok(journal)
}
