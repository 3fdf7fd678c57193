//! Order 1 on a tensor grid: nothing that does not depend on the inner axis is computed at its nodes.
//!
//! The inner axis is the last one, which is the joint next to the tool. What happens on its tool side and in it
//! depends on its own position alone: point, displacement and rotation at each of its nodes are computed once for the grid, and
//! so are the sines, cosines and errors at the nodes of every other axis. The outer joints are one rigid motion (R, t) with one
//! twist (v, w) for a whole line of nodes, and
//!
//! ```text
//! displacement = R d + w x (R p + t) + v        rotation = R r + w
//! ```
//!
//! where of an inner linear axis `R p` is a constant and the position times a constant.

use super::ahead::{Ahead, Part};
use super::batch::{Output, Slices, Task};
use super::curves::Six;
use super::first::{FirstOrder, Joint, States};
use super::grid::{AxisNodes, advance, write};
use super::lanes::{Kernel, Lanes, MOST};
use super::links::{Motion, cross, minus, plus, splat, times};

type Vector3 = [f64; 3];

/// A plan of order 1 with the nodes of a grid.
#[derive(Debug, Clone)]
pub struct Composed {
    plan: FirstOrder,
    outer: Vec<AxisTwists>,
    inner: Inner,
}

/// At the nodes of an axis: the twist, if there are errors.
type AxisTwists = AxisNodes<Option<Six>>;

/// State behind the inner joint at its nodes, in columns that are padded to whole vectors.
#[derive(Debug, Clone)]
struct Inner {
    count: usize,
    position: Vec<f64>,
    /// Direction of a linear axis and the point at position 0.
    slide: Option<(Vector3, Vector3)>,
    point: [Vec<f64>; 3],
    displacement: [Vec<f64>; 3],
    rotation: [Vec<f64>; 3],
}

/// The outer joints so far: ideal motion `x -> columns x + place`, and a twist in the workpiece frame.
#[derive(Debug, Clone, Copy)]
struct Level {
    columns: [Vector3; 3],
    place: Vector3,
    shift: Vector3,
    turn: Vector3,
}

impl Level {
    const START: Self = Self {
        columns: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        place: [0.0; 3],
        shift: [0.0; 3],
        turn: [0.0; 3],
    };

    #[inline(always)]
    fn turned(&self, v: Vector3) -> Vector3 {
        plus(plus(times(self.columns[0], v[0]), times(self.columns[1], v[1])), times(self.columns[2], v[2]))
    }

    #[inline(always)]
    fn add(&mut self, [x, y, z, a, b, c]: &Six) {
        let turn = self.turned([*a, *b, *c]);
        self.shift = plus(self.shift, minus(self.turned([*x, *y, *z]), cross(turn, self.place)));
        self.turn = plus(self.turn, turn);
    }

    /// Past a joint at one of its nodes.
    #[inline(always)]
    fn past(&self, joint: &Joint, axis: &AxisTwists, node: usize) -> Self {
        let (mut next, q, twist) = (*self, axis.positions[node], &axis.nodes[node]);
        if let Some(constant) = &joint.constant {
            next.add(constant);
        }
        if let (Some(twist), true) = (twist, joint.outside) {
            next.add(twist);
        }
        match &joint.motion {
            Motion::Slide(u) => {
                if let Some(bend) = joint.bend {
                    next.shift = plus(next.shift, times(self.turned(bend), q));
                }
                next.place = plus(next.place, times(self.turned(*u), q));
            }
            Motion::Turn(about) => {
                let turn = axis.turns[node];
                let unit = Self::START.columns;
                next.columns = unit.map(|e| self.turned(about.turned(turn, e)));
                next.place = plus(next.place, self.turned(minus(joint.origin, about.turned(turn, joint.origin))));
            }
        }
        if let (Some(twist), false) = (twist, joint.outside) {
            next.add(twist);
        }
        next
    }
}

impl Inner {
    fn new(plan: &FirstOrder, joint: &Joint, axis: &AxisTwists) -> Self {
        let count = axis.positions.len();
        let padded = || vec![0.0; count.next_multiple_of(MOST)];
        let columns = || std::array::from_fn(|_| padded());
        let slide = match joint.motion {
            Motion::Slide(direction) => Some((direction, plan.tip)),
            Motion::Turn(_) => None,
        };
        let mut inner =
            Self { count, position: padded(), slide, point: columns(), displacement: columns(), rotation: columns() };
        inner.position[..count].copy_from_slice(&axis.positions);
        let plan = plan.inner(joint);
        let (mut ahead, mut states) = ([Ahead::NONE], States::NONE);
        let poses = Slices { axes: &[&axis.positions], added: &[], whole: axis.positions.len() };
        for at in 0..count {
            plan.ahead::<f64>(&mut ahead, &mut states, Part { poses, from: at, count: 1 });
            let [point, displacement, rotation] = states.alone(&plan);
            for k in 0..3 {
                inner.point[k][at] = point[k];
                inner.displacement[k][at] = displacement[k];
                inner.rotation[k][at] = rotation[k];
            }
        }
        inner
    }
}

impl Composed {
    /// On the nodes of a grid: their positions, axis by axis. `None` without axes.
    pub fn new(plan: &FirstOrder, positions: Vec<Vec<f64>>) -> Option<Self> {
        let twists = |(joint, positions): (&Joint, Vec<f64>)| {
            AxisNodes::new(positions, |q, turn| joint.curves.as_ref().map(|curves| curves.alone(q, turn)))
        };
        let mut outer: Vec<AxisTwists> = plan.joints.iter().zip(positions).map(twists).collect();
        let (last, joint) = (outer.pop()?, plan.joints.last()?);
        let inner = Inner::new(plan, joint, &last);
        Some(Self { plan: plan.clone(), outer, inner })
    }

    /// Level after every outer joint, from the joint `from` on, at these nodes.
    #[inline(always)]
    fn climb(&self, levels: &mut [Level], nodes: &[usize], from: usize) {
        for k in from..self.outer.len() {
            levels[k + 1] = levels[k].past(&self.plan.joints[k], &self.outer[k], nodes[k]);
        }
    }
}

/// Whole lines of a grid.
pub struct Lines<'a, 'o> {
    /// The grid.
    pub grid: &'a Composed,
    /// The first line, by the node of every outer axis.
    pub first: Vec<usize>,
    /// As many lines as there is room for.
    pub out: Output<'o>,
}

impl Kernel for Lines<'_, '_> {
    #[inline(always)]
    fn run<V: Lanes>(mut self) {
        let grid = self.grid;
        let lines = self.out.len() / grid.inner.count;
        let mut nodes = std::mem::take(&mut self.first);
        let mut levels = vec![Level::START; grid.outer.len() + 1];
        let mut from = 0;
        for line in 0..lines {
            grid.climb(&mut levels, &nodes, from);
            let level = levels[grid.outer.len()];
            match &grid.inner.slide {
                Some((direction, start)) => self.straight::<V>(line, &level, direction, start),
                None => self.round::<V>(line, &level),
            }
            from = advance(&mut nodes, |axis| grid.outer[axis].positions.len());
        }
    }
}

/// Three columns at a node.
#[inline(always)]
fn load<V: Lanes>(columns: &[Vec<f64>; 3], at: usize) -> [V; 3] {
    [V::load(&columns[0][at..]), V::load(&columns[1][at..]), V::load(&columns[2][at..])]
}

#[inline(always)]
fn splat_columns<V: Lanes>([a, b, c]: &[Vector3; 3]) -> [[V; 3]; 3] {
    [splat(a), splat(b), splat(c)]
}

impl Lines<'_, '_> {
    /// An inner linear axis.
    #[inline(always)]
    fn straight<V: Lanes>(&mut self, line: usize, level: &Level, direction: &Vector3, start: &Vector3) {
        let inner = &self.grid.inner;
        let slope = splat::<V>(&cross(level.turn, level.turned(*direction)));
        let base = splat::<V>(&plus(level.shift, cross(level.turn, plus(level.turned(*start), level.place))));
        let turn = splat::<V>(&level.turn);
        let columns = splat_columns::<V>(&level.columns);
        let mut i = 0;
        while i < inner.count {
            let q = V::load(&inner.position[i..]);
            let d = load::<V>(&inner.displacement, i);
            let w = load::<V>(&inner.rotation, i);
            let mut moved = [q; 3];
            let mut turned = [q; 3];
            for k in 0..3 {
                let sum = columns[0][k] * d[0] + columns[1][k] * d[1] + columns[2][k] * d[2];
                moved[k] = sum + (slope[k] * q + base[k]);
                turned[k] = columns[0][k] * w[0] + columns[1][k] * w[1] + columns[2][k] * w[2] + turn[k];
            }
            write(&mut self.out, line * inner.count + i, moved, turned);
            i += V::COUNT;
        }
    }

    /// An inner rotary axis.
    #[inline(always)]
    fn round<V: Lanes>(&mut self, line: usize, level: &Level) {
        let inner = &self.grid.inner;
        let base = splat::<V>(&plus(level.shift, cross(level.turn, level.place)));
        let turn = splat::<V>(&level.turn);
        let columns = splat_columns::<V>(&level.columns);
        let [a, b, c] = level.columns;
        let levers = splat_columns::<V>(&[cross(level.turn, a), cross(level.turn, b), cross(level.turn, c)]);
        let mut i = 0;
        while i < inner.count {
            let p = load::<V>(&inner.point, i);
            let d = load::<V>(&inner.displacement, i);
            let w = load::<V>(&inner.rotation, i);
            let (mut moved, mut turned) = (p, p);
            for k in 0..3 {
                let sum = columns[0][k] * d[0] + columns[1][k] * d[1] + columns[2][k] * d[2];
                let lever = levers[0][k] * p[0] + levers[1][k] * p[1] + levers[2][k] * p[2];
                moved[k] = sum + (lever + base[k]);
                turned[k] = columns[0][k] * w[0] + columns[1][k] * w[1] + columns[2][k] * w[2] + turn[k];
            }
            write(&mut self.out, line * inner.count + i, moved, turned);
            i += V::COUNT;
        }
    }
}
