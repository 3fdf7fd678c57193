//! Events of a path on a machine: rewinds, pole crossings, and for each axis its motion and its reversals.

use super::steps::{PathPose, Steps};
use crate::analysis::inverse::{CandidateSearch, Miss, ToolPose};
use crate::machine::{Machine, Pose};

/// The tool is at a pole of a rotary axis where it is nearer to the axis's line than this, deg.
pub const POLE_DEG: f64 = 2.0;

/// A pole at an end of the path counts where the axis turns by more, deg.
const END_TURN_DEG: f64 = 10.0;

/// An axis reverses where it then moves back by more, mm or deg.
pub const REVERSAL: f64 = 1e-3;

/// A tip or an axis that moves by less stands, mm or deg.
const STANDING_MM: f64 = 1e-6;

/// A step in which the tool has to leave the path.
#[derive(Debug, Clone, PartialEq)]
pub struct Rewind {
    /// Indices of the rows before and after it.
    pub rows: [usize; 2],
    /// Motions of the rotary axes, by index, deg.
    pub turns: Vec<(usize, f64)>,
}

/// A passage near the line of a rotary axis.
#[derive(Debug, Clone, PartialEq)]
pub struct PoleCrossing {
    /// Index of the rotary axis.
    pub axis: usize,
    /// Indices of the rows before and after it.
    pub rows: [usize; 2],
    /// The row after the step that comes nearest.
    pub nearest_row: usize,
    /// Least angle between the tool and the axis, deg.
    pub nearest_deg: f64,
    /// Angle by which the axis turns meanwhile, deg.
    pub turn_deg: f64,
    /// Largest turn of the axis per motion of the tip, deg/mm; `None` if the tip stands in a step in which it turns.
    pub deg_per_mm: Option<f64>,
}

/// The motion of an axis along a path.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AxisMotion {
    /// Sum of its steps, mm or deg; rewinds among them.
    pub sum: f64,
    /// Its largest step, rewinds apart, mm or deg.
    pub largest: f64,
    /// The row after that step.
    pub largest_row: Option<usize>,
    /// Rows at which it reverses.
    pub reversals: Vec<usize>,
}

/// Events of a path on a machine.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PathEvents {
    /// The rewinds in their order.
    pub rewinds: Vec<Rewind>,
    /// The pole crossings, axis by axis in their order.
    pub poles: Vec<PoleCrossing>,
    /// Axis by axis.
    pub axes: Vec<AxisMotion>,
}

/// Returns the events of a path: tool poses with the poses (mm, deg) that take them; rows that are missed are left out.
pub fn path_events(machine: &Machine, targets: &[ToolPose], found: &[Result<Pose, Miss>]) -> PathEvents {
    let steps = Steps::new(machine, &CandidateSearch::new(machine), false);
    let reached = targets.iter().zip(found).enumerate().filter_map(|(row, (target, pose))| {
        let pose = pose.as_ref().ok()?;
        Some(PathRow { row, target: target.to_unturned(machine), pose, free: steps.free_axis(pose) })
    });
    let rows: Vec<PathRow<'_>> = reached.collect();
    let is_rewind: Vec<bool> = rows.windows(2).map(|pair| !steps.is_continuous(&pair[0].at(), &pair[1].at())).collect();
    let rotary = |axis: &usize| machine.axes()[*axis].kind == crate::machine::AxisKind::Rotary;
    let axes: Vec<usize> = (0..machine.axes().len()).collect();
    let rewind = |(pair, _): (&[PathRow<'_>], &bool)| Rewind {
        rows: [pair[0].row, pair[1].row],
        turns: axes
            .iter()
            .copied()
            .filter(rotary)
            .map(|axis| (axis, pair[1].pose[axis] - pair[0].pose[axis]))
            .collect(),
    };
    PathEvents {
        rewinds: rows.windows(2).zip(&is_rewind).filter(|(_, is_rewind)| **is_rewind).map(rewind).collect(),
        poles: poles(&steps, &rows, &is_rewind),
        axes: axes.iter().map(|axis| motion(*axis, &rows, &is_rewind)).collect(),
    }
}

/// A row that is reached.
struct PathRow<'a> {
    row: usize,
    target: ToolPose,
    pose: &'a Pose,
    free: Option<usize>,
}

impl PathRow<'_> {
    fn at(&self) -> PathPose<'_> {
        PathPose { target: &self.target, pose: self.pose, free: self.free }
    }
}

/// Returns the motion of an axis.
fn motion(axis: usize, rows: &[PathRow<'_>], is_rewind: &[bool]) -> AxisMotion {
    let mut motion = AxisMotion::default();
    let mut turning = rows.first().map(|first| TurningPoint::new(axis, first));
    for (pair, is_rewind) in rows.windows(2).zip(is_rewind) {
        let by = (pair[1].pose[axis] - pair[0].pose[axis]).abs();
        motion.sum += by;
        if *is_rewind {
            turning = Some(TurningPoint::new(axis, &pair[1]));
            continue;
        }
        if by > motion.largest.max(STANDING_MM) {
            (motion.largest, motion.largest_row) = (by, Some(pair[1].row));
        }
        motion.reversals.extend(turning.as_mut().and_then(|turning| turning.pass(&pair[1])));
    }
    motion
}

/// The furthest position of an axis in its present sense.
struct TurningPoint {
    axis: usize,
    sense: f64,
    position: f64,
    row: usize,
}

impl TurningPoint {
    fn new(axis: usize, first: &PathRow<'_>) -> Self {
        Self { axis, sense: 0.0, position: first.pose[axis], row: first.row }
    }

    /// Passes a row; returns the row at which the axis has reversed, once it has.
    fn pass(&mut self, next: &PathRow<'_>) -> Option<usize> {
        let q = next.pose[self.axis];
        let by = q - self.position;
        if self.sense == 0.0 && by.abs() <= REVERSAL {
            return None;
        }
        let is_back = self.sense != 0.0 && by * self.sense < 0.0;
        if is_back && by.abs() <= REVERSAL {
            return None;
        }
        let reversed = is_back.then_some(self.row);
        (self.sense, self.position, self.row) = (if by == 0.0 { self.sense } else { by.signum() }, q, next.row);
        reversed
    }
}

/// Returns the pole crossings of all axes.
fn poles(steps: &Steps<'_>, rows: &[PathRow<'_>], is_rewind: &[bool]) -> Vec<PoleCrossing> {
    let tilts: Vec<Vec<(usize, f64)>> = rows.windows(2).map(|pair| steps.tilts(pair[0].pose, pair[1].pose)).collect();
    let Some(first) = tilts.first() else { return Vec::new() };
    let mut list = Vec::new();
    let always_free = steps.always_free();
    for (k, (axis, _)) in first.iter().enumerate().filter(|(_, (axis, _))| Some(*axis) != always_free) {
        let is_near = |step: usize| !is_rewind[step] && tilts[step][k].1.to_degrees() < POLE_DEG;
        let mut from = 0;
        while from < tilts.len() {
            let to = from + (from..tilts.len()).take_while(|step| is_near(*step)).count();
            if to > from {
                let nearest = (from..to).min_by(|a, b| tilts[*a][k].1.total_cmp(&tilts[*b][k].1)).unwrap_or(from);
                let tilt_rad = tilts[nearest][k].1;
                let crossing = crossing(*axis, &rows[from..=to], NearestStep { step: nearest - from, tilt_rad });
                let is_passed = from > 0 && to < tilts.len();
                let is_all = from == 0 && to == tilts.len();
                if is_passed || (!is_all && crossing.turn_deg > END_TURN_DEG) {
                    list.push(crossing);
                }
            }
            from = to.max(from + 1);
        }
    }
    list
}

/// The step that comes nearest to a pole.
struct NearestStep {
    /// Its index among those near the pole.
    step: usize,
    /// Angle between the tool and the axis, rad.
    tilt_rad: f64,
}

/// Returns the crossing of the rows near a pole.
fn crossing(axis: usize, rows: &[PathRow<'_>], nearest: NearestStep) -> PoleCrossing {
    let turn = |pair: &[PathRow<'_>]| (pair[1].pose[axis] - pair[0].pose[axis]).abs();
    let rate = |pair: &[PathRow<'_>]| {
        let far = (pair[1].target.tip - pair[0].target.tip).norm();
        if turn(pair) <= REVERSAL { Some(0.0) } else { (far > STANDING_MM).then(|| turn(pair) / far) }
    };
    PoleCrossing {
        axis,
        rows: [rows[0].row, rows[rows.len() - 1].row],
        nearest_row: rows[nearest.step + 1].row,
        nearest_deg: nearest.tilt_rad.to_degrees(),
        turn_deg: rows.windows(2).map(turn).sum(),
        deg_per_mm: rows.windows(2).map(rate).try_fold(0.0, |most: f64, rate| Some(most.max(rate?))),
    }
}
