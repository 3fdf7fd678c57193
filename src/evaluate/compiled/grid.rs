//! Tensor grids: nothing that does not depend on the inner axis is computed at its nodes.
//!
//! The inner axis is the last one, which is the joint next to the tool. The outer joints are lines into one map for a whole line
//! (`composed`): the numbers are those of scattered poses up to rounding, 1e-12 of the largest, and the same at any vector width and on any
//! number of threads.

use super::affine::ErrorProducts;
use super::batch::Output;
use super::grid_lines::{GridLines, Lines};
use super::lanes::run;
use super::model::{CompiledModel, OrderKernel};
use super::second::SecondOrder;
use crate::evaluate::poses::Nodes;
use rayon::prelude::*;

/// A plan with the nodes of a grid.
#[derive(Debug, Clone)]
pub struct CompiledGrid {
    plan: CompiledModel,
    counts: Vec<usize>,
    lines: Box<GridLines>,
}

/// Lines that one thread does at a time, in nodes.
const BLOCK: usize = 1 << 15;

/// Nodes of all axes together of which 300 bytes each are kept.
const MAX_KNOWN: usize = 1 << 16;

impl CompiledGrid {
    /// Nodes of a line: of the inner axis.
    pub fn line(&self) -> usize {
        self.counts.last().copied().unwrap_or(1)
    }

    /// Lines of the grid; the largest `usize` if there are more.
    pub fn lines(&self) -> usize {
        self.counts.iter().rev().skip(1).copied().fold(1, usize::saturating_mul)
    }

    /// Deviations at the nodes of whole lines from `first` on, in the order of [`Nodes::get`]: as many lines as `out` has room
    /// for, on this thread.
    pub fn fill(&self, first: usize, out: Output<'_>) {
        let lines = (out.len() / self.line()).min(self.lines().saturating_sub(first));
        let (whole, _) = out.split_at(lines * self.line());
        let mut at = vec![0; self.counts.len() - 1];
        let mut index = first;
        for (node, count) in at.iter_mut().zip(&self.counts).rev() {
            (*node, index) = (index % count, index / count);
        }
        run(self.plan.width, Lines { grid: &self.lines, first: at, out: whole });
    }

    /// The same on all threads of rayon's pool.
    pub fn fill_parallel(&self, first: usize, out: Output<'_>) {
        let lines = (out.len() / self.line()).min(self.lines().saturating_sub(first));
        let block = (BLOCK / self.line()).max(1);
        let mut parts = Vec::new();
        let (mut rest, _) = out.split_at(lines * self.line());
        for start in (0..lines).step_by(block) {
            let (part, others) = rest.split_at(block.min(lines - start) * self.line());
            parts.push((first + start, part));
            rest = others;
        }
        parts.into_par_iter().for_each(|(start, part)| self.fill(start, part));
    }
}

impl CompiledModel {
    /// The plan on the nodes of a grid; `None` if it is not compiled or has no axes, where the errors of the exact model may turn by
    /// more than 0.3 rad together, and of axes with so many nodes that what is known at each of them had no end.
    pub fn grid(&self, nodes: &Nodes) -> Option<CompiledGrid> {
        let known = nodes.counts().fold(0, usize::saturating_add);
        if known > MAX_KNOWN || nodes.counts().count() != self.machine.axes().len() {
            return None;
        }
        let positions = nodes.positions();
        let lines = match &self.kernel {
            OrderKernel::First(_) => {
                GridLines::new(&SecondOrder::new(self.chain.clone()?)?, ErrorProducts::Dropped, &positions)
            }
            OrderKernel::Second(task) => GridLines::new(task, ErrorProducts::SecondDegree, &positions),
            OrderKernel::Exact(task) => GridLines::new(task.as_ref(), ErrorProducts::Kept, &positions),
            OrderKernel::General => None,
        };
        Some(CompiledGrid { plan: self.clone(), counts: nodes.counts().collect(), lines: Box::new(lines?) })
    }
}
