//! Arrangements with their results, and their order.

use crate::analysis::design::budget::{Verdict, VersusFirst};
use crate::analysis::design::compare::UnreachableCount;
use serde::{Deserialize, Serialize};

/// The standing of an arrangement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Standing {
    /// It reaches tool poses and has a result.
    Judged,
    /// Its rotary axes cannot turn the tool in as many directions as the work requires.
    CannotTurn,
    /// It reaches none of the tool poses.
    ReachesNothing,
    /// It does not reach the point at which the part is probed.
    MissesReference,
}

/// An arrangement and its result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct ArrangementRow {
    /// The chain as ISO prints it.
    pub chain: String,
    /// Number of axes that carry the workpiece.
    pub table: usize,
    /// Result of the arrangement.
    pub standing: Standing,
    /// Tool poses it reaches.
    pub reached: usize,
    /// Those it does not.
    pub unreachable: UnreachableCount,
    /// Over the tool poses it reaches, um.
    pub result: Option<ArrangementErrors>,
    /// Names of the axes, or `workpiece`, whose geometry the file does not state for the side where they stand.
    pub not_stated: Vec<String>,
    /// The travel that the work needs of each axis (mm, deg), for a study that sizes them.
    #[serde(default)]
    pub travel: Vec<NeededRange>,
    /// Number of its rewinds, where the tool poses are a path.
    #[serde(default)]
    pub rewinds: Option<usize>,
}

/// The positions of an axis over a work.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct NeededRange {
    /// Name of the axis.
    pub axis: String,
    /// Smallest position, mm or deg.
    pub min: f64,
    /// Largest position, mm or deg.
    pub max: f64,
}

/// The position error of an arrangement over the tool poses it reaches, um.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct ArrangementErrors {
    /// Value of the ranking: the 95 % value of the drawn machines, or the statistic of the errors given.
    pub um: f64,
    /// Interval that holds the 95 % value with 95 % confidence, where there are enough samples.
    pub low: Option<f64>,
    /// Its upper end.
    pub high: Option<f64>,
    /// Mean of the drawn machines.
    pub mean: Option<f64>,
    /// Value of the ranking minus that of the machine as its file has it, on the tool poses that both reach; `None`
    /// without such.
    pub minus_file: Option<f64>,
    /// Number of machines drawn of the arrangement; `None` by the errors given.
    pub samples: Option<usize>,
    /// Standing against rank 1; `None` for those that are not ranked.
    pub versus_first: Option<VersusFirst>,
    /// The same with the best fit of each machine taken out, where it is asked for besides.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub best_fit: Option<FittedArrangement>,
}

/// The position error of an arrangement without the rigid motion of the part that fits its deviations best.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct FittedArrangement {
    /// Its figure, um.
    pub um: f64,
    /// Its figure minus that of rank 1; none where it is not ranked.
    pub versus_first: Option<VersusFirst>,
}

/// Arrangements in four groups, each in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranking {
    /// Best first; of equal ones the one listed first.
    pub ranked: Vec<ArrangementRow>,
    /// Judged, but they miss tool poses. First those that reach enough, by their difference to the machine as its file
    /// has it on the same tool poses; then those that reach more.
    pub short: Vec<ArrangementRow>,
    /// The file does not state their geometry; first those that reach enough of the work, best first.
    pub not_stated: Vec<ArrangementRow>,
    /// They cannot turn the tool as the work requires.
    pub cannot_turn: Vec<ArrangementRow>,
}

/// The work, and the part of it that an arrangement reaches to be listed by its figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// Number of tool poses.
    pub work: usize,
    /// Minimum fraction of them, 0 to 1.
    pub fraction: f64,
}

impl Reach {
    /// True for an arrangement that does the whole work: only these are compared with each other.
    pub fn is_whole(self, row: &ArrangementRow) -> bool {
        row.standing == Standing::Judged && row.reached == self.work
    }

    /// True for an arrangement that reaches enough to be listed by its figure.
    pub fn is_enough(self, row: &ArrangementRow) -> bool {
        row.standing == Standing::Judged && row.reached as f64 >= self.fraction * self.work as f64
    }
}

/// Returns the arrangements in order.
pub fn rank(rows: Vec<ArrangementRow>, reach: Reach) -> Ranking {
    let (cannot_turn, able): (Vec<ArrangementRow>, Vec<ArrangementRow>) =
        rows.into_iter().partition(|r| r.standing == Standing::CannotTurn);
    let (not_stated, able): (Vec<ArrangementRow>, Vec<ArrangementRow>) =
        able.into_iter().partition(|row| !row.not_stated.is_empty());
    let (ranked, short) = in_order(able, reach);
    let (mut apart, rest) = in_order(not_stated, reach);
    apart.extend(rest);
    Ranking { ranked, short, not_stated: apart, cannot_turn }
}

/// Returns those that do the whole work, best first, and the others.
fn in_order(rows: Vec<ArrangementRow>, reach: Reach) -> (Vec<ArrangementRow>, Vec<ArrangementRow>) {
    let (mut ranked, mut short): (Vec<ArrangementRow>, Vec<ArrangementRow>) =
        rows.into_iter().partition(|row| reach.is_whole(row));
    let um = |row: &ArrangementRow| row.result.map_or(f64::INFINITY, |result| result.um);
    // Against rank 1, on the machines drawn of both: what was left after a round has fewer of them.
    let key = |row: &ArrangementRow| match row.result.and_then(|result| result.versus_first) {
        Some(VersusFirst { verdict: Verdict::First, .. }) => f64::NEG_INFINITY,
        Some(versus) => versus.minus_first.value,
        None => um(row),
    };
    ranked.sort_by(|a, b| key(a).total_cmp(&key(b)));
    // Values over different tool poses are no ranks: each counts against the file's machine on its own ones.
    let versus_file = |row: &ArrangementRow| row.result.and_then(|result| result.minus_file).unwrap_or(f64::INFINITY);
    short.sort_by(|a, b| {
        let by_reach = b.reached.cmp(&a.reached).then(versus_file(a).total_cmp(&versus_file(b)));
        match (reach.is_enough(a), reach.is_enough(b)) {
            (true, true) => versus_file(a).total_cmp(&versus_file(b)).then(by_reach),
            (enough, other) => other.cmp(&enough).then(by_reach),
        }
    });
    (ranked, short)
}
