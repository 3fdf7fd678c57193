//! The work on which machines are compared: poses of the tool in the workpiece frame.

use crate::analysis::inverse::{ToolPose, tool_pose};
use crate::evaluate::{Poses, Random};
use crate::machine::{Machine, Pose};

/// Tool poses, computed by index or listed.
#[derive(Debug, Clone, PartialEq)]
pub enum Work {
    /// The tool poses of the nominal machine at these poses.
    OfPoses(Poses),
    /// A list.
    Listed(Vec<ToolPose>),
    /// The tool poses of one continuous path.
    Path(Vec<ToolPose>),
    /// The tool poses of the nominal machine at these poses of its axes, which it takes as they are.
    OfAxes {
        /// The poses, mm and deg.
        poses: Vec<Pose>,
        /// True if they are one continuous path.
        is_path: bool,
    },
}

impl Work {
    /// Returns the tool poses at `count` random poses over a machine's volume.
    pub fn random(machine: &Machine, count: usize, seed: u64) -> Self {
        Self::OfPoses(Poses::Random(Random::of(machine, count, seed)))
    }

    /// Returns a work of tool poses, one path or single ones.
    pub fn listed(list: Vec<ToolPose>, is_path: bool) -> Self {
        if is_path { Self::Path(list) } else { Self::Listed(list) }
    }

    /// Returns the number of tool poses.
    pub fn len(&self) -> usize {
        match self {
            Self::OfPoses(poses) => poses.len(),
            Self::Listed(list) | Self::Path(list) => list.len(),
            Self::OfAxes { poses, .. } => poses.len(),
        }
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the tool pose with an index below [`Self::len`]; `machine` is the nominal machine of [`Self::OfPoses`]
    /// and [`Self::OfAxes`].
    pub fn get(&self, machine: &Machine, index: usize) -> ToolPose {
        match self {
            Self::OfPoses(poses) => tool_pose(machine, &poses.get(index)),
            Self::Listed(list) | Self::Path(list) => list[index],
            Self::OfAxes { poses, .. } => tool_pose(machine, &poses[index]),
        }
    }

    /// True if the tool poses are one continuous path.
    pub fn is_path(&self) -> bool {
        matches!(self, Self::Path(_) | Self::OfAxes { is_path: true, .. })
    }
}
