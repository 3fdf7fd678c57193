//! Quantities that are computed for a chunk of poses before their walk: positions in the tables, sines, cosines, and
//! errors.
//!
//! A walk that looked this up itself would wait for it joint by joint, and compilers would keep the lanes of an index
//! or of a fraction in a register and take them apart by shuffles, on the very port that transposes the rows. Computed
//! a chunk ahead they lie in memory: an index is there when its row is due, and a fraction is an operand of its
//! product. Measured with AVX-512, order 1, in the cache: 26 ns per pose without, 17 with. The errors of order 2 and of
//! the exact model are looked up ahead too (6 % less time); order 1 sums rows instead: its walk is short, and the
//! stores would cost as much as they gain.

use super::batch::Slices;
use super::curves::{CompiledCurves, TablePositions, TableVector};
use super::simd::Lanes;
use super::trigonometry::{sin_cos, sines_cosines};

/// Poses of a chunk: a multiple of every vector width, few enough that all their data stay in the first cache.
pub const CHUNK: usize = 32;

/// Data of one axis at the poses of a chunk.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub struct AxisLookup {
    table: TablePositions<CHUNK>,
    sine: [f64; CHUNK],
    cosine: [f64; CHUNK],
    /// The six errors (mm, rad) of axes whose rows are not summed.
    errors: [[f64; CHUNK]; 6],
}

/// Consecutive poses of a batch: whole vectors, at most [`CHUNK`] poses.
#[derive(Debug, Clone, Copy)]
pub struct Chunk<'a> {
    /// The batch.
    pub poses: Slices<'a>,
    /// Index of the first pose.
    pub from: usize,
    /// Number of poses.
    pub count: usize,
}

impl Chunk<'_> {
    /// Returns the positions (mm or deg) of an axis.
    #[inline(always)]
    pub fn positions(&self, axis: usize) -> &[f64] {
        &self.poses.axes[axis][self.from..self.from + self.count]
    }
}

/// Data that the walk of an order reads at an axis.
#[derive(Debug, Clone, Copy)]
pub struct LookupRequest<'a> {
    /// True if it reads the sine and cosine of the position.
    pub turns: bool,
    /// The error curves that it reads.
    pub curves: Option<&'a CompiledCurves>,
}

impl AxisLookup {
    /// Data before any look-up.
    pub const NONE: Self =
        Self { table: TablePositions::NONE, sine: [0.0; CHUNK], cosine: [0.0; CHUNK], errors: [[0.0; CHUNK]; 6] };

    /// Computes sines, cosines and positions in the table for one axis.
    #[inline(always)]
    pub fn fill<V: Lanes>(&mut self, request: LookupRequest<'_>, axis: usize, chunk: Chunk<'_>) {
        let positions = chunk.positions(axis);
        if request.turns {
            self.fill_sines::<V>(positions);
        }
        match (request.curves, chunk.poses.added.get(axis)) {
            (Some(curves), None) => curves.locate::<V, CHUNK>(positions, &mut self.table),
            (Some(curves), Some(added)) => {
                let mut actual = [0.0; CHUNK];
                let actual = &mut actual[..chunk.count];
                for (i, q) in actual.iter_mut().enumerate() {
                    *q = positions[i] + added[chunk.from + i];
                }
                curves.locate::<V, CHUNK>(actual, &mut self.table);
            }
            (None, _) => {}
        }
    }

    /// Computes the six errors of an axis whose positions in the table are known.
    #[inline(always)]
    pub fn fill_errors<V: Lanes>(&mut self, curves: &CompiledCurves, axis: usize, chunk: Chunk<'_>) {
        let mut i = 0;
        while i < chunk.count {
            let (mut q, mut turn) =
                (V::load(&chunk.poses.axes[axis][chunk.from + i..]), (V::splat(0.0), V::splat(0.0)));
            if curves.has_harmonics() {
                turn = (V::load(&self.sine[i..]), V::load(&self.cosine[i..]));
            }
            if let Some(added) = chunk.poses.added.get(axis) {
                q = q + V::load(&added[chunk.from + i..]);
                if curves.has_harmonics() {
                    turn = sin_cos(q);
                }
            }
            let six = curves.at(q, turn, self.table_vector(i));
            for k in 0..6 {
                six[k].store(&mut self.errors[k][i..]);
            }
            i += V::COUNT;
        }
    }

    /// Returns the positions in the table of the vector that begins at pose i of the chunk.
    #[inline(always)]
    pub fn table_vector(&self, i: usize) -> TableVector<'_, CHUNK> {
        TableVector { positions: &self.table, at: i }
    }

    /// Returns the six errors from pose i of the chunk on, if they were computed.
    #[inline(always)]
    pub fn errors<V: Lanes>(&self, i: usize) -> [V; 6] {
        let mut six = [V::splat(0.0); 6];
        for k in 0..6 {
            six[k] = V::load(&self.errors[k][i..]);
        }
        six
    }

    /// Returns sine and cosine of the positions from pose i of the chunk on, if they were computed.
    #[inline(always)]
    pub fn turn<V: Lanes>(&self, i: usize) -> (V, V) {
        (V::load(&self.sine[i..]), V::load(&self.cosine[i..]))
    }

    #[inline(always)]
    fn fill_sines<V: Lanes>(&mut self, positions: &[f64]) {
        let i = self.fill_sines_of::<V, 2>(positions, 0);
        let _ = self.fill_sines_of::<V, 1>(positions, i);
    }

    /// Computes N vectors at a time from position i on while N remain; returns the first position not done.
    #[inline(always)]
    fn fill_sines_of<V: Lanes, const N: usize>(&mut self, positions: &[f64], mut i: usize) -> usize {
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

/// Source of the data that a walk reads, axis by axis.
pub trait LaneInputs<V: Lanes>: Copy {
    /// Returns the position, mm or deg.
    fn position(self, axis: usize) -> V;
    /// Returns what the command adds to the position of the actual machine only; `None` without commands.
    fn added(self, axis: usize) -> Option<V>;
    /// Returns sine and cosine of the position, if the axis reads them.
    fn turn(self, axis: usize) -> (V, V);
    fn errors(self, axis: usize) -> [V; 6];
}

/// Data of one vector of poses of a batch.
#[derive(Debug, Clone, Copy)]
pub struct PoseInputs<'a> {
    /// The batch.
    pub poses: Slices<'a>,
    /// Index of the first pose of the vector in the batch.
    pub at: usize,
    /// Data looked up, by axis.
    pub axes: &'a [AxisLookup],
    /// Index of the first pose within the chunk.
    pub i: usize,
}

impl<V: Lanes> LaneInputs<V> for PoseInputs<'_> {
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
    fn errors(self, axis: usize) -> [V; 6] {
        self.axes[axis].errors(self.i)
    }
}
