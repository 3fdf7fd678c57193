//! A study: every walk on the same tool poses, judged by a budget or by the errors that have a value.

use super::arrangement::Walk;
use super::journal::RoundRecord;
use super::ranking::{ArrangementRow, NeededRange, Standing};
use super::side_draws::SideDraws;
use super::walk_budget::{self, WalkPoses};
use crate::analysis::design::budget::{Bound, Draws, SampleLanes, Statistic, percentile_95};
use crate::analysis::design::compare::UnreachableCount;
use crate::analysis::inverse::{Miss, Needs, ToolPose, freedom, rotary_axes_place_tip};
use crate::analysis::path::{path_events, solve};
use crate::analysis::reference::{PartReference, tip_at};
use crate::analysis::volume::Work;
use crate::evaluate::{Bare, Field, Order};
use crate::machine::{Approach, Axis, AxisName, Branch, ErrorId, Machine, OperatingConditions, Pose};
use rayon::prelude::*;
use std::ops::Range;

/// The criterion by which arrangements are judged.
#[derive(Debug, Clone)]
pub enum Judge {
    /// Errors drawn between bounds.
    Budget {
        bounds: Vec<Bound>,
        /// The generator of errors.
        draws: Draws,
    },
    /// The errors that have a value, with the exact model.
    Errors,
}

/// The set-up of a part on every arrangement.
pub trait PartSetUps: std::fmt::Debug + Sync {
    /// Returns what is taken out on a machine at its poses (mm, deg) for the work; after it what the best fit takes
    /// out, if that is asked for too. `None` if the machine does not reach the point of the reference.
    fn references(&self, machine: &Machine, poses: &[Pose]) -> Option<Vec<Option<PartReference>>>;

    /// True if what is taken out first depends on the poses.
    fn is_fitted(&self) -> bool;
}

/// Nothing is taken out.
#[derive(Debug, Clone, Copy, Default)]
pub struct MachineCoordinates;

impl PartSetUps for MachineCoordinates {
    fn references(&self, _: &Machine, _: &[Pose]) -> Option<Vec<Option<PartReference>>> {
        Some(vec![None])
    }

    fn is_fitted(&self) -> bool {
        false
    }
}

/// A study of arrangements.
#[derive(Debug, Clone)]
pub struct Study<'a> {
    machine: &'a Machine,
    walks: Vec<Walk>,
    statistic: Statistic,
    judge: Judge,
    work: Vec<ToolPose>,
    /// The poses (mm, deg) of the machine as its file has it.
    poses: Vec<Pose>,
    /// The index of that pose for each tool pose; `None` where the machine does not reach it.
    of_file: Vec<Option<usize>>,
    freedom: usize,
    sized: bool,
    set_ups: &'a dyn PartSetUps,
    is_path: bool,
}

/// One round of a study: the machines that are drawn in it.
#[derive(Debug)]
pub struct StudyRound<'a> {
    study: &'a Study<'a>,
    samples: Range<usize>,
    drawn: SideDraws,
    reference: ReferenceMachine,
}

/// The machine as its file has it: squared lengths of the deviations (mm^2) at every tool pose that it reaches.
#[derive(Debug)]
enum ReferenceMachine {
    /// Chunk by chunk.
    Drawn(Vec<Vec<SampleLanes>>),
    Values(Vec<f64>),
}

impl<'a> Study<'a> {
    /// Returns a study with its work. Listed tool poses all count; of those drawn from the volume, which the machine
    /// reaches but for rounding, the others are left out.
    pub fn new(machine: &'a Machine, walks: Vec<Walk>, judge: Judge, statistic: Statistic, work: &Work) -> Self {
        let targets: Vec<ToolPose> = (0..work.len()).into_par_iter().map(|i| work.get(machine, i)).collect();
        let found = solve(machine, &targets, work.is_path()).into_iter().zip(targets);
        let (is_path, is_drawn) = (work.is_path(), matches!(work, Work::OfPoses(_)));
        let (mut work, mut poses, mut of_file) = (Vec::new(), Vec::new(), Vec::new());
        for (pose, target) in found.filter(|(pose, _)| pose.is_ok() || !is_drawn) {
            work.push(target);
            of_file.push(pose.is_ok().then_some(poses.len()));
            poses.extend(pose);
        }
        let (freedom, set_ups) = (freedom(machine), &MachineCoordinates);
        Self { machine, walks, statistic, judge, work, poses, of_file, freedom, sized: false, set_ups, is_path }
    }

    /// The same study without what the set-up of the part takes out.
    pub fn with_set_ups(self, set_ups: &'a dyn PartSetUps) -> Self {
        Self { set_ups, ..self }
    }

    /// The same study, which also tells the travel that the work needs of each arrangement.
    pub fn with_travel(self, sized: bool) -> Self {
        Self { sized, ..self }
    }

    /// Returns the number of walks.
    pub fn walks(&self) -> usize {
        self.walks.len()
    }

    /// True if the travel that the work needs is told.
    pub(super) fn is_sized(&self) -> bool {
        self.sized
    }

    /// True if the work is one path.
    pub(super) fn is_path(&self) -> bool {
        self.is_path
    }

    /// Returns the arrangements of a walk that have so many axes on the table, `None` for all, with these numbers.
    pub(super) fn arrangements(&self, walk: usize, tables: Option<&[usize]>) -> Vec<(usize, Machine)> {
        let (walk, machine) = (&self.walks[walk], self.machine);
        let wanted = |table: &&usize| tables.is_none_or(|tables| tables.contains(table));
        let arranged = |table: &usize| Some((*table, machine.rearranged(&walk.sides(machine, *table))?));
        walk.tables.iter().filter(wanted).filter_map(arranged).collect()
    }

    /// Returns the criterion.
    pub(super) fn judge_mut(&mut self) -> &mut Judge {
        &mut self.judge
    }

    /// Returns the number of searches for poses of arms that so many walks take; 0 of machines whose linear axes place
    /// the tip, which need none.
    pub fn searches(&self, walks: usize) -> usize {
        if rotary_axes_place_tip(self.machine) { walks.saturating_mul(self.work.len()) } else { 0 }
    }

    /// Returns a round with its samples drawn, and all before them.
    pub fn round(&'a self, samples: Range<usize>) -> StudyRound<'a> {
        let drawn = match &self.judge {
            Judge::Errors => SideDraws::default(),
            Judge::Budget { bounds, draws } => SideDraws::new(self.machine, bounds, draws, samples.end),
        };
        let reference = self.file_lengths(&self.poses, &drawn);
        StudyRound { study: self, samples, drawn, reference }
    }

    /// Returns the machine as its file has it at some of its poses for the work.
    fn file_lengths(&self, poses: &[Pose], drawn: &SideDraws) -> ReferenceMachine {
        let references = self.set_ups.references(self.machine, poses).unwrap_or_else(|| vec![None]);
        if let Judge::Errors = self.judge {
            return ReferenceMachine::Values(squared_deviations(self.machine, poses, references[0].as_ref()));
        }
        let axes: Vec<usize> = (0..self.machine.axes().len()).collect();
        let tables = [self.machine.axes().iter().filter(|a| a.branch == Branch::Workpiece).count()];
        let references = &references[..1];
        let walk = WalkPoses { machine: self.machine, axes: &axes, tables: &tables, poses, references };
        ReferenceMachine::Drawn(walk_budget::squared_lengths(walk, drawn))
    }

    /// Returns the tool poses of the work.
    pub fn work(&self) -> &[ToolPose] {
        &self.work
    }

    /// Returns the names of what has no geometry stated for its side.
    pub(super) fn not_stated(&self, machine: &Machine) -> Vec<String> {
        let bounded = |axis: &AxisName| match &self.judge {
            Judge::Budget { bounds, .. } => bounds.iter().any(|bound| turns(&bound.error, axis)),
            Judge::Errors => false,
        };
        let axes = machine.unstated(bounded).into_iter().map(|(index, _)| machine.axes()[index].name.to_string());
        axes.chain(machine.unstated_workpiece().map(|_| "workpiece".to_owned())).collect()
    }
}

impl StudyRound<'_> {
    /// Returns the records of the arrangements of one walk that have so many axes on the table: `None` for all.
    pub fn step(&self, index: usize, tables: Option<&[usize]>) -> Vec<RoundRecord> {
        let walk = &self.study.walks[index];
        let (tables, machines): (Vec<usize>, Vec<Machine>) = self.study.arrangements(index, tables).into_iter().unzip();
        let mut records = Vec::new();
        let mut from = 0;
        while from < machines.len() {
            let alike = machines[from..].iter().take_while(|m| same_nominal(m, &machines[from])).count();
            records.extend(self.alike(walk, &machines[from..from + alike], &tables[from..from + alike]));
            from += alike;
        }
        records
    }

    /// Returns the records of arrangements with the same nominal machine.
    fn alike(&self, walk: &Walk, machines: &[Machine], tables: &[usize]) -> Vec<RoundRecord> {
        let study = self.study;
        let nominal = &machines[0];
        let row = |(machine, table): (&Machine, &usize), standing, missed: UnreachableCount| ArrangementRow {
            chain: machine.chain().to_string(),
            table: *table,
            standing,
            reached: study.work.len() - missed.total,
            unreachable: missed,
            result: None,
            not_stated: study.not_stated(machine),
            travel: Vec::new(),
            rewinds: None,
        };
        let each = || machines.iter().zip(tables);
        let (empty, none) = (Vec::new, None::<f64>);
        let apart = |row| RoundRecord { row, values: empty(), best_fit: empty(), file: none, common: none };
        if freedom(nominal) < study.freedom {
            let all = study.work.len();
            let missed = UnreachableCount { total: all, direction: all, ..UnreachableCount::default() };
            return each().map(|of| apart(row(of, Standing::CannotTurn, missed))).collect();
        }
        let found: Vec<Result<Pose, Miss>> = solve(nominal, &study.work, study.is_path);
        let missed = UnreachableCount::count(found.iter().filter_map(|pose| pose.as_ref().err()));
        let travel = if study.sized { travel_needs(nominal, &found) } else { Vec::new() };
        let rewinds = study.is_path.then(|| path_events(nominal, &study.work, &found).rewinds.len());
        let (reached, poses): (Vec<usize>, Vec<Pose>) =
            found.into_iter().enumerate().filter_map(|(i, pose)| Some((i, pose.ok()?))).unzip();
        if poses.is_empty() {
            return each().map(|of| apart(row(of, Standing::ReachesNothing, missed))).collect();
        }
        let Some(references) = study.set_ups.references(nominal, &poses) else {
            return each().map(|of| apart(row(of, Standing::MissesReference, missed))).collect();
        };
        let file = self.file_value(&reached);
        let common = self.common_values(walk, machines, tables, (&reached, &poses));
        let walk = WalkPoses { machine: nominal, axes: &walk.axes, tables, poses: &poses, references: &references };
        let mut values = self.values(walk, machines, self.samples.clone()).into_iter();
        let (values, best_fit) = (values.next().unwrap_or_default(), values.next());
        let best_fit = best_fit.unwrap_or_else(|| vec![Vec::new(); machines.len()]);
        let judged =
            each().zip(values).zip(best_fit).zip(common).map(|(((of, values), best_fit), common)| RoundRecord {
                row: ArrangementRow { travel: travel.clone(), rewinds, ..row(of, Standing::Judged, missed) },
                values,
                best_fit,
                file,
                common,
            });
        judged.collect()
    }

    /// Returns the ranked values of arrangements, um, on those of their tool poses that the machine as its file has it
    /// reaches too; none where these are all, or none.
    fn common_values(
        &self,
        walk: &Walk,
        machines: &[Machine],
        tables: &[usize],
        (reached, poses): (&[usize], &[Pose]),
    ) -> Vec<Option<f64>> {
        let is_common = |index: &usize| self.study.of_file[*index].is_some();
        let poses: Vec<Pose> =
            reached.iter().zip(poses).filter(|(index, _)| is_common(index)).map(|(_, pose)| pose.clone()).collect();
        let references = (!poses.is_empty() && poses.len() < reached.len())
            .then(|| self.study.set_ups.references(&machines[0], &poses))
            .flatten();
        let Some(references) = references else { return vec![None; machines.len()] };
        let (machine, axes, references) = (&machines[0], walk.axes.as_slice(), &references[..1]);
        let walk = WalkPoses { machine, axes, tables, poses: &poses, references };
        let values = self.values(walk, machines, 0..self.samples.end).into_iter().next().unwrap_or_default();
        values.iter().map(|values| Some(percentile_95(values))).collect()
    }

    /// Returns the values in samples, um, for every reference and arrangement.
    fn values(&self, walk: WalkPoses<'_>, machines: &[Machine], samples: Range<usize>) -> Vec<Vec<Vec<f64>>> {
        let statistic = self.study.statistic;
        if let ReferenceMachine::Drawn(_) = &self.reference {
            let round = walk_budget::Round { drawn: &self.drawn, samples };
            let mut values = walk_budget::statistics(walk, &round, statistic);
            values.iter_mut().flatten().flatten().for_each(|mm| *mm *= 1e3);
            return values;
        }
        let value = |machine: &Machine, reference: &Option<PartReference>| {
            vec![statistic.of(&mut squared_deviations(machine, walk.poses, reference.as_ref())).sqrt() * 1e3]
        };
        let of = |reference| machines.iter().map(|machine| value(machine, reference)).collect();
        walk.references.iter().map(of).collect()
    }

    /// Returns the ranked value of the machine as its file has it on those of the tool poses that it reaches, um; none
    /// if it reaches none of them.
    fn file_value(&self, reached: &[usize]) -> Option<f64> {
        let (study, statistic) = (self.study, self.study.statistic);
        let own: Vec<usize> = reached.iter().filter_map(|index| study.of_file[*index]).collect();
        if own.is_empty() {
            return None;
        }
        let all: Vec<usize> = (0..own.len()).collect();
        let fitted = (study.set_ups.is_fitted() && own.len() < study.poses.len()).then(|| {
            let poses: Vec<Pose> = own.iter().map(|i| study.poses[*i].clone()).collect();
            study.file_lengths(&poses, &self.drawn)
        });
        let (own, places) = match &fitted {
            Some(of) => (of, all),
            None => (&self.reference, own),
        };
        Some(match own {
            ReferenceMachine::Drawn(own) => {
                let file = own.iter().flat_map(|lanes| {
                    let same: Vec<SampleLanes> = places.iter().map(|i| lanes[*i]).collect();
                    walk_budget::over_poses(statistic, &same)
                });
                percentile_95(&file.take(self.samples.end).map(|mm| mm * 1e3).collect::<Vec<_>>())
            }
            ReferenceMachine::Values(own) => {
                statistic.of(&mut places.iter().map(|i| own[*i]).collect::<Vec<_>>()).sqrt() * 1e3
            }
        })
    }
}

/// Returns the travel that the work needs of each axis.
fn travel_needs(machine: &Machine, found: &[Result<Pose, Miss>]) -> Vec<NeededRange> {
    let ranges = Needs::of(found.iter().map(|pose| pose.as_ref())).ranges;
    let of = |(axis, (min, max)): (&Axis, (f64, f64))| NeededRange { axis: axis.name.to_string(), min, max };
    machine.axes().iter().zip(ranges).map(of).collect()
}

/// True for machines that differ at most in the side of axes on which nothing nominal depends. Axes whose sense or
/// geometry depends on their side make another nominal machine.
fn same_nominal(a: &Machine, b: &Machine) -> bool {
    let nominal = |(a, b): (&Axis, &Axis)| {
        (a.sign(), a.direction, a.origin, a.travel) == (b.sign(), b.direction, b.origin, b.travel)
    };
    let placed = |machine: &Machine| (machine.workpiece(), machine.workpiece_angles());
    placed(a) == placed(b) && a.axes().iter().zip(b.axes()).all(nominal)
}

/// True for an error that turns the body that the axis carries about a point.
fn turns(error: &ErrorId, axis: &AxisName) -> bool {
    error.axis == *axis && error.direction.is_rotation() && !error.is_location()
}

/// Returns the squared lengths (mm^2) of the deviations by the errors that have a value, less what a reference
/// takes out.
fn squared_deviations(machine: &Machine, poses: &[Pose], reference: Option<&PartReference>) -> Vec<f64> {
    let bare = Bare { machine, order: Order::Exact };
    let motion = reference.map(|of| of.motion_of(&bare, Order::Exact, OperatingConditions::from(Approach::Mean)));
    let square = |pose: &Pose| {
        let whole = bare.deviation(&Approach::Mean.at_pose(pose));
        let left = motion.map_or(whole, |motion| motion.removed_from(&whole, &tip_at(machine, pose)));
        left.position.norm_squared()
    };
    poses.par_iter().map(square).collect()
}
