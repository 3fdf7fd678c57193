//! Machines side by side on the same work: the same tool poses in the workpiece frame, reached by
//! each machine's own nominal inverse kinematics.

use crate::analysis::inverse::{Miss, Needs, ToolPose, Unreachable, tool_pose};
use crate::analysis::path::{PathEvents, path_events, solve};
use crate::analysis::reference::{PartReference, tip_at};
use crate::analysis::volume::Work;
use crate::analysis::volume::{View, deviation_in};
use crate::evaluate::{Deviation, Difference, Field, Frame, Order, Statistics};
use crate::machine::{Machine, OperatingConditions, Pose};
use crate::run::Advance;
use rayon::prelude::*;

/// Two or more machines over the tool poses that all of them can reach.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// Number of tool poses requested.
    pub asked: usize,
    /// The tool poses that all machines reach, in their order.
    pub common: Vec<ToolPose>,
    /// The machines, in their order.
    pub machines: Vec<MachineResult>,
}

/// One machine of a comparison.
#[derive(Debug, Clone)]
pub struct MachineResult {
    /// Number of tool poses it cannot reach, whether or not the others can.
    pub unreachable: UnreachableCount,
    /// These tool poses by index with what is missing, in order.
    pub missed: Vec<(usize, Miss)>,
    /// Positions of its axes over all tool poses.
    pub needs: Needs,
    /// Events of the path, if the tool poses are one.
    pub path: Option<PathEvents>,
    /// Its pose (mm, deg) at each common tool pose, with the deviation there (workpiece frame).
    pub reached: Vec<(Pose, Deviation)>,
    /// Over the common tool poses.
    pub statistics: Statistics,
    /// Its statistics minus those of the first machine: negative is better than the first.
    pub difference: Difference,
}

/// Number of unreachable tool poses, by reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct UnreachableCount {
    /// Their total number.
    pub total: usize,
    /// Number for which the rotary axes cannot point the tool in the direction.
    pub direction: usize,
    /// Number whose place the linear axes do not span.
    pub place: usize,
    /// Number for which an axis would leave its travel.
    pub travel: usize,
    /// Number of them for which no pose was found, without a proof that there is none.
    #[serde(default, skip_serializing_if = "is_none_of_them")]
    pub not_proved: usize,
}

fn is_none_of_them(count: &usize) -> bool {
    *count == 0
}

/// `12 (3 direction, 9 travel)`.
impl std::fmt::Display for UnreachableCount {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let each = [(self.direction, "direction"), (self.place, "place"), (self.travel, "travel")];
        let list: Vec<String> = each.iter().filter(|(n, _)| *n > 0).map(|(n, why)| format!("{n} {why}")).collect();
        let open = if self.not_proved > 0 { format!("; {} not proved", self.not_proved) } else { String::new() };
        if list.is_empty() { f.write_str("0") } else { write!(f, "{} ({}{open})", self.total, list.join(", ")) }
    }
}

impl UnreachableCount {
    /// Returns the numbers of reasons.
    pub fn count<'a>(misses: impl Iterator<Item = &'a Miss>) -> Self {
        misses.fold(Self::default(), |mut count, miss| {
            count.add(miss);
            count
        })
    }

    /// Counts a tool pose.
    pub fn add(&mut self, miss: &Miss) {
        self.total += 1;
        self.not_proved += usize::from(!miss.is_proved);
        match miss.why {
            Unreachable::Direction => self.direction += 1,
            Unreachable::Place => self.place += 1,
            Unreachable::Travel => self.travel += 1,
        }
    }

    /// Adds other tool poses.
    pub fn merge(&mut self, other: Self) {
        self.total += other.total;
        self.direction += other.direction;
        self.place += other.place;
        self.travel += other.travel;
        self.not_proved += other.not_proved;
    }
}

type ComparisonRow = Vec<Result<(Pose, Deviation), Miss>>;

/// Returns the comparison of machines on the same work, which may be the tool poses of the first. Of several poses for
/// a tool pose each machine takes the one nearest to its zero pose; a path is solved as a whole. Poses of the axes are
/// taken as they are by the first, and by each machine that they give the same tool poses. Calls `progress` with the
/// number of tool poses done since its last call.
pub fn compare<F: Send>(
    fields: &[&dyn Field],
    work: &Work,
    conditions: OperatingConditions,
    progress: Advance<'_, F>,
) -> Result<Comparison, F> {
    let Some(first) = fields.first() else {
        return Ok(Comparison { asked: work.len(), common: Vec::new(), machines: Vec::new() });
    };
    let targets: Vec<ToolPose> = (0..work.len()).into_par_iter().map(|i| work.get(first.machine(), i)).collect();
    let taken = |field: &&dyn Field| match work {
        Work::OfAxes { poses, .. } => as_they_are(first.machine(), field.machine(), poses, &targets),
        _ => None,
    };
    let of = |field: &&dyn Field| match taken(field) {
        Some(poses) => poses.into_iter().map(Ok).collect(),
        None => solve(field.machine(), &targets, work.is_path()),
    };
    let found: Vec<Vec<Result<Pose, Miss>>> = fields.iter().map(of).collect();
    let events = |(field, found): (&&dyn Field, &Vec<Result<Pose, Miss>>)| {
        work.is_path().then(|| path_events(field.machine(), &targets, found))
    };
    let paths: Vec<Option<PathEvents>> = fields.iter().zip(&found).map(events).collect();
    let row = |index: usize| {
        let at = |(field, found): (&&dyn Field, &Vec<Result<Pose, Miss>>)| {
            let pose = found[index].clone()?;
            let deviation = deviation_in(*field, &pose, View { conditions, frame: Frame::Workpiece });
            Ok((pose, deviation))
        };
        let row: ComparisonRow = fields.iter().zip(&found).map(at).collect();
        progress(1)?;
        Ok((targets[index], row))
    };
    let rows: Vec<(ToolPose, ComparisonRow)> = (0..work.len()).into_par_iter().map(row).collect::<Result<_, F>>()?;
    let mut comparison = side_by_side(rows, fields.len());
    comparison.machines.iter_mut().zip(paths).for_each(|(side, path)| side.path = path);
    Ok(comparison)
}

/// Largest difference of tips (mm), unit vectors and turns (rad) of one tool pose.
const SAME_TOOL_POSE: f64 = 1e-9;

/// Returns poses of the axes of the first machine as those of another one; `None` where its axes have other names, or
/// where they would give it other tool poses.
fn as_they_are(first: &Machine, machine: &Machine, poses: &[Pose], targets: &[ToolPose]) -> Option<Vec<Pose>> {
    let is_same_count = first.axes().len() == machine.axes().len();
    let order = machine.axes().iter().map(|axis| first.axis_index(axis.name.as_str())).collect::<Option<Vec<usize>>>();
    let order = order.filter(|_| is_same_count)?;
    let own: Vec<Pose> = poses.iter().map(|pose| order.iter().map(|axis| pose[*axis]).collect()).collect();
    let is_same = |(pose, target): (&Pose, &ToolPose)| {
        let found = tool_pose(machine, pose);
        let turn = found.spin_rad.zip(target.spin_rad).map_or(0.0, |(a, b)| libm::sin((a - b) / 2.0).abs());
        let off = (found.tip - target.tip).norm().max((found.direction - target.direction).norm()).max(turn);
        off < SAME_TOOL_POSE
    };
    own.par_iter().zip(targets).all(is_same).then_some(own)
}

impl Comparison {
    /// Returns the comparison without what the set-up of the part takes out on each machine.
    pub fn without(
        mut self,
        fields: &[&dyn Field],
        references: &[Option<&PartReference>],
        orders: &[Order],
        conditions: OperatingConditions,
    ) -> Self {
        for (((side, field), reference), order) in self.machines.iter_mut().zip(fields).zip(references).zip(orders) {
            let Some(reference) = reference else { continue };
            let motion = reference.motion_of(*field, *order, conditions);
            side.reached.par_iter_mut().for_each(|(pose, deviation)| {
                *deviation = motion.removed_from(deviation, &tip_at(field.machine(), pose));
            });
            side.statistics = statistics(&side.reached);
        }
        let first = self.machines.first().map(|side| side.statistics);
        for side in &mut self.machines {
            side.difference = side.statistics.minus(&first.unwrap_or(side.statistics));
        }
        self
    }
}

fn statistics(reached: &[(Pose, Deviation)]) -> Statistics {
    Statistics::of(&reached.iter().map(|(_, d)| *d).collect::<Vec<_>>())
}

fn side_by_side(rows: Vec<(ToolPose, ComparisonRow)>, count: usize) -> Comparison {
    let asked = rows.len();
    let why = |m: usize| {
        let failure = |(i, (_, row)): (usize, &(ToolPose, ComparisonRow))| Some((i, row[m].as_ref().err()?.clone()));
        rows.iter().enumerate().filter_map(failure).collect::<Vec<_>>()
    };
    let missed: Vec<Vec<(usize, Miss)>> = (0..count).map(why).collect();
    let need = |m: usize| Needs::of(rows.iter().map(|(_, row)| row[m].as_ref().map(|(pose, _)| pose)));
    let needs: Vec<Needs> = (0..count).map(need).collect();
    let mut common = Vec::new();
    let mut reached = vec![Vec::new(); count];
    for (target, row) in rows {
        if let Ok(row) = row.into_iter().collect::<Result<Vec<_>, _>>() {
            common.push(target);
            reached.iter_mut().zip(row).for_each(|(list, at)| list.push(at));
        }
    }
    let all: Vec<Statistics> = reached.iter().map(|list| statistics(list)).collect();
    let sides = missed.into_iter().zip(needs).zip(reached).zip(&all);
    let sides = sides.map(|(((missed, needs), reached), s)| MachineResult {
        unreachable: UnreachableCount::count(missed.iter().map(|(_, miss)| miss)),
        missed,
        needs,
        path: None,
        reached,
        statistics: *s,
        difference: s.minus(&all[0]),
    });
    Comparison { asked, common, machines: sides.collect() }
}
