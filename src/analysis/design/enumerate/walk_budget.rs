//! The budget of all arrangements of a walk at once. Where the bed stands does not change the nominal
//! machine, only the side of its motion on which each axis errs. So the deviation by every joint is computed once
//! for either side, and an arrangement is a sum of table-side joints before the bed and tool-side ones
//! after it, always added up in the same order.

use super::side_draws::SideDraws;
use crate::analysis::design::budget::{
    CurvePoint, DrawnSource, JointBounds, SAMPLE_LANES, SampleLanes, SourceEffects, Statistic, add, columns, squares,
};
use crate::lower::{Quantity, SideWeights, twists};
use crate::machine::{Axis, Branch, Machine, Pose};
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

/// Returns the statistic over the poses, mm, for every arrangement (rows, as `tables` lists them) and sample of the
/// round. `axes` are the indices of the walk's axes among the drawn joints; the last joint is the spindle.
pub fn statistics(
    machine: &Machine,
    axes: &[usize],
    tables: &[usize],
    poses: &[Pose],
    round: &Round<'_>,
    statistic: Statistic,
) -> Vec<Vec<f64>> {
    let drawn = round.drawn;
    let pose_maps: Vec<PoseMaps> = poses.iter().map(|pose| maps(machine, axes, pose, drawn)).collect();
    let mut rows = vec![Vec::with_capacity(round.chunks().len() * SAMPLE_LANES); tables.len()];
    let mut lengths: Vec<Vec<SampleLanes>> = vec![Vec::with_capacity(poses.len()); tables.len()];
    for chunk in round.chunks() {
        lengths.iter_mut().for_each(Vec::clear);
        for maps in &pose_maps {
            let deviations = maps.deviations(chunk, drawn);
            lengths.iter_mut().zip(tables).for_each(|(list, table)| list.push(squares(&deviations[*table])));
        }
        rows.iter_mut().zip(&lengths).for_each(|(row, lanes)| row.extend(over_poses(statistic, lanes)));
    }
    let before = round.samples.start % SAMPLE_LANES;
    rows.iter_mut().for_each(|row| {
        let _ = row.drain(..before);
        row.truncate(round.samples.len());
    });
    rows
}

/// Returns the squared lengths (mm^2) of one arrangement, chunk by chunk and pose by pose.
pub fn squared_lengths(
    machine: &Machine,
    axes: &[usize],
    table: usize,
    poses: &[Pose],
    drawn: &SideDraws,
) -> Vec<Vec<SampleLanes>> {
    let pose_maps: Vec<PoseMaps> = poses.iter().map(|pose| maps(machine, axes, pose, drawn)).collect();
    let at = |maps: &PoseMaps, chunk: usize| squares(&maps.deviations(chunk, drawn)[table]);
    (0..drawn.chunks()).map(|chunk| pose_maps.iter().map(|maps| at(maps, chunk)).collect()).collect()
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
        add(&self.spindle, drawn.chunk(chunk, spindle, Branch::Tool).location(spindle), &mut last);
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
        add(&self.location[0], of[0].location(self.drawn), &mut sides[0]);
        if self.alike {
            sides[1] = sides[0];
        } else {
            add(&self.location[1], of[1].location(self.drawn), &mut sides[1]);
        }
        for i in 0..2 {
            add(&self.component[i], &of[i].component(self.drawn, self.point[i]), &mut sides[i]);
        }
        sides
    }
}

fn sum(a: &Deviations, b: &Deviations) -> Deviations {
    std::array::from_fn(|i| std::array::from_fn(|lane| a[i][lane] + b[i][lane]))
}
