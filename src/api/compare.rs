//! Machines side by side on the same tool poses.

use super::bounded::{AddedByBounds, AddingBounds};
use super::budgets::ComparedBudgets;
use super::compare_figures::{Alike, AlikeDraws, Bounded, Figures, FittedComparison, MachineVerdict, removed, set_ups};
use super::compiled_model::PoseDeviation;
use super::tolerances::ToleranceOptions;
use super::withheld::LimitWork;
use crate::analysis::budget::{Bound, BoundedDeviation, most_samples};
use crate::analysis::figure_bands::ComparedBands;
use crate::analysis::reference::PartReference;
use crate::analysis::{
    Comparison, ErrorContribution as AnalysedContribution, MachineResult, UnreachableCount, Work, compare as compared,
    contributions as contributions_of,
};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::{Bare, Difference, Field, Frame, Order, Statistics, Summary};
use crate::job::job_file::JobPaths;
use crate::job::limit::{JobLimit, LimitVerdict};
use crate::job::machine_file::{MachineFile, order_of, sources_of};
use crate::job::over::Over;
use crate::job::path::PathResult;
use crate::job::poses::check;
use crate::job::reference::{Reference, SetUp};
use crate::job::reference_text::ReferenceOption;
use crate::job::tool_poses::{MissedToolPose, NeededTravel, ToolPoses, needed_travel};
use crate::machine::{Approach, Machine, Pose};
use crate::report::{BoundedFigures, RssDifference};
use crate::run::{Call, Count, Refused, Reply, Run};
use crate::units::counted;
use std::path::PathBuf;

/// Options of [`compare`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct CompareOptions {
    /// Number of tool poses, drawn from the volume of the first machine.
    pub poses: usize,
    /// A CSV file of tool poses in the workpiece frame instead: columns X, Y, Z (mm) and I, J, K or rotary axes
    /// (deg) of the first machine.
    pub tool_poses: Option<PathBuf>,
    /// A CSV file of poses of the axes of the first machine instead: a header of axis names, one pose a line, mm and
    /// deg; omitted axes are at 0. A machine that they give the same tool poses takes them, too.
    pub axis_poses: Option<PathBuf>,
    /// A job file instead of the tool poses.
    pub job: Option<PathBuf>,
    /// True if the tool poses are one continuous path, solved as a whole; by default what the job file says, or else of
    /// CL data alone.
    pub path: Option<bool>,
    /// Motion that the part's set-up takes out of the deviations; by default the zero at the part's origin for tool
    /// poses. Without tool poses machine coordinates and best fit are both compared by default.
    #[schemars(with = "Option<ReferenceOption>")]
    pub reference: Option<Reference>,
    /// Seed of the tool poses, and of the errors that are drawn.
    pub seed: u64,
    /// Bounds, draws and statistic of errors; budgets are compared where every machine bounds errors.
    #[serde(flatten)]
    pub tolerances: ToleranceOptions,
    /// Number of machines that are drawn for the budgets, at least 2.
    pub samples: usize,
    /// Maximum number of them: more are drawn until every machine is told apart from the first; by default eight times
    /// `samples`.
    pub max_samples: Option<usize>,
    /// Order of the errors; exact by default, unless the conventions of a machine name an order.
    pub order: Option<Order>,
    /// Side of approach, where forward and reverse curves were given.
    pub approach: Approach,
}

impl CompareOptions {
    /// Returns the files of the job.
    pub(crate) fn job_paths(&self) -> JobPaths<'_> {
        JobPaths {
            job: self.job.as_deref(),
            tool_poses: self.tool_poses.as_deref(),
            axis_poses: self.axis_poses.as_deref(),
            path: self.path,
        }
    }
}

impl Default for CompareOptions {
    fn default() -> Self {
        let (tolerances, approach) = (ToleranceOptions::default(), Approach::default());
        Self {
            poses: 1000,
            tool_poses: None,
            axis_poses: None,
            job: None,
            path: None,
            reference: None,
            seed: 1,
            tolerances,
            samples: 1000,
            max_samples: None,
            order: None,
            approach,
        }
    }
}

/// Machines side by side, over the tool poses that all of them reach.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct CompareResult {
    /// What the comparison is over.
    pub over: Over,
    /// Effect of each error alone, largest first.
    pub contributions: Vec<ErrorContribution>,
    /// Number of tool poses asked for.
    pub asked: usize,
    /// Number of tool poses that all machines reach.
    pub poses: usize,
    /// Seed of the tool poses, and of the errors that are drawn.
    pub seed: u64,
    /// Frame of the vectors: the workpiece frame.
    pub frame: Frame,
    /// Side of approach.
    pub direction: Approach,
    /// The machines in their order.
    pub machines: Vec<ComparedMachine>,
    /// Budgets on the same work, where every machine bounds errors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub budgets: Option<ComparedBudgets>,
    /// The same without the best fit of each machine, where neither tool poses nor a reference are given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub best_fit: Option<FittedComparison>,
    /// The verdict on each machine but the first.
    pub verdicts: Vec<MachineVerdict>,
    /// The tool poses that all machines reach, with the deviations of each machine.
    #[serde(skip)]
    pub rows: Vec<ComparedPose>,
}

/// Effect of an error alone in each machine.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct ErrorContribution {
    /// Name of the error.
    pub error: String,
    /// 95 % position deviation with only this error, first order, um, by machine; none without a value.
    pub um: Vec<Option<f64>>,
    /// The same minus that of the first machine.
    pub minus_first: Vec<f64>,
}

/// One machine of a comparison.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct ComparedMachine {
    /// Name of the machine.
    pub machine: String,
    /// Name of its file.
    pub file: String,
    /// Order of its errors.
    pub order: Order,
    /// Number of tool poses that it does not reach, by reason.
    pub unreachable: UnreachableCount,
    /// `bounds` where nothing is measured: then the statistics are of the 95 % value at each tool pose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<&'static str>,
    /// What its bounds lead to, where nothing is measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds: Option<ComparedBounds>,
    /// What bounds of errors without a value add to the measured ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds_add: Option<AddedByBounds>,
    /// Statistics of the deviation of the functional point, um.
    pub position_um: Summary,
    /// Statistics of the deviation of the orientation of the tool, urad.
    pub rotation_urad: Summary,
    /// The statistics minus those of the first machine: negative is better than the first. None where of only one of
    /// the two nothing is measured.
    pub minus_first: Option<Difference>,
    /// Intervals of its statistics, and of these minus those of the first machine, where any of the files states
    /// uncertainties of errors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<ComparedBands>,
    /// Rows of a file of tool poses that it does not reach.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub missed: Option<Vec<MissedToolPose>>,
    /// The travel that the tool poses of a file need, axis by axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub travel: Option<Vec<NeededTravel>>,
    /// Its 95 % value against the limit of the job, if it states one: of its budget, or else of its measured errors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<LimitVerdict>,
    /// Events of the path, if the tool poses are one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<PathResult>,
    /// The kinematic chain.
    #[serde(skip)]
    pub chain: String,
}

/// What the bounds of a machine lead to on the tool poses, where nothing is measured.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct ComparedBounds {
    /// Its figures, with the machines drawn.
    #[serde(flatten)]
    pub figures: BoundedFigures,
    /// The statistics of the RSS minus those of the first machine.
    pub rss_minus_first: Option<RssDifference>,
}

impl ComparedMachine {
    /// Returns the statistics over `poses` poses.
    pub fn statistics(&self, poses: usize) -> Statistics {
        Statistics { poses, position_um: self.position_um, rotation_urad: self.rotation_urad }
    }
}

/// A tool pose that all machines reach.
#[derive(Debug, Clone)]
pub struct ComparedPose {
    /// Functional point from the workpiece origin, mm, workpiece frame.
    pub tip_mm: [f64; 3],
    /// Unit vector of the tool axis from the tip to the holder, workpiece frame.
    pub direction: [f64; 3],
    /// Deviation of each machine.
    pub deviations: Vec<PoseDeviation>,
    /// What the bounds of each machine lead to, where nothing is measured.
    pub bounded: Vec<Option<BoundedDeviation>>,
    /// Events of the path of each machine in words, empty without; none of single poses.
    pub events: Vec<String>,
}

/// Compares machines on the same tool poses; the first is the reference.
///
/// Fails if no tool pose is reached by all machines. Warns of tool poses of a file that a machine does not reach.
pub fn compare(files: &[MachineFile], options: &CompareOptions, run: Run<'_>) -> Reply<CompareResult> {
    Call::answer(run, &sources_of(files), |call| {
        options.job_paths().with_tools(call, files, |call, files| side_by_side(call, files, options))
    })
}

fn side_by_side(
    call: &mut Call<'_>,
    files: &[MachineFile],
    options: &CompareOptions,
) -> Result<CompareResult, Refused> {
    let [first, _, ..] = files else { return call.usage("a comparison takes two machines at least") };
    call.check_counts(&[Count::Machines(options.samples), Count::Poses(options.poses)])?;
    options.max_samples.map_or(Ok(()), |limit| call.check_counts(&[Count::MaxMachines(limit)]))?;
    let order = |machine: &Machine| order_of(machine, options.order);
    let bare: Vec<Bare<'_>> = files.iter().map(|file| Bare { machine: file, order: order(file) }).collect();
    let fields: Vec<&dyn Field> = bare.iter().map(|field| field as &dyn Field).collect();
    let paths = options.job_paths();
    let job = paths.read_common(call, files)?;
    let asked = job.as_ref().map(|job| &job.poses);
    let work = match asked {
        Some(asked) => asked.work(first),
        None => Work::random(first, options.poses, options.seed),
    };
    let comparison =
        call.stage("poses", work.len(), |advance| compared(&fields, &work, options.approach.into(), advance))?;
    let sides: Vec<(&Machine, Vec<Pose>)> =
        files.iter().zip(&comparison.machines).map(|(file, side)| (&**file, poses(side))).collect();
    let (mut missed, mut paths) = (vec![None; sides.len()], vec![None; sides.len()]);
    if let Some(asked) = asked {
        for (i, ((machine, poses), side)) in sides.iter().zip(&comparison.machines).enumerate() {
            let rows = asked.missed(machine, &side.missed);
            paths[i] = side.path.as_ref().map(|events| PathResult::new(machine, events, &asked.lines()));
            call.about(files[i].path(), |call| {
                asked.say(call, machine, &rows)?;
                call.extend(paths[i].as_ref().and_then(|path| path.warning(machine)));
                check(call, machine, poses)
            })?;
            missed[i] = Some(rows);
        }
    }
    if comparison.common.is_empty() {
        return call.refuse(nothing_in_common(files, &comparison));
    }
    let (set_ups, unlike) = set_ups(call, files, &sides, options.reference.as_ref(), job.as_ref())?;
    let (samples, approach) = (options.samples, options.approach);
    let max_samples = options.max_samples.unwrap_or_else(|| most_samples(samples));
    let draws = AlikeDraws { tolerances: &options.tolerances, samples, max_samples, seed: options.seed };
    let alike =
        Alike { files, fields: &fields, sides: &sides, draws, order: options.order, conditions: approach.into() };
    let whole = alike.figures(call, comparison.clone(), &set_ups)?;
    let counts = [comparison.asked, comparison.common.len()];
    let over = |reference: &Reference| Over::common(first, reference, asked, counts);
    let part = job.as_ref().filter(|job| job.has_part());
    let fitted = match (&options.reference, part) {
        (None, None) => {
            let fits: Vec<SetUp> = sides.iter().map(|(machine, poses)| SetUp::best_fit(machine, poses)).collect();
            Some(alike.figures(call, comparison.clone(), &fits)?)
        }
        _ => None,
    };
    let best_fit = fitted.as_ref().map(|of| of.compared(over(&Reference::best_fit())));
    let why = |i: usize| unlike.clone().or_else(|| unlike_paths(&paths, i));
    let verdicts = (1..files.len()).map(|i| whole.verdict(fitted.as_ref(), i, why(i))).collect();
    let references = removed(&set_ups);
    let contributions = contributions_of(&sides, options.approach.into(), &references);
    let adds = additions(call, files, (options, whole.samples), &sides, &references)?;
    let Figures { comparison, bounded, budgets, bounds_left_out, uncertainty, .. } = whole;
    let mut rows: Vec<ComparedPose> = (0..comparison.common.len()).map(|i| row(&comparison, &bounded, i)).collect();
    put_events(&mut rows, asked, &comparison, &paths);
    let machines = (0..files.len()).map(|i| compared_machine(files, &comparison, order(&files[i]), (i, &bounded)));
    let travel = |(i, missed): (usize, &Option<Vec<_>>)| {
        missed.is_some().then(|| needed_travel(&files[i], &comparison.machines[i].needs))
    };
    let travels: Vec<_> = missed.iter().enumerate().map(travel).collect();
    let limits = job.as_ref().and_then(|job| job.limit_mm).map(|mm| -> Result<LimitOfMachines<'_>, Refused> {
        let in_force = in_force(call, files, &options.tolerances)?;
        let (sides, references, budgets) = (&sides, &references, budgets.as_ref());
        Ok(LimitOfMachines { mm, options, sides, references, in_force, budgets, bounds_left_out })
    });
    let limits = limits.transpose()?;
    let of = |(i, ((((machine, missed), travel), bounds_add), path))| {
        let uncertainty = uncertainty.as_ref().map(|of: &Vec<ComparedBands>| of[i]);
        let machine = ComparedMachine { missed, travel, path, bounds_add, uncertainty, ..machine };
        let limit = limits.as_ref().map(|limits| limits.judge(call, i, &machine)).transpose()?;
        Ok(ComparedMachine { limit, ..machine })
    };
    let machines = machines.zip(missed).zip(travels).zip(adds).zip(paths).enumerate().map(of);
    Ok(CompareResult {
        over: over(&set_ups[0].reference),
        contributions: contributions.iter().map(contribution).collect(),
        asked: comparison.asked,
        poses: comparison.common.len(),
        seed: options.seed,
        frame: Frame::Workpiece,
        direction: options.approach,
        machines: machines.collect::<Result<_, _>>()?,
        budgets,
        best_fit,
        verdicts,
        rows,
    })
}

/// The figures, the bounds and the work by which the limit of a job is judged, machine by machine.
struct LimitOfMachines<'a> {
    mm: f64,
    options: &'a CompareOptions,
    sides: &'a [(&'a Machine, Vec<Pose>)],
    references: &'a [Option<&'a PartReference>],
    in_force: Vec<Vec<Bound>>,
    budgets: Option<&'a ComparedBudgets>,
    bounds_left_out: bool,
}

impl LimitOfMachines<'_> {
    fn judge(&self, call: &Call<'_>, index: usize, machine: &ComparedMachine) -> Result<LimitVerdict, Refused> {
        let (mm, CompareOptions { tolerances, samples, seed, .. }) = (self.mm, self.options);
        let budget = self.budgets.map(|of| &of.machines[index]);
        let is_partial = budget.map_or(self.bounds_left_out, |of| of.left_out > 0);
        let missed = machine.missed.as_ref().map_or(0, Vec::len);
        let limit = JobLimit { mm, statistic: tolerances.statistic, missed, is_partial };
        let band = machine.uncertainty.as_ref().map(|of| &of.own.position_um);
        let spread = limit.spread_um(&machine.position_um, band);
        let verdict = match (budget, &machine.bounds) {
            (Some(of), _) => of.position_um.monte_carlo.against(&limit, spread),
            (None, Some(of)) => of.figures.position_um.monte_carlo.against(&limit, None),
            (None, None) => limit.on_values(&machine.position_um, band),
        };
        let ((machine, poses), reference) = (&self.sides[index], self.references[index]);
        let (bounds, samples, seed) = (&self.in_force[index], *samples, *seed);
        LimitWork { machine, bounds, poses, reference, tolerances, samples, seed }.open(call, verdict)
    }
}

/// Returns the bounds in force of each machine.
fn in_force(
    call: &mut Call<'_>,
    files: &[MachineFile],
    tolerances: &ToleranceOptions,
) -> Result<Vec<Vec<Bound>>, Refused> {
    files.iter().map(|file| Ok(tolerances.bounds_if_any(call, file)?.0)).collect()
}

/// Returns the difference in words if a machine has to leave the path at other places than the first, or more often.
fn unlike_paths(paths: &[Option<PathResult>], index: usize) -> Option<String> {
    let rewinds = |i: usize| paths[i].as_ref().map_or(0, |path| path.rewinds.len());
    let leaves = |i: usize| format!("machine {} leaves the path for {}", i + 1, counted(rewinds(i), "rewind"));
    (rewinds(0) != rewinds(index)).then(|| format!("{}, {}", leaves(0), leaves(index)))
}

fn poses(side: &MachineResult) -> Vec<Pose> {
    side.reached.iter().map(|(pose, _)| pose.clone()).collect()
}

fn contribution(alone: &AnalysedContribution) -> ErrorContribution {
    let minus_first = (0..alone.um.len()).map(|i| alone.minus_first(i)).collect();
    ErrorContribution { error: alone.error.to_string(), um: alone.um.clone(), minus_first }
}

fn compared_machine(
    files: &[MachineFile],
    comparison: &Comparison,
    order: Order,
    (index, bounded): (usize, &[Option<Bounded>]),
) -> ComparedMachine {
    let (file, side, own) = (&files[index], &comparison.machines[index], bounded[index].as_ref());
    let statistics = |i: usize| match &bounded[i] {
        Some(of) => of.figures.statistics(comparison.common.len()),
        None => comparison.machines[i].statistics,
    };
    let is_alike = own.is_some() == bounded[0].is_some();
    let bounds = own.map(|own| ComparedBounds {
        figures: own.figures.clone(),
        rss_minus_first: bounded[0].as_ref().map(|first| own.figures.rss_minus(&first.figures)),
    });
    ComparedMachine {
        machine: file.name().to_owned(),
        file: file.path().to_owned(),
        order: if own.is_some() { Order::Degree(1) } else { order },
        unreachable: side.unreachable,
        from: own.map(|_| "bounds"),
        bounds,
        bounds_add: None,
        position_um: statistics(index).position_um,
        rotation_urad: statistics(index).rotation_urad,
        minus_first: is_alike.then(|| statistics(index).minus(&statistics(0))),
        uncertainty: None,
        travel: None,
        missed: None,
        path: None,
        limit: None,
        chain: file.chain().to_string(),
    }
}

fn row(comparison: &Comparison, bounded: &[Option<Bounded>], index: usize) -> ComparedPose {
    let target = &comparison.common[index];
    let deviation = |side: &MachineResult| {
        let (_, deviation) = &side.reached[index];
        PoseDeviation { position_mm: deviation.position.into(), rotation_rad: deviation.rotation.into() }
    };
    let deviations = comparison.machines.iter().map(deviation).collect();
    let bounded = bounded.iter().map(|of| of.as_ref().map(|of| of.found.poses[index])).collect();
    let (tip_mm, direction, events) = (target.tip.into(), target.direction.into(), Vec::new());
    ComparedPose { tip_mm, direction, deviations, bounded, events }
}

/// Returns what the bounds of each machine add to its measured errors.
fn additions(
    call: &mut Call<'_>,
    files: &[MachineFile],
    (options, samples): (&CompareOptions, usize),
    sides: &[(&Machine, Vec<Pose>)],
    references: &[Option<&PartReference>],
) -> Result<Vec<Option<AddedByBounds>>, Refused> {
    let mut adds = Vec::new();
    for (((machine, poses), file), reference) in sides.iter().zip(files).zip(references) {
        let (tolerances, seed) = (&options.tolerances, options.seed);
        let of = AddingBounds { machine, tolerances, samples, seed, work: Some(poses), reference: *reference };
        adds.push(call.about(file.path(), |call| of.added(call))?);
    }
    call.check()?;
    Ok(adds)
}

/// Puts the events of the path of each machine to the tool poses that all machines reach.
fn put_events(
    rows: &mut [ComparedPose],
    asked: Option<&ToolPoses>,
    comparison: &Comparison,
    paths: &[Option<PathResult>],
) {
    let is_missed = |side: &MachineResult, index: usize| side.missed.binary_search_by_key(&index, |of| of.0).is_ok();
    let is_common = |index: &usize| !comparison.machines.iter().any(|side| is_missed(side, *index));
    let lines = asked.map_or_else(Vec::new, ToolPoses::lines);
    let common: Vec<usize> = (0..lines.len()).filter(is_common).map(|index| lines[index]).collect();
    for path in paths.iter().flatten() {
        let words = path.words_at(common.iter().copied());
        rows.iter_mut().zip(words).for_each(|(row, words)| row.events.push(words));
    }
}

pub(crate) fn nothing_in_common(files: &[MachineFile], comparison: &Comparison) -> Diagnostic {
    let missed = |(file, side): (&MachineFile, &MachineResult)| format!("{} misses {}", file.path(), side.unreachable);
    let help = files.iter().zip(&comparison.machines).map(missed).collect::<Vec<_>>().join("; ");
    let message = format!("none of the {} tool poses is reached by all machines", comparison.asked);
    Diagnostic::new(codes::E0813, message).help(format!(
        "{help}. Tool poses count from the workpiece origin: give the machines comparable ones, or narrow the first \
         one's `volume`"
    ))
}
