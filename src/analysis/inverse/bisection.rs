//! Reach by bisection of the travels of the rotary axes, with a bound: a box of rotary positions holds no pose for a
//! tool pose if at its middle the direction is further off, or the place further from what the linear axes span, than
//! the axes can bring it within the box.
//!
//! Turning an axis by an angle moves a direction by no more than this angle times the sine between the two, and a point
//! by no more than this angle times its distance from the line of the axis. The distance counts on the side of the
//! tool or on that of the workpiece, whichever is less: links and travels between, put in line.

use super::linear::{LinearSlide, slides};
use super::rotary::RotaryDirections;
use super::tool_pose::{DIRECTION_TOLERANCE, PLACE_TOLERANCE, ToolPose, unturned_tool_pose};
use crate::machine::{Axis, AxisKind, Machine, Pose, Travel};
use nalgebra::Vector3;
use std::collections::VecDeque;

/// Number of boxes that are looked at for a tool pose.
const BOXES: usize = 4000;

/// Boxes no wider than this (rad to either side) also give a pose to try.
const TRIED_RAD: f64 = 0.1;

/// Part by which bounds are widened for rounding.
const ROUNDING: f64 = 1e-9;

/// Result of a bisection.
pub struct Bisection {
    /// Poses (mm, deg) worth trying: their rotary axes are near to a solution, in the order of the boxes.
    pub near: Vec<Pose>,
    /// True if no box was left: the tool pose is out of reach, whatever the poses.
    pub is_out_of_reach: bool,
}

/// A rotary axis with what bounds its effect.
struct BoundedTurn {
    axis: usize,
    /// Largest sine between the axis and the direction that it turns.
    sine: f64,
    /// Largest distance of the place from the line of the axis, mm.
    distance: f64,
}

/// Rotary positions (deg) with as much to either side (rad), axis by axis.
struct Cell {
    middle: Vec<f64>,
    half: Vec<f64>,
}

/// Returns what a bisection comes to for a tool pose (unturned workpiece frame); linear axes of `reference` (mm, deg)
/// are within their travel.
pub fn bisect(machine: &Machine, directions: &RotaryDirections, target: &ToolPose, reference: &[f64]) -> Bisection {
    let turns = bounded_turns(machine, directions, target);
    let mut cells = VecDeque::from([whole(machine, &turns)]);
    let mut bisection = Bisection { near: Vec::new(), is_out_of_reach: true };
    let mut pose = reference.to_vec();
    for _ in 0..BOXES {
        let Some(cell) = cells.pop_front() else { return bisection };
        turns.iter().zip(&cell.middle).for_each(|(turn, q)| pose[turn.axis] = *q);
        let widths = turns.iter().zip(&cell.half);
        let turned: f64 = widths.clone().map(|(turn, half)| turn.sine * half).sum();
        let direction = directions.direction(&pose);
        let off_rad = libm::atan2(direction.cross(&target.direction).norm(), direction.dot(&target.direction));
        if off_rad > turned * (1.0 + ROUNDING) + DIRECTION_TOLERANCE {
            continue;
        }
        let moved: f64 = widths.map(|(turn, half)| turn.distance * half).sum();
        if off_mm(machine, target, &pose, reference) > moved * (1.0 + ROUNDING) + PLACE_TOLERANCE {
            continue;
        }
        if cell.half.iter().all(|half| *half <= TRIED_RAD) {
            bisection.near.push(pose.clone());
        }
        cells.extend(cell.halves());
    }
    bisection.is_out_of_reach = cells.is_empty();
    bisection
}

impl Cell {
    /// Returns the halves along the widest side; none of a machine without rotary axes.
    fn halves(self) -> Vec<Self> {
        let widest = (0..self.half.len()).max_by(|a, b| self.half[*a].total_cmp(&self.half[*b]));
        let Some(side) = widest else { return Vec::new() };
        let half = self.half[side] / 2.0;
        let at = |by: f64| {
            let mut cell = Self { middle: self.middle.clone(), half: self.half.clone() };
            cell.middle[side] += by.to_degrees();
            cell.half[side] = half;
            cell
        };
        vec![at(-half), at(half)]
    }
}

/// Returns the cell of all positions, but for whole turns.
fn whole(machine: &Machine, turns: &[BoundedTurn]) -> Cell {
    let ends = |turn: &BoundedTurn| match machine.axes()[turn.axis].travel {
        Travel::Range(min, max) => (min, max.min(min + 360.0)),
        Travel::Continuous => (-180.0, 180.0),
    };
    let (middle, half) = turns.iter().map(ends).map(|(a, b)| ((a + b) / 2.0, ((b - a) / 2.0).to_radians())).unzip();
    Cell { middle, half }
}

fn bounded_turns(machine: &Machine, directions: &RotaryDirections, target: &ToolPose) -> Vec<BoundedTurn> {
    let axes = machine.axes();
    let lines = directions.turned_axes(&vec![0.0; axes.len()]);
    let place = |axis: usize| Vector3::from(axes[axis].origin);
    let (workpiece, tip) = (Vector3::from(machine.workpiece()), Vector3::from(machine.tool().tip));
    let bounded = |(k, (axis, w)): (usize, &(usize, Vector3<f64>))| {
        let beside = |direction: &Vector3<f64>| w.cross(direction).norm();
        // The outermost axes turn a direction that is known.
        let of_workpiece = if k == 0 { beside(&target.direction) } else { 1.0 };
        let of_tool = if k + 1 == lines.len() { beside(&machine.tool().direction.into()) } else { 1.0 };
        let to_tool: Vec<_> = lines[k..].iter().map(|(axis, _)| place(*axis)).chain([tip]).collect();
        let to_workpiece: Vec<_> = [workpiece].into_iter().chain(lines[..=k].iter().map(|(a, _)| place(*a))).collect();
        let tool_side = length(&to_tool) + travels(&axes[*axis..]);
        let workpiece_side = target.tip.norm() + length(&to_workpiece) + travels(&axes[..*axis]);
        BoundedTurn { axis: *axis, sine: of_workpiece.min(of_tool), distance: tool_side.min(workpiece_side) }
    };
    lines.iter().enumerate().map(bounded).collect()
}

/// Returns the length of a polygon of points, mm.
fn length(points: &[Vector3<f64>]) -> f64 {
    points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
}

/// Returns the sum of the largest positions of the linear axes among these, mm.
fn travels(axes: &[Axis]) -> f64 {
    let largest = |axis: &Axis| match axis.travel {
        Travel::Range(min, max) => min.abs().max(max.abs()),
        Travel::Continuous => f64::INFINITY,
    };
    axes.iter().filter(|axis| axis.kind == AxisKind::Linear).map(largest).sum()
}

/// Returns a lower bound (mm) of the distance between a place and those that the linear axes bring the tip to, with
/// the rotary axes as in the pose: the largest distance across a face of what the travels span.
fn off_mm(machine: &Machine, target: &ToolPose, pose: &[f64], reference: &[f64]) -> f64 {
    let mut still = pose.to_vec();
    let slides = slides(machine.axes(), pose, reference);
    slides.iter().for_each(|slide| still[slide.axis] = reference[slide.axis]);
    let way = target.tip - unturned_tool_pose(machine, &still).tip;
    let across = |normal: Vector3<f64>| {
        let width = |sum: (f64, f64), slide: &LinearSlide| {
            let part = slide.direction.dot(&normal);
            // Parts of rounding do not make an endless axis reach across.
            let [a, b] = if part.abs() < ROUNDING { [0.0; 2] } else { [part * slide.range.0, part * slide.range.1] };
            (sum.0 + a.min(b), sum.1 + a.max(b))
        };
        let (low, high) = slides.iter().fold((0.0, 0.0), width);
        let at = way.dot(&normal);
        (low - at).max(at - high)
    };
    let mut off = 0.0_f64;
    for (i, a) in slides.iter().enumerate() {
        for b in &slides[i + 1..] {
            let Some(normal) = a.direction.cross(&b.direction).try_normalize(1e-6) else { continue };
            off = off.max(across(normal));
            if slides.len() == 2 {
                off = off.max(across(normal.cross(&a.direction))).max(across(normal.cross(&b.direction)));
            }
        }
    }
    off
}
