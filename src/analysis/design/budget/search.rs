//! The search for the worst pose of a volume.
//!
//! A deviation by an error at its bound is affine in the position of every linear axis, so that worst case and RSS are
//! convex there: they are largest at an end. Along rotary axes they rise and fall: a grid with all ends of the linear
//! axes gives the starts, and each start climbs along one rotary axis after the other.

use crate::machine::{Axis, AxisKind, Grid, Machine, Pose};
use rayon::prelude::*;

/// Maximum number of poses of the grid.
const MAX_NODES: f64 = 1024.0;
/// Maximum number of linear axes of which all ends are visited.
const MAX_LINEAR: usize = 8;
/// Largest number of nodes of a rotary axis: every 15 deg of a turn.
const MAX_TURN_NODES: usize = 25;
const STARTS: usize = 16;
/// Maximum number of rounds over the rotary axes.
const ROUNDS: usize = 8;
/// A round that gains less than this fraction is the last.
const GAIN: f64 = 1e-7;
/// Number of sections of a line: 72 deg shrink to a tenth of a degree.
const SECTIONS: usize = 14;
/// Values this close, relatively, are equal: rounding must not choose between places that are alike.
const EQUAL: f64 = 1e-11;

/// True if a value is larger by more than rounding.
pub fn exceeds(a: f64, b: f64) -> bool {
    a > b + EQUAL * b.abs()
}

/// Errors at their bounds at a pose.
pub type BoundVectors<'a> = &'a (dyn Fn(&[f64]) -> Vec<[f64; 3]> + Sync);

/// The quantity that is maximised.
#[derive(Clone, Copy)]
pub struct Objective<'a> {
    /// The value.
    pub value: &'a (dyn Fn(&[[f64; 3]]) -> f64 + Sync),
    /// A bound of it that is quick to compute and chooses the starts.
    pub bound: &'a (dyn Fn(&[[f64; 3]]) -> f64 + Sync),
}

/// The axes of a volume.
pub struct VolumeSearch<'a> {
    axes: Vec<TravelLine>,
    at: BoundVectors<'a>,
    objective: Objective<'a>,
}

#[derive(Debug, Clone, Copy)]
struct TravelLine {
    min: f64,
    max: f64,
    turns: bool,
    /// Both ends are one place.
    closed: bool,
    /// Distance of two nodes of a rotary axis.
    step: f64,
    nodes: usize,
}

/// True if the ends of the volume of an axis are one place.
pub fn is_closed(axis: &Axis, grid: &Grid) -> bool {
    axis.kind == AxisKind::Rotary && grid.max - grid.min >= 360.0
}

impl<'a> VolumeSearch<'a> {
    /// A search over the volume of a machine.
    pub fn new(machine: &Machine, at: BoundVectors<'a>, objective: Objective<'a>) -> Self {
        let pairs = || machine.axes().iter().zip(machine.volume()).filter(|(_, grid)| grid.max > grid.min);
        let of = |kind: AxisKind| pairs().filter(|(axis, _)| axis.kind == kind).count();
        let (linear, rotary) = (of(AxisKind::Linear), of(AxisKind::Rotary));
        let corners = if linear > MAX_LINEAR { 1.0 } else { (1_u32 << linear) as f64 };
        let each = libm::pow(MAX_NODES / corners, 1.0 / rotary.max(1) as f64);
        let nodes = (libm::floor(each) as usize).clamp(3, MAX_TURN_NODES);
        let line = |(axis, grid): (&Axis, &Grid)| {
            let turns = axis.kind == AxisKind::Rotary && grid.max > grid.min;
            let nodes = match (turns, grid.max > grid.min && linear <= MAX_LINEAR) {
                (true, _) => nodes,
                (false, true) => 2,
                (false, false) => 1,
            };
            let step = (grid.max - grid.min) / (nodes.max(2) - 1) as f64;
            TravelLine { min: grid.min, max: grid.max, turns, closed: is_closed(axis, grid), step, nodes }
        };
        Self { axes: machine.axes().iter().zip(machine.volume()).map(line).collect(), at, objective }
    }

    /// Returns the worst pose, its errors and its value; `known` is a pose that it is at least as bad as.
    pub fn worst(&self, known: &[f64]) -> (Pose, Vec<[f64; 3]>, f64) {
        let count: usize = self.axes.iter().map(|line| line.nodes).product();
        let node = |mut k: usize| -> Pose {
            let along = self.axes.iter().map(|line| {
                let i = k % line.nodes;
                k /= line.nodes;
                if i + 1 == line.nodes && i > 0 { line.max } else { line.min + i as f64 * line.step }
            });
            along.collect()
        };
        let bounds: Vec<f64> =
            (0..count).into_par_iter().map(|k| (self.objective.bound)(&(self.at)(&node(k)))).collect();
        // In single precision, where rounding does not order places that are alike.
        let single = |k: usize| bounds[k] as f32;
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|a, b| single(*b).total_cmp(&single(*a)).then(a.cmp(b)));
        let mut starts: Vec<Pose> = vec![known.to_vec()];
        for k in order {
            let pose = node(k);
            if starts.len() > STARTS {
                break;
            }
            if !starts.iter().any(|start| self.near(start, &pose)) {
                starts.push(pose);
            }
        }
        let climbed: Vec<(Pose, f64)> = starts.into_par_iter().map(|start| self.climb(start)).collect();
        let best = (0..climbed.len()).fold(0, |best, i| if exceeds(climbed[i].1, climbed[best].1) { i } else { best });
        let (pose, value) = climbed[best].clone();
        let vectors = (self.at)(&pose);
        (pose, vectors, value)
    }

    fn value(&self, pose: &[f64]) -> f64 {
        (self.objective.value)(&(self.at)(pose))
    }

    /// True for poses that climb to the same place.
    fn near(&self, a: &[f64], b: &[f64]) -> bool {
        self.axes.iter().zip(a.iter().zip(b)).all(|(line, (a, b))| {
            let apart = (a - b).abs();
            let apart = if line.closed { apart.min((line.max - line.min - apart).abs()) } else { apart };
            if line.turns { apart <= 1.5 * line.step } else { apart == 0.0 }
        })
    }

    fn climb(&self, mut pose: Pose) -> (Pose, f64) {
        let mut best = self.value(&pose);
        for _ in 0..ROUNDS {
            let before = best;
            for (axis, line) in self.axes.iter().enumerate() {
                if line.turns {
                    self.along(axis, line, &mut pose, &mut best);
                } else if line.max > line.min {
                    for end in [line.min, line.max] {
                        self.offer(axis, end, &mut pose, &mut best);
                    }
                }
            }
            if best <= before * (1.0 + GAIN) {
                break;
            }
        }
        (pose, best)
    }

    /// Takes a position if it is worse; returns its value.
    fn offer(&self, axis: usize, position: f64, pose: &mut Pose, best: &mut f64) -> f64 {
        let old = std::mem::replace(&mut pose[axis], position);
        let value = self.value(pose);
        if exceeds(value, *best) {
            *best = value;
        } else {
            pose[axis] = old;
        }
        value
    }

    /// Golden sections around the position of a rotary axis.
    fn along(&self, axis: usize, line: &TravelLine, pose: &mut Pose, best: &mut f64) {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let middle = pose[axis];
        let inside = |q: f64| match line.closed {
            true => line.min + (q - line.min).rem_euclid(360.0),
            false => q.clamp(line.min, line.max),
        };
        let (mut low, mut high) = (middle - line.step, middle + line.step);
        if !line.closed {
            (low, high) = (low.max(line.min), high.min(line.max));
            for end in [low, high] {
                self.offer(axis, end, pose, best);
            }
        }
        let (mut a, mut b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        let mut values = [a, b].map(|q| self.offer(axis, inside(q), pose, best));
        for _ in 0..SECTIONS {
            if exceeds(values[0], values[1]) {
                (high, b, values[1]) = (b, a, values[0]);
                a = high - GOLDEN * (high - low);
                values[0] = self.offer(axis, inside(a), pose, best);
            } else {
                (low, a, values[0]) = (a, b, values[1]);
                b = low + GOLDEN * (high - low);
                values[1] = self.offer(axis, inside(b), pose, best);
            }
        }
    }
}
