//! Rounds of a study: all arrangements have the machines of the first round, and those that could still be among the
//! first have more, up to a limit.
//!
//! The sizes of the rounds are fixed beforehand, and the probability of error is split evenly over them. After a round,
//! from the results of all in the order of arrangements, those leave that are worse than each of the first K. Which
//! they are depends on the records alone, not on how the study was cut.

use super::journal::{Journal, RoundRecord, RoundStep};
use super::ranking::{ArrangementErrors, ArrangementRow, FittedArrangement, Reach};
use crate::analysis::design::budget::{
    PairedDifference, PairedTest, Percentile, Verdict, VersusFirst, are_equal, mean, percentile_95, round_sizes,
};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;

/// The plan of the rounds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rounds {
    /// Number of drawn machines after each round.
    sizes: Vec<usize>,
    /// Number of first ranks that are to be told apart.
    first: usize,
    /// True if values are drawn; the errors given have one value.
    drawn: bool,
}

impl Rounds {
    /// Returns rounds that begin with `samples` machines and double them up to `limit`, until the first `first` ranks
    /// are told apart.
    pub fn doubling(samples: usize, limit: usize, first: usize) -> Self {
        let sizes = round_sizes(samples, limit);
        Self { sizes, first: first.max(1), drawn: true }
    }

    /// Returns the only round of arrangements that are judged by the errors given.
    pub fn single() -> Self {
        Self { sizes: vec![1], first: 1, drawn: false }
    }

    /// The machines that are drawn in a round.
    pub fn samples(&self, round: usize) -> Range<usize> {
        let begin = round.checked_sub(1).and_then(|before| self.sizes.get(before)).copied().unwrap_or(0);
        begin..self.sizes.get(round).copied().unwrap_or(begin)
    }

    /// Number of machines after each round.
    pub fn sizes(&self) -> &[usize] {
        &self.sizes
    }

    fn test(&self, samples: usize, arrangements: usize) -> PairedTest {
        PairedTest::of_round(samples, arrangements, self.sizes.len())
    }
}

/// A finished round.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct RoundCount {
    /// Number of machines of each arrangement after it.
    pub samples: usize,
    /// Number of arrangements that took part.
    pub arrangements: usize,
}

/// State of a study by its records.
#[derive(Debug, Clone, PartialEq)]
pub enum Standings {
    /// Walks are not done.
    Missing(MissingSteps),
    /// All rounds are done.
    Done(StudyEnd),
}

/// The walks that a round takes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MissingSteps {
    /// The round, from 0.
    pub round: usize,
    /// Number of walks of the round.
    pub walks: usize,
    /// The walks that are not done, with the numbers of axes on the table; `None` for all.
    pub todo: BTreeMap<usize, Option<Vec<usize>>>,
}

/// The end of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyEnd {
    /// All arrangements with their results.
    pub rows: Vec<ArrangementRow>,
    /// Limits of the ranked ones.
    pub reach: Reach,
    /// The rounds.
    pub rounds: Vec<RoundCount>,
    /// True if the first K ranks are told apart.
    pub told: bool,
}

struct Entrant<'a> {
    step: usize,
    record: &'a RoundRecord,
    values: Vec<f64>,
    /// The same with the best fit.
    best_fit: Vec<f64>,
    file: FileValues,
    /// Number of different arrangements in its last round.
    rivals: usize,
}

/// The ranked values on the tool poses that an arrangement and the machine as its file has it both reach, um.
#[derive(Debug, Clone, Copy)]
struct FileValues {
    /// That of the machine; `None` without such tool poses.
    file: Option<f64>,
    /// That of the arrangement, where they are not all of its own.
    own: Option<f64>,
}

impl FileValues {
    fn of(record: &RoundRecord) -> Self {
        Self { file: record.file, own: record.common }
    }
}

struct Decision {
    /// Rank 1, among the entrants.
    leader: usize,
    /// Those that go on.
    next: Vec<usize>,
    told: bool,
}

/// Returns what is missing, or the end, of a study of `steps` walks.
pub fn standings(journal: &Journal, rounds: &Rounds, fraction: f64) -> Standings {
    let missing = (0..journal.steps).filter(|step| !journal.done.contains_key(&RoundStep { round: 0, step: *step }));
    let todo: BTreeMap<usize, Option<Vec<usize>>> = missing.map(|step| (step, None)).collect();
    if !todo.is_empty() {
        return Standings::Missing(MissingSteps { round: 0, walks: journal.steps, todo });
    }
    let work = journal.round(0).map(|(_, record)| record.row.reached + record.row.unreachable.total).max().unwrap_or(0);
    let reach = Reach { work, fraction };
    let mut entrants: Vec<Entrant<'_>> = journal
        .round(0)
        .filter(|(_, record)| reach.is_whole(&record.row) && record.row.not_stated.is_empty())
        .map(|(step, record)| {
            let (values, best_fit) = (record.values.clone(), record.best_fit.clone());
            Entrant { step, record, values, best_fit, file: FileValues::of(record), rivals: 1 }
        })
        .collect();
    let mut inside: Vec<usize> = (0..entrants.len()).collect();
    let mut counts = Vec::new();
    let mut last = None;
    for round in 0..rounds.sizes.len() {
        if round > 0 {
            let todo = missing_of(journal, round, &entrants, &inside);
            if let Some(missing) = todo {
                return Standings::Missing(missing);
            }
            inside.iter().for_each(|i| take(journal, round, &mut entrants[*i]));
        }
        let Some(decision) = decide(&mut entrants, &inside, rounds, round) else { break };
        counts.push(RoundCount { samples: rounds.sizes[round], arrangements: inside.len() });
        inside.clone_from(&decision.next);
        let told = decision.told;
        last = Some(decision);
        if told {
            break;
        }
    }
    Standings::Done(study_end(journal, rounds, reach, &entrants, last, counts))
}

/// Returns the walks of a round that are not done, if any.
fn missing_of(journal: &Journal, round: usize, entrants: &[Entrant<'_>], inside: &[usize]) -> Option<MissingSteps> {
    let mut steps: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for entrant in inside.iter().map(|i| &entrants[*i]) {
        steps.entry(entrant.step).or_default().push(entrant.record.row.table);
    }
    let walks = steps.len();
    let todo: BTreeMap<usize, Option<Vec<usize>>> = steps
        .into_iter()
        .filter(|(step, _)| !journal.done.contains_key(&RoundStep { round, step: *step }))
        .map(|(step, tables)| (step, Some(tables)))
        .collect();
    (!todo.is_empty()).then_some(MissingSteps { round, walks, todo })
}

fn take(journal: &Journal, round: usize, entrant: &mut Entrant<'_>) {
    let records = journal.done.get(&RoundStep { round, step: entrant.step });
    let table = entrant.record.row.table;
    if let Some(record) = records.into_iter().flatten().find(|record| record.row.table == table) {
        entrant.values.extend(&record.values);
        entrant.best_fit.extend(&record.best_fit);
        entrant.file = FileValues::of(record);
    }
}

/// Returns the decision after a round; `None` without arrangements.
fn decide(entrants: &mut [Entrant<'_>], inside: &[usize], rounds: &Rounds, round: usize) -> Option<Decision> {
    let classes = equal_classes(entrants, inside);
    let leader = *classes.first()?.first()?;
    inside.iter().for_each(|i| entrants[*i].rivals = classes.len());
    if !rounds.drawn || classes.len() == 1 {
        return Some(Decision { leader, next: inside.to_vec(), told: true });
    }
    let test = rounds.test(rounds.sizes[round], classes.len());
    let values = |class: &Vec<usize>| &entrants[class[0]].values;
    let is_open = |place: &usize| {
        let before = &classes[..rounds.first.min(*place)];
        before.iter().any(|leader| !test.exceeds(values(&classes[*place]), values(leader)))
    };
    let open: Vec<usize> = (1..classes.len()).into_par_iter().filter(is_open).collect();
    let stays = |place: usize| place < rounds.first || open.binary_search(&place).is_ok();
    let mut next: Vec<usize> =
        (0..classes.len()).filter(|place| stays(*place)).flat_map(|place| classes[place].iter().copied()).collect();
    next.sort_unstable();
    Some(Decision { leader, next, told: open.is_empty() })
}

/// Returns classes of equal arrangements, best first; in a class and of equal classes the one listed first.
fn equal_classes(entrants: &[Entrant<'_>], inside: &[usize]) -> Vec<Vec<usize>> {
    /// Beyond this fraction two 95 % values are not of equal arrangements.
    const NEAR: f64 = 1e-8;
    let mut order: Vec<(f64, usize)> = inside.par_iter().map(|i| (percentile_95(&entrants[*i].values), *i)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut classes: Vec<(f64, Vec<usize>)> = Vec::new();
    for (um, i) in order {
        let near = classes.iter_mut().rev().take_while(|(other, _)| um - *other <= NEAR * um);
        let equal = |class: &Vec<usize>| are_equal(&entrants[i].values, &entrants[class[0]].values);
        match near.into_iter().find(|(_, class)| equal(class)) {
            Some((_, class)) => class.push(i),
            None => classes.push((um, vec![i])),
        }
    }
    classes.into_iter().map(|(_, class)| class).collect()
}

fn study_end(
    journal: &Journal,
    rounds: &Rounds,
    reach: Reach,
    entrants: &[Entrant<'_>],
    last: Option<Decision>,
    counts: Vec<RoundCount>,
) -> StudyEnd {
    let mut tests: BTreeMap<(usize, usize), PairedTest> = BTreeMap::new();
    if rounds.drawn {
        for entrant in entrants {
            let key = (entrant.values.len(), entrant.rivals);
            let _ = tests.entry(key).or_insert_with(|| rounds.test(key.0, key.1));
        }
    }
    let leader = last.as_ref().map(|decision| decision.leader);
    let result = |i: usize| {
        let entrant = &entrants[i];
        let test = tests.get(&(entrant.values.len(), entrant.rivals));
        let versus = |values: for<'b> fn(&'b Entrant<'_>) -> &'b [f64]| {
            leader.map(|first| versus_first(values(entrant), values(&entrants[first]), i == first, test))
        };
        let result = outcome(&entrant.values, entrant.file, versus(|of| &of.values), rounds.drawn);
        let best_fit = fitted(&entrant.best_fit, || versus(|of| &of.best_fit));
        ((entrant.step, entrant.record.row.table), result.map(|result| ArrangementErrors { best_fit, ..result }))
    };
    let results: BTreeMap<(usize, usize), Option<ArrangementErrors>> =
        (0..entrants.len()).into_par_iter().map(result).collect();
    let row = |(step, record): (usize, &RoundRecord)| {
        let ranked = results.get(&(step, record.row.table)).copied();
        let result = ranked.unwrap_or_else(|| {
            let best_fit = fitted(&record.best_fit, || None);
            let result = outcome(&record.values, FileValues::of(record), None, rounds.drawn);
            result.map(|result| ArrangementErrors { best_fit, ..result })
        });
        ArrangementRow { result, ..record.row.clone() }
    };
    let rows = journal.round(0).map(row).collect();
    StudyEnd { rows, reach, rounds: counts, told: last.is_some_and(|decision| decision.told) }
}

/// Returns the standing of values against those of rank 1.
fn versus_first(values: &[f64], leader: &[f64], is_first: bool, test: Option<&PairedTest>) -> VersusFirst {
    let same = leader.get(..values.len()).unwrap_or(leader);
    let minus_first = PairedDifference::certain(values, same);
    match test {
        _ if is_first => VersusFirst { verdict: Verdict::First, minus_first },
        Some(test) => test.versus(values, same),
        None if are_equal(values, same) => VersusFirst { verdict: Verdict::Equal, minus_first },
        None => VersusFirst { verdict: Verdict::of_difference(minus_first.value), minus_first },
    }
}

/// Returns the result of values with the best fit (um), if there are any.
fn fitted(values: &[f64], versus_first: impl FnOnce() -> Option<VersusFirst>) -> Option<FittedArrangement> {
    (!values.is_empty()).then(|| FittedArrangement { um: percentile_95(values), versus_first: versus_first() })
}

/// Returns the result of values (um), if there are any.
fn outcome(
    values: &[f64],
    of_file: FileValues,
    versus_first: Option<VersusFirst>,
    drawn: bool,
) -> Option<ArrangementErrors> {
    if values.is_empty() {
        return None;
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Percentile { value: um, low, high, .. } = Percentile::of(&sorted, 95);
    let minus_file = of_file.file.map(|file| of_file.own.unwrap_or(um) - file);
    Some(if drawn {
        let mean = Some(mean(values).0);
        let samples = Some(values.len());
        ArrangementErrors { um, low, high, mean, minus_file, samples, versus_first, best_fit: None }
    } else {
        let (low, high, mean, samples, best_fit) = (None, None, None, None, None);
        ArrangementErrors { um, low, high, mean, minus_file, samples, versus_first, best_fit }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::design::compare::UnreachableCount;
    use crate::analysis::design::enumerate::ranking::{Standing, rank};

    #[test]
    fn rounds_double_up_to_the_limit() {
        let rounds = Rounds::doubling(200, 1500, 1);
        assert_eq!(rounds.sizes(), [200, 400, 800, 1500]);
        assert_eq!((rounds.samples(0), rounds.samples(3)), (0..200, 800..1500));
        assert_eq!(Rounds::doubling(200, 10, 1).sizes(), [200]);
    }

    /// Values of arrangement `k` in samples: a common part, one of its own, and what the arrangement is worse by.
    fn value(k: usize, sample: usize, worse: f64) -> f64 {
        let unit = |seed: u64| {
            let mut x = (seed + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
        };
        100.0 + 20.0 * unit(sample as u64) + 4.0 * unit((k as u64 + 7) << 32 | sample as u64) + worse
    }

    fn record(row: ArrangementRow, values: Vec<f64>) -> RoundRecord {
        RoundRecord { row, values, best_fit: Vec::new(), file: Some(100.0), common: None }
    }

    /// Runs a study of walks with one arrangement each: (identity of the noise, how much worse).
    fn run(arrangements: &[(usize, f64)], rounds: &Rounds) -> StudyEnd {
        let mut journal = Journal::new("x".to_owned(), arrangements.len());
        loop {
            let missing = match standings(&journal, rounds, 0.5) {
                Standings::Done(end) => return end,
                Standings::Missing(missing) => missing,
            };
            for step in missing.todo.keys() {
                let (k, worse) = arrangements[*step];
                let row = ArrangementRow {
                    chain: format!("{step}"),
                    table: 0,
                    standing: Standing::Judged,
                    reached: 10,
                    unreachable: UnreachableCount::default(),
                    result: None,
                    not_stated: Vec::new(),
                    travel: Vec::new(),
                    rewinds: None,
                };
                let values = rounds.samples(missing.round).map(|sample| value(k, sample, worse)).collect();
                let at = RoundStep { round: missing.round, step: *step };
                let _ = journal.done.insert(at, vec![record(row, values)]);
            }
        }
    }

    #[test]
    fn equal_ones_are_ties_and_clear_ones_leave_early() {
        // 350 equal arrangements, 9 far behind, one behind by little.
        let mut list = vec![(0, 0.0); 350];
        list.extend((1..10).map(|k| (k, 15.0 + k as f64)));
        list.push((20, 0.4));
        let rounds = Rounds::doubling(400, 12_800, 1);
        let end = run(&list, &rounds);
        assert!(end.told, "{:?}", end.rounds);
        assert_eq!(end.rounds[0], RoundCount { samples: 400, arrangements: 360 });
        assert!(end.rounds.len() > 1 && end.rounds[1].arrangements <= 352, "{:?}", end.rounds);
        let ranking = rank(end.rows, end.reach);
        let verdicts: Vec<Verdict> =
            ranking.ranked.iter().map(|row| row.result.unwrap().versus_first.unwrap().verdict).collect();
        assert_eq!(verdicts[0], Verdict::First);
        assert!(verdicts[1..350].iter().all(|verdict| *verdict == Verdict::Equal));
        assert!(verdicts[350..].iter().all(|verdict| *verdict == Verdict::Worse));
        assert_eq!(ranking.ranked[350].chain, "359");
        let versus = ranking.ranked[350].result.unwrap().versus_first.unwrap().minus_first;
        assert!(versus.low.unwrap() > 0.0 && versus.low.unwrap() <= 0.4 && versus.high.unwrap() >= 0.4, "{versus:?}");
    }

    #[test]
    fn what_is_the_same_in_law_is_hardly_ever_told_apart() {
        // Eight arrangements with the same distribution: any statement is wrong; at most 5 % of studies may make one.
        let rounds = Rounds::doubling(100, 800, 1);
        let wrong = (0..60_usize).filter(|study| {
            let list: Vec<(usize, f64)> = (0..8).map(|k| (1000 * study + k, 0.0)).collect();
            let end = run(&list, &rounds);
            end.rows.iter().any(|row| row.result.unwrap().versus_first.unwrap().verdict == Verdict::Worse)
        });
        assert!(wrong.count() <= 3);
    }

    #[test]
    fn the_first_three_are_told_apart_if_asked() {
        let list = [(1, 0.0), (2, 9.0), (3, 18.0), (4, 27.0), (5, 60.0)];
        let (one, three) = (Rounds::doubling(400, 6400, 1), Rounds::doubling(400, 6400, 3));
        assert!(run(&list, &one).told && run(&list, &three).told);
        let last = |end: StudyEnd| end.rounds.last().copied().unwrap();
        let close = [(1, 0.0), (2, 15.0), (3, 17.0), (4, 18.0), (5, 60.0)];
        assert!(last(run(&close, &one)).samples < last(run(&close, &three)).samples);
    }
}
