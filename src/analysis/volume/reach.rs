//! The tool poses of a grid that the nominal machine takes: tips over a box of the workpiece frame, each with every
//! direction of a set.

use crate::analysis::inverse::{Miss, ToolPose, inverse_all, rest, rotary_axes_place_tip, tool_pose};
use crate::evaluate::{Poses, Random};
use crate::machine::{AxisKind, Machine, Pose};
use crate::run::{Advance, Cancelled};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Maximum number of linear axes whose ends are combined.
const MAX_LINEAR: usize = 10;

/// Poses of a robot by which its box is found.
const ROBOT_POSES: usize = 2000;

/// Tips at equal distances over a box, ends included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReachGrid {
    /// Ends of the box along x, y, z of the workpiece frame, mm.
    pub region: [[f64; 2]; 3],
    /// Number of tips along x, y, z.
    pub counts: [usize; 3],
}

impl ReachGrid {
    /// Returns a grid over a box (mm), its tips at most `step` (mm, above 0) apart; `None` if their number does not fit
    /// a count.
    pub fn new(region: [[f64; 2]; 3], step: f64) -> Option<Self> {
        let counts = region.map(|[min, max]| libm::ceil((max - min) / step - 1e-9).max(0.0) + 1.0);
        let fits = counts.iter().product::<f64>() < 1e12;
        fits.then(|| Self { region, counts: counts.map(|count| count as usize) })
    }

    /// Returns the box over which the machine carries its tip: with rotary axes at rest and the linear ones over their
    /// travels; for a robot over the travels of all axes, as random poses show it.
    pub fn region_of(machine: &Machine) -> [[f64; 2]; 3] {
        let poses: Vec<Pose> = if rotary_axes_place_tip(machine) {
            let travels = machine.axes().iter().map(|axis| axis.travel.interval()).collect();
            Poses::Random(Random::new(travels, ROBOT_POSES, 0)).iter().collect()
        } else {
            ends(machine)
        };
        let tips: Vec<Vector3<f64>> = poses.iter().map(|pose| tool_pose(machine, pose).tip).collect();
        std::array::from_fn(|k| {
            let (min, max) = tips
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), tip| (min.min(tip[k]), max.max(tip[k])));
            [min + 0.0, max + 0.0]
        })
    }

    /// Returns the number of tips.
    pub fn len(&self) -> usize {
        self.counts.iter().product()
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the tip with an index below [`Self::len`], x running fastest, mm.
    pub fn tip(&self, index: usize) -> Vector3<f64> {
        let [x, y, _] = self.counts;
        let steps = [index % x, index / x % y, index / (x * y)];
        Vector3::from_fn(|k, _| self.position(k, steps[k]))
    }

    /// Returns the place of a step along x, y or z (0, 1, 2), mm.
    pub fn position(&self, side: usize, step: usize) -> f64 {
        let [min, max] = self.region[side];
        let last = self.counts[side] - 1;
        match step {
            0 => min,
            step if step == last => max,
            step => min + (max - min) * (step as f64 / last as f64),
        }
    }
}

/// Returns the poses at all ends of the linear axes, rotary axes at rest.
fn ends(machine: &Machine) -> Vec<Pose> {
    let linear = (0..machine.axes().len()).filter(|axis| machine.axes()[*axis].kind == AxisKind::Linear);
    linear.take(MAX_LINEAR).fold(vec![rest(machine)], |poses, axis| {
        let (min, max) = machine.axes()[axis].travel.interval();
        let at = |pose: &Pose, position: f64| {
            let mut pose = pose.clone();
            pose[axis] = position;
            pose
        };
        poses.iter().flat_map(|pose| [at(pose, min), at(pose, max)]).collect()
    })
}

/// Returns what `sum` makes of the poses of the nominal machine, or of what it lacks, at each tip of a grid in the
/// directions (unit vectors, workpiece frame): in the order of the tips, the same on any number of threads. Calls
/// `progress` with the number of tips done since its last call.
pub fn reach<T: Send>(
    machine: &Machine,
    grid: &ReachGrid,
    directions: &[Vector3<f64>],
    sum: &(dyn Fn(Vec<Result<Pose, Miss>>) -> T + Sync),
    progress: Advance<'_>,
) -> Result<Vec<T>, Cancelled> {
    let one = |index: usize| {
        let tip = grid.tip(index);
        let targets: Vec<ToolPose> = directions.iter().map(|direction| ToolPose::new(tip, *direction)).collect();
        let summed = sum(inverse_all(machine, &targets));
        progress(1)?;
        Ok(summed)
    };
    (0..grid.len()).into_par_iter().map(one).collect()
}
