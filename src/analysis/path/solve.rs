//! Dynamic programming over the candidates of all rows.
//!
//! Candidates are held for [`BLOCK`] rows at a time. The first pass keeps the state before each block; the second goes
//! back block by block, and computes each but the last anew. So memory does not grow with the rows beyond their poses,
//! and a path of more than one block takes twice the time.

use super::settle::settle;
use super::steps::{ChosenPose, PathPose, Steps};
use crate::analysis::inverse::{CandidateSearch, Miss, RowCandidates, ToolPose, inverse_all, is_same};
use crate::machine::{Machine, Pose};
use rayon::prelude::*;

/// Rows whose candidates are held at a time.
const BLOCK: usize = 4096;

/// Number of the best poses of a row whose values of a free axis are candidates of the next.
const CARRIED: usize = 8;

/// The cost of a sequence, compared in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
struct Cost {
    rewinds: u32,
    /// Millionths of a mm or deg.
    motion: u64,
    /// Place of the start among the candidates of the first row, the nearest to the pose of zeros first.
    start: u32,
}

/// A candidate with the best sequence that ends in it.
#[derive(Debug, Clone)]
struct Node {
    pose: Pose,
    free: Option<usize>,
    /// True if the same axis was free at all rows before.
    is_loose: bool,
    cost: Cost,
    /// Index of the candidate of the row before.
    back: u8,
}

/// The candidates of a row that is reached.
#[derive(Debug, Clone)]
struct Layer {
    row: usize,
    target: ToolPose,
    nodes: Vec<Node>,
}

impl Layer {
    fn at(&self, index: usize) -> PathPose<'_> {
        let node = &self.nodes[index];
        PathPose { target: &self.target, pose: &node.pose, free: node.free }
    }

    /// Returns the candidates by index, cheapest first.
    fn best_first(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.nodes.len()).collect();
        order.sort_by_key(|index| (self.nodes[*index].cost, *index));
        order
    }
}

/// Returns the poses (mm, deg) of a machine along a path of tool poses, in their order: of all sequences of candidates
/// the one with the fewest rewinds, then the least motion, then the start nearest to the pose of zeros. Rotary axes
/// are not wrapped: positions of endless ones may be beyond a turn. Rows that are missed, as single poses are, are left
/// out of the path. Arms without finitely many branches follow from pose to pose.
pub fn solve_path(machine: &Machine, targets: &[ToolPose]) -> Vec<Result<Pose, Miss>> {
    let search = CandidateSearch::new(machine);
    if search.only_follows() {
        return inverse_all(machine, targets);
    }
    let steps = Steps::new(machine, &search, true);
    let solver = PathSolver { machine, always_free: steps.always_free(), steps, search };
    let mut misses = Vec::new();
    let mut chosen = solver.chosen(targets, &mut misses);
    settle(machine, &solver.steps, &solver.search, &mut chosen);
    let mut rows: Vec<(usize, Result<Pose, Miss>)> = chosen.into_iter().map(|of| (of.row, Ok(of.pose))).collect();
    rows.extend(misses.into_iter().map(|(row, miss)| (row, Err(miss))));
    rows.sort_by_key(|(row, _)| *row);
    rows.into_iter().map(|(_, found)| found).collect()
}

struct PathSolver<'a> {
    machine: &'a Machine,
    steps: Steps<'a>,
    search: CandidateSearch<'a>,
    /// The axis that is free at all poses, if one is.
    always_free: Option<usize>,
}

impl PathSolver<'_> {
    /// Returns the best sequence over the rows that are reached; the others become misses.
    fn chosen(&self, targets: &[ToolPose], misses: &mut Vec<(usize, Miss)>) -> Vec<ChosenPose> {
        let mut starts: Vec<Option<Layer>> = Vec::new();
        let mut last: Option<Layer> = None;
        let mut held = Vec::new();
        for (index, block) in targets.chunks(BLOCK).enumerate() {
            starts.push(last.clone());
            held = self.layers(last.as_ref(), index * BLOCK, block, misses);
            last = held.last().cloned().or(last);
        }
        let Some(mut at) = last.as_ref().and_then(|layer| layer.best_first().first().copied()) else {
            return Vec::new();
        };
        let mut chosen = Vec::new();
        for (index, block) in targets.chunks(BLOCK).enumerate().rev() {
            let is_last = index + 1 == starts.len();
            let layers = if is_last {
                std::mem::take(&mut held)
            } else {
                self.layers(starts[index].as_ref(), index * BLOCK, block, &mut Vec::new())
            };
            for Layer { row, target, mut nodes } in layers.into_iter().rev() {
                let Node { pose, free, back, .. } = nodes.swap_remove(at);
                chosen.push(ChosenPose { row, target, pose, free });
                at = usize::from(back);
            }
        }
        chosen.reverse();
        chosen
    }

    /// Returns the candidates of a block of rows with the sequences that end in them, after the state before it.
    fn layers(
        &self,
        before: Option<&Layer>,
        first: usize,
        block: &[ToolPose],
        misses: &mut Vec<(usize, Miss)>,
    ) -> Vec<Layer> {
        let unturned: Vec<ToolPose> = block.iter().map(|target| target.to_unturned(self.machine)).collect();
        let found: Vec<Result<RowCandidates, Miss>> =
            unturned.par_iter().map(|target| self.search.of(target)).collect();
        let mut layers: Vec<Layer> = Vec::new();
        for (k, (target, found)) in unturned.into_iter().zip(found).enumerate() {
            match found {
                Ok(found) => {
                    let nodes = self.nodes(layers.last().or(before), &target, found);
                    layers.push(Layer { row: first + k, target, nodes });
                }
                Err(miss) => misses.push((first + k, miss)),
            }
        }
        layers
    }

    /// Returns the candidates of a row with the best sequences that end in them.
    fn nodes(&self, before: Option<&Layer>, target: &ToolPose, found: RowCandidates) -> Vec<Node> {
        let RowCandidates { mut poses, sweeps } = found;
        let order = before.map_or_else(Vec::new, Layer::best_first);
        if let Some(before) = before {
            for index in order.into_iter().take(CARRIED) {
                let carried: Vec<Pose> = self.search.carried(target, &sweeps, &before.nodes[index].pose).collect();
                for pose in carried {
                    if !poses.iter().any(|known| is_same(known, &pose)) {
                        poses.push(pose);
                    }
                }
            }
        }
        let mut nodes = Vec::new();
        for (start, pose) in poses.into_iter().enumerate() {
            let free = self.steps.free_axis(&pose);
            let is_loose = free.is_some() && free != self.always_free;
            let node = Node { free, is_loose, cost: Cost::default(), back: 0, pose };
            nodes.push(match before {
                None => Node { cost: Cost { start: start as u32, ..Cost::default() }, ..node },
                Some(before) => self.after(before, target, node),
            });
        }
        nodes
    }

    /// Returns a candidate after the best of the row before.
    fn after(&self, before: &Layer, target: &ToolPose, node: Node) -> Node {
        let at = PathPose { target, pose: &node.pose, free: node.free };
        let reached = |(index, from): (usize, &Node)| {
            // An axis that has been free from the start begins where it is needed first.
            let but = from.free.filter(|_| from.is_loose);
            let motion = from.cost.motion + self.steps.motion(&from.pose, &node.pose, but);
            (Cost { motion, ..from.cost }, index)
        };
        let mut order: Vec<(Cost, usize)> = before.nodes.iter().enumerate().map(reached).collect();
        order.sort_unstable();
        let mut best: Option<(Cost, usize)> = None;
        for (cost, index) in order {
            if best.is_some_and(|(best, _)| best <= cost) {
                break;
            }
            let rewinds = cost.rewinds + u32::from(!self.steps.is_continuous(&before.at(index), &at));
            let cost = Cost { rewinds, ..cost };
            if best.is_none_or(|(best, _)| cost < best) {
                best = Some((cost, index));
            }
        }
        let (cost, back) = best.unwrap_or_default();
        let is_loose = node.is_loose && before.nodes[back].is_loose && before.nodes[back].free == node.free;
        Node { cost, back: back as u8, is_loose, ..node }
    }
}
