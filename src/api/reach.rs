//! The workspace: which part of a grid of tips and tool directions the nominal machine reaches.

use super::text::parse_length;
use crate::analysis::{
    DirectionKind, Miss, ReachGrid, ToolDirections, UnreachableCount, reach as reached, rotary_axes_place_tip,
};
use crate::diagnostic::{Diagnostic, codes, shown};
use crate::job::job_file::{Job, JobPaths, NO_JOB};
use crate::job::machine_file::MachineFile;
use crate::job::over::{Over, OverKind};
use crate::job::path::PathResult;
use crate::job::reference::{Reference, SetUp};
use crate::job::reference_text::ReferenceOption;
use crate::job::tool_poses::{Lack, Lacks, MissedToolPose, ReachedToolPoses};
use crate::machine::{Machine, Pose};
use crate::report::{Picture, ReachPicture, structured_grid};
use crate::run::{Call, Refused, Reply, Run};
use crate::units::{FARTHEST, number, significant};
use std::path::{Path, PathBuf};

/// Options of [`reach`].
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct ReachOptions {
    /// The box of the tips in the workpiece frame, `X=-100..100,Z=0..200` (mm, or with units). Sides that are left out
    /// are those of the box over which the linear axes carry the tip, rotary axes at rest; for robots, whose rotary
    /// axes place the tip, those of the box around it at 2000 random poses.
    pub region: Option<String>,
    /// Largest distance of neighbouring tips, mm; by default an eighth of the longest side, for robots a third.
    pub step_mm: Option<f64>,
    /// Number of directions of the tool; 60 by default, 6 for robots. A machine that does not turn its tool has one; of
    /// a circle those count that are within the hemisphere about the tool axis at rest.
    pub directions: Option<usize>,
    /// A file of tool poses in place of the box.
    pub tool_poses: Option<PathBuf>,
    /// A job file in place of the box.
    pub job: Option<PathBuf>,
    /// True if the tool poses are one continuous path, solved as a whole; by default what the job file says, or else of
    /// CL data alone.
    pub path: Option<bool>,
    /// Motion that the part's set-up takes out, whose point is to be reached, too; of tool poses alone, by default the
    /// zero at the part's origin.
    #[schemars(with = "Option<ReferenceOption>")]
    pub reference: Option<Reference>,
}

impl ReachOptions {
    /// Largest number of tool poses.
    pub const MAX: usize = 1_000_000;
    /// Largest number of tool poses of a robot, which takes long to find each.
    pub const MAX_ROBOT: usize = 10_000;

    fn is_box(&self) -> bool {
        self.region.is_some() || self.step_mm.is_some() || self.directions.is_some()
    }

    /// Returns the files of the job. A box that is asked for comes before the job of the machine file.
    fn job_paths(&self) -> JobPaths<'_> {
        let boxed = (self.is_box() && self.tool_poses.is_none()).then(|| Path::new(NO_JOB));
        JobPaths {
            job: self.job.as_deref().or(boxed),
            tool_poses: self.tool_poses.as_deref(),
            axis_poses: None,
            path: self.path,
        }
    }
}

/// Directions of the tool at every tip.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct ReachDirections {
    /// `one`, `circle` (equal turns of an axis), `hemisphere` (equal areas) or `listed` (those of a job, one at each
    /// tip).
    pub kind: DirectionKind,
    /// Number of directions.
    pub count: usize,
    /// The tool axis at rest, from the tip to the holder, workpiece frame.
    pub about: [f64; 3],
}

/// The reach of a machine.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct ReachResult {
    /// Name of the machine.
    pub machine: String,
    /// Name of the tool; empty for a tool without a name.
    pub tool: String,
    /// Poses and reference of the reach.
    pub over: Over,
    /// Events of the path, if the tool poses are one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<PathResult>,
    /// Ends of the box along x, y, z of the workpiece frame, mm.
    pub box_mm: [[f64; 2]; 3],
    /// Number of tips along x, y, z; of a job all tips stand in one row.
    pub counts: [usize; 3],
    /// Number of tips.
    pub tips: usize,
    /// The directions at every tip.
    pub directions: ReachDirections,
    /// Number of tool poses: tips times directions.
    pub tool_poses: usize,
    /// Number of them that are reached.
    pub reached: usize,
    /// Their fraction.
    pub share: f64,
    /// Number of tips that are reached in all directions.
    pub tips_in_all_directions: usize,
    /// Number of tips that are reached in at least one.
    pub tips_in_any_direction: usize,
    /// Number of the tool poses out of reach, by reason.
    pub unreachable: UnreachableCount,
    /// What they lack, the most frequent first.
    pub lacks: Vec<Lack>,
    /// Tool poses of a job, row by row where they are out of reach.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub job: Option<ReachedToolPoses>,
    #[serde(skip)]
    grid: ReachGrid,
    /// The tips of a job, mm.
    #[serde(skip)]
    job_tips: Vec<[f64; 3]>,
    /// Events of the path at each tip in words, empty at a tip without; none of single poses.
    #[serde(skip)]
    pub events: Vec<String>,
    /// Directions reached at each tip.
    #[serde(skip)]
    by_tip: Vec<usize>,
}

struct AtTip {
    reached: usize,
    unreachable: UnreachableCount,
    lacks: Lacks,
}

impl ReachResult {
    /// Returns the tips (mm, workpiece frame) with the fraction of the directions reached, x running fastest.
    pub fn tips(&self) -> impl Iterator<Item = ([f64; 3], f64)> {
        let tip = |i: usize| self.job_tips.get(i).copied().unwrap_or_else(|| self.grid.tip(i).into());
        self.by_tip.iter().enumerate().map(move |(i, reached)| (tip(i), self.fraction(*reached)))
    }

    fn fraction(&self, reached: usize) -> f64 {
        reached as f64 / self.directions.count as f64
    }

    /// Returns the tips as a VTK structured grid (`.vts`), with `share` and `reached`.
    pub fn vtk(&self) -> Vec<u8> {
        let points: Vec<[f64; 3]> = self.tips().map(|(tip, _)| tip).collect();
        let shares: Vec<f64> = self.tips().map(|(_, share)| share).collect();
        let reached: Vec<f64> = self.by_tip.iter().map(|reached| *reached as f64).collect();
        let note = "Tips in the workpiece frame in mm; share and number of the tool directions reached.";
        structured_grid(note, self.counts, &points, &[("share", &shares), ("reached", &reached)])
    }

    /// Returns sections of the box, coloured by the share of directions reached.
    pub fn picture(&self) -> Picture {
        let shares: Vec<f64> = self.tips().map(|(_, share)| share).collect();
        let mut notes = vec![
            format!("Colour: share of the {} reached at each tip; white: none.", self.directions_text()),
            format!(
                "{} % of {} tool poses are reached; all directions at {} of {} tips.",
                significant(100.0 * self.share, 4),
                self.tool_poses,
                self.tips_in_all_directions,
                self.tips
            ),
        ];
        notes.extend(self.lacks.first().map(|lack| format!("First of all: {}.", lack.words("tool pose"))));
        let title =
            if self.tool.is_empty() { self.machine.clone() } else { format!("{}, {}", self.machine, self.tool) };
        ReachPicture { title: &title, grid: &self.grid, shares: &shares, notes: &notes }.picture()
    }

    /// Returns the directions in words, such as `60 directions over the hemisphere about (0, 0, 1)`.
    pub fn directions_text(&self) -> String {
        let about = self.directions.about.map(|x| significant(x + 0.0, 4)).join(", ");
        match self.directions.kind {
            DirectionKind::Listed => "one direction each, those of the job".to_owned(),
            DirectionKind::One => format!("one direction, ({about})"),
            DirectionKind::Circle => format!("{} directions on the circle through ({about})", self.directions.count),
            DirectionKind::Hemisphere => {
                format!("{} directions over the hemisphere about ({about})", self.directions.count)
            }
        }
    }
}

/// Returns the share of a grid of tips and tool directions that the nominal machine reaches, whatever its errors.
///
/// Fails for a box, a step or a number of directions that makes no sense, and for more tool poses than
/// [`ReachOptions::MAX`].
pub fn reach(file: &MachineFile, options: &ReachOptions, run: Run) -> Reply<ReachResult> {
    Call::answer(run, file.sources(), |call| {
        options.job_paths().with_tool(call, file, |call, file| find(call, file, options))
    })
}

fn find(call: &mut Call, machine: &MachineFile, options: &ReachOptions) -> Result<ReachResult, Refused> {
    if let Some(job) = options.job_paths().read(call, machine)? {
        if options.is_box() {
            return call.usage("a job has its own tool poses: omit `--box`, `--step` and `--directions`");
        }
        return of_job(call, machine, &job, options.reference.as_ref());
    }
    if options.reference.is_some() {
        return call.usage("the reference sets up the part of a job: add `--job` or `--tool-poses`");
    }
    let robot = rotary_axes_place_tip(machine);
    let region = region(call, machine, options)?;
    let count = options.directions.unwrap_or(if robot { 6 } else { 60 });
    if !(1..=ReachOptions::MAX).contains(&count) {
        return call.usage(format!("{count} directions: 1 to {} are taken", ReachOptions::MAX));
    }
    let longest = region.iter().map(|[min, max]| max - min).fold(0.0, f64::max);
    let step = options.step_mm.unwrap_or(longest / if robot { 3.0 } else { 8.0 });
    // Without a length all tips are one, whatever the step.
    let step = if longest == 0.0 && options.step_mm.is_none() { 1.0 } else { step };
    if !(step > 0.0 && step.is_finite()) {
        return call.usage("the step is a length above 0");
    }
    let directions = ToolDirections::of(machine, count);
    let max = if robot { ReachOptions::MAX_ROBOT } else { ReachOptions::MAX };
    let grid = ReachGrid::new(region, step).filter(|grid| grid.len().saturating_mul(directions.list.len()) <= max);
    let Some(grid) = grid else { return call.refuse(too_many(step, directions.list.len(), max)) };
    let at_tip = |results: Vec<Result<Pose, Miss>>| at_tip(machine, results);
    let tips =
        call.stage("tips", grid.len(), |progress| reached(machine, &grid, &directions.list, &at_tip, progress))?;
    let by_tip: Vec<usize> = tips.iter().map(|tip| tip.reached).collect();
    let (mut unreachable, mut lacks) = (UnreachableCount::default(), Lacks::default());
    for tip in tips {
        unreachable.merge(tip.unreachable);
        lacks.merge(tip.lacks);
    }
    let counts = [grid.len() * directions.list.len(), by_tip.iter().sum()];
    let over = Over::new(OverKind::Volume, machine, &Reference::default(), counts);
    Ok(sum_up(machine, over, &grid, &directions, by_tip, (unreachable, lacks)))
}

fn too_many(step: f64, directions: usize, max: usize) -> Diagnostic {
    let message =
        format!("tips {} mm apart in {directions} directions are more than {max} tool poses", significant(step, 6));
    Diagnostic::new(codes::E0812, message).help("take a larger `--step`, a smaller `--box` or fewer `--directions`")
}

fn region(call: &mut Call, machine: &Machine, options: &ReachOptions) -> Result<[[f64; 2]; 3], Refused> {
    let mut region = ReachGrid::region_of(machine);
    for side in options.region.iter().flat_map(|text| text.split(',')) {
        match parse_side(side) {
            Some((k, ends)) => region[k] = ends,
            None => {
                let side = shown(side);
                return call.usage(format!("`{side}` is no side of a box: `X=-100..100,Z=0..200` gives two, in mm"));
            }
        }
    }
    Ok(region)
}

/// Returns the index of x, y, z and the ends (mm) of a side such as `X=-100..100`.
fn parse_side(side: &str) -> Option<(usize, [f64; 2])> {
    let (letter, ends) = side.split_once('=')?;
    let (min, max) = ends.split_once("..")?;
    let k = ["X", "Y", "Z"].iter().position(|known| letter.trim().eq_ignore_ascii_case(known))?;
    let length = |text: &str| {
        let mm = number(text).ok().or_else(|| parse_length(text).ok().flatten());
        mm.filter(|mm| mm.abs() <= FARTHEST)
    };
    let ends = [length(min)?, length(max)?];
    (ends[0] <= ends[1]).then_some((k, ends))
}

fn at_tip(machine: &Machine, results: Vec<Result<Pose, Miss>>) -> AtTip {
    let mut at = AtTip { reached: 0, unreachable: UnreachableCount::default(), lacks: Lacks::default() };
    for result in results {
        match result {
            Ok(_) => at.reached += 1,
            Err(miss) => {
                at.unreachable.add(&miss);
                at.lacks.take(machine, &MissedToolPose::new(machine, (0, None), &miss, None));
            }
        }
    }
    at
}

/// Returns the reach of the tool poses of a job. Warns of rewinds, and if the part cannot be set up.
fn of_job(call: &mut Call, machine: &Machine, job: &Job, stated: Option<&Reference>) -> Result<ReachResult, Refused> {
    let reached = job.poses.examine(machine);
    call.extend(reached.path.as_ref().and_then(|path| path.warning(machine)));
    let tips = job.poses.tips();
    let side = |k: usize| {
        let ends = |[min, max]: [f64; 2], tip: &[f64; 3]| [min.min(tip[k]), max.max(tip[k])];
        tips.iter().fold([f64::INFINITY, f64::NEG_INFINITY], ends)
    };
    let grid = ReachGrid { region: [0, 1, 2].map(side), counts: [tips.len(), 1, 1] };
    let reference = Job::stated(Some(job), stated).unwrap_or_else(|| job.zero());
    let set_up = match SetUp::new(machine, &reference, &reached.poses) {
        Ok(set_up) => set_up,
        Err(reason) => {
            let help = "state a reference that the machine reaches in the job";
            call.warn(Job::located(Some(job), stated, Diagnostic::new(codes::W0850, reason.message)).help(help));
            call.check()?;
            SetUp::machine()
        }
    };
    let mut lacks = Lacks::default();
    reached.rows.iter().for_each(|row| lacks.take(machine, row));
    let lines = job.poses.lines();
    let path = reached.path.clone();
    let events = path.as_ref().map_or_else(Vec::new, |path| path.words_at(lines.iter().copied()));
    let is_reached = |line: usize| reached.lines.binary_search_by(|of| of.0.cmp(&line)).is_ok();
    let by_tip = lines.into_iter().map(|line| usize::from(is_reached(line))).collect();
    let about = ToolDirections::of(machine, 1).about;
    let directions = ToolDirections { kind: DirectionKind::Listed, about, list: vec![about] };
    let over = Over::work(machine, &set_up.reference, Some(&reached), 0);
    let whole = sum_up(machine, over, &grid, &directions, by_tip, (reached.unreachable, lacks));
    Ok(ReachResult { job: Some(reached), job_tips: tips, path, events, ..whole })
}

fn sum_up(
    machine: &Machine,
    over: Over,
    grid: &ReachGrid,
    directions: &ToolDirections,
    by_tip: Vec<usize>,
    (unreachable, lacks): (UnreachableCount, Lacks),
) -> ReachResult {
    let count = directions.list.len();
    let (reached, tool_poses) = (by_tip.iter().sum::<usize>(), by_tip.len() * count);
    ReachResult {
        machine: machine.name().to_owned(),
        tool: machine.tool().name.clone(),
        over,
        path: None,
        box_mm: grid.region,
        counts: grid.counts,
        tips: by_tip.len(),
        directions: ReachDirections { kind: directions.kind, count, about: directions.about.map(|x| x + 0.0).into() },
        tool_poses,
        reached,
        share: reached as f64 / tool_poses as f64,
        tips_in_all_directions: by_tip.iter().filter(|reached| **reached == count).count(),
        tips_in_any_direction: by_tip.iter().filter(|reached| **reached > 0).count(),
        unreachable,
        lacks: lacks.most_first(),
        job: None,
        grid: *grid,
        job_tips: Vec::new(),
        events: Vec::new(),
        by_tip,
    }
}
