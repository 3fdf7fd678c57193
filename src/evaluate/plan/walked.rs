//! Orders 2 and exact on a tensor grid: the walk of scattered poses, with everything looked up beforehand.
//!
//! At the nodes of each axis its sine and cosine, its errors, and what the walk makes of them are computed once for the
//! grid. The nodes of a line differ in the inner axis alone, which is next to the tool; all others are the same in every lane.
//! The walk itself is that of a batch, operation by operation: so the numbers are those of scattered poses, to the bit.

use super::ahead::Inputs;
use super::batch::{FARTHEST, Nodal, Output};
use super::curves::Six;
use super::grid::{AxisNodes, advance, write};
use super::lanes::{Kernel, Lanes, MOST};

/// A task with the nodes of a grid.
#[derive(Debug, Clone)]
pub struct Walked<T: Nodal> {
    task: T,
    outer: Vec<AxisNodes<Known<T::Node>>>,
    inner: Inner,
}

/// The errors of an axis at one of its nodes, and what the walk makes of them.
#[derive(Debug, Clone)]
struct Known<Node> {
    six: Six,
    node: Node,
}

/// What is known at the nodes of the inner axis, in columns that are padded to whole vectors.
#[derive(Debug, Clone)]
struct Inner {
    count: usize,
    position: Vec<f64>,
    turn: [Vec<f64>; 2],
    six: [Vec<f64>; 6],
}

impl<T: Nodal> Walked<T> {
    /// On the nodes of a grid: their positions, axis by axis. `None` without axes.
    pub fn new(task: T, positions: Vec<Vec<f64>>) -> Option<Self> {
        let mut axes = Vec::new();
        for (axis, positions) in positions.into_iter().enumerate() {
            let curves = task.wanted(axis).curves;
            axes.push(AxisNodes::new(positions, |q, turn| {
                let six = curves.map_or([0.0; 6], |curves| curves.alone(q, turn));
                Known { six, node: task.node(axis, &six) }
            }));
        }
        let inner = Inner::new(&axes.pop()?);
        Some(Self { task, outer: axes, inner })
    }
}

impl Inner {
    fn new<Node>(axis: &AxisNodes<Known<Node>>) -> Self {
        let count = axis.positions.len();
        let padded = |value: &dyn Fn(usize) -> f64| {
            (0..count.next_multiple_of(MOST)).map(|node| if node < count { value(node) } else { 0.0 }).collect()
        };
        Self {
            count,
            position: padded(&|node| axis.positions[node]),
            turn: [padded(&|node| axis.turns[node].0), padded(&|node| axis.turns[node].1)],
            six: std::array::from_fn(|k| padded(&|node| axis.nodes[node].six[k])),
        }
    }
}

/// A vector of nodes of a line.
struct AtNodes<'a, T: Nodal> {
    grid: &'a Walked<T>,
    /// Of the outer axes.
    nodes: &'a [usize],
    /// The first of the inner axis.
    i: usize,
}

impl<T: Nodal> Clone for AtNodes<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: Nodal> Copy for AtNodes<'_, T> {}

impl<V: Lanes, T: Nodal> Inputs<V, T::Node> for AtNodes<'_, T> {
    #[inline(always)]
    fn position(self, axis: usize) -> V {
        match self.grid.outer.get(axis) {
            Some(outer) => V::splat(outer.positions[self.nodes[axis]]),
            None => V::load(&self.grid.inner.position[self.i..]),
        }
    }

    #[inline(always)]
    fn added(self, _: usize) -> Option<V> {
        None
    }

    #[inline(always)]
    fn turn(self, axis: usize) -> (V, V) {
        match self.grid.outer.get(axis) {
            Some(outer) => {
                let (sine, cosine) = outer.turns[self.nodes[axis]];
                (V::splat(sine), V::splat(cosine))
            }
            None => {
                let [sine, cosine] = &self.grid.inner.turn;
                (V::load(&sine[self.i..]), V::load(&cosine[self.i..]))
            }
        }
    }

    #[inline(always)]
    fn six(self, axis: usize) -> [V; 6] {
        let mut six = [V::splat(0.0); 6];
        for k in 0..6 {
            six[k] = match self.grid.outer.get(axis) {
                Some(outer) => V::splat(outer.nodes[self.nodes[axis]].six[k]),
                None => V::load(&self.grid.inner.six[k][self.i..]),
            };
        }
        six
    }

    #[inline(always)]
    fn known(&self, axis: usize) -> Option<&T::Node> {
        match self.grid.outer.get(axis) {
            Some(outer) => Some(&outer.nodes[self.nodes[axis]].node),
            None => None,
        }
    }
}

/// Whole lines of a grid.
pub struct Lines<'a, 'o, T: Nodal> {
    /// The grid.
    pub grid: &'a Walked<T>,
    /// The first line, by the node of every outer axis.
    pub first: Vec<usize>,
    /// As many lines as there is room for.
    pub out: Output<'o>,
    /// Nodes that the kernel could not do.
    pub beyond: &'a mut Vec<usize>,
}

impl<T: Nodal> Kernel for Lines<'_, '_, T> {
    #[inline(always)]
    fn run<V: Lanes>(mut self) {
        let grid = self.grid;
        let count = grid.inner.count;
        let mut nodes = std::mem::take(&mut self.first);
        for line in 0..self.out.len() / count {
            let mut i = 0;
            while i < count {
                let (d, w, far) = grid.task.walk::<V, _>(AtNodes { grid, nodes: &nodes, i });
                write(&mut self.out, line * count + i, d, w);
                let far = far.spread();
                for lane in 0..V::COUNT.min(count - i) {
                    if far[lane] > FARTHEST {
                        self.beyond.push(line * count + i + lane);
                    }
                }
                i += V::COUNT;
            }
            advance(&mut nodes, |axis| grid.outer[axis].positions.len());
        }
    }
}
