//! One pass over a batch: chunk by chunk the look-up ahead, then vector by vector the walk of the order.

use super::batch::{Output, Slices};
use super::lanes::{prefetch, store_fence};
use super::lookup::{AxisLookup, CHUNK, Chunk, PoseInputs};
use super::simd::{Kernel, Lanes};
use super::vector::Vector;
use std::ops::Range;

/// The walk of an order over the chain: deviations at poses, a pose per lane.
pub trait PoseKernel {
    /// Data that the kernel keeps for a chunk of poses, beside those of each axis.
    type Workspace;
    /// The workspace before the first chunk.
    const EMPTY: Self::Workspace;

    /// Looks up everything that a chunk of poses needs before the walk.
    fn lookup<V: Lanes>(&self, axes: &mut [AxisLookup], workspace: &mut Self::Workspace, chunk: Chunk<'_>);

    /// Returns the deviations at one vector of poses of the chunk.
    fn at<V: Lanes>(&self, workspace: &Self::Workspace, inputs: PoseInputs<'_>) -> LaneDeviation<V>;
}

/// Deviations at a vector of poses, unturned workpiece frame.
#[derive(Debug, Clone, Copy)]
pub struct LaneDeviation<V> {
    /// Displacement of the functional point, mm.
    pub position: Vector<V>,
    /// Rotation vector of the tool, rad.
    pub rotation: Vector<V>,
    /// Largest squared half angle met on the walk, rad^2: above [`MAX_SQUARED_HALF_ANGLE`] the general algebra takes
    /// over.
    pub squared_half_angle: V,
}

/// Squared half angle (rad^2) up to which the series of the kernels are exact to rounding: rotations of 0.3 rad.
pub const MAX_SQUARED_HALF_ANGLE: f64 = 0.0225;

/// Doubles of a cache line.
const LINE: usize = 8;

/// Batches up to this number of poses fit into the second cache with their deviations.
const CACHE_POSES: usize = 1 << 14;

/// Above this number of poses the deviations (12 MB) would evict everything else from the caches before they are read
/// again.
const STREAM_ABOVE: usize = 1 << 18;

/// Distance of prefetches in poses: as short as latency permits, for the tables of five axes almost fill the first
/// cache.
const PREFETCH_DISTANCE: usize = 2 * CHUNK;

/// A kernel over a batch of at least one vector of poses.
pub struct Pass<'a, 'o, T> {
    /// The kernel.
    pub kernel: &'a T,
    /// The poses.
    pub poses: Slices<'a>,
    /// The deviations.
    pub out: Output<'o>,
    /// Indices of the poses whose rotations exceed the kernel's range.
    pub uncovered: &'a mut Vec<usize>,
}

struct ChunkData<W> {
    axes: Vec<AxisLookup>,
    workspace: W,
}

/// Use of the batch's memory by the pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum MemoryAccess {
    /// Everything fits into the caches: no prefetch.
    InCache,
    /// Lines are prefetched before they are read or written.
    Prefetch,
    /// Lines are prefetched before they are read; deviations are stored past the caches.
    Stream,
}

impl<T: PoseKernel> Kernel for Pass<'_, '_, T> {
    #[inline(always)]
    fn run<V: Lanes>(mut self) {
        let mut data = ChunkData { axes: vec![AxisLookup::NONE; self.poses.axes.len()], workspace: T::EMPTY };
        let count = self.out.len();
        let access = match self.poses.whole {
            0..=CACHE_POSES => MemoryAccess::InCache,
            _ if V::FILLS_CACHE_LINE && self.poses.whole > STREAM_ABOVE => MemoryAccess::Stream,
            _ => MemoryAccess::Prefetch,
        };
        // Vectors are to be whole cache lines: the poses before the first line are a chunk of their own, and the last
        // vector ends where the batch does. Both overlap other vectors, with the same bits.
        let before =
            if access == MemoryAccess::InCache || count < LINE { 0 } else { doubles_before_line(self.out.position[0]) };
        let mut from = 0;
        while from < count {
            let start = from.min(count - V::COUNT);
            let room = (count - start) / V::COUNT * V::COUNT;
            let (end, next) = match from {
                0 if before > 0 => (before.next_multiple_of(V::COUNT), before),
                _ => (start + room.min(CHUNK), start + room.min(CHUNK)),
            };
            self.chunk::<V>(&mut data, start..end, access);
            from = next;
        }
        if access == MemoryAccess::Stream {
            store_fence();
        }
    }
}

/// Returns the number of doubles before the first that begins a cache line.
fn doubles_before_line(column: &[f64]) -> usize {
    column.as_ptr().align_offset(64).min(LINE - 1)
}

impl<T: PoseKernel> Pass<'_, '_, T> {
    /// Prefetches the columns at a pose: eleven are more than a hardware prefetcher follows.
    #[inline(always)]
    fn prefetch(&self, at: usize, access: MemoryAccess) {
        if access != MemoryAccess::InCache {
            for column in self.poses.axes {
                prefetch(column, at);
            }
        }
        if access == MemoryAccess::Prefetch {
            for column in self.out.position.iter().chain(&self.out.rotation) {
                prefetch(column, at);
            }
        }
    }

    #[inline(always)]
    fn chunk<V: Lanes>(
        &mut self,
        ChunkData { axes, workspace }: &mut ChunkData<T::Workspace>,
        range: Range<usize>,
        access: MemoryAccess,
    ) {
        let Range { start, end } = range;
        self.kernel.lookup::<V>(axes, workspace, Chunk { poses: self.poses, from: start, count: end - start });
        let mut at = start;
        while at < end {
            if (at - start).is_multiple_of(LINE) {
                self.prefetch(at + PREFETCH_DISTANCE, access);
            }
            // The mask changes nothing; it shows the compiler that the vector lies within the chunk.
            let i = (at - start) & (CHUNK - V::COUNT);
            self.step::<V>(workspace, PoseInputs { poses: self.poses, at, axes, i }, access);
            at += V::COUNT;
        }
    }

    #[inline(always)]
    fn step<V: Lanes>(&mut self, workspace: &T::Workspace, inputs: PoseInputs<'_>, access: MemoryAccess) {
        let at = inputs.at;
        let LaneDeviation { position: d, rotation: w, squared_half_angle } = self.kernel.at::<V>(workspace, inputs);
        for k in 0..3 {
            let (position, rotation) = (&mut self.out.position[k][at..], &mut self.out.rotation[k][at..]);
            if access == MemoryAccess::Stream {
                d[k].store_streaming(position);
                w[k].store_streaming(rotation);
            } else {
                d[k].store(position);
                w[k].store(rotation);
            }
        }
        for (lane, square) in squared_half_angle.to_array().iter().enumerate().take(V::COUNT) {
            if *square > MAX_SQUARED_HALF_ANGLE {
                self.uncovered.push(at + lane);
            }
        }
    }
}
