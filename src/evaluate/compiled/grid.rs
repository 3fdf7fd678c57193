//! Tensor grids: at a node nothing is computed that depends on the outer axes or on the inner axis alone.
//!
//! The inner axis is the last one, the joint next to the tool. The outer joints are multiplied into one map for a whole
//! line (`grid_lines`): the numbers are those of scattered poses up to rounding, 1e-12 of the largest, and the same at
//! any vector width and on any number of threads.

use super::affine::ErrorProducts;
use super::batch::Output;
use super::grid_lines::{GridLines, Lines};
use super::lanes::run;
use super::model::{CompiledModel, OrderKernel};
use super::second::SecondOrder;
use crate::evaluate::poses::Nodes;
use rayon::prelude::*;

/// A compiled model on the nodes of a grid.
#[derive(Debug, Clone)]
pub struct CompiledGrid {
    model: CompiledModel,
    counts: Vec<usize>,
    lines: Box<GridLines>,
}

/// Number of nodes of a task for one thread, in whole lines.
const BLOCK: usize = 1 << 15;

/// Maximum number of nodes of all axes together; each takes 300 bytes.
const MAX_AXIS_NODES: usize = 1 << 16;

impl CompiledGrid {
    /// Returns the number of nodes of a line, which are those of the inner axis.
    pub fn line(&self) -> usize {
        self.counts.last().copied().unwrap_or(1)
    }

    /// Returns the number of lines; `usize::MAX` if there are more.
    pub fn lines(&self) -> usize {
        self.counts.iter().rev().skip(1).copied().fold(1, usize::saturating_mul)
    }

    /// Computes the deviations at the nodes of whole lines from line `first` on, in the order of [`Nodes::get`], as
    /// many as fit into `out`, on this thread.
    pub fn fill(&self, first: usize, out: Output<'_>) {
        let lines = (out.len() / self.line()).min(self.lines().saturating_sub(first));
        let (whole, _) = out.split_at(lines * self.line());
        let mut at = vec![0; self.counts.len() - 1];
        let mut index = first;
        for (node, count) in at.iter_mut().zip(&self.counts).rev() {
            (*node, index) = (index % count, index / count);
        }
        run(self.model.width, Lines { grid: &self.lines, first: at, out: whole });
    }

    /// Computes the same deviations as [`Self::fill`] on all threads of rayon's pool.
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
    /// Returns the model on the nodes of a grid; `None` if the model is not compiled or has no axes, if the errors of
    /// the exact model together may rotate by more than 0.3 rad, and if the axes have more than 65536 nodes together.
    pub fn grid(&self, nodes: &Nodes) -> Option<CompiledGrid> {
        let count = nodes.counts().fold(0, usize::saturating_add);
        if count > MAX_AXIS_NODES || nodes.counts().count() != self.machine.axes().len() {
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
        Some(CompiledGrid { model: self.clone(), counts: nodes.counts().collect(), lines: Box::new(lines?) })
    }
}
