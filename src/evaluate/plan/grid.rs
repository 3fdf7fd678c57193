//! Tensor grids: nothing that does not depend on the inner axis is computed at its nodes.
//!
//! The inner axis is the last one, which is the joint next to the tool. Order 1 composes the outer joints into one motion and
//! one twist for a whole line (`composed`): its numbers are those of scattered poses up to rounding, 1e-12 of the largest. Orders
//! 2 and exact walk like scattered poses, with everything looked up beforehand (`walked`): the same numbers, to the bit. All
//! of them are the same at any vector width and on any number of threads.

use super::batch::Output;
use super::composed::{self, Composed};
use super::exact::Exact;
use super::lanes::{Lanes, run};
use super::second::SecondOrder;
use super::trigonometry::sin_cos;
use super::walked::{self, Walked};
use super::{Plan, Walk};
use crate::evaluate::Nodes;
use rayon::prelude::*;

/// A plan with the nodes of a grid.
#[derive(Debug, Clone)]
pub struct GridPlan {
    plan: Plan,
    nodes: Nodes,
    counts: Vec<usize>,
    kind: Kind,
}

#[derive(Debug, Clone)]
enum Kind {
    First(Box<Composed>),
    Second(Box<Walked<SecondOrder>>),
    Exact(Box<Walked<Exact>>),
}

/// Lines that one thread does at a time, in nodes.
const BLOCK: usize = 1 << 15;

impl GridPlan {
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
        let (mut whole, _) = out.split_at(lines * self.line());
        let mut at = vec![0; self.counts.len() - 1];
        let mut index = first;
        for (node, count) in at.iter_mut().zip(&self.counts).rev() {
            (*node, index) = (index % count, index / count);
        }
        let (mut beyond, out) = (Vec::new(), whole.reborrow());
        match &self.kind {
            Kind::First(grid) => run(self.plan.width, composed::Lines { grid, first: at, out }),
            Kind::Second(grid) => run(self.plan.width, walked::Lines { grid, first: at, out, beyond: &mut beyond }),
            Kind::Exact(grid) => run(self.plan.width, walked::Lines { grid, first: at, out, beyond: &mut beyond }),
        }
        for index in beyond {
            let pose = self.nodes.get(first * self.line() + index);
            whole.put(index, &self.plan.general(&pose));
        }
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

impl Plan {
    /// The plan on the nodes of a grid; `None` if it is not compiled or has no axes.
    pub fn grid(&self, nodes: &Nodes) -> Option<GridPlan> {
        let positions = nodes.positions();
        if positions.len() != self.machine.axes().len() {
            return None;
        }
        let kind = match &self.kernel {
            Walk::First(task) => Kind::First(Box::new(Composed::new(task, positions)?)),
            Walk::Second(task) => Kind::Second(Box::new(Walked::new(task.clone(), positions)?)),
            Walk::Exact(task) => Kind::Exact(Box::new(Walked::new(Exact::clone(task), positions)?)),
            Walk::General => return None,
        };
        Some(GridPlan { plan: self.clone(), nodes: nodes.clone(), counts: nodes.counts().collect(), kind })
    }
}

/// What is known at the nodes of an axis: found out once for the grid.
#[derive(Debug, Clone)]
pub struct AxisNodes<Node> {
    pub positions: Vec<f64>,
    /// Sines and cosines of the positions.
    pub turns: Vec<(f64, f64)>,
    /// What else.
    pub nodes: Vec<Node>,
}

impl<Node> AxisNodes<Node> {
    /// At these positions; `node` gets a position with its sine and cosine.
    pub fn new(positions: Vec<f64>, node: impl Fn(f64, (f64, f64)) -> Node) -> Self {
        let turns: Vec<(f64, f64)> = positions.iter().map(|q| sin_cos(*q)).collect();
        let nodes = positions.iter().zip(&turns).map(|(q, turn)| node(*q, *turn)).collect();
        Self { positions, turns, nodes }
    }
}

/// The next line; which is the outermost axis that moved.
pub fn advance(nodes: &mut [usize], count: impl Fn(usize) -> usize) -> usize {
    for k in (0..nodes.len()).rev() {
        nodes[k] += 1;
        if nodes[k] < count(k) {
            return k;
        }
        nodes[k] = 0;
    }
    0
}

/// A vector of nodes. It may reach into the next line, which is written after it; not beyond the end.
#[inline(always)]
pub fn write<V: Lanes>(out: &mut Output<'_>, at: usize, d: [V; 3], w: [V; 3]) {
    let room = out.position[0].len() - at;
    for k in 0..3 {
        if V::COUNT <= room {
            d[k].store(&mut out.position[k][at..]);
            w[k].store(&mut out.rotation[k][at..]);
        } else {
            out.position[k][at..].copy_from_slice(&d[k].spread()[..room]);
            out.rotation[k][at..].copy_from_slice(&w[k].spread()[..room]);
        }
    }
}
