//! Number of poses of a certificate and of its single errors.

use crate::controller::replay::Replay;
use crate::evaluate::random_poses;
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

/// An axis whose volume reaches beyond what was measured of it: its index, the measured part of its volume, and its
/// volume (mm, deg).
struct ShortAxis {
    axis: usize,
    measured: (f64, f64),
    volume: (f64, f64),
}

impl ShortAxis {
    fn all(machine: &Machine) -> Vec<Self> {
        let both = machine.measured_volume().into_iter().zip(machine.volume()).enumerate();
        let all = both.map(|(axis, (measured, grid))| Self { axis, measured, volume: (grid.min, grid.max) });
        all.filter(|short| short.measured != short.volume).collect()
    }

    /// Returns the share of the volume below a position.
    fn share(&self, position: f64) -> f64 {
        (position - self.volume.0) / (self.volume.1 - self.volume.0)
    }

    fn within(&self, position: f64) -> f64 {
        let (low, high) = self.measured;
        (low + self.share(position) * (high - low)).min(high)
    }

    /// Returns the position at the same share of the two ends beyond.
    fn beyond(&self, position: f64) -> f64 {
        let (below, above) = (self.measured.0 - self.volume.0, self.volume.1 - self.measured.1);
        let along = self.share(position) * (below + above);
        if along < below { self.volume.0 + along } else { (self.measured.1 + (along - below)).min(self.volume.1) }
    }
}

impl Depth {
    /// Returns the poses, spread over the measured part of the volume.
    pub fn poses(self, machine: &Machine) -> Vec<Pose> {
        let mut poses = random_poses(machine, self.poses, self.seed);
        for short in ShortAxis::all(machine) {
            poses.iter_mut().for_each(|pose| pose[short.axis] = short.within(pose[short.axis]));
        }
        poses
    }

    /// Returns as many poses spread over the volume, each with an axis in turn beyond what was measured of it; none
    /// where all of the volume was measured.
    pub fn poses_beyond(self, machine: &Machine) -> Vec<Pose> {
        let all = ShortAxis::all(machine);
        if all.is_empty() {
            return Vec::new();
        }
        let mut poses = random_poses(machine, self.poses, self.seed);
        for (pose, short) in poses.iter_mut().zip(all.iter().cycle()) {
            pose[short.axis] = short.beyond(pose[short.axis]);
        }
        poses
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
