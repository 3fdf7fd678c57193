//! A study: every walk on the same tool poses, judged by a budget or by the errors that have a value.

use super::arrangement::Walk;
use super::ranking::{NeededRange, Outcome, Row, Standing};
use super::side_draws::SideDraws;
use super::walk_budget;
use crate::analysis::design::budget::{Bound, Draws, Percentile, SampleLanes, Statistic, mean};
use crate::analysis::design::compare::UnreachableCount;
use crate::analysis::inverse::{Miss, Needs, ToolPose, inverse_all, tool_pose};
use crate::analysis::volume::Work;
use crate::evaluate::{Bare, Field, Order, Poses, Random};
use crate::lower::{Quantity, Twist, twists};
use crate::machine::{Approach, Axis, AxisKind, AxisName, Branch, ErrorId, Machine, Pose};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

/// The criterion by which arrangements are judged.
#[derive(Debug, Clone)]
pub enum Judge {
    /// Errors drawn between bounds.
    Budget {
        /// The bounds.
        bounds: Vec<Bound>,
        /// The generator of errors.
        draws: Draws,
        /// Number of samples.
        samples: usize,
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
    reference: Reference,
    drawn: SideDraws,
    freedom: usize,
    sized: bool,
}

/// The machine as its file has it: squared lengths of the deviations (mm^2) at every tool pose.
#[derive(Debug)]
enum Reference {
    /// SampleChunk by chunk.
    Drawn(Vec<Vec<SampleLanes>>),
    Values(Vec<f64>),
}

impl<'a> Study<'a> {
    /// Returns a study with its work and errors drawn. Tool poses that the machine itself cannot reach are left out.
    pub fn new(machine: &'a Machine, walks: Vec<Walk>, judge: Judge, statistic: Statistic, work: &Work) -> Self {
        let targets: Vec<ToolPose> = (0..work.len()).into_par_iter().map(|i| work.get(machine, i)).collect();
        let found = inverse_all(machine, &targets).into_iter().zip(targets);
        let (work, poses): (Vec<ToolPose>, Vec<Pose>) =
            found.filter_map(|(pose, target)| Some((target, pose.ok()?))).unzip();
        let drawn = match &judge {
            Judge::Errors => SideDraws::default(),
            Judge::Budget { bounds, draws, samples } => SideDraws::new(machine, bounds, draws, *samples),
        };
        let freedom = freedom(machine);
        let reference = Reference::Values(Vec::new());
        let mut study = Self { machine, walks, statistic, judge, work, reference, drawn, freedom, sized: false };
        study.reference = study.own(&poses);
        study
    }

    /// The same study, which also tells the travel that the work needs of each arrangement.
    pub fn sized(self, sized: bool) -> Self {
        Self { sized, ..self }
    }

    /// Returns the machine's own deviations at the work.
    fn own(&self, poses: &[Pose]) -> Reference {
        if let Judge::Errors = self.judge {
            return Reference::Values(poses.par_iter().map(|pose| squared_deviation(self.machine, pose)).collect());
        }
        let axes: Vec<usize> = (0..self.machine.axes().len()).collect();
        let table = self.machine.axes().iter().filter(|a| a.branch == Branch::Workpiece).count();
        Reference::Drawn(walk_budget::squared_lengths(self.machine, &axes, table, poses, &self.drawn))
    }

    /// Returns the tool poses of the work.
    pub fn work(&self) -> &[ToolPose] {
        &self.work
    }

    /// Returns the rows of all arrangements of one walk.
    pub fn step(&self, index: usize) -> Vec<Row> {
        let walk = &self.walks[index];
        let mut rows = Vec::new();
        let machines: Vec<Machine> =
            walk.tables.iter().filter_map(|table| self.machine.rearranged(&walk.sides(self.machine, *table))).collect();
        let mut from = 0;
        while from < machines.len() {
            let alike = machines[from..].iter().take_while(|m| same_nominal(m, &machines[from])).count();
            rows.extend(self.alike(walk, &machines[from..from + alike], &walk.tables[from..from + alike]));
            from += alike;
        }
        rows
    }

    /// Returns the rows of arrangements with the same nominal machine.
    fn alike(&self, walk: &Walk, machines: &[Machine], tables: &[usize]) -> Vec<Row> {
        let nominal = &machines[0];
        let row = |(machine, table): (&Machine, &usize), standing, missed: UnreachableCount| Row {
            chain: machine.chain().to_string(),
            table: *table,
            standing,
            reached: self.work.len() - missed.total,
            unreachable: missed,
            result: None,
            not_stated: self.not_stated(machine),
            travel: Vec::new(),
        };
        let each = || machines.iter().zip(tables);
        if freedom(nominal) < self.freedom {
            let missed =
                UnreachableCount { total: self.work.len(), direction: self.work.len(), ..UnreachableCount::default() };
            return each().map(|of| row(of, Standing::CannotTurn, missed)).collect();
        }
        let found: Vec<Result<Pose, Miss>> = inverse_all(nominal, &self.work);
        let missed = UnreachableCount::count(found.iter().filter_map(|pose| Some(&pose.as_ref().err()?.why)));
        let travel = if self.sized { needed(nominal, &found) } else { Vec::new() };
        let (reached, poses): (Vec<usize>, Vec<Pose>) =
            found.into_iter().enumerate().filter_map(|(i, pose)| Some((i, pose.ok()?))).unzip();
        if poses.is_empty() {
            return each().map(|of| row(of, Standing::ReachesNothing, missed)).collect();
        }
        let results = self.results(walk, machines, tables, &reached, &poses);
        let judged = each().zip(results).map(|(of, result)| Row {
            result: Some(result),
            travel: travel.clone(),
            ..row(of, Standing::Judged, missed)
        });
        judged.collect()
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

    fn results(
        &self,
        walk: &Walk,
        machines: &[Machine],
        tables: &[usize],
        reached: &[usize],
        poses: &[Pose],
    ) -> Vec<Outcome> {
        match (&self.judge, &self.reference) {
            (Judge::Budget { samples, .. }, Reference::Drawn(own)) => {
                let file = own.iter().flat_map(|lanes| {
                    let same: Vec<SampleLanes> = reached.iter().map(|i| lanes[*i]).collect();
                    walk_budget::over_poses(self.statistic, &same)
                });
                let file = percentile(file.take(*samples).collect()).value;
                let rows =
                    walk_budget::statistics(&machines[0], &walk.axes, tables, poses, &self.drawn, self.statistic);
                let outcome = |mut row: Vec<f64>| {
                    row.truncate(*samples);
                    let (mean, _) = mean(&row);
                    let p = percentile(row);
                    let um = |x: f64| x * 1e3;
                    let (low, high) = (p.low.map(um), p.high.map(um));
                    Outcome { um: um(p.value), low, high, mean: Some(um(mean)), minus_file: um(p.value) - um(file) }
                };
                rows.into_iter().map(outcome).collect()
            }
            (_, Reference::Values(own)) => {
                let file = self.statistic.of(&mut reached.iter().map(|i| own[*i]).collect::<Vec<_>>()).sqrt();
                let outcome = |machine: &Machine| {
                    let mut squares: Vec<f64> = poses.iter().map(|pose| squared_deviation(machine, pose)).collect();
                    let um = self.statistic.of(&mut squares).sqrt() * 1e3;
                    Outcome { um, low: None, high: None, mean: None, minus_file: um - file * 1e3 }
                };
                machines.iter().map(outcome).collect()
            }
            (Judge::Errors, Reference::Drawn(_)) => Vec::new(),
        }
    }
}

/// Returns the travel that the work needs of each axis.
fn needed(machine: &Machine, found: &[Result<Pose, Miss>]) -> Vec<NeededRange> {
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
    a.workpiece() == b.workpiece() && a.axes().iter().zip(b.axes()).all(nominal)
}

/// True for an error that turns the body that the axis carries about a point.
fn turns(error: &ErrorId, axis: &AxisName) -> bool {
    error.axis == *axis && error.direction.is_rotation() && !error.is_location()
}

fn percentile(mut values: Vec<f64>) -> Percentile {
    values.sort_by(f64::total_cmp);
    Percentile::of(&values, 95)
}

/// Returns the squared length (mm^2) of the deviation by the errors that have a value.
fn squared_deviation(machine: &Machine, pose: &[f64]) -> f64 {
    Bare { machine, order: Order::Exact }.deviation(pose, Approach::Mean).position.norm_squared()
}

/// Returns the number of directions in which the machine can turn its tool axis: 0, 1 or 2, at almost all poses.
pub fn freedom(machine: &Machine) -> usize {
    const POSES: usize = 4;
    const MIN_EIGENVALUE: f64 = 1e-9;
    let intervals = machine.axes().iter().map(|axis| axis.travel.interval()).collect();
    let at = |pose: Pose| {
        let direction = tool_pose(machine, &pose).direction;
        let twists = twists(machine, &pose, Quantity::Rotation);
        let turn = |(axis, twist): (&Axis, &Twist)| {
            let u = axis.direction;
            let w = Vector3::from_fn(|i, _| (0..3).map(|k| twist.outer[i][k + 3] * u[k]).sum());
            w.cross(&direction)
        };
        let rotary = machine.axes().iter().zip(&twists).filter(|(axis, _)| axis.kind == AxisKind::Rotary);
        let gram = rotary.map(turn).fold(Matrix3::zeros(), |sum, w| sum + w * w.transpose());
        gram.symmetric_eigenvalues().iter().filter(|value| **value > MIN_EIGENVALUE).count()
    };
    Poses::Random(Random::new(intervals, POSES, 0)).iter().map(at).max().unwrap_or(0)
}
