//! The work that machines are given: poses of the tool in the workpiece frame.

use crate::analysis::inverse::{ToolPose, tool_pose};
use crate::evaluate::{Poses, Random};
use crate::machine::Machine;

/// Tool poses, made by index or listed.
#[derive(Debug, Clone, PartialEq)]
pub enum Work {
    /// Those that the nominal machine takes at these poses.
    OfPoses(Poses),
    /// As listed.
    Listed(Vec<ToolPose>),
}

impl Work {
    /// So many at random poses over a machine's volume.
    pub fn random(machine: &Machine, count: usize, seed: u64) -> Self {
        Self::OfPoses(Poses::Random(Random::of(machine, count, seed)))
    }

    /// How many.
    pub fn len(&self) -> usize {
        match self {
            Self::OfPoses(poses) => poses.len(),
            Self::Listed(list) => list.len(),
        }
    }

    /// None at all?
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The one with this index, which is less than the number; `machine` is the one that takes them.
    pub fn get(&self, machine: &Machine, index: usize) -> ToolPose {
        match self {
            Self::OfPoses(poses) => tool_pose(machine, &poses.get(index)),
            Self::Listed(list) => list[index],
        }
    }
}
