//! Results walk by walk.

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
    /// The same with the best fit of each machine taken out, where it is asked for besides.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub best_fit: Vec<f64>,
    /// The ranked value of the machine as its file has it, on those of the tool poses that it reaches and all machines
    /// drawn so far, um; `None` without such, and without values.
    pub file: Option<f64>,
    /// The value of the arrangement on these tool poses, where they are not all of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub common: Option<f64>,
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
}
