//! Number of poses of a certificate and of its single errors.

use crate::controller::replay::Replay;
use crate::evaluate::{Poses, Random};
use crate::machine::{Machine, Pose};
use std::collections::BTreeSet;

/// Number of poses, and the seed.
#[derive(Debug, Clone, Copy)]
pub struct Depth {
    /// Poses of the certificate.
    pub poses: usize,
    /// Their seed.
    pub seed: u64,
}

/// Largest number of poses for the figures of single errors.
const MAX_SINGLE_POSES: usize = 2000;

/// Largest number of a lattice's nodes that are filled for the figures of single errors.
const MAX_SINGLE_NODES: usize = 16_384;

impl Depth {
    /// Returns the poses, spread over the measured part of the volume.
    pub fn poses(self, machine: &Machine) -> Vec<Pose> {
        Poses::Random(Random::new(machine.measured_volume(), self.poses, self.seed)).iter().collect()
    }

    /// Returns as many poses spread over the volume, each with an axis in turn beyond what was measured of it; none of a
    /// volume that is measured everywhere.
    pub fn poses_beyond(self, machine: &Machine) -> Vec<Pose> {
        let short: Vec<_> = machine.measured_volume().into_iter().zip(machine.volume()).enumerate().collect();
        let short: Vec<_> =
            short.into_iter().filter(|(_, ((low, high), grid))| *low > grid.min || *high < grid.max).collect();
        let mut poses = Poses::Random(Random::of(machine, self.poses, self.seed)).iter().collect::<Vec<Pose>>();
        for (pose, (axis, ((low, high), grid))) in poses.iter_mut().zip(short.iter().cycle()) {
            // The place along the axis, as a length along its two ends.
            let (before, behind) = (low - grid.min, grid.max - high);
            let along = (pose[*axis] - grid.min) / (grid.max - grid.min) * (before + behind);
            pose[*axis] = if along < before { grid.min + along } else { high + (along - before) };
        }
        if short.is_empty() { Vec::new() } else { poses }
    }
}

/// Returns those of a certificate's poses on which the figures of single errors rest.
pub(in crate::controller) fn single_error_poses(poses: &[Pose]) -> &[Pose] {
    &poses[..poses.len().min(MAX_SINGLE_POSES)]
}

/// The part of a lattice that single errors are judged by: its cells around the first poses.
#[derive(Debug, Clone)]
pub(in crate::controller) struct LatticeSubset {
    /// Number of poses.
    pub poses: usize,
    /// Numbers of the nodes around them, rising.
    pub nodes: Vec<usize>,
}

impl LatticeSubset {
    /// Returns the cells around as many of the poses as the bound on nodes lets be filled.
    pub fn of(replay: &Replay, poses: &[Pose]) -> Self {
        let mut nodes = BTreeSet::new();
        for (count, pose) in poses.iter().enumerate() {
            let corners: Vec<usize> = replay.lattice_corners(pose).into_iter().map(|(node, _)| node).collect();
            let fresh = corners.iter().filter(|node| !nodes.contains(*node)).count();
            if nodes.len() + fresh > MAX_SINGLE_NODES {
                return Self { poses: count, nodes: nodes.into_iter().collect() };
            }
            nodes.extend(corners);
        }
        Self { poses: poses.len(), nodes: nodes.into_iter().collect() }
    }
}
