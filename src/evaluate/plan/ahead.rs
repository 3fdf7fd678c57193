//! What is found out about a chunk of poses before their walk: places in the tables, sines and cosines.
//!
//! A walk that looked all this up itself would wait for it joint by joint, and compilers would keep the lanes of an index or
//! a share in a register and take them apart by shuffles, on the very port that transposes the rows. A chunk ahead
//! they lie in memory: an index is there when its row is due, and a share is an operand of its product. Measured with
//! AVX-512, order 1, in the cache: 26 ns per pose without, 17 with.

use super::batch::Slices;
use super::curves::{Curves, Spots};
use super::lanes::Lanes;
use super::trigonometry::sin_cos;

/// Poses of a chunk: whole vectors of any width, few enough that everything stays in the first cache.
pub const CHUNK: usize = 32;

/// Of one axis, at the poses of a chunk.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub struct Ahead {
    spots: Spots<CHUNK>,
    sine: [f64; CHUNK],
    cosine: [f64; CHUNK],
}

/// What a walk wants to know at an axis.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// The sine and cosine of the position?
    pub turns: bool,
    /// These curves at it.
    pub curves: Option<&'a Curves>,
}

impl Ahead {
    /// Of nothing yet.
    pub const NONE: Self = Self { spots: Spots::NONE, sine: [0.0; CHUNK], cosine: [0.0; CHUNK] };

    /// Finds it out for `count` poses, whole vectors.
    #[inline(always)]
    pub fn look<V: Lanes>(&mut self, wanted: Wanted<'_>, poses: &Slices<'_>, axis: usize, from: usize, count: usize) {
        let mut i = 0;
        while i < count {
            let q = V::load(&poses.axes[axis][from + i..]);
            if wanted.turns {
                let (sine, cosine) = sin_cos(q);
                sine.store(&mut self.sine[i..]);
                cosine.store(&mut self.cosine[i..]);
            }
            if let Some(curves) = wanted.curves {
                let there = match poses.added.get(axis) {
                    Some(column) => q + V::load(&column[from + i..]),
                    None => q,
                };
                curves.locate(there, &mut self.spots, i);
            }
            i += V::COUNT;
        }
    }
}

/// What a walk reads, axis by axis. `Node` is what the walk makes of the six errors, where that is known beforehand.
pub trait Inputs<V: Lanes, Node>: Copy {
    /// Position.
    fn position(self, axis: usize) -> V;
    /// What is added to it for the real machine only.
    fn added(self, axis: usize) -> Option<V>;
    /// Sine and cosine of the position, where wanted.
    fn turn(self, axis: usize) -> (V, V);
    /// The errors of the axis, whose curves these are, at a position with this sine and cosine.
    fn six(self, axis: usize, curves: &Curves, position: V, turn: (V, V)) -> [V; 6];
    /// What these errors come to, the same in all lanes.
    fn known(&self, axis: usize) -> Option<&Node>;
}

/// Of a vector of poses of a batch.
#[derive(Debug, Clone, Copy)]
pub struct Scattered<'a> {
    /// The batch.
    pub poses: Slices<'a>,
    /// The first pose of the vector.
    pub at: usize,
    /// What was found out, by axis.
    pub axes: &'a [Ahead],
    /// The first pose within the chunk.
    pub i: usize,
}

impl<V: Lanes, Node> Inputs<V, Node> for Scattered<'_> {
    #[inline(always)]
    fn position(self, axis: usize) -> V {
        V::load(&self.poses.axes[axis][self.at..])
    }

    #[inline(always)]
    fn added(self, axis: usize) -> Option<V> {
        match self.poses.added.get(axis) {
            Some(column) => Some(V::load(&column[self.at..])),
            None => None,
        }
    }

    #[inline(always)]
    fn turn(self, axis: usize) -> (V, V) {
        let Ahead { sine, cosine, .. } = &self.axes[axis];
        (V::load(&sine[self.i..]), V::load(&cosine[self.i..]))
    }

    #[inline(always)]
    fn six(self, axis: usize, curves: &Curves, position: V, turn: (V, V)) -> [V; 6] {
        curves.at(position, turn, (&self.axes[axis].spots, self.i))
    }

    #[inline(always)]
    fn known(&self, _: usize) -> Option<&Node> {
        None
    }
}
