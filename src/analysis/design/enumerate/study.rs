//! A study: every walk on the same tool poses, judged by a budget or by the errors that have a value.

use super::arrangement::Walk;
use super::journal::RoundRecord;
use super::ranking::{ArrangementRow, NeededRange, Standing};
use super::side_draws::SideDraws;
use super::walk_budget;
use crate::analysis::design::budget::{Bound, Draws, SampleLanes, Statistic, percentile_95};
use crate::analysis::design::compare::UnreachableCount;
use crate::analysis::inverse::{Miss, Needs, ToolPose, freedom};
use crate::analysis::path::{path_events, solve};
use crate::analysis::volume::Work;
use crate::evaluate::{Bare, Field, Order};
use crate::machine::{Approach, Axis, AxisName, Branch, ErrorId, Machine, Pose};
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

/// A study of arrangements.
#[derive(Debug)]
pub struct Study<'a> {
    machine: &'a Machine,
    walks: Vec<Walk>,
    statistic: Statistic,
    judge: Judge,
    work: Vec<ToolPose>,
    poses: Vec<Pose>,
    freedom: usize,
    sized: bool,
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

/// The machine as its file has it: squared lengths of the deviations (mm^2) at every tool pose.
#[derive(Debug)]
enum ReferenceMachine {
    /// Chunk by chunk.
    Drawn(Vec<Vec<SampleLanes>>),
    Values(Vec<f64>),
}

impl<'a> Study<'a> {
    /// Returns a study with its work. Tool poses that the machine itself cannot reach are left out.
    pub fn new(machine: &'a Machine, walks: Vec<Walk>, judge: Judge, statistic: Statistic, work: &Work) -> Self {
        let targets: Vec<ToolPose> = (0..work.len()).into_par_iter().map(|i| work.get(machine, i)).collect();
        let found = solve(machine, &targets, work.is_path()).into_iter().zip(targets);
        let is_path = work.is_path();
        let (work, poses): (Vec<ToolPose>, Vec<Pose>) =
            found.filter_map(|(pose, target)| Some((target, pose.ok()?))).unzip();
        Self { machine, walks, statistic, judge, work, poses, freedom: freedom(machine), sized: false, is_path }
    }

    /// The same study, which also tells the travel that the work needs of each arrangement.
    pub fn with_travel(self, sized: bool) -> Self {
        Self { sized, ..self }
    }

    /// Returns a round with its samples drawn, and all before them.
    pub fn round(&'a self, samples: Range<usize>) -> StudyRound<'a> {
        let Judge::Budget { bounds, draws } = &self.judge else {
            let values = self.poses.par_iter().map(|pose| squared_deviation(self.machine, pose)).collect();
            return StudyRound {
                study: self,
                samples,
                drawn: SideDraws::default(),
                reference: ReferenceMachine::Values(values),
            };
        };
        let drawn = SideDraws::new(self.machine, bounds, draws, samples.end);
        let axes: Vec<usize> = (0..self.machine.axes().len()).collect();
        let table = self.machine.axes().iter().filter(|a| a.branch == Branch::Workpiece).count();
        let lengths = walk_budget::squared_lengths(self.machine, &axes, table, &self.poses, &drawn);
        StudyRound { study: self, samples, drawn, reference: ReferenceMachine::Drawn(lengths) }
    }

    /// Returns the tool poses of the work.
    pub fn work(&self) -> &[ToolPose] {
        &self.work
    }

    /// Returns the names of what has no geometry stated for its side.
    fn not_stated(&self, machine: &Machine) -> Vec<String> {
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
        let (walk, machine) = (&self.study.walks[index], self.study.machine);
        let wanted = |table: &usize| tables.is_none_or(|tables| tables.contains(table));
        let (tables, machines): (Vec<usize>, Vec<Machine>) = walk
            .tables
            .iter()
            .filter(|table| wanted(table))
            .filter_map(|table| Some((*table, machine.rearranged(&walk.sides(machine, *table))?)))
            .unzip();
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
        let apart = |row: ArrangementRow| RoundRecord { row, values: Vec::new(), file: None };
        if freedom(nominal) < study.freedom {
            let all = study.work.len();
            let missed = UnreachableCount { total: all, direction: all, ..UnreachableCount::default() };
            return each().map(|of| apart(row(of, Standing::CannotTurn, missed))).collect();
        }
        let found: Vec<Result<Pose, Miss>> = solve(nominal, &study.work, study.is_path);
        let missed = UnreachableCount::count(found.iter().filter_map(|pose| Some(&pose.as_ref().err()?.why)));
        let travel = if study.sized { travel_needs(nominal, &found) } else { Vec::new() };
        let rewinds = study.is_path.then(|| {
            let poses: Vec<Option<&Pose>> = found.iter().map(|pose| pose.as_ref().ok()).collect();
            path_events(nominal, &study.work, &poses).rewinds.len()
        });
        let (reached, poses): (Vec<usize>, Vec<Pose>) =
            found.into_iter().enumerate().filter_map(|(i, pose)| Some((i, pose.ok()?))).unzip();
        if poses.is_empty() {
            return each().map(|of| apart(row(of, Standing::ReachesNothing, missed))).collect();
        }
        let (values, file) = self.values(walk, machines, tables, &reached, &poses);
        let judged = each().zip(values).map(|(of, values)| RoundRecord {
            row: ArrangementRow { travel: travel.clone(), rewinds, ..row(of, Standing::Judged, missed) },
            values,
            file: Some(file),
        });
        judged.collect()
    }

    /// Returns the values of the round, um, for every arrangement, and the ranked value of the file's machine.
    fn values(
        &self,
        walk: &Walk,
        machines: &[Machine],
        tables: &[usize],
        reached: &[usize],
        poses: &[Pose],
    ) -> (Vec<Vec<f64>>, f64) {
        let statistic = self.study.statistic;
        let um = |mm: f64| mm * 1e3;
        match &self.reference {
            ReferenceMachine::Drawn(own) => {
                let file = own.iter().flat_map(|lanes| {
                    let same: Vec<SampleLanes> = reached.iter().map(|i| lanes[*i]).collect();
                    walk_budget::over_poses(statistic, &same)
                });
                let file: Vec<f64> = file.take(self.samples.end).map(um).collect();
                let round = walk_budget::Round { drawn: &self.drawn, samples: self.samples.clone() };
                let rows = walk_budget::statistics(&machines[0], &walk.axes, tables, poses, &round, statistic);
                (rows.into_iter().map(|row| row.into_iter().map(um).collect()).collect(), percentile_95(&file))
            }
            ReferenceMachine::Values(own) => {
                let file = statistic.of(&mut reached.iter().map(|i| own[*i]).collect::<Vec<_>>()).sqrt();
                let value = |machine: &Machine| {
                    let mut squares: Vec<f64> = poses.iter().map(|pose| squared_deviation(machine, pose)).collect();
                    vec![um(statistic.of(&mut squares).sqrt())]
                };
                (machines.iter().map(value).collect(), um(file))
            }
        }
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

/// Returns the squared length (mm^2) of the deviation by the errors that have a value.
fn squared_deviation(machine: &Machine, pose: &[f64]) -> f64 {
    Bare { machine, order: Order::Exact }.deviation(&Approach::Mean.at_pose(pose)).position.norm_squared()
}
