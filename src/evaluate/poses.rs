//! Poses over the volume of a machine: nodes of a grid, seeded random or low-discrepancy ones, made by index.
//!
//! A pose depends on nothing but its index (and the seed), so any number of threads sees the same ones,
//! and a map need not store them.

use super::compiled::batch::PoseColumns;
use super::spread::{Spread, unit};
use crate::machine::{Grid, Machine, Pose};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// The poses of a map.
#[derive(Debug, Clone, PartialEq)]
pub enum Poses {
    /// The nodes of a grid; the last axis runs fastest.
    Nodes(Nodes),
    /// Random, uniformly distributed over the volume.
    Random(Random),
    /// Low-discrepancy: with smaller gaps than random ones.
    Spread(Spread),
    /// A list.
    Listed(Vec<Pose>),
}

impl Poses {
    /// Returns the number of poses; `usize::MAX` if there are more.
    pub fn len(&self) -> usize {
        match self {
            Self::Nodes(nodes) => nodes.len(),
            Self::Random(random) => random.count,
            Self::Spread(spread) => spread.len(),
            Self::Listed(list) => list.len(),
        }
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the pose with this index (mm, deg); beyond the end of a list, one without positions.
    pub fn get(&self, index: usize) -> Pose {
        match self {
            Self::Nodes(nodes) => nodes.get(index),
            Self::Random(random) => random.get(index),
            Self::Spread(spread) => spread.get(index),
            Self::Listed(list) => list.get(index).cloned().unwrap_or_default(),
        }
    }

    /// Replaces the columns by the poses with these indices.
    pub fn fill(&self, indices: std::ops::Range<usize>, columns: &mut PoseColumns) {
        columns.clear();
        match self {
            Self::Nodes(nodes) => nodes.fill(indices, columns),
            Self::Random(random) => {
                let mut pose = Vec::new();
                for index in indices {
                    random.put(index, &mut pose);
                    columns.push(&pose);
                }
            }
            Self::Spread(spread) => indices.for_each(|index| columns.push(&spread.get(index))),
            Self::Listed(list) => list[indices].iter().for_each(|pose| columns.push(pose)),
        }
    }

    /// Returns all poses in order.
    pub fn iter(&self) -> impl Iterator<Item = Pose> {
        (0..self.len()).map(|index| self.get(index))
    }
}

/// The nodes of a grid: evenly spaced on each axis, both ends included.
#[derive(Debug, Clone, PartialEq)]
pub struct Nodes {
    axes: Vec<(Grid, usize)>,
}

impl Nodes {
    /// Returns the grid of the machine's volume.
    pub fn of(machine: &Machine) -> Self {
        Self::new(machine.volume())
    }

    /// Returns the grid over intervals (mm or deg) whose nodes are at most a step apart.
    pub fn new(volume: &[Grid]) -> Self {
        Self { axes: volume.iter().map(|grid| (*grid, node_count(grid))).collect() }
    }

    /// Returns the number of nodes of each axis.
    pub fn counts(&self) -> impl Iterator<Item = usize> {
        self.axes.iter().map(|(_, count)| *count)
    }

    /// Returns the number of nodes; `usize::MAX` if there are more.
    pub fn len(&self) -> usize {
        self.counts().fold(1, usize::saturating_mul)
    }

    /// Returns false: every axis has a node.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Returns the positions of the nodes (mm or deg), axis by axis.
    pub fn positions(&self) -> Vec<Vec<f64>> {
        let of = |(grid, count): &(Grid, usize)| (0..*count).map(|node| position(grid, *count, node)).collect();
        self.axes.iter().map(of).collect()
    }

    /// Returns the node with this index (mm, deg); the last axis runs fastest.
    pub fn get(&self, index: usize) -> Pose {
        let mut rest = index;
        let mut pose: Pose = self
            .axes
            .iter()
            .rev()
            .map(|(grid, count)| {
                let node = rest % count;
                rest /= count;
                position(grid, *count, node)
            })
            .collect();
        pose.reverse();
        pose
    }
}

impl Nodes {
    /// Fills columns like an odometer: only the positions that change are computed.
    fn fill(&self, indices: std::ops::Range<usize>, columns: &mut PoseColumns) {
        let mut nodes = vec![0; self.axes.len()];
        let mut rest = indices.start;
        for (node, (_, count)) in nodes.iter_mut().zip(&self.axes).rev() {
            (*node, rest) = (rest % count, rest / count);
        }
        let mut pose = self.get(indices.start);
        for _ in indices {
            columns.push(&pose);
            for k in (0..nodes.len()).rev() {
                let (grid, count) = &self.axes[k];
                nodes[k] = (nodes[k] + 1) % count;
                pose[k] = position(grid, *count, nodes[k]);
                if nodes[k] != 0 {
                    break;
                }
            }
        }
    }
}

/// Returns the number of nodes that keep the step. A step that divides the interval up to rounding adds no node.
pub fn node_count(grid: &Grid) -> usize {
    let intervals = libm::ceil((grid.max - grid.min) / grid.step - 1e-9);
    if intervals >= 1.0 { (intervals as usize).saturating_add(1) } else { 1 + usize::from(grid.max > grid.min) }
}

/// Returns the positions (mm or deg) of `count` evenly spaced nodes over an interval.
pub fn node_positions(grid: &Grid, count: usize) -> Vec<f64> {
    (0..count).map(|node| position(grid, count, node)).collect()
}

/// Returns the position of a node. The ends are exact, and so are positions whose division leaves no remainder.
fn position(grid: &Grid, count: usize, node: usize) -> f64 {
    if node + 1 == count && count > 1 {
        return grid.max;
    }
    grid.min + (grid.max - grid.min) * node as f64 / (count.max(2) - 1) as f64
}

/// Random poses, evenly distributed over intervals.
#[derive(Debug, Clone, PartialEq)]
pub struct Random {
    intervals: Vec<(f64, f64)>,
    seed: u64,
    count: usize,
}

impl Random {
    /// Returns `count` poses over the machine's volume.
    pub fn of(machine: &Machine, count: usize, seed: u64) -> Self {
        Self::new(machine.volume().iter().map(|grid| (grid.min, grid.max)).collect(), count, seed)
    }

    /// Returns `count` poses over intervals (mm or deg), one per axis.
    pub fn new(intervals: Vec<(f64, f64)>, count: usize, seed: u64) -> Self {
        Self { intervals, seed, count }
    }

    /// Returns the pose with this index (mm, deg), from its own stream of the generator with this seed.
    pub fn get(&self, index: usize) -> Pose {
        let mut pose = Vec::new();
        self.put(index, &mut pose);
        pose
    }

    /// Writes the pose with this index into a buffer.
    fn put(&self, index: usize, pose: &mut Pose) {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&self.seed.to_le_bytes());
        let mut generator = ChaCha8Rng::from_seed(key);
        generator.set_stream(index as u64);
        let position = |(min, max): &(f64, f64)| (min + (max - min) * unit(generator.next_u64())).min(*max);
        pose.clear();
        pose.extend(self.intervals.iter().map(position));
    }
}

/// Returns random poses over the machine's volume (mm, deg); a longer list begins with the same poses.
pub fn random_poses(machine: &Machine, count: usize, seed: u64) -> Vec<Pose> {
    Poses::Random(Random::of(machine, count, seed)).iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(min: f64, max: f64, step: f64) -> Grid {
        Grid { min, max, step }
    }

    #[test]
    fn nodes_include_both_ends_and_keep_the_step() {
        let nodes = Nodes::new(&[grid(0.0, 500.0, 62.5), grid(-120.0, 30.0, 40.0), grid(7.0, 7.0, 1.0)]);
        assert_eq!(nodes.counts().collect::<Vec<_>>(), [9, 5, 1]);
        assert_eq!(nodes.len(), 45);
        assert_eq!(nodes.get(0), [0.0, -120.0, 7.0]);
        assert_eq!(nodes.get(1), [0.0, -82.5, 7.0]);
        assert_eq!(nodes.get(44), [500.0, 30.0, 7.0]);
    }

    #[test]
    fn a_step_that_fits_by_rounding_adds_no_node() {
        assert_eq!(node_count(&grid(0.0, 0.3, 0.1)), 4);
        assert_eq!(node_count(&grid(0.0, 1.0, 2.0)), 2);
        assert_eq!(node_count(&grid(0.0, 1e300, 1e-300)), usize::MAX);
    }

    #[test]
    fn random_poses_depend_on_seed_and_index_alone() {
        let random = |count, seed| Poses::Random(Random::new(vec![(0.0, 500.0), (-120.0, 30.0)], count, seed));
        let (few, many): (Vec<_>, Vec<_>) = (random(3, 7).iter().collect(), random(100, 7).iter().collect());
        assert_eq!(few[..], many[..3]);
        assert_ne!(random(3, 8).get(0), few[0]);
        assert!(many.iter().all(|p| (0.0..500.0).contains(&p[0]) && (-120.0..30.0).contains(&p[1])));
        let mean = many.iter().map(|p| p[0]).sum::<f64>() / 100.0;
        assert!((mean - 250.0).abs() < 60.0, "{mean}");
    }
}
