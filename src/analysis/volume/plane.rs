//! A field over a plane of two linear axes.

use super::map::{View, deviation_in};
use crate::evaluate::{Deviation, Field};
use crate::lower::NominalPose;
use crate::machine::{Machine, Pose};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Deviations on a regular grid over two linear axes, the other axes at rest.
#[derive(Debug, Clone)]
pub struct Plane {
    /// Index of the axis drawn to the right, and of the one drawn upwards.
    pub axes: [usize; 2],
    /// Their intervals, mm.
    pub intervals: [(f64, f64); 2],
    /// Number of nodes of each, ends included.
    pub counts: [usize; 2],
    /// Pose (mm, deg) of the other axes.
    pub at: Pose,
    /// Content of the nodes.
    pub nodes: PlaneNodes,
}

/// Content of the nodes of a plane, the axis to the right running fastest.
#[derive(Debug, Clone)]
pub enum PlaneNodes {
    /// Deviations.
    Deviations {
        /// Deviation at each node, in the frame asked for.
        deviations: Vec<Deviation>,
        /// Components of the position deviation along the directions of the two axes at each node, mm. They do not
        /// depend on the frame.
        in_plane: Vec<[f64; 2]>,
    },
    /// Lengths alone, mm.
    Lengths(Vec<f64>),
}

impl Plane {
    /// Returns a field over the volume's intervals of two different linear axes, `counts` nodes each, at least 2.
    pub fn of(field: &dyn Field, axes: [usize; 2], at: &[f64], counts: [usize; 2], view: View) -> Self {
        let machine = field.machine();
        let intervals = axes.map(|i| (machine.volume()[i].min, machine.volume()[i].max));
        let counts = counts.map(|count| count.max(2));
        let directions = axes.map(|axis| direction(machine, at, axis));
        let node = |index: usize| {
            let mut pose = at.to_vec();
            for (i, step) in [index % counts[0], index / counts[0]].into_iter().enumerate() {
                let (min, max) = intervals[i];
                pose[axes[i]] = min + (max - min) * (step as f64 / (counts[i] - 1) as f64);
            }
            let unturned = field.deviation(&view.conditions.at_pose(&pose)).position;
            (deviation_in(field, &pose, view), directions.map(|u| u.dot(&unturned)))
        };
        let nodes: Vec<_> = (0..counts[0] * counts[1]).into_par_iter().map(node).collect();
        let (deviations, in_plane) = nodes.into_iter().unzip();
        let nodes = PlaneNodes::Deviations { deviations, in_plane };
        Self { axes, intervals, counts, at: at.to_vec(), nodes }
    }

    /// Returns lengths (mm) over the volume's intervals of two different linear axes, `counts` nodes each, at least 2;
    /// `of` returns those at poses (mm, deg), and fails with it.
    pub fn of_lengths<F>(
        machine: &Machine,
        axes: [usize; 2],
        at: &[f64],
        counts: [usize; 2],
        of: impl FnOnce(Vec<Pose>) -> Result<Vec<f64>, F>,
    ) -> Result<Self, F> {
        let intervals = axes.map(|i| (machine.volume()[i].min, machine.volume()[i].max));
        let counts = counts.map(|count| count.max(2));
        let empty = Self { axes, intervals, counts, at: at.to_vec(), nodes: PlaneNodes::Lengths(Vec::new()) };
        let lengths = of((0..counts[0] * counts[1]).map(|index| empty.pose(index)).collect())?;
        Ok(Self { nodes: PlaneNodes::Lengths(lengths), ..empty })
    }

    /// Returns the pose (mm, deg) of a node.
    fn pose(&self, index: usize) -> Pose {
        let mut pose = self.at.clone();
        for (i, step) in [index % self.counts[0], index / self.counts[0]].into_iter().enumerate() {
            pose[self.axes[i]] = self.position(i, step);
        }
        pose
    }

    /// Returns the components within the plane at a node, mm; `None` where the nodes hold lengths alone.
    pub fn in_plane(&self, index: usize) -> Option<[f64; 2]> {
        match &self.nodes {
            PlaneNodes::Deviations { in_plane, .. } => in_plane.get(index).copied(),
            PlaneNodes::Lengths(_) => None,
        }
    }

    /// Returns the position of a node along one of the two axes, mm.
    pub fn position(&self, axis: usize, step: usize) -> f64 {
        let (min, max) = self.intervals[axis];
        min + (max - min) * (step as f64 / (self.counts[axis] - 1) as f64)
    }
}

/// Returns the unit vector along which the tool moves in the unturned workpiece frame when the axis rises.
fn direction(machine: &Machine, at: &[f64], axis: usize) -> Vector3<f64> {
    let moved = |by: f64| {
        let mut pose = at.to_vec();
        pose[axis] = by;
        NominalPose::at(machine, &pose).pose.translation
    };
    (moved(1.0) - moved(0.0)).try_normalize(0.0).unwrap_or_default()
}
