//! The budget of all arrangements of a walk at once. Where the bed stands does not change the nominal
//! machine, only the side of its motion on which each axis errs. So the deviation by every joint is computed once
//! for either side, and an arrangement is a sum of table-side joints before the bed and tool-side ones
//! after it, always added up in the same order.

use super::side_draws::SideDraws;
use crate::analysis::design::budget::{
    CurvePoint, DrawnSource, JointBounds, SAMPLE_LANES, SampleLanes, SourceEffects, Statistic, columns, remove_motion,
    squares,
};
use crate::analysis::reference::{PartReference, ReferencePoint, tip_at};
use crate::lower::{Quantity, SideWeights, twists};
use crate::machine::{Axis, Branch, Machine, Pose};
use nalgebra::Vector3;
use std::ops::Range;

/// A joint at a pose: effects of its errors on the tool side and on the table side.
struct JointMaps {
    /// Index among the drawn joints.
    drawn: usize,
    point: [CurvePoint; 2],
    location: [SourceEffects; 2],
    component: [SourceEffects; 2],
    /// True if a location error acts the same on either side.
    alike: bool,
}

struct PoseMaps {
    joints: Vec<JointMaps>,
    spindle: SourceEffects,
}

/// Samples over which a round is computed, of all that are drawn.
#[derive(Debug, Clone)]
pub struct Round<'a> {
    /// All that are drawn.
    pub drawn: &'a SideDraws,
    /// Those of the round.
    pub samples: Range<usize>,
}

impl Round<'_> {
    fn chunks(&self) -> Range<usize> {
        self.samples.start / SAMPLE_LANES..self.samples.end.div_ceil(SAMPLE_LANES)
    }
}

/// Arrangements of one walk at their poses for the work.
#[derive(Debug, Clone, Copy)]
pub struct WalkPoses<'a> {
    /// The nominal machine.
    pub machine: &'a Machine,
    /// Indices of the walk's axes among the drawn joints; the last joint is the spindle.
    pub axes: &'a [usize],
    /// Numbers of axes on the table, one for each arrangement.
    pub tables: &'a [usize],
    /// The poses (mm, deg).
    pub poses: &'a [Pose],
    /// Motions that set-ups of the part take out, each by itself; `None` is nothing.
    pub references: &'a [Option<PartReference>],
}

/// Returns the statistic over the poses, mm, for every reference, arrangement and sample of the round.
pub fn statistics(walk: WalkPoses<'_>, round: &Round<'_>, statistic: Statistic) -> Vec<Vec<Vec<f64>>> {
    let maps = WalkMaps::new(walk, round.drawn);
    let empty = Vec::with_capacity(round.chunks().len() * SAMPLE_LANES);
    let mut rows = vec![vec![empty; walk.tables.len()]; walk.references.len()];
    for chunk in round.chunks() {
        let lengths = maps.squared_lengths(chunk);
        for (row, lanes) in rows.iter_mut().flatten().zip(lengths.iter().flatten()) {
            row.extend(over_poses(statistic, lanes));
        }
    }
    let before = round.samples.start % SAMPLE_LANES;
    rows.iter_mut().flatten().for_each(|row| {
        let _ = row.drain(..before);
        row.truncate(round.samples.len());
    });
    rows
}

/// Returns the squared lengths (mm^2) of the first arrangement with the first reference, chunk by chunk and pose by
/// pose.
pub fn squared_lengths(walk: WalkPoses<'_>, drawn: &SideDraws) -> Vec<Vec<SampleLanes>> {
    let maps = WalkMaps::new(walk, drawn);
    let first = |of: Vec<Vec<Vec<SampleLanes>>>| of.into_iter().flatten().next().unwrap_or_default();
    (0..drawn.chunks()).map(|chunk| first(maps.squared_lengths(chunk))).collect()
}

/// The effects of drawn errors at the poses of a walk, and at the points of its references.
struct WalkMaps<'a> {
    walk: WalkPoses<'a>,
    drawn: &'a SideDraws,
    poses: Vec<PoseMaps>,
    tips: Vec<Vector3<f64>>,
    /// Of each reference its points; those of a best fit are the poses.
    points: Vec<Vec<PoseMaps>>,
}

impl<'a> WalkMaps<'a> {
    fn new(walk: WalkPoses<'a>, drawn: &'a SideDraws) -> Self {
        let at = |pose: &Pose| maps(walk.machine, walk.axes, pose, drawn);
        let own = |points: &[ReferencePoint]| !points.iter().map(|point| &point.pose).eq(walk.poses);
        let points = |of: &Option<PartReference>| match of.as_ref().map(PartReference::points) {
            Some(points) if own(points) => points.iter().map(|point| at(&point.pose)).collect(),
            _ => Vec::new(),
        };
        let is_set_up = walk.references.iter().any(Option::is_some);
        let tips = walk.poses.iter().filter(|_| is_set_up).map(|pose| tip_at(walk.machine, pose)).collect();
        let points = walk.references.iter().map(points).collect();
        Self { walk, drawn, poses: walk.poses.iter().map(at).collect(), tips, points }
    }

    /// Returns the deviations of every arrangement.
    fn deviations(&self, of: &PoseMaps, chunk: usize) -> Vec<Deviations> {
        let all = of.deviations(chunk, self.drawn);
        self.walk.tables.iter().map(|table| all[*table]).collect()
    }

    /// Returns squared lengths (mm^2) by reference, arrangement and pose.
    fn squared_lengths(&self, chunk: usize) -> Vec<Vec<Vec<SampleLanes>>> {
        let at_poses: Vec<Vec<Deviations>> = self.poses.iter().map(|pose| self.deviations(pose, chunk)).collect();
        let arrangements = 0..self.walk.tables.len();
        let of = |(reference, points): (&Option<PartReference>, &Vec<PoseMaps>)| {
            let own: Vec<Vec<Deviations>> = points.iter().map(|point| self.deviations(point, chunk)).collect();
            let at_points = if own.is_empty() { &at_poses } else { &own };
            let lengths = |i: usize| match reference {
                None => at_poses.iter().map(|all| squares(&all[i])).collect(),
                Some(reference) => {
                    let motion = motion(reference, at_points.iter().map(|all| &all[i]));
                    let left = |(all, tip): (&Vec<Deviations>, &Vector3<f64>)| {
                        let mut left = all[i];
                        remove_motion(&motion, tip, &mut left);
                        squares(&left)
                    };
                    at_poses.iter().zip(&self.tips).map(left).collect()
                }
            };
            arrangements.clone().map(lengths).collect()
        };
        self.walk.references.iter().zip(&self.points).map(of).collect()
    }
}

/// Returns the motion of every sample that a reference takes out, by deviations at its points.
fn motion<'a>(reference: &PartReference, at_points: impl Iterator<Item = &'a Deviations>) -> [SampleLanes; 6] {
    let mut motion = [[0.0; SAMPLE_LANES]; 6];
    for (point, deviations) in reference.points().iter().zip(at_points) {
        for (i, sum) in motion.iter_mut().enumerate() {
            for (k, lanes) in deviations.iter().enumerate() {
                let gain = point.gain[(i, k)];
                sum.iter_mut().zip(lanes).for_each(|(sum, d)| *sum += gain * d);
            }
        }
    }
    motion
}

/// Returns the statistic of lengths over the poses, for every lane.
pub fn over_poses(statistic: Statistic, squares: &[SampleLanes]) -> SampleLanes {
    let mut column = vec![0.0; squares.len()];
    std::array::from_fn(|lane| {
        column.iter_mut().zip(squares).for_each(|(x, lanes)| *x = lanes[lane]);
        statistic.of(&mut column).sqrt()
    })
}

fn maps(machine: &Machine, axes: &[usize], pose: &[f64], drawn: &SideDraws) -> PoseMaps {
    let twists = twists(machine, pose, Quantity::Position);
    let conventions = machine.conventions();
    let joint = |(i, axis): (usize, &Axis)| {
        let side = |branch| Axis { branch, ..axis.clone() };
        let sides = [side(Branch::Tool), side(Branch::Workpiece)];
        let location = sides.each_ref().map(|axis| SideWeights::location(axis, conventions));
        let component = sides.each_ref().map(|axis| SideWeights::component(axis, conventions));
        let bounds = Branch::BOTH.map(|branch| drawn.bounds(axes[i], branch));
        let of = |weights: [SideWeights; 2], sources: fn(&JointBounds) -> &[DrawnSource]| {
            [0, 1].map(|side| columns(&weights[side].map(&twists[i]), sources(bounds[side])))
        };
        JointMaps {
            drawn: axes[i],
            point: bounds.map(|bounds| bounds.curve_point(pose[i])),
            alike: location[0] == location[1] && !drawn.differs(),
            location: of(location, |bounds| &bounds.location),
            component: of(component, |bounds| &bounds.component),
        }
    };
    let joints: Vec<JointMaps> = machine.axes().iter().enumerate().map(joint).collect();
    let spindle = &drawn.bounds(drawn.spindle(), Branch::Tool).location;
    PoseMaps { spindle: columns(&SideWeights::SPINDLE.map(&twists[joints.len()]), spindle), joints }
}

type Deviations = [SampleLanes; 3];

const NONE: Deviations = [[0.0; SAMPLE_LANES]; 3];

impl PoseMaps {
    /// Returns the deviations with 0, 1, ... all axes on the table.
    fn deviations(&self, chunk: usize, drawn: &SideDraws) -> Vec<Deviations> {
        let sides: Vec<[Deviations; 2]> = self.joints.iter().map(|joint| joint.deviations(chunk, drawn)).collect();
        let mut last = NONE;
        let spindle = drawn.spindle();
        drawn.chunk(chunk, spindle, Branch::Tool).add_location(spindle, &self.spindle, &mut last);
        // Tool-side joints are added up from the tool, table-side ones from the workpiece.
        let mut all = vec![last];
        for [tool, _] in sides.iter().rev() {
            let sum = sum(&all[all.len() - 1], tool);
            all.push(sum);
        }
        all.reverse();
        let mut table_side = NONE;
        for (i, [_, table]) in sides.iter().enumerate() {
            table_side = sum(&table_side, table);
            all[i + 1] = sum(&all[i + 1], &table_side);
        }
        all
    }
}

impl JointMaps {
    /// Returns the deviations on the tool side, and on the table side.
    fn deviations(&self, chunk: usize, drawn: &SideDraws) -> [Deviations; 2] {
        let mut sides = [NONE; 2];
        let of = Branch::BOTH.map(|branch| drawn.chunk(chunk, self.drawn, branch));
        of[0].add_location(self.drawn, &self.location[0], &mut sides[0]);
        if self.alike {
            sides[1] = sides[0];
        } else {
            of[1].add_location(self.drawn, &self.location[1], &mut sides[1]);
        }
        for i in 0..2 {
            of[i].add_component(self.drawn, self.point[i], &self.component[i], &mut sides[i]);
        }
        sides
    }
}

fn sum(a: &Deviations, b: &Deviations) -> Deviations {
    std::array::from_fn(|i| std::array::from_fn(|lane| a[i][lane] + b[i][lane]))
}
