//! What is found out about a chunk of poses before their walk: places in the tables, sines and cosines, and errors.
//!
//! A walk that looked all this up itself would wait for it joint by joint, and compilers would keep the lanes of an index or
//! a share in a register and take them apart by shuffles, on the very port that transposes the rows. A chunk ahead
//! they lie in memory: an index is there when its row is due, and a share is an operand of its product. Measured with
//! AVX-512, order 1, in the cache: 26 ns per pose without, 17 with. Orders 2 and exact have their errors looked up ahead too
//! (6 % less time); order 1, which sums them, does not: its walk is short, and the stores would take what is won.

use super::batch::Slices;
use super::curves::{Curves, Spots};
use super::simd::Lanes;
use super::trigonometry::{sin_cos, sines_cosines};

/// Poses of a chunk: whole vectors of any width, few enough that everything stays in the first cache.
pub const CHUNK: usize = 32;

/// Of one axis, at the poses of a chunk.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub struct Lookup {
    spots: Spots<CHUNK>,
    sine: [f64; CHUNK],
    cosine: [f64; CHUNK],
    /// The six errors, of axes that are not summed.
    errors: [[f64; CHUNK]; 6],
}

/// Some poses of a batch: whole vectors, at most a chunk.
#[derive(Debug, Clone, Copy)]
pub struct Part<'a> {
    /// The batch.
    pub poses: Slices<'a>,
    /// The first pose.
    pub from: usize,
    /// How many.
    pub count: usize,
}

impl Part<'_> {
    /// Their positions of an axis.
    #[inline(always)]
    pub fn positions(&self, axis: usize) -> &[f64] {
        &self.poses.axes[axis][self.from..self.from + self.count]
    }
}

/// What a walk wants to know at an axis.
#[derive(Debug, Clone, Copy)]
pub struct LookupRequest<'a> {
    /// The sine and cosine of the position?
    pub turns: bool,
    /// These curves at it.
    pub curves: Option<&'a Curves>,
}

impl Lookup {
    /// Of nothing yet.
    pub const NONE: Self =
        Self { spots: Spots::NONE, sine: [0.0; CHUNK], cosine: [0.0; CHUNK], errors: [[0.0; CHUNK]; 6] };

    /// Sines, cosines and places of an axis.
    #[inline(always)]
    pub fn look<V: Lanes>(&mut self, wanted: LookupRequest<'_>, axis: usize, part: Part<'_>) {
        let positions = part.positions(axis);
        if wanted.turns {
            self.turns::<V>(positions);
        }
        match (wanted.curves, part.poses.added.get(axis)) {
            (Some(curves), None) => curves.locate::<V, CHUNK>(positions, &mut self.spots),
            (Some(curves), Some(added)) => {
                let mut there = [0.0; CHUNK];
                let there = &mut there[..part.count];
                for (i, q) in there.iter_mut().enumerate() {
                    *q = positions[i] + added[part.from + i];
                }
                curves.locate::<V, CHUNK>(there, &mut self.spots);
            }
            (None, _) => {}
        }
    }

    /// The six errors of an axis, once its places are known.
    #[inline(always)]
    pub fn six<V: Lanes>(&mut self, curves: &Curves, axis: usize, part: Part<'_>) {
        let mut i = 0;
        while i < part.count {
            let (mut q, mut turn) = (V::load(&part.poses.axes[axis][part.from + i..]), (V::splat(0.0), V::splat(0.0)));
            if curves.has_waves() {
                turn = (V::load(&self.sine[i..]), V::load(&self.cosine[i..]));
            }
            if let Some(added) = part.poses.added.get(axis) {
                q = q + V::load(&added[part.from + i..]);
                if curves.has_waves() {
                    turn = sin_cos(q);
                }
            }
            let six = curves.at(q, turn, (&self.spots, i));
            for k in 0..6 {
                six[k].store(&mut self.errors[k][i..]);
            }
            i += V::COUNT;
        }
    }

    /// Where the positions from the i-th on lie in their table.
    #[inline(always)]
    pub fn spots(&self, i: usize) -> (&Spots<CHUNK>, usize) {
        (&self.spots, i)
    }

    /// The six errors, where they are looked up ahead.
    #[inline(always)]
    pub fn errors<V: Lanes>(&self, i: usize) -> [V; 6] {
        let mut six = [V::splat(0.0); 6];
        for k in 0..6 {
            six[k] = V::load(&self.errors[k][i..]);
        }
        six
    }

    /// Sine and cosine of the positions, where wanted.
    #[inline(always)]
    pub fn turn<V: Lanes>(&self, i: usize) -> (V, V) {
        (V::load(&self.sine[i..]), V::load(&self.cosine[i..]))
    }

    #[inline(always)]
    fn turns<V: Lanes>(&mut self, positions: &[f64]) {
        let i = self.turn_abreast::<V, 2>(positions, 0);
        let _ = self.turn_abreast::<V, 1>(positions, i);
    }

    /// From a position on, until fewer are left; returns how far it came.
    #[inline(always)]
    fn turn_abreast<V: Lanes, const N: usize>(&mut self, positions: &[f64], mut i: usize) -> usize {
        while i + N * V::COUNT <= positions.len() {
            let mut degrees = [V::splat(0.0); N];
            for k in 0..N {
                degrees[k] = V::load(&positions[i + k * V::COUNT..]);
            }
            let (sine, cosine) = sines_cosines(degrees);
            for k in 0..N {
                sine[k].store(&mut self.sine[i + k * V::COUNT..]);
                cosine[k].store(&mut self.cosine[i + k * V::COUNT..]);
            }
            i += N * V::COUNT;
        }
        i
    }
}

/// What a walk reads, axis by axis.
pub trait Inputs<V: Lanes>: Copy {
    /// Position.
    fn position(self, axis: usize) -> V;
    /// What is added to it for the real machine only.
    fn added(self, axis: usize) -> Option<V>;
    /// Sine and cosine of the position, where wanted.
    fn turn(self, axis: usize) -> (V, V);
    /// The errors of the axis.
    fn six(self, axis: usize) -> [V; 6];
}

/// Of a vector of poses of a batch.
#[derive(Debug, Clone, Copy)]
pub struct Scattered<'a> {
    /// The batch.
    pub poses: Slices<'a>,
    /// The first pose of the vector.
    pub at: usize,
    /// What was found out, by axis.
    pub axes: &'a [Lookup],
    /// The first pose within the chunk.
    pub i: usize,
}

impl<V: Lanes> Inputs<V> for Scattered<'_> {
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
        self.axes[axis].turn(self.i)
    }

    #[inline(always)]
    fn six(self, axis: usize) -> [V; 6] {
        self.axes[axis].errors(self.i)
    }
}
