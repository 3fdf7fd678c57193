//! All arrangements of the axes on the two sides of the bed, ranked on the same work.

use super::tolerances::{ClassSource, ToleranceOptions};
use super::withheld::{StudyCoverage, TurnedVerdicts, apart};
use crate::analysis::budget::{
    Bound, Coverage, PairedDifference, Statistic, Verdict, VersusFirst, count_staying, known, most_samples,
};
use crate::analysis::enumerate::{
    ArrangementRow, BUILDABLE_RULES, FittedArrangement, Journal, Judge, MAX_ARRANGEMENTS, MissingSteps, PartSetUps,
    Ranking, RoundCount, RoundRecord, RoundStep, Rounds, Rule, RuleFailure, Standing, Standings, Study, StudyEnd,
    TooMany, Walk, buildable, rank, standings, walks,
};
use crate::analysis::reference::PartReference;
use crate::analysis::{UnreachableCount, Work};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::job::job_file::{Job, JobPaths};
use crate::job::machine_file::MachineFile;
use crate::job::over::Over;
use crate::job::reference::{Reference, ReferenceKind, SetUp};
use crate::job::reference_text::ReferenceOption;
use crate::job::tool_poses::ReachedToolPoses;
use crate::machine::{AxisKind, AxisName, ErrorId, ErrorTerm, Machine, Pose};
use crate::run::{Call, Count, Refused, Reply, Run, sha256};
use crate::shards::study::{self, StudyFile};
use crate::units::{counted, significant};
use indexmap::IndexMap;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Serialize, Serializer};
use std::path::PathBuf;

/// Options of [`enumerate`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct EnumerateOptions {
    /// Bounds, distribution and statistic of the errors.
    #[serde(flatten)]
    pub tolerances: ToleranceOptions,
    /// Seed of poses and errors.
    pub seed: u64,
    /// Criterion of the arrangements; by default a budget if any error is bounded.
    pub by: Option<JudgedBy>,
    /// Rules that arrangements obey, such as `C before A`, `Y carries A`, `at most 2 on table`.
    pub require: Vec<String>,
    /// Leaves out what is hardly built: a linear axis above a rotary one on the table, more than four axes below the
    /// part, more than two rotary axes in the head. What the machine's own file has is never left out.
    pub buildable: bool,
    /// Maximum number of axes that carry the workpiece.
    pub max_table: Option<usize>,
    /// Number of rotary axes at a time, every choice of them; by default all.
    pub rotary: Option<usize>,
    /// Number of tool poses.
    pub poses: usize,
    /// A CSV file of tool poses in the workpiece frame instead: columns X, Y, Z (mm) and I, J, K or rotary axes (deg).
    pub tool_poses: Option<PathBuf>,
    /// A job file instead of the tool poses.
    pub job: Option<PathBuf>,
    /// True if the tool poses are one continuous path, solved as a whole; by default what the job file says, or else of
    /// CL data alone.
    pub path: Option<bool>,
    /// Motion that the part's set-up takes out of the deviations; by default the zero at the part's origin for tool
    /// poses. Without tool poses arrangements are ranked in machine coordinates by default, and their best fits beside.
    #[schemars(with = "Option<ReferenceOption>")]
    pub reference: Option<Reference>,
    /// Gives linear axes the travel that the work needs, whatever the file says; every arrangement tells it.
    pub size: bool,
    /// Number of machines that are drawn of every arrangement for the budget, at least 2.
    pub samples: usize,
    /// Maximum number of machines that are drawn of the arrangements that could be among the first; by default eight
    /// times `samples`, or what can be kept of them.
    pub max_samples: Option<usize>,
    /// Number of first ranks that are to be told apart from each other and from all others.
    pub first: usize,
    /// Fraction of the tool poses, in percent, from which on arrangements that miss some are listed by their figure.
    /// Ranked ones reach all.
    pub reach_percent: f64,
    /// A file of results of this study; what it holds is not computed again.
    pub state: Option<PathBuf>,
    /// Computes only part I of N of the walks of one round.
    pub shard: Option<(usize, usize)>,
    /// Files of results that together hold the first round; what they hold is not computed again.
    pub merge: Vec<PathBuf>,
}

impl Default for EnumerateOptions {
    fn default() -> Self {
        Self {
            tolerances: ToleranceOptions::default(),
            seed: 1,
            by: None,
            require: Vec::new(),
            buildable: true,
            max_table: None,
            rotary: None,
            poses: 500,
            tool_poses: None,
            job: None,
            path: None,
            reference: None,
            size: false,
            samples: 200,
            max_samples: None,
            first: 1,
            reach_percent: 50.0,
            state: None,
            shard: None,
            merge: Vec::new(),
        }
    }
}

/// Criterion of the arrangements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "snake_case")]
pub enum JudgedBy {
    /// Errors drawn between tolerances.
    Budget,
    /// The errors that have values.
    Errors,
}

/// The arrangements, or how far the study has come.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
#[serde(untagged)]
pub enum EnumerateResult {
    /// All walks are done.
    Ranked(Box<RankedArrangements>),
    /// A part of the walks is done.
    Part(StudyProgress),
}

/// Progress of a study.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct StudyProgress {
    /// The file of the results; empty without.
    pub state: String,
    /// The round, from 1.
    pub round: usize,
    /// Number of its walks that are done.
    pub walks_done: usize,
    /// Number of its walks.
    pub walks: usize,
}

/// Arrangements in order.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct RankedArrangements {
    /// Name of the machine.
    pub machine: String,
    /// Its kinematic chain as the file has it.
    pub chain: String,
    /// Poses and reference of the ranking; reached are the poses that the machine reaches as its file has it.
    pub over: Over,
    /// Criterion of the arrangements.
    pub by: JudgedBy,
    /// The class that bounds what the machine file does not.
    pub class: Option<String>,
    /// Source of the class.
    pub class_source: Option<String>,
    /// Number of errors that count.
    pub errors: usize,
    /// Number of errors that have values and are left out of all arrangements, for bounds stand for them.
    pub left_out: usize,
    /// Which of the errors that act in the machine of the file are known, where the ranking is by a budget.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coverage: Option<Coverage>,
    /// Verdicts that are withheld because errors without a value or a bound could turn them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turned: Option<TurnedVerdicts>,
    /// Number of tool poses: all of a job, whether or not the machine of the file reaches them.
    pub poses: usize,
    /// Number of machines drawn of every arrangement.
    pub samples: Option<usize>,
    /// The rounds, where machines are drawn.
    pub rounds: Option<RankingRounds>,
    /// Seed of poses and errors.
    pub seed: u64,
    /// Statistic of a machine over the poses.
    pub statistic: Statistic,
    /// Fraction of the tool poses from which on arrangements that miss some are listed by their figure.
    pub reach: f64,
    /// Number of arrangements.
    pub arrangements: usize,
    /// Arrangements that are left out because they are hardly built, by rule.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_buildable: Vec<ExcludedArrangements>,
    /// The arrangements that do the whole work, best first.
    pub ranked: Vec<Arrangement>,
    /// Arrangements that miss some tool poses: figures over their own tool poses, `minus_file` on those of them that
    /// the arrangement of the file reaches.
    pub reach_less: Vec<Arrangement>,
    /// Arrangements whose geometry the file does not state.
    pub geometry_not_stated: Vec<Arrangement>,
    /// Arrangements that cannot turn the tool: their chains.
    #[serde(serialize_with = "chains")]
    #[schemars(with = "Vec<String>")]
    pub cannot_turn_the_tool: Vec<Arrangement>,
    /// Tool poses of a file that the machine reaches, as its file has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tool_poses: Option<ReachedToolPoses>,
}

/// Arrangements that a rule of what can be built leaves out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct ExcludedArrangements {
    /// The rule.
    pub rule: &'static str,
    /// Number of arrangements; one that breaks several rules counts for the first.
    pub arrangements: usize,
}

/// Rounds of a ranking.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RankingRounds {
    /// Maximum number of machines drawn of an arrangement.
    pub max_samples: usize,
    /// Number of first ranks that were to be told apart.
    pub first: usize,
    /// True if they are.
    pub told_apart: bool,
    /// The rounds done: machines drawn, and arrangements that took part.
    pub done: Vec<RoundCount>,
    /// Number of machines drawn of ranked arrangements.
    pub drawn: usize,
    /// Their number if all arrangements had as many as the one with most.
    pub drawn_without_elimination: usize,
}

/// An arrangement of the axes.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Arrangement {
    /// Its kinematic chain.
    pub chain: String,
    /// Number of axes that carry the workpiece.
    pub on_table: usize,
    /// Number of tool poses that it reaches.
    pub reached: usize,
    /// Number of tool poses that it does not reach, by reason.
    pub unreachable: UnreachableCount,
    /// Its figure, um; none where it is not judged.
    pub um: Option<f64>,
    /// Lower end of the confidence interval of the figure, um.
    pub low: Option<f64>,
    /// Upper end of the confidence interval of the figure, um.
    pub high: Option<f64>,
    /// Mean of the machines drawn, um.
    pub mean: Option<f64>,
    /// Its figure minus that of the arrangement of the file, um, on the tool poses that both reach; none without such.
    pub minus_file: Option<f64>,
    /// Number of machines drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<usize>,
    /// Its figure minus that of the best.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub versus_first: Option<AgainstFirst>,
    /// The same with the best fit of each arrangement taken out, where neither tool poses nor a reference are given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub best_fit: Option<FittedArrangement>,
    /// The reason why there is no verdict against the best: what depends on the reference is none, nor is what errors
    /// without a value or a bound could turn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub withheld: Option<String>,
    /// True if it does not reach the point at which the part is probed.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub misses_reference: bool,
    /// Travel that the work needs by axis, mm or deg: minimum and maximum.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub travel: IndexMap<String, [f64; 2]>,
    /// Number of its rewinds, where the tool poses are one path.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rewinds: Option<usize>,
    /// Geometry that the file does not state.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_stated: Vec<String>,
    /// Its rank, from 1; of ranked arrangements only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rank: Option<usize>,
}

fn chains<S: Serializer>(list: &[Arrangement], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(list.iter().map(|arrangement| &arrangement.chain))
}

impl Arrangement {
    fn new(row: ArrangementRow, rank: Option<usize>) -> Self {
        let result = row.result;
        let judged = result.filter(|_| row.standing == Standing::Judged);
        let withheld = result.and_then(|result| apart(result.versus_first?, result.best_fit?.versus_first?));
        let against = |VersusFirst { verdict, minus_first }: VersusFirst| AgainstFirst {
            verdict: Some(verdict).filter(|_| withheld.is_none()),
            minus_first,
        };
        Self {
            chain: row.chain,
            on_table: row.table,
            reached: row.reached,
            unreachable: row.unreachable,
            um: judged.map(|result| result.um),
            low: result.and_then(|result| result.low),
            high: result.and_then(|result| result.high),
            mean: result.and_then(|result| result.mean),
            minus_file: result.and_then(|result| result.minus_file),
            samples: result.and_then(|result| result.samples),
            versus_first: result.and_then(|result| result.versus_first).map(against),
            best_fit: result.and_then(|result| result.best_fit),
            withheld,
            misses_reference: row.standing == Standing::MissesReference,
            // Adding zero turns -0 into 0.
            travel: row.travel.into_iter().map(|t| (t.axis, [t.min + 0.0, t.max + 0.0])).collect(),
            rewinds: row.rewinds,
            not_stated: row.not_stated,
            rank,
        }
    }
}

impl RankingRounds {
    fn new(options: &EnumerateOptions, max_samples: usize, (done, told_apart): (Vec<RoundCount>, bool)) -> Self {
        let mut before = 0;
        let mut drawn = 0;
        for round in &done {
            drawn += round.arrangements * (round.samples - before);
            before = round.samples;
        }
        let drawn_without_elimination = done.first().map_or(0, |round| round.arrangements * before);
        Self { max_samples, first: options.first, told_apart, done, drawn, drawn_without_elimination }
    }
}

impl RankedArrangements {
    /// Returns the number of ranked arrangements with a verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.ranked.iter().filter(|row| row.verdict() == Some(verdict)).count()
    }
}

impl Arrangement {
    /// Returns the verdict against the best; none where it is not ranked, or depends on the reference.
    pub fn verdict(&self) -> Option<Verdict> {
        self.versus_first.and_then(|versus| versus.verdict)
    }
}

/// Withholds the verdicts against the best arrangement, the first, for which it does not do the same work.
fn withhold_unlike(of: &StudyCoverage<'_>, ranked: &mut [Arrangement]) {
    let Some((first, others)) = ranked.split_first_mut() else { return };
    let values = count_staying(of.machine, of.bounds);
    let rewinds = |row: &Arrangement| counted(row.rewinds.unwrap_or(0), "rewind");
    for row in others.iter_mut().filter(|row| row.withheld.is_none()) {
        let reason = if values > 0 {
            format!("{} with a value left out of all arrangements", counted(values, "error"))
        } else if row.rewinds != first.rewinds {
            format!("leaves the path for {}, the best for {}", rewinds(row), rewinds(first))
        } else {
            continue;
        };
        row.withheld = Some(reason);
        row.versus_first.iter_mut().for_each(|versus| versus.verdict = None);
    }
}

/// Withholds the verdicts by errors with values whose uncertainty is stated: no ranking counts it.
fn withhold_uncertain(machine: &Machine, ranked: &mut [Arrangement]) {
    if machine.uncertain_parts().is_empty() {
        return;
    }
    for row in ranked.iter_mut().skip(1).filter(|row| row.withheld.is_none()) {
        row.withheld = Some("the uncertainty of the values is not counted; `compare` of two files does".to_owned());
        row.versus_first.iter_mut().for_each(|versus| versus.verdict = None);
    }
}

/// Withholds the verdicts against the best arrangement, the first, that stand on unlike work or that something could
/// turn; returns those that missing errors could, `None` if there are none. `of` is none of a ranking by values.
fn withhold(
    call: &Call<'_>,
    machine: &Machine,
    of: Option<StudyCoverage<'_>>,
    (study, samples): (&Study<'_>, usize),
    ranked: &mut [Arrangement],
) -> Result<Option<TurnedVerdicts>, Refused> {
    let Some(of) = of else {
        withhold_uncertain(machine, ranked);
        return Ok(None);
    };
    withhold_unlike(&of, ranked);
    let decided = |of: &Arrangement| of.verdict().filter(|of| matches!(of, Verdict::Better | Verdict::Worse));
    let Some((first, others)) = ranked.split_first_mut() else { return Ok(None) };
    if of.coverage.missing.is_empty() || !others.iter().any(|row| decided(row).is_some()) {
        return Ok(None);
    }
    let filled = of.fill(call, study, samples)?;
    let mut count = 0;
    for row in others {
        if decided(row).is_some_and(|verdict| filled.turns(&row.chain, &first.chain, verdict)) {
            row.withheld = Some(filled.reason.clone());
            row.versus_first.iter_mut().for_each(|versus| versus.verdict = None);
            count += 1;
        }
    }
    Ok(filled.count(count))
}

/// An arrangement against the best.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct AgainstFirst {
    /// The verdict; none if it is withheld.
    pub verdict: Option<Verdict>,
    /// The difference to the best on the machines drawn of both.
    pub minus_first: PairedDifference,
}

/// Travel of linear axes that a work sizes, to either side of zero, mm.
const LONG_MM: f64 = 1e6;

/// Poses times samples: as many figures are kept of the arrangement of the file.
const MAX_DRAWS: u64 = 20_000_000;

/// Ranks all arrangements of the axes of a machine. `file` keeps the results while they are computed.
///
/// Fails for rules that are not understood, for more arrangements or draws than can be kept, and for files of results
/// that belong to another study.
pub fn enumerate(
    machine: &MachineFile,
    options: &EnumerateOptions,
    file: Option<&dyn StudyFile>,
    run: Run<'_>,
) -> Reply<EnumerateResult> {
    Call::answer(run, machine.sources(), |call| {
        options.job_paths().with_tool(call, machine, |call, machine| studied(call, machine, options, file))
    })
}

fn studied(
    call: &mut Call<'_>,
    machine_file: &MachineFile,
    options: &EnumerateOptions,
    file: Option<&dyn StudyFile>,
) -> Result<EnumerateResult, Refused> {
    let machine: &Machine = machine_file;
    fitting(call, machine, options)?;
    let rules = rules(options, machine).or_else(|refusal| call.refuse(refusal))?;
    let walks = listed(options, machine, &rules).or_else(|refusal| call.refuse(refusal))?;
    let (walks, excluded) = if options.buildable { buildable(machine, walks) } else { (walks, [0; 3]) };
    if walks.is_empty() {
        let message = "the rules leave no arrangement that can be built";
        let help = "take one of the rules back, or list what is hardly built: `--buildable no`";
        return call.refuse(Diagnostic::new(codes::E0609, message).help(help));
    }
    let (judge, class) = judge(call, options, machine)?;
    if options.size && matches!(judge, Judge::Errors) {
        return call
            .usage("`--size` ranks by a budget: errors with values are known over the travel of the file alone");
    }
    let long = options.size.then(|| sized(machine));
    let machine = long.as_ref().unwrap_or(machine);
    let paths = options.job_paths();
    let job = paths.read(call, machine_file)?;
    let tool_poses = job.as_ref().map(|job| job.poses.reached(call, machine)).transpose()?;
    let work = match &job {
        Some(job) => job.poses.work(machine),
        None => Work::random(machine, options.poses, options.seed),
    };
    let set_ups = SetUps::new(call, options, machine, (job.as_ref(), tool_poses.as_ref()))?;
    if let (Judge::Budget { .. }, true) = (&judge, job.is_some()) {
        draws(work.len() as u64, options.largest() as u64).or_else(|refusal| call.refuse(refusal))?;
    }
    let rounds = rounds(options, &judge, work.len());
    let listed = job.as_ref().map(|_| &work);
    let empty = Journal::new(fingerprint(options, machine, (&judge, &rounds), &rules, (listed, &set_ups)), walks.len());
    let (by, errors, bounds) = match &judge {
        Judge::Errors => (JudgedBy::Errors, known(machine), Vec::new()),
        Judge::Budget { bounds, .. } => (JudgedBy::Budget, bounds.len(), bounds.clone()),
    };
    let coverage = (by == JudgedBy::Budget).then(|| Coverage::of(machine, &bounds));
    let study = Study::new(machine, walks, judge, options.tolerances.statistic, &work);
    let study = study.with_travel(options.size).with_set_ups(&set_ups);
    let check = |at: RoundStep, records: &[RoundRecord]| study.check_records(&rounds, at, records);
    let begun = study::begin(call, options.state.as_deref(), empty, &check)?;
    let begun = study::merge(call, &options.merge, begun, &check)?;
    let end = match computed(call, options, (&study, &rounds), (begun, file))? {
        Computed::End(end) => end,
        Computed::Part(progress) => return Ok(EnumerateResult::Part(progress)),
    };
    if end.reach.work == 0 {
        return call.refuse(nothing_reached(machine));
    }
    let (class, class_source) = class.unzip();
    let left_out = coverage.as_ref().map_or(0, |of| known(machine) - of.valued);
    let Ranking { ranked, short, not_stated, cannot_turn } = rank(end.rows, end.reach);
    let max_samples = rounds.sizes().last().copied().unwrap_or(options.samples);
    let drawn = (by == JudgedBy::Budget).then(|| RankingRounds::new(options, max_samples, (end.rounds, end.told)));
    let mut ranked: Vec<Arrangement> = (1..).zip(ranked).map(|(rank, row)| Arrangement::new(row, Some(rank))).collect();
    let of = |coverage| StudyCoverage { machine, bounds: &bounds, coverage, class: class.as_deref() };
    let turned = withhold(call, machine, coverage.as_ref().map(of), (&study, options.samples), &mut ranked)?;
    let unranked = |rows: Vec<ArrangementRow>| rows.into_iter().map(|row| Arrangement::new(row, None)).collect();
    let mut over = Over::work(machine, &set_ups.reference, tool_poses.as_ref(), options.poses);
    if tool_poses.is_none() {
        over.reached = end.reach.work;
    }
    Ok(EnumerateResult::Ranked(Box::new(RankedArrangements {
        over,
        machine: machine.name().to_owned(),
        chain: machine.chain().to_string(),
        by,
        class,
        class_source,
        errors,
        left_out,
        coverage,
        turned,
        poses: end.reach.work,
        samples: drawn.is_some().then_some(options.samples),
        rounds: drawn,
        seed: options.seed,
        statistic: options.tolerances.statistic,
        reach: options.reach_percent / 100.0,
        arrangements: ranked.len() + short.len() + not_stated.len() + cannot_turn.len(),
        not_buildable: exclusions(excluded),
        ranked,
        reach_less: unranked(short),
        geometry_not_stated: unranked(not_stated),
        cannot_turn_the_tool: unranked(cannot_turn),
        tool_poses,
    })))
}

fn exclusions(counts: [usize; 3]) -> Vec<ExcludedArrangements> {
    let all = BUILDABLE_RULES.into_iter().zip(counts);
    let rules = all.map(|(rule, arrangements)| ExcludedArrangements { rule, arrangements });
    rules.filter(|rule| rule.arrangements > 0).collect()
}

impl EnumerateOptions {
    /// Returns the files of the job.
    pub(crate) fn job_paths(&self) -> JobPaths<'_> {
        JobPaths { job: self.job.as_deref(), tool_poses: self.tool_poses.as_deref(), axis_poses: None, path: self.path }
    }

    /// The largest number of machines that is asked for.
    fn largest(&self) -> usize {
        self.samples.max(self.max_samples.unwrap_or(0))
    }
}

/// The rounds: by default up to eight times the first, as far as it can be kept.
fn rounds(options: &EnumerateOptions, judge: &Judge, poses: usize) -> Rounds {
    if let Judge::Errors = judge {
        return Rounds::single();
    }
    let kept = usize::try_from(MAX_DRAWS).unwrap_or(usize::MAX) / poses.max(1);
    let limit = options.max_samples.unwrap_or_else(|| most_samples(options.samples).min(kept));
    Rounds::doubling(options.samples, limit, options.first)
}

fn nothing_reached(machine: &Machine) -> Diagnostic {
    let message =
        format!("`{}` reaches no tool pose of the work, so there is nothing to rank on", shown(machine.name()));
    let help = "give tool poses that the machine reaches with `--tool-poses`, or another `volume`";
    Diagnostic::new(codes::E0613, message).help(help)
}

/// Returns the machine with linear axes as long as any work needs. Errors with values are left out: a budget does not
/// count them, and they are known over the travel of the file alone.
fn sized(machine: &Machine) -> Machine {
    let bounded: Vec<ErrorId> =
        machine.errors().filter(|(_, term)| matches!(term, ErrorTerm::Tolerance(_))).map(|(error, _)| error).collect();
    machine.filtered(|error| bounded.contains(error)).with_linear_travels(LONG_MM)
}

/// Refuses options that make no sense, for this machine or together.
fn fitting(call: &mut Call<'_>, machine: &Machine, options: &EnumerateOptions) -> Result<(), Refused> {
    if options.shard.is_some_and(|(i, n)| !(1..=n).contains(&i)) {
        return call.usage("part I of N is 1 to N");
    }
    if !(0.0..=100.0).contains(&options.reach_percent) {
        return call.usage("`--reach` is a share in percent, 0 to 100");
    }
    call.check_counts(&[Count::Machines(options.samples), Count::Poses(options.poses)])?;
    options.max_samples.map_or(Ok(()), |limit| call.check_counts(&[Count::MaxMachines(limit)]))?;
    if options.max_samples.is_some_and(|limit| limit < options.samples) || options.first < 1 {
        return call.usage("`--max-samples` is not below `--samples`, and `--first` is 1 at least");
    }
    let rotary = machine.axes().iter().filter(|axis| axis.kind == AxisKind::Rotary).count();
    if options.rotary.is_some_and(|wanted| wanted > rotary) {
        return call.usage(format!("`--rotary` is at most {rotary}: so many rotary axes has the machine"));
    }
    if options.tool_poses.is_none() && options.job.is_none() {
        draws(options.poses as u64, options.largest() as u64).or_else(|refusal| call.refuse(refusal))?;
    }
    Ok(())
}

/// Refuses more draws than are kept.
fn draws(poses: u64, samples: u64) -> Result<(), Diagnostic> {
    let draws = poses.saturating_mul(samples);
    if draws <= MAX_DRAWS {
        return Ok(());
    }
    let message = format!("{poses} poses and {samples} samples are {draws} drawn poses; {MAX_DRAWS} are kept at most");
    Err(Diagnostic::new(codes::E0606, message).help("take fewer poses or `--samples`"))
}

/// The set-ups of the part on all arrangements.
#[derive(Debug)]
struct SetUps {
    reference: Reference,
    /// True if the best fit is asked for besides.
    best_fit: bool,
}

impl SetUps {
    /// Returns the set-ups by the reference of a work, which the machine of the file reaches.
    fn new(
        call: &mut Call<'_>,
        options: &EnumerateOptions,
        machine: &Machine,
        (job, reached): (Option<&Job>, Option<&ReachedToolPoses>),
    ) -> Result<Self, Refused> {
        let best_fit = job.is_none() && options.reference.is_none();
        let stated = Job::stated(job, options.reference.as_ref());
        if let Some(reference) = &stated {
            SetUp { reference: reference.clone(), removed: None }.refuse_minimum_zone(call, "a ranking")?;
        }
        if let (Some(stated), None) = (stated.as_ref().filter(|of| of.kind == ReferenceKind::BestFit), reached) {
            return Ok(Self { reference: stated.clone(), best_fit });
        }
        let poses = reached.map_or(&[][..], |reached| &reached.poses);
        let reference = Job::set_up(job, call, machine, options.reference.as_ref(), poses)?.reference;
        Ok(Self { reference, best_fit })
    }
}

impl PartSetUps for SetUps {
    fn references(&self, machine: &Machine, poses: &[Pose]) -> Option<Vec<Option<PartReference>>> {
        let first = SetUp::new(machine, &self.reference, poses).ok()?.removed;
        let fit = self.best_fit.then(|| SetUp::best_fit(machine, poses).removed);
        Some(std::iter::once(first).chain(fit).collect())
    }

    fn is_fitted(&self) -> bool {
        self.reference.kind == ReferenceKind::BestFit
    }
}

fn rules(options: &EnumerateOptions, machine: &Machine) -> Result<Vec<Rule>, Diagnostic> {
    let names: Vec<&AxisName> = machine.axes().iter().map(|axis| &axis.name).collect();
    let sugar = options.max_table.map(|n| format!("at most {n} on table"));
    let help = "write `X before Y`, `X carries Y`, `X on table`, `at most 2 on table`, or one of them after `not`";
    let refusal = |why: RuleFailure| Diagnostic::new(codes::E0608, shown(&why.to_string())).help(help);
    options.require.iter().chain(&sugar).map(|text| Rule::parse(text, &names).map_err(refusal)).collect()
}

fn listed(options: &EnumerateOptions, machine: &Machine, rules: &[Rule]) -> Result<Vec<Walk>, Diagnostic> {
    let message = match walks(machine, options.rotary, rules) {
        Ok(list) if list.is_empty() => {
            let message = "the rules leave no arrangement";
            return Err(Diagnostic::new(codes::E0609, message).help("take one of the rules back"));
        }
        Ok(list) => return Ok(list),
        Err(TooMany::Before(usize::MAX)) => "the axes have more arrangements than can be counted".to_owned(),
        Err(TooMany::Before(count)) => format!("the axes have {count} arrangements before any is excluded"),
        Err(TooMany::After(count)) => format!("{count} arrangements are left"),
    };
    let help = "exclude what you would not build (`--require`, `--max-table`), take fewer rotary axes (`--rotary \
     2`), or take axes out of the chain";
    Err(Diagnostic::new(codes::E0607, format!("{message}; {MAX_ARRANGEMENTS} are listed at most")).help(help))
}

fn judge(
    call: &mut Call<'_>,
    options: &EnumerateOptions,
    machine: &Machine,
) -> Result<(Judge, Option<ClassSource>), Refused> {
    let by_class = options.tolerances.class.is_some() || machine.class().is_some();
    let bounded = by_class || machine.tolerances().count() > 0 || machine.errors().count() > known(machine);
    let by = options.by.unwrap_or(if bounded { JudgedBy::Budget } else { JudgedBy::Errors });
    if by == JudgedBy::Errors {
        return Ok((Judge::Errors, None));
    }
    let (bounds, source): (Vec<Bound>, _) = options.tolerances.bounds_of_design(call, machine)?;
    Ok((Judge::Budget { bounds, draws: options.tolerances.draws(options.seed) }, source))
}

/// Everything that results depend on: the resolved machine, and every option that changes a number.
fn fingerprint(
    options: &EnumerateOptions,
    machine: &Machine,
    (judge, rounds): (&Judge, &Rounds),
    rules: &[Rule],
    (listed, set_ups): (Option<&Work>, &SetUps),
) -> String {
    let rules: Vec<String> = rules.iter().map(Rule::to_string).collect();
    let bounds = match judge {
        Judge::Budget { bounds, .. } => {
            let bounds: String = bounds.iter().map(Bound::canonical).collect();
            format!("{bounds} {rounds:?} {} {:?}", options.reach_percent, options.tolerances.distribution)
        }
        Judge::Errors => "errors".to_owned(),
    };
    let listed = listed.map_or_else(String::new, |work| format!(" whole {work:?}"));
    let drawn = (options.buildable, options.rotary, options.poses, options.seed, options.tolerances.statistic);
    let text = format!(
        "{} {} {rules:?} {bounds} {drawn:?}{listed} {set_ups:?}",
        env!("CARGO_PKG_VERSION"),
        machine.canonical()
    );
    sha256(text.as_bytes())
}

/// Walks with the numbers of axes on the table; `None` for all.
type WalkTables = Vec<(usize, Option<Vec<usize>>)>;

/// The end of a study, or how far it has come.
enum Computed {
    End(StudyEnd),
    Part(StudyProgress),
}

/// Round by round and walk by walk what is not there yet, kept every now and then. A shard computes one round.
fn computed(
    call: &mut Call<'_>,
    options: &EnumerateOptions,
    (study, rounds): (&Study<'_>, &Rounds),
    (mut journal, file): (Journal, Option<&dyn StudyFile>),
) -> Result<Computed, Refused> {
    let fraction = options.reach_percent / 100.0;
    let mut computed = None;
    loop {
        let missing = match standings(&journal, rounds, fraction) {
            Standings::Done(end) => return Ok(Computed::End(end)),
            Standings::Missing(missing) => missing,
        };
        let mine = |step: &usize| options.shard.is_none_or(|(i, n)| step % n == i - 1);
        let todo: WalkTables =
            missing.todo.iter().filter(|(step, _)| mine(step)).map(|(step, of)| (*step, of.clone())).collect();
        if missing.round == 0 && !options.merge.is_empty() && options.shard.is_none() {
            return call.refuse(study::incomplete(missing.todo.len(), missing.walks));
        }
        let is_part = options.shard.is_some() && (todo.is_empty() || computed.is_some_and(|r| r != missing.round));
        if is_part {
            return Ok(Computed::Part(progress(options, &missing)));
        }
        computed = Some(missing.round);
        journal = computed_round(call, (study, rounds), (missing.round, todo), (journal, file))?;
    }
}

fn progress(options: &EnumerateOptions, missing: &MissingSteps) -> StudyProgress {
    let state = options.state.as_ref().map(|path| path.display().to_string()).unwrap_or_default();
    let MissingSteps { round, walks, ref todo } = *missing;
    StudyProgress { state, round: round + 1, walks_done: walks - todo.len(), walks }
}

/// Searches for poses of arms below which a study says nothing of its cost.
const MANY_SEARCHES: usize = 500;

/// Time that one of them takes on a core, s: docs/enumerate.md has the command.
const SEARCH_SECONDS: f64 = 0.04;

/// Says what searches for poses of arms will cost.
fn announce(call: &Call<'_>, searches: usize) {
    if searches >= MANY_SEARCHES {
        let minutes = significant(searches as f64 * SEARCH_SECONDS / 60.0, 2);
        call.announce(&format!(
            "{searches} searches for poses of arms, some {minutes} min on one core; fewer `--poses` or `--require` \
             take less"
        ));
    }
}

fn computed_round(
    call: &mut Call<'_>,
    (study, rounds): (&Study<'_>, &Rounds),
    (round, todo): (usize, WalkTables),
    (begun, file): (Journal, Option<&dyn StudyFile>),
) -> Result<Journal, Refused> {
    let keeper = study::Keeper::new(begun, file);
    announce(call, study.searches(todo.len()));
    let drawn = study.round(rounds.samples(round));
    let done = call.stage("arrangements", todo.len(), |advance| {
        todo.into_par_iter().try_for_each(|(step, tables)| {
            if keeper.has_failed() {
                return Ok(());
            }
            keeper.keep(RoundStep { round, step }, drawn.step(step, tables.as_deref()));
            advance(1)
        })
    });
    done?;
    keeper.finish().or_else(|refusal| call.refuse(refusal))
}
