//! The drawn errors of every joint on either side of the bed: bounds and travels may depend on the side.

use crate::analysis::design::budget::{Bound, Draws, JointBounds, SAMPLE_LANES, SampleChunk, by_joint, on_other_sides};
use crate::machine::{Branch, Machine};
use rayon::prelude::*;

/// Draws of the joints on one side.
#[derive(Debug, Default)]
struct Drawn {
    joints: Vec<JointBounds>,
    chunks: Vec<SampleChunk>,
}

/// The drawn errors of the joints of a machine: its axes in their order, then the spindle.
#[derive(Debug, Default)]
pub struct SideDraws {
    /// On the sides on which the axes stand in the machine's file.
    own: Drawn,
    /// On the other sides, if anything that is drawn differs there.
    other: Option<Drawn>,
    own_sides: Vec<Branch>,
}

impl SideDraws {
    /// Draws the errors of so many samples.
    pub fn new(machine: &Machine, bounds: &[Bound], draws: &Draws, samples: usize) -> Self {
        let own = by_joint(machine, bounds);
        let other_bounds = on_other_sides(machine, bounds);
        let mut other = by_joint(machine, &other_bounds);
        for (joint, axis) in other.iter_mut().zip(machine.axes()) {
            if let Some(geometry) = machine.geometry().axes.get(&axis.name) {
                joint.travel(geometry.on(axis.branch.opposite()).travel);
            }
        }
        let differs = other != own || other_bounds != bounds;
        let drawn = |joints: Vec<JointBounds>, bounds: &[Bound]| {
            let chunk = |i: usize| SampleChunk::new(&joints, bounds, draws, i * SAMPLE_LANES);
            let chunks = (0..samples.div_ceil(SAMPLE_LANES)).into_par_iter().map(chunk).collect();
            Drawn { chunks, joints }
        };
        Self {
            own: drawn(own, bounds),
            other: differs.then(|| drawn(other, &other_bounds)),
            own_sides: machine.axes().iter().map(|axis| axis.branch).collect(),
        }
    }

    fn on(&self, joint: usize, branch: Branch) -> &Drawn {
        let own = self.own_sides.get(joint).is_none_or(|side| *side == branch);
        if own { &self.own } else { self.other.as_ref().unwrap_or(&self.own) }
    }

    /// The bounds of a joint on a side.
    pub fn bounds(&self, joint: usize, branch: Branch) -> &JointBounds {
        &self.on(joint, branch).joints[joint]
    }

    /// A chunk of samples, as the errors of a joint on a side are drawn.
    pub fn chunk(&self, chunk: usize, joint: usize, branch: Branch) -> &SampleChunk {
        &self.on(joint, branch).chunks[chunk]
    }

    /// True if anything that is drawn depends on the side.
    pub fn differs(&self) -> bool {
        self.other.is_some()
    }

    /// Index of the spindle among the joints.
    pub fn spindle(&self) -> usize {
        self.own.joints.len() - 1
    }

    /// Number of chunks.
    pub fn chunks(&self) -> usize {
        self.own.chunks.len()
    }
}
