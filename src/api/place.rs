//! The part of a job at many places of the table: what the machine reaches there, and how far it deviates.

use super::bounded::DrawnBounds;
use super::budgets::stand_in;
use super::map_bounds::refuse_order;
use super::tolerances::ToleranceOptions;
use crate::analysis::budget::{Coverage, Statistic, adding};
use crate::analysis::rotary_axes_place_tip;
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::{CompiledField, Order};
use crate::job::job_file::{Job, JobPaths};
use crate::job::limit::MissingInLimit;
use crate::job::machine_file::{MachineFile, order_of};
use crate::job::over::{Over, OverKind};
use crate::job::place_grid::{PlaceGrid, PlaceRange};
use crate::job::place_study::{PlaceDraws, PlaceFigure, PlaceStudy, PlacementGain, TriedPlace};
use crate::job::placement::Placement;
use crate::job::reference::{Reference, SetUp};
use crate::machine::{Approach, Machine};
use crate::report::{DrawSettings, Picture, PlacementPicture};
use crate::run::{Call, Count, Refused, Reply, Run};
use std::path::PathBuf;

/// Options of [`place`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct PlacementOptions {
    /// Ranges of the place of the part, `X=-200..200:9,C=0..90:4`: X, Y, Z of its origin (mm), A, B, C of its rotation
    /// (deg), with the number of values; the other numbers are those of the job.
    pub ranges: String,
    /// True for the figure of the deviation at each place, false for the reach alone.
    pub figure: bool,
    /// The job file.
    pub job: Option<PathBuf>,
    /// A file of tool poses in place of a job file.
    pub tool_poses: Option<PathBuf>,
    /// True if the tool poses are one continuous path, solved as a whole; by default what the job file says, or else of
    /// CL data alone.
    pub path: Option<bool>,
    /// Motion that the part's set-up takes out of the deviations; by default what the job states, or else the zero at
    /// the part's origin. It moves with the part.
    pub reference: Option<Reference>,
    /// Order of the errors; exact by default, unless the conventions of the machine name an order.
    pub order: Option<Order>,
    /// Side of approach, where forward and reverse curves were given.
    pub approach: Approach,
    /// Bounds and draws of errors, for a machine of which nothing is measured.
    #[serde(flatten)]
    pub tolerances: ToleranceOptions,
    /// Number of machines that are drawn, at least 2.
    pub samples: usize,
    /// Seed of these machines.
    pub seed: u64,
}

impl Default for PlacementOptions {
    fn default() -> Self {
        Self {
            ranges: String::new(),
            figure: false,
            job: None,
            tool_poses: None,
            path: None,
            reference: None,
            order: None,
            approach: Approach::default(),
            tolerances: ToleranceOptions::default(),
            samples: 1000,
            seed: 1,
        }
    }
}

impl PlacementOptions {
    /// Returns the files of the job.
    pub(crate) fn job_paths(&self) -> JobPaths<'_> {
        JobPaths { job: self.job.as_deref(), tool_poses: self.tool_poses.as_deref(), axis_poses: None, path: self.path }
    }

    /// Largest number of places.
    pub const MAX_PLACES: usize = 10_000;
    /// Largest number of tool poses, places times those of the job.
    pub const MAX_TOOL_POSES: usize = 2_000_000;
    /// Largest number of tool poses of a robot, which takes long to find each.
    pub const MAX_ROBOT: usize = 20_000;
    /// Largest number of drawn deviations, tool poses times machines.
    pub const MAX_DRAWN: usize = 2_000_000_000;
    /// Largest number of drawn machines that are kept, places times machines.
    pub const MAX_KEPT: usize = 20_000_000;
}

/// Places of a part on a machine.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct PlacementResult {
    /// Name of the machine.
    pub machine: String,
    /// Poses and reference of the result; `reached` counts at the place of the job.
    pub over: Over,
    /// `values` or `bounds`, from which the figures are; none for reach alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<&'static str>,
    /// The statistic of a machine over the tool poses, by which places are ranked; none for reach alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub statistic: Option<Statistic>,
    /// Settings of the machines drawn, where errors are bounded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drawing: Option<DrawSettings>,
    /// The ranges, in the order named.
    pub ranges: Vec<PlaceRange>,
    /// Number of places that were tried; that of the job is one of them.
    pub places: usize,
    /// Number of places that reach all tool poses.
    pub reach_all: usize,
    /// Number of places that are ranked: those that reach the same tool poses, the most of all, and the reference.
    pub ranked: usize,
    /// Number of ranked places that the machines drawn do not tell apart from the best, or that are equal to it; none
    /// where no machines are drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_told_apart: Option<usize>,
    /// The place of the job.
    pub own: TriedPlace,
    /// The best place; none if no tool pose is reached anywhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub best: Option<TriedPlace>,
    /// Ranges at whose end the best place lies.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub at_end_of: Vec<&'static str>,
    /// Gain of the best place over that of the job.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gain: Option<PlacementGain>,
    /// All places: those of the ranges, the first range running fastest, then that of the job if it is none of them.
    pub tried: Vec<TriedPlace>,
}

impl PlacementResult {
    /// Returns the places over the first two ranges, coloured by the share in reach or by the 95 % value.
    pub fn picture(&self) -> Picture {
        let (ranges, tried, best) = (&self.ranges, &self.tried, self.best.as_ref());
        let (title, over) = (&self.machine, &self.over.line());
        let (own, figures) = (&self.own, self.figure_words());
        PlacementPicture { title, over, ranges, tried, own, best, figures }.picture()
    }

    /// Returns the figure by which places are ranked in words, such as `largest position deviation over the tool
    /// poses`; none for reach alone.
    pub fn figure_words(&self) -> Option<&'static str> {
        Some(match (self.not_told_apart.is_some(), self.statistic?) {
            (false, Statistic::Max) => "largest position deviation over the tool poses",
            (false, Statistic::P95) => "95 % of the tool poses within",
            (true, Statistic::Max) => "95 % of machines within, at all tool poses",
            (true, Statistic::P95) => "95 % of machines within, at 95 % of the tool poses",
        })
    }
}

/// Tries the part of a job at places of the workpiece frame: the nominal machine's reach at each, and with
/// [`PlacementOptions::figure`] the deviation.
///
/// Fails without a job, for ranges that make no sense, for more places or tool poses than the limits of
/// [`PlacementOptions`], and for figures where the reference or no tool pose is reached from any place.
pub fn place(file: &MachineFile, options: &PlacementOptions, run: Run<'_>) -> Reply<PlacementResult> {
    Call::answer(run, file.sources(), |call| {
        options.job_paths().with_tool(call, file, |call, file| try_places(call, file, options))
    })
}

fn try_places(call: &mut Call<'_>, file: &MachineFile, options: &PlacementOptions) -> Result<PlacementResult, Refused> {
    call.check_counts(&[Count::Machines(options.samples)])?;
    let machine: &Machine = file;
    let paths = options.job_paths();
    let Some(job) = paths.read_unplaced(call, file)? else {
        return call.usage("`--place` moves the part of a job: give `--job` or `--tool-poses`");
    };
    let grid = PlaceGrid::parse(&options.ranges, job.place()).or_else(|reason| call.usage(reason.to_string()))?;
    if grid.turns() && job.poses().gives_rotary() {
        return call.usage(
            "tool poses with positions of rotary axes do not turn with the part: give ranges of X, Y and Z alone, or \
             tool directions I, J, K",
        );
    }
    let drawn = if options.figure {
        DrawnBounds::of(call, machine, (&options.tolerances, options.samples, options.seed))?
    } else {
        None
    };
    // Bounds of errors without a value count beside the values of others.
    let (added, class) = match options.figure && drawn.is_none() {
        true => options.tolerances.bounds_if_any(call, machine)?,
        false => (Vec::new(), None),
    };
    let added = adding(machine, &added);
    let stated = Job::stated(Some(&job.at(job.place())), options.reference.as_ref());
    if let Some(reference) = stated.filter(|_| drawn.is_some() || !added.is_empty()) {
        SetUp { reference, removed: None }.refuse_minimum_zone(call, "places of a machine with bounds")?;
    }
    let rows = job.poses().lines().len();
    let is_drawn = drawn.is_some() || !added.is_empty();
    if let Some(refusal) = too_many(machine, grid.len(), rows, is_drawn.then_some(options.samples)) {
        return call.refuse(refusal);
    }
    let mut places: Vec<Placement> = grid.places().collect();
    if !places.contains(&job.place()) {
        places.push(job.place());
    }
    let order = order_of(machine, options.order);
    let compiled = CompiledField::new(machine, order);
    let draws = options.tolerances.draws(options.seed);
    let place_draws = |bounds| PlaceDraws { bounds, draws: &draws, samples: options.samples };
    let (from, figure) = match &drawn {
        Some(drawn) => {
            refuse_order(call, options.order)?;
            (Some("bounds"), PlaceFigure::Bounds(place_draws(drawn.bounds.as_slice())))
        }
        None if options.figure => {
            let adding = Some(added.as_slice()).filter(|bounds| !bounds.is_empty()).map(place_draws);
            let conditions = options.approach.into();
            (Some("values"), PlaceFigure::Values { field: &compiled, order, conditions, adding })
        }
        None => (None, PlaceFigure::Reach),
    };
    let (asked, statistic) = (options.reference.as_ref(), options.tolerances.statistic);
    let seed = options.seed;
    let in_force = drawn.as_ref().map_or(added.as_slice(), |drawn| &drawn.bounds);
    let missing = Coverage::of(machine, in_force).missing.len();
    let (name, _) = stand_in(options.tolerances.class_name(machine), &[machine]);
    let missing = (missing > 0).then_some(MissingInLimit { errors: missing, class: name, um: None });
    let study = PlaceStudy { machine, job: &job, places: &places, asked, figure, missing, statistic, seed };
    let found = study.run(call)?;
    let own = found.tried[found.own].clone();
    let best = found.best.map(|best| found.tried[best].clone());
    let over = Over::new(OverKind::Job, machine, &found.reference, [rows, own.reached]).along(job.poses().is_path());
    Ok(PlacementResult {
        machine: machine.name().to_owned(),
        over,
        from,
        statistic: from.map(|_| statistic),
        drawing: match drawn {
            Some(drawn) => Some(drawn.drawing),
            None => (!added.is_empty()).then(|| options.tolerances.drawing(class, options.samples, options.seed)),
        },
        places: found.tried.len(),
        reach_all: found.tried.iter().filter(|of| of.reached == rows).count(),
        ranked: found.tried.iter().filter(|of| of.rank.is_some()).count(),
        not_told_apart: best
            .as_ref()
            .and_then(|best| best.versus_first)
            .map(|_| found.tried.iter().filter(|of| of.is_open()).count()),
        at_end_of: best.as_ref().map_or_else(Vec::new, |best| grid.edges(&best.place)),
        ranges: grid.ranges,
        own,
        best,
        gain: found.gain,
        tried: found.tried,
    })
}

/// Returns the refusal of work beyond the limits.
fn too_many(machine: &Machine, places: usize, rows: usize, samples: Option<usize>) -> Option<Diagnostic> {
    let poses = places.saturating_mul(rows);
    let is_robot = rotary_axes_place_tip(machine);
    let max = if is_robot { PlacementOptions::MAX_ROBOT } else { PlacementOptions::MAX_TOOL_POSES };
    let drawn = poses.saturating_mul(samples.unwrap_or_default());
    let (what, help) = if places > PlacementOptions::MAX_PLACES {
        (format!("; {} are tried at most", PlacementOptions::MAX_PLACES), "take fewer values in `--place`")
    } else if poses > max {
        let what = format!(" of {rows} tool poses; {max} tool poses are solved at most");
        (what, "take fewer values in `--place`, or every n-th tool pose")
    } else if drawn > PlacementOptions::MAX_DRAWN {
        let what = format!(" of {rows} tool poses on {} machines", samples.unwrap_or_default());
        (
            what + &format!("; {} deviations are drawn at most", PlacementOptions::MAX_DRAWN),
            "take fewer `--samples`, or fewer values in `--place`",
        )
    } else if places.saturating_mul(samples.unwrap_or_default()) > PlacementOptions::MAX_KEPT {
        let what =
            format!(" on {} machines; {} are kept at most", samples.unwrap_or_default(), PlacementOptions::MAX_KEPT);
        (what, "take fewer `--samples`, or fewer values in `--place`")
    } else {
        return None;
    };
    Some(Diagnostic::new(codes::E0812, format!("there are {places} places{what}")).help(help))
}
