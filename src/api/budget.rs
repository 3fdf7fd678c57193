//! From tolerances to the volumetric error.

use super::goal::{GoalInputs, ToleranceGoal, goal};
use super::tolerances::{ClassSource, ToleranceOptions, nothing_bounded};
use super::withheld::LimitWork;
use crate::analysis::budget::{
    ActingErrors, Bound, Budget, Coverage, Draws, Request, StayingErrors, bounds_by_values, budget_from_samples,
    budget_poses, draw_with_zone,
};
use crate::analysis::figure_bands::field_bands;
use crate::analysis::reference::PartReference;
use crate::evaluate::{Bare, Field, Order, Poses, Statistics};
use crate::job::characteristics::{CharacteristicResult, DrawnRequest, JobCharacteristics};
use crate::job::job_file::{Job, JobPaths};
use crate::job::limit::{JobLimit, LimitVerdict};
use crate::job::machine_file::MachineFile;
use crate::job::over::Over;
use crate::job::path::PathResult;
use crate::job::poses::{AxisPositions, axis_positions, check, pose_option};
use crate::job::reference::{Reference, SetUp};
use crate::job::reference_text::ReferenceOption;
use crate::job::tool_poses::ReachedToolPoses;
use crate::machine::{Machine, OperatingConditions, Pose};
use crate::report::{BoundedContribution, BudgetFigures, DeviationBudget, DrawnMachineFigures, Picture, contributions};
use crate::run::{Call, Count, Refused, Reply, Run};
use crate::shards::budget_parts::{self, BudgetShard, Division};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::PathBuf;

/// Options of [`budget`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct BudgetOptions {
    /// Bounds, distribution and statistic of the errors.
    #[serde(flatten)]
    pub tolerances: ToleranceOptions,
    /// Seed of poses and errors.
    pub seed: u64,
    /// Number of random poses, besides the corners of the volume.
    pub poses: usize,
    /// A CSV file of tool poses in the workpiece frame that replace these poses: columns X, Y, Z (mm) and I, J, K or
    /// rotary axes (deg).
    pub tool_poses: Option<PathBuf>,
    /// A CSV file of poses of the axes instead: a header of axis names, one pose a line, mm and deg; omitted axes are
    /// at 0. Where no error is bounded, each with a value is between ± the largest that it has at these poses.
    pub axis_poses: Option<PathBuf>,
    /// A job file instead of the tool poses.
    pub job: Option<PathBuf>,
    /// True if the tool poses are one continuous path, solved as a whole; by default what the job file says, or else of
    /// CL data alone.
    pub path: Option<bool>,
    /// Motion that the part's set-up takes out of the effects; by default the zero at the part's origin for tool poses,
    /// nothing for a volume.
    #[schemars(with = "Option<ReferenceOption>")]
    pub reference: Option<Reference>,
    /// Number of machines that are drawn, at least 2.
    pub samples: usize,
    /// A pose at which contributions are listed too, `X=100,C=90`: mm and deg; axes left out are at 0.
    pub at: Option<String>,
    /// Goal of the 95 % value of the position, mm: the cheapest tolerances for it are sought.
    pub goal_mm: Option<f64>,
    /// YAML file with the cost of tolerances; by default the sum of present / new - 1, a tolerance halved counts 1.
    pub cost: Option<PathBuf>,
    /// Tolerances may become coarser than they are for a goal.
    pub loosen: bool,
    /// Draws only part I of N of the machines.
    pub shard: Option<(usize, usize)>,
    /// Files of drawn machines that together hold all; none is drawn again.
    pub merge: Vec<PathBuf>,
}

impl Default for BudgetOptions {
    fn default() -> Self {
        let tolerances = ToleranceOptions::default();
        Self {
            tolerances,
            seed: 1,
            poses: 500,
            tool_poses: None,
            axis_poses: None,
            job: None,
            path: None,
            reference: None,
            samples: 1000,
            at: None,
            goal_mm: None,
            cost: None,
            loosen: false,
            shard: None,
            merge: Vec::new(),
        }
    }
}

impl BudgetOptions {
    /// Returns the files of the job.
    pub(crate) fn job_paths(&self) -> JobPaths<'_> {
        JobPaths {
            job: self.job.as_deref(),
            tool_poses: self.tool_poses.as_deref(),
            axis_poses: self.axis_poses.as_deref(),
            path: self.path,
        }
    }

    /// Returns what drawn machines depend on.
    fn drawn_by(&self) -> impl std::fmt::Debug {
        (self.seed, self.samples, &self.tolerances)
    }

    fn goal_inputs(&self) -> GoalInputs<'_> {
        let Self { cost, loosen, tolerances, samples, seed, .. } = self;
        let default_samples = Self::default().samples;
        GoalInputs {
            cost: cost.as_deref(),
            loosen: *loosen,
            tolerances,
            samples: *samples,
            default_samples,
            seed: *seed,
        }
    }

    fn division<'a>(&'a self, drawn_by: &'a dyn std::fmt::Debug) -> Division<'a> {
        Division { shard: self.shard, merge: &self.merge, drawn_by }
    }
}

/// A budget with what it is of.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct BudgetResult {
    /// The budget.
    #[serde(flatten)]
    pub budget: BudgetFigures,
    /// `values` where no error is bounded: then each is between ± the largest value that it has at the poses of the
    /// axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<&'static str>,
    /// Which of the errors that act are known.
    pub coverage: Coverage,
    /// Name of the machine.
    pub machine: String,
    /// The kinematic chain.
    pub chain: String,
    /// What the budget is over.
    pub over: Over,
    /// The 95 % value of the position against the limit of the job, if it states one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<LimitVerdict>,
    /// Events of the path, if the tool poses are one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<PathResult>,
    /// The same without the rigid motion of the best fit, for a volume whose reference is not stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub best_fit: Option<FittedBudget>,
    /// The machines drawn without the minimum zone, where it is the reference: it has no worst case, RSS and effects of
    /// single errors, so the other figures are without the least squares.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub minimum_zone: Option<ZoneBudget>,
    /// Tool poses of a file that the machine reaches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tool_poses: Option<ReachedToolPoses>,
    /// The characteristics of features for which the job states tolerances, over the machines drawn.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub characteristics: Vec<CharacteristicResult>,
    /// The cheapest tolerances, if a goal was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub goal: Option<ToleranceGoal>,
    /// Contributions at the pose that was named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<ContributionsAt>,
}

/// A budget without the rigid motion of the part that fits the deviations best.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct FittedBudget {
    /// Poses and reference that it is over.
    pub over: Over,
    /// The position deviation, um.
    pub position_um: DeviationBudget,
    /// The rotation of the tool, urad.
    pub rotation_urad: DeviationBudget,
    /// The error whose tolerance to tighten first.
    pub tighten_first: String,
    /// True if that is the same error in machine coordinates.
    pub agrees: bool,
}

/// Machines drawn without the motion of the part that leaves the smallest largest deviation of each.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct ZoneBudget {
    /// Poses and reference that it is over.
    pub over: Over,
    /// The position deviation, um.
    pub position_um: DrawnMachineFigures,
    /// The rotation of the tool, urad.
    pub rotation_urad: DrawnMachineFigures,
}

/// Contributions at a pose.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ContributionsAt {
    /// The pose, mm and deg.
    pub axes: AxisPositions,
    /// Effect of each error at its bound, largest first.
    pub contributions: Vec<BoundedContribution>,
}

impl BudgetResult {
    /// Returns a picture of the effects of the errors at their bounds: the `top` largest, and the sum of all.
    pub fn pareto(&self, top: usize) -> Picture {
        self.budget.pareto(&self.machine, top)
    }

    /// Returns a picture of the use of the budget, tolerance by tolerance: the `top` largest, and the sum of the
    /// others.
    pub fn waterfall(&self, top: usize) -> Picture {
        self.budget.waterfall(&self.machine, top)
    }
}

/// Budgets the errors that are only bounded, to first order.
///
/// Fails if no error is bounded, and for poses or classes that do not fit the machine.
pub fn budget(file: &MachineFile, options: &BudgetOptions, run: Run<'_>) -> Reply<BudgetResult> {
    Call::answer(run, file.sources(), |call| {
        if options.shard.is_some() {
            return call.usage("a part of the machines has no budget: put all parts together with `merge`");
        }
        options.job_paths().with_tool(call, file, |call, file| budgeted(call, file, options))
    })
}

/// Draws part I of N of the machines of a budget, [`BudgetOptions::shard`]; without it all of them.
/// A part that a file of [`BudgetOptions::merge`] holds already is not drawn again; such a file need not be there.
///
/// Fails where [`budget`] does, and for a part that is not 1 to N.
pub fn budget_part(file: &MachineFile, options: &BudgetOptions, run: Run<'_>) -> Reply<BudgetShard> {
    let part_of = |call: &mut Call<'_>, file: &MachineFile| {
        let at = fitting(call, file, options)?;
        let work = BudgetWork::of(call, file, options)?;
        let BudgetBounds { list: bounds, .. } = work.bounds(call, file, options)?;
        let request = work.request(file, options, (&bounds, at.as_deref()));
        budget_parts::draw_part(call, options.division(&options.drawn_by()), request)
    };
    Call::answer(run, file.sources(), |call| options.job_paths().with_tool(call, file, part_of))
}

/// Maximum number of random poses.
const MAX_POSES: usize = 100_000;

fn budgeted(call: &mut Call<'_>, machine: &MachineFile, options: &BudgetOptions) -> Result<BudgetResult, Refused> {
    let at = fitting(call, machine, options)?;
    let work = BudgetWork::of(call, machine, options)?;
    let bounds = work.bounds(call, machine, options)?;
    budget_of(call, machine, options, at, work, bounds)
}

/// The bounds of a budget.
pub(crate) struct BudgetBounds {
    pub list: Vec<Bound>,
    pub class: Option<ClassSource>,
    /// True if they are values, since no error is bounded.
    pub are_values: bool,
}

/// Refuses options that make no sense together, and returns the pose asked for.
fn fitting(call: &mut Call<'_>, machine: &Machine, options: &BudgetOptions) -> Result<Option<Pose>, Refused> {
    call.check_counts(&[Count::Machines(options.samples), Count::Poses(options.poses)])?;
    if options.poses > MAX_POSES {
        return call.usage(format!("a budget takes {MAX_POSES} random poses at most, all of which are held"));
    }
    if options.cost.is_some() && options.goal_mm.is_none() {
        return call.usage("`--cost` is the cost of tolerances for a `--goal`");
    }
    if options.loosen && options.goal_mm.is_none() {
        return call.usage("`--loosen` lets tolerances become coarser for a `--goal`");
    }
    let at = pose_option(call, machine, options.at.as_ref())?;
    check(call, machine, at.as_slice())?;
    Ok(at)
}

/// The poses of a budget and the generator of its machines.
pub(crate) struct BudgetWork {
    poses: Vec<Pose>,
    tool_poses: Option<ReachedToolPoses>,
    toleranced: Option<JobCharacteristics>,
    set_up: SetUp,
    /// The set-up that is asked for, if it is a minimum zone.
    zone: Option<SetUp>,
    limit: Option<JobLimit>,
    draws: Draws,
}

impl BudgetWork {
    /// Returns the bounds in force; of poses of the axes of a machine of which no error is bounded, its values.
    fn bounds(&self, call: &mut Call<'_>, machine: &Machine, options: &BudgetOptions) -> Result<BudgetBounds, Refused> {
        let of_axes = self.tool_poses.as_ref().is_some_and(|of| of.of_axes);
        let (list, class) = match of_axes {
            true => options.tolerances.bounds_if_any(call, machine)?,
            false => options.tolerances.bounds(call, machine)?,
        };
        if !list.is_empty() {
            return Ok(BudgetBounds { list, class, are_values: false });
        }
        let list = bounds_by_values(machine, &self.poses);
        if list.is_empty() {
            return call.refuse(nothing_bounded(machine));
        }
        if options.goal_mm.is_some() {
            return call.usage("`--goal` is about tolerances, and no error is bounded: give some, or omit it");
        }
        Ok(BudgetBounds { list, class, are_values: true })
    }

    pub(crate) fn of(call: &mut Call<'_>, machine: &MachineFile, options: &BudgetOptions) -> Result<Self, Refused> {
        let paths = options.job_paths();
        let job = paths.read(call, machine)?;
        let tool_poses = job.as_ref().map(|job| job.poses.reached(call, machine)).transpose()?;
        let toleranced = Job::characteristics(job.as_ref(), call, machine, tool_poses.as_ref())?;
        let poses = match &tool_poses {
            Some(reached) => reached.poses.clone(),
            None => budget_poses(machine, options.poses, options.seed),
        };
        let asked = Job::set_up(job.as_ref(), call, machine, options.reference.as_ref(), &poses)?;
        if options.goal_mm.is_some() {
            asked.refuse_minimum_zone(call, "a goal")?;
        }
        let (set_up, zone) = match asked.reference.is_minimum_zone() {
            true => (SetUp::best_fit(machine, &poses), Some(asked)),
            false => (asked, None),
        };
        let limit = Job::limit(job.as_ref(), options.tolerances.statistic, tool_poses.as_ref());
        let draws = options.tolerances.draws(options.seed);
        Ok(Self { poses, tool_poses, toleranced, set_up, zone, limit, draws })
    }

    fn request<'a>(
        &'a self,
        machine: &'a Machine,
        options: &BudgetOptions,
        (bounds, at): (&'a [Bound], Option<&'a [f64]>),
    ) -> Request<'a> {
        let (samples, statistic) = (options.samples, options.tolerances.statistic);
        let (searched, reference) = (self.tool_poses.is_none(), self.set_up.removed());
        let acting = ActingErrors::OfMachine;
        Request {
            machine,
            acting,
            bounds,
            poses: &self.poses,
            reference,
            searched,
            at,
            draws: &self.draws,
            samples,
            statistic,
        }
    }

    /// Returns the characteristics of toleranced features over the machines drawn, which have the errors with values
    /// besides those between bounds.
    fn characteristics(
        &self,
        call: &Call<'_>,
        machine: &Machine,
        request: Request<'_>,
    ) -> Result<Vec<CharacteristicResult>, Refused> {
        let Some(of) = &self.toleranced else { return Ok(Vec::new()) };
        let Request { bounds, draws, samples, reference: removed, .. } = request;
        let staying = StayingErrors::new(machine, bounds, removed);
        let values = staying.as_ref().map(|staying| staying as &dyn Field);
        of.drawn(call, DrawnRequest { machine, bounds, removed, draws, samples, values })
    }

    /// Returns the machines drawn without the minimum zone, if that is the reference.
    fn drawn_with_zone(
        &self,
        call: &Call<'_>,
        machine: &Machine,
        request: Request<'_>,
    ) -> Result<Option<ZoneBudget>, Refused> {
        let Some((of, zone)) = self.zone.as_ref().and_then(|of| Some((of, of.removed()?))) else { return Ok(None) };
        let [position, rotation] =
            call.stage("machines drawn", request.samples, |advance| draw_with_zone(request, zone, advance))?;
        let figures = |mut values: Vec<f64>, scale: f64| {
            values.iter_mut().for_each(|value| *value *= scale);
            values.sort_by(f64::total_cmp);
            DrawnMachineFigures::of(&values)
        };
        let over = self.over(machine, &of.reference);
        let (position_um, rotation_urad) = (figures(position, 1e3), figures(rotation, 1e6));
        Ok(Some(ZoneBudget { over, position_um, rotation_urad }))
    }

    /// Returns by how much the uncertainty of values moves their figure (um), down and up; `None` without such values.
    fn spread_um(&self, machine: &Machine, limit: &JobLimit, seed: u64) -> Option<[f64; 2]> {
        let (order, conditions) = (Order::Degree(1), OperatingConditions::default());
        let bare = Bare { machine, order };
        let referenced = self.set_up.field(&bare, order, conditions);
        let field = referenced.as_ref().map_or(&bare as &dyn Field, |field| field);
        let at = |pose: &Pose| field.deviation(&conditions.at_pose(pose));
        let whole = Statistics::of(&self.poses.par_iter().map(at).collect::<Vec<_>>());
        let listed = Poses::Listed(self.poses.clone());
        let bands = field_bands(field, &listed, whole, &[], conditions, seed, self.set_up.removed())?;
        limit.spread_um(&whole.position_um, Some(&bands.position_um))
    }

    /// Returns the statement of what a budget is over.
    fn over(&self, machine: &Machine, reference: &Reference) -> Over {
        Over::work(machine, reference, self.tool_poses.as_ref(), self.poses.len())
    }
}

pub(crate) fn budget_of(
    call: &mut Call<'_>,
    machine: &MachineFile,
    options: &BudgetOptions,
    at: Option<Pose>,
    work: BudgetWork,
    bounds: BudgetBounds,
) -> Result<BudgetResult, Refused> {
    let BudgetBounds { list: bounds, class, are_values } = bounds;
    let request = work.request(machine, options, (&bounds, at.as_deref()));
    let drawn = budget_parts::merge(call, options.division(&options.drawn_by()), request)?;
    let steps = if drawn.is_some() { 0 } else { 2 * options.samples };
    let budget = call.stage("machines drawn", steps, |advance| budget_from_samples(request, drawn, advance))?;
    let characteristics = work.characteristics(call, machine, request)?;
    let goal = match options.goal_mm {
        Some(goal_mm) => {
            let inputs = options.goal_inputs();
            Some(goal(call, machine, inputs, (&bounds, &work.poses, work.set_up.removed()), goal_mm)?)
        }
        None => None,
    };
    let drawing = options.tolerances.drawing(class, options.samples, options.seed);
    let has_part = work.tool_poses.as_ref().is_some_and(|of| !of.of_axes);
    let best_fit = if options.reference.is_none() && !has_part {
        Some(best_fit(call, machine, &work, request, &budget)?)
    } else {
        None
    };
    let minimum_zone = work.drawn_with_zone(call, machine, request)?;
    let at = at.zip(budget.at.as_ref()).map(|(pose, list)| ContributionsAt {
        axes: axis_positions(machine, &pose),
        contributions: contributions(&bounds, list),
    });
    let over = work.over(machine, &work.set_up.reference);
    let spread = work.limit.and_then(|limit| work.spread_um(machine, &limit, options.seed));
    let BudgetWork { poses, tool_poses, limit, set_up, .. } = work;
    let (coverage, in_force) = (Coverage::of(machine, &bounds), bounds.clone());
    let path = tool_poses.as_ref().and_then(|reached| reached.path.clone());
    let budget = BudgetFigures::new(machine, bounds, &budget, poses.len(), drawing);
    let drawn = minimum_zone.as_ref().map_or(&budget.position_um.monte_carlo, |of| &of.position_um);
    let limit = limit.map(|limit| JobLimit { is_partial: budget.left_out > 0, ..limit });
    let BudgetOptions { tolerances, samples, seed, .. } = options;
    let (reference, samples, seed) = (set_up.removed(), *samples, *seed);
    let judged = LimitWork { machine, bounds: &in_force, poses: &poses, reference, tolerances, samples, seed };
    let limit = limit.map(|limit| judged.open(call, drawn.against(&limit, spread))).transpose()?;
    let (machine, chain) = (machine.name().to_owned(), machine.chain().to_string());
    Ok(BudgetResult {
        budget,
        from: are_values.then_some("values"),
        coverage,
        machine,
        chain,
        over,
        limit,
        path,
        best_fit,
        minimum_zone,
        tool_poses,
        characteristics,
        goal,
        at,
    })
}

/// Returns the budget of the same machines drawn without the best fit over the poses.
fn best_fit(
    call: &Call<'_>,
    machine: &Machine,
    work: &BudgetWork,
    request: Request<'_>,
    whole: &Budget,
) -> Result<FittedBudget, Refused> {
    let reference = PartReference::best_fit(machine, &work.poses);
    let request = Request { reference: Some(&reference), at: None, ..request };
    let budget =
        call.stage("machines drawn", 2 * request.samples, |advance| budget_from_samples(request, None, advance))?;
    let first = |budget: &Budget| budget.position.first_to_tighten().map(|i| request.bounds[i].to_string());
    let tighten_first = first(&budget);
    Ok(FittedBudget {
        over: work.over(machine, &Reference::best_fit()),
        position_um: DeviationBudget::new(machine, &budget.position),
        rotation_urad: DeviationBudget::new(machine, &budget.rotation),
        agrees: tighten_first == first(whole),
        tighten_first: tighten_first.unwrap_or_default(),
    })
}
