//! Statistics of deviations that are not kept: sums, extremes, a sketch of the quantile, the worst poses.
//!
//! Tallies are merged in any order. Counts, extremes and the worst poses do not depend on how the poses were divided;
//! the sums are kept block by block and added up in the order of the blocks, so the result is the same to the bit on
//! any number of threads, as long as the blocks are the same. Within a block eight poses are summed side by side, at
//! any vector width.
//!
//! The sketch counts lengths in buckets: 1024 per power of two, from 2^-50 mm (or rad) to 2^14. Its quantile is the
//! middle of the bucket that holds the exact one: within 0.05 % ([`Tally::QUANTILE_ERROR`]), whatever the distribution.
//! It allocates the powers of two that occur.

#![allow(clippy::needless_range_loop, reason = "kernels have plain loops: see `compiled`")]

use super::compiled::batch::Columns;
use super::compiled::lanes::run;
use super::compiled::simd::{Kernel, Lanes};
use super::compiled::width::Width;
use super::statistics::{Statistics, Summary};
use super::terms::Deviation;
use std::collections::BinaryHeap;

/// Statistics of the deviations added so far.
#[derive(Debug, Clone)]
pub struct Tally {
    poses: u64,
    /// Statistics of positions (mm) and of rotations (rad).
    lengths: [LengthStatistics; 2],
    blocks: Vec<BlockSums>,
    worst: BinaryHeap<Worst>,
    max_worst: usize,
    width: Width,
}

/// Index of a block's first pose; sum and sum of squares of the lengths of positions and of rotations.
#[derive(Debug, Clone, Copy)]
struct BlockSums {
    first: usize,
    sums: [[f64; 2]; 2],
}

/// Extremes and sketch of the lengths of one kind of vectors.
#[derive(Debug, Clone)]
struct LengthStatistics {
    max: f64,
    range: [(f64, f64); 3],
    sketch: Sketch,
}

/// Number of lengths in each bucket, for the powers of two from the smallest length to the largest.
#[derive(Debug, Clone, Default)]
struct Sketch {
    /// Index of the first allocated bucket, at which a power of two begins.
    first: usize,
    counts: Vec<u64>,
    /// Number of lengths in bucket 0 while it was not allocated: mainly zeros.
    below_range: u64,
}

/// A pose among the worst; the greatest is the one to be dropped first.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Worst {
    length: f64,
    index: usize,
    deviation: Deviation,
}

impl Eq for Worst {}

impl Ord for Worst {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        other.length.total_cmp(&self.length).then(self.index.cmp(&other.index))
    }
}

impl PartialOrd for Worst {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// Buckets per power of two: 10 bits of the mantissa are kept.
const POWER: usize = 1 << 10;
/// Number of bits of a double that do not affect its bucket.
const BELOW: u32 = 42;
/// Bits of 2^-50 above [`BELOW`]: the first bucket.
const FIRST: u64 = (1023 - 50) << 10;
const BUCKETS: usize = 64 * POWER;

impl Sketch {
    #[inline(always)]
    fn count(&mut self, length: f64) {
        let cut = length.to_bits() >> BELOW;
        // A length beyond all buckets has no counter either.
        match self.counts.get_mut(cut.wrapping_sub(FIRST + self.first as u64) as usize) {
            Some(count) => *count += 1,
            None => self.count_out_of_range(cut),
        }
    }

    /// Counts a length whose bucket is not allocated, or that is beyond the first or the last.
    #[inline(never)]
    fn count_out_of_range(&mut self, cut: u64) {
        let bucket = (cut.saturating_sub(FIRST) as usize).min(BUCKETS - 1);
        match self.counts.get_mut(bucket.wrapping_sub(self.first)) {
            Some(count) => *count += 1,
            None if bucket == 0 => self.below_range += 1,
            None => {
                self.allocate(bucket, bucket + 1);
                self.counts[bucket - self.first] += 1;
            }
        }
    }

    /// Allocates the powers of two of a range of buckets.
    #[cold]
    fn allocate(&mut self, from: usize, to: usize) {
        let (from, to) = (from / POWER * POWER, to.next_multiple_of(POWER));
        let (old_from, old_to) = (self.first, self.first + self.counts.len());
        let (from, to) = if self.counts.is_empty() { (from, to) } else { (from.min(old_from), to.max(old_to)) };
        let mut counts = vec![0; to - from];
        if !self.counts.is_empty() {
            counts[old_from - from..old_to - from].copy_from_slice(&self.counts);
        }
        (self.first, self.counts) = (from, counts);
    }

    fn merge(&mut self, other: &Self) {
        self.below_range += other.below_range;
        if !other.counts.is_empty() {
            self.allocate(other.first, other.first + other.counts.len());
            let at = other.first - self.first;
            self.counts[at..].iter_mut().zip(&other.counts).for_each(|(sum, count)| *sum += count);
        }
    }

    /// Returns the middle of the bucket that holds the length of this rank (from 1); `None` if that is the first
    /// bucket.
    fn quantile(&self, rank: u64) -> Option<f64> {
        let mut seen = self.below_range;
        let place = self.counts.iter().position(|count| {
            seen += count;
            seen >= rank
        });
        let bucket = place.filter(|_| self.below_range < rank)? + self.first;
        let edge = |bucket: usize| f64::from_bits((FIRST + bucket as u64) << BELOW);
        (bucket > 0).then(|| 0.5 * (edge(bucket) + edge(bucket + 1)))
    }
}

/// Sums and extremes of a block, eight poses side by side.
struct Accumulators {
    sum: [f64; 8],
    squares: [f64; 8],
    max: [f64; 8],
    low: [[f64; 8]; 3],
    high: [[f64; 8]; 3],
}

impl Accumulators {
    const NONE: Self = Self {
        sum: [0.0; 8],
        squares: [0.0; 8],
        max: [0.0; 8],
        low: [[f64::INFINITY; 8]; 3],
        high: [[f64::NEG_INFINITY; 8]; 3],
    };

    /// Adds eight vectors; returns their lengths.
    #[inline(always)]
    fn add(&mut self, vectors: [&[f64; 8]; 3]) -> [f64; 8] {
        let squares = squares(vectors);
        let mut lengths = [0.0; 8];
        for k in 0..8 {
            lengths[k] = squares[k].sqrt();
            self.sum[k] += lengths[k];
            self.squares[k] += squares[k];
            self.max[k] = if lengths[k] > self.max[k] { lengths[k] } else { self.max[k] };
        }
        for axis in 0..3 {
            let (values, low, high) = (vectors[axis], &mut self.low[axis], &mut self.high[axis]);
            for k in 0..8 {
                low[k] = if values[k] < low[k] { values[k] } else { low[k] };
                high[k] = if values[k] > high[k] { values[k] } else { high[k] };
            }
        }
        lengths
    }
}

#[inline(always)]
fn squares([x, y, z]: [&[f64; 8]; 3]) -> [f64; 8] {
    let mut squares = [0.0; 8];
    for k in 0..8 {
        squares[k] = x[k] * x[k] + y[k] * y[k] + z[k] * z[k];
    }
    squares
}

/// Returns the first `len` numbers of each column in groups of eight, and the remainder.
#[inline(always)]
fn eights(columns: &[Vec<f64>; 3], len: usize) -> ([&[[f64; 8]]; 3], [&[f64]; 3]) {
    let [(x, a), (y, b), (z, c)] = columns.each_ref().map(|column| column[..len].as_chunks::<8>());
    ([x, y, z], [a, b, c])
}

impl LengthStatistics {
    const NONE: Self = Self {
        max: 0.0,
        range: [(f64::INFINITY, f64::NEG_INFINITY); 3],
        sketch: Sketch { first: 0, counts: Vec::new(), below_range: 0 },
    };

    /// Adds a block; returns its largest length, and its sum and sum of squares.
    #[inline(always)]
    fn add(&mut self, columns: &[Vec<f64>; 3], len: usize) -> (f64, [f64; 2]) {
        let ([x, y, z], rest) = eights(columns, len);
        let mut block = Accumulators::NONE;
        for ((x, y), z) in x.iter().zip(y).zip(z) {
            let lengths = block.add([x, y, z]);
            for k in 0..8 {
                self.sketch.count(lengths[k]);
            }
        }
        self.add_rest(&mut block, rest);
        for axis in 0..3 {
            let (low, high) = &mut self.range[axis];
            *low = block.low[axis].iter().fold(*low, |low, x| low.min(*x));
            *high = block.high[axis].iter().fold(*high, |high, x| high.max(*x));
        }
        let max = block.max.into_iter().fold(0.0, f64::max);
        self.max = self.max.max(max);
        (max, [block.sum.iter().sum(), block.squares.iter().sum()])
    }

    /// Adds fewer than eight vectors: padded with the first, which changes no extreme, and does not enter the sums.
    fn add_rest(&mut self, block: &mut Accumulators, rest: [&[f64]; 3]) {
        let count = rest[0].len();
        if count == 0 {
            return;
        }
        let (sum, squares) = (block.sum, block.squares);
        let padded = rest.map(|rest| {
            let mut eight = [rest[0]; 8];
            eight[..count].copy_from_slice(rest);
            eight
        });
        let lengths = block.add(padded.each_ref());
        lengths[..count].iter().for_each(|length| self.sketch.count(*length));
        block.sum[count..].copy_from_slice(&sum[count..]);
        block.squares[count..].copy_from_slice(&squares[count..]);
    }

    fn merge(&mut self, other: &Self) {
        self.max = self.max.max(other.max);
        for ((low, high), (l, h)) in self.range.iter_mut().zip(other.range) {
            (*low, *high) = (low.min(l), high.max(h));
        }
        self.sketch.merge(&other.sketch);
    }

    fn summary(&self, poses: u64, [sum, squares]: [f64; 2], unit: f64) -> Summary {
        let count = poses as f64;
        Summary {
            max: self.max * unit,
            mean: sum / count * unit,
            rms: (squares / count).sqrt() * unit,
            p95: self.sketch.quantile((95 * poses).div_ceil(100)).unwrap_or(0.0).min(self.max) * unit,
            range: self.range.map(|(low, high)| (high - low) * unit),
        }
    }
}

/// The addition of a block, compiled for every width, with the same bits.
struct TallyBlock<'a> {
    tally: &'a mut Tally,
    first: usize,
    columns: &'a Columns,
    len: usize,
}

impl Kernel for TallyBlock<'_> {
    #[inline(always)]
    fn run<V: Lanes>(self) {
        let Self { tally, first, columns, len } = self;
        let (longest, position) = tally.lengths[0].add(&columns.position, len);
        let (_, rotation) = tally.lengths[1].add(&columns.rotation, len);
        tally.poses += len as u64;
        tally.blocks.push(BlockSums { first, sums: [position, rotation] });
        if longest >= tally.worst_threshold() {
            tally.look_for_worst(first, columns, len);
        }
    }
}

impl Tally {
    /// Largest relative error of the 95 % quantile.
    pub const QUANTILE_ERROR: f64 = 1.0 / 2048.0;

    /// Returns an empty tally that will keep the `max_worst` worst poses.
    pub fn new(max_worst: usize) -> Self {
        let lengths = [LengthStatistics::NONE, LengthStatistics::NONE];
        Self { poses: 0, lengths, blocks: Vec::new(), worst: BinaryHeap::new(), max_worst, width: Width::widest() }
    }

    /// Returns the tally with vectors of this width; a width that the processor lacks runs as [`Width::Scalar`].
    #[must_use]
    pub fn with_width(mut self, width: Width) -> Self {
        self.width = width;
        self
    }

    /// Adds a block: the first `len` deviations of the columns (mm, rad); the first has index `first`.
    pub fn add(&mut self, first: usize, columns: &Columns, len: usize) {
        run(self.width, TallyBlock { tally: self, first, columns, len });
    }

    /// Returns the length (mm) below which a pose is not among the worst.
    fn worst_threshold(&self) -> f64 {
        if self.worst.len() < self.max_worst {
            0.0
        } else {
            self.worst.peek().map_or(f64::INFINITY, |worst| worst.length)
        }
    }

    /// Returns the square of the threshold, reduced by its rounding error.
    fn squared_threshold(&self) -> f64 {
        let threshold = self.worst_threshold();
        threshold * threshold * (1.0 - 1e-14)
    }

    #[inline(always)]
    fn look_for_worst(&mut self, first: usize, columns: &Columns, len: usize) {
        let ([x, y, z], rest) = eights(&columns.position, len);
        let mut threshold = self.squared_threshold();
        for at in 0..x.len() {
            let squares = squares([&x[at], &y[at], &z[at]]);
            let mut found = false;
            for k in 0..8 {
                found |= squares[k] >= threshold || squares[k].is_nan();
            }
            if found {
                self.keep(first, columns, 8 * at..8 * at + 8);
                threshold = self.squared_threshold();
            }
        }
        self.keep(first, columns, len - rest[0].len()..len);
    }

    #[inline(never)]
    fn keep(&mut self, first: usize, columns: &Columns, range: std::ops::Range<usize>) {
        for i in range {
            let deviation = columns.get(i);
            self.keep_one(Worst { length: deviation.position.norm(), index: first + i, deviation });
        }
    }

    fn keep_one(&mut self, worst: Worst) {
        if self.worst.len() < self.max_worst {
            self.worst.push(worst);
        } else if self.worst.peek().is_some_and(|last| worst < *last) {
            let _ = self.worst.pop();
            self.worst.push(worst);
        }
    }

    /// Returns the tally of the poses of both.
    #[must_use]
    pub fn merge(mut self, other: Self) -> Self {
        self.poses += other.poses;
        for (kind, others) in self.lengths.iter_mut().zip(&other.lengths) {
            kind.merge(others);
        }
        self.blocks.extend(other.blocks);
        other.worst.into_iter().for_each(|worst| self.keep_one(worst));
        self
    }

    /// Returns the statistics of all poses; the quantiles are those of the sketch.
    pub fn statistics(&self) -> Statistics {
        if self.poses == 0 {
            return Statistics::of(&[]);
        }
        let mut blocks: Vec<&BlockSums> = self.blocks.iter().collect();
        blocks.sort_unstable_by_key(|block| block.first);
        let total = |kind: usize| [0, 1].map(|k| blocks.iter().map(|block| block.sums[kind][k]).sum());
        Statistics {
            poses: self.poses as usize,
            position_um: self.lengths[0].summary(self.poses, total(0), 1e3),
            rotation_urad: self.lengths[1].summary(self.poses, total(1), 1e6),
        }
    }

    /// Returns the worst poses by index with their deviations: largest first; of equal ones the first.
    pub fn worst(&self) -> Vec<(usize, Deviation)> {
        let sorted = self.worst.clone().into_sorted_vec();
        sorted.into_iter().map(|worst| (worst.index, worst.deviation)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::statistics::worst;
    use nalgebra::Vector3;

    /// LengthStatistics over twelve decades.
    fn deviations(count: usize) -> Vec<Deviation> {
        let one = |i: usize| {
            let x = ((i * 7919) % count) as f64 / count as f64;
            let scale = libm::exp(-27.0 * x);
            Deviation {
                position: Vector3::new(scale, -0.5 * x * scale, x),
                rotation: Vector3::new(0.0, scale, 0.0) * 1e-3,
            }
        };
        (0..count).map(one).collect()
    }

    fn columns(list: &[Deviation]) -> Columns {
        let mut columns = Columns::new(list.len());
        for (i, d) in list.iter().enumerate() {
            for k in 0..3 {
                columns.position[k][i] = d.position[k];
                columns.rotation[k][i] = d.rotation[k];
            }
        }
        columns
    }

    /// Returns the tally of blocks of 1001, merged in groups.
    fn tallied(list: &[Deviation], group: usize) -> Tally {
        tallied_at(Width::widest(), list, group)
    }

    fn tallied_at(width: Width, list: &[Deviation], group: usize) -> Tally {
        let new = || Tally::new(7).with_width(width);
        let mut whole = new();
        for (g, part) in list.chunks(1001 * group).enumerate() {
            let mut tally = new();
            for (b, block) in part.chunks(1001).enumerate() {
                tally.add((g * group + b) * 1001, &columns(block), block.len());
            }
            whole = whole.merge(tally);
        }
        whole
    }

    #[test]
    fn a_tally_is_the_statistics_of_the_list() {
        let list = deviations(12_345);
        let (exact, tally) = (Statistics::of(&list), tallied(&list, 3));
        let found = tally.statistics();
        assert_eq!(found.poses, exact.poses);
        for (a, b) in [(found.position_um, exact.position_um), (found.rotation_urad, exact.rotation_urad)] {
            let close = |a: f64, b: f64| (a - b).abs() <= 1e-13 * b.abs();
            assert!(close(a.max, b.max) && close(a.mean, b.mean) && close(a.rms, b.rms), "{a:?} {b:?}");
            assert!(a.range.iter().zip(b.range).all(|(a, b)| close(*a, b)), "{a:?} {b:?}");
            assert!((a.p95 - b.p95).abs() <= Tally::QUANTILE_ERROR * b.p95, "{} {}", a.p95, b.p95);
        }
        let indices: Vec<usize> = tally.worst().iter().map(|(index, _)| *index).collect();
        assert_eq!(indices, worst(&list, 7));
    }

    #[test]
    fn no_division_of_the_work_changes_a_bit() {
        let list = deviations(20_500);
        let one = tallied(&list, 1);
        for group in [2, 5, 100] {
            let other = tallied(&list, group);
            assert_eq!(other.statistics(), one.statistics(), "{group}");
            assert_eq!(other.worst(), one.worst(), "{group}");
        }
    }

    #[test]
    fn no_width_and_no_order_changes_a_bit() {
        let list = deviations(9_876);
        let one = tallied_at(Width::Scalar, &list, 1);
        for width in Width::ALL {
            let other = tallied_at(width, &list, 2);
            assert_eq!((other.statistics(), other.worst()), (one.statistics(), one.worst()), "{width:?}");
        }
        let block = |first: usize| {
            let mut tally = Tally::new(7);
            let part = &list[first..(first + 1001).min(list.len())];
            tally.add(first, &columns(part), part.len());
            tally
        };
        let backwards = (0..list.len()).step_by(1001).rev().map(block).fold(Tally::new(7), Tally::merge);
        assert_eq!((backwards.statistics(), backwards.worst()), (one.statistics(), one.worst()));
    }

    #[test]
    fn lengths_beyond_the_buckets_are_counted_in_the_first_or_the_last() {
        let of = |x: f64| Deviation { position: Vector3::new(x, 0.0, 0.0), rotation: Vector3::zeros() };
        let smallest = f64::from_bits(FIRST << BELOW);
        let lengths = [1e-300, 0.0, 1.0, smallest, 1.5 * smallest, 1e300, 1e-20, 16_384.0, 3.0, 1e9];
        let list: Vec<Deviation> = (0..40).flat_map(|_| lengths).map(of).collect();
        let mut tally = Tally::new(0);
        tally.add(0, &columns(&list), list.len());
        let Sketch { first, counts, below_range } = &tally.lengths[0].sketch;
        assert_eq!((*first, counts.len()), (0, BUCKETS));
        assert_eq!((below_range + counts[0], counts[BUCKETS - 1]), (160, 120));
        assert_eq!(below_range + counts.iter().sum::<u64>(), 400);
        assert_eq!(tally.lengths[1].sketch.below_range, 400);
    }
}
