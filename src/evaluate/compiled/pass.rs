//! One pass over a batch: chunk by chunk what can be looked up ahead, then vector by vector the walk of the order.

use super::batch::{Output, Slices};
use super::lanes::{expect, settle};
use super::lookup::{CHUNK, Lookup, Part, Scattered};
use super::simd::{Kernel, Lanes};
use super::vector::Vector;

/// Something that has a deviation at a pose, lane by lane.
pub trait Task {
    /// What it keeps of a chunk of poses, beside what is known of each axis.
    type Room;
    /// Nothing yet.
    const ROOM: Self::Room;

    /// Does for a chunk of poses what can be done ahead.
    fn lookup<V: Lanes>(&self, axes: &mut [Lookup], room: &mut Self::Room, part: Part<'_>);

    /// Position, rotation, and a number that is above [`FARTHEST`] where they must not be trusted.
    fn at<V: Lanes>(&self, room: &Self::Room, inputs: Scattered<'_>) -> (Vector<V>, Vector<V>, V);
}

/// Squared half angle (rad) up to which the series of the kernels are good to the last bit.
pub const FARTHEST: f64 = 0.0225;

/// Doubles of a cache line.
const LINE: usize = 8;

/// Poses of a batch that may be in the second cache with their deviations.
const IN_CACHE: usize = 1 << 14;

/// Poses of a batch whose deviations (12 MB) would drive everything else from the caches, and be driven out themselves.
const PAST_CACHES: usize = 1 << 18;

/// How many poses ahead memory is asked for: no more than needed, for tables of five axes all but fill the first cache.
const EXPECTED: usize = 2 * CHUNK;

/// A task over a batch of at least a vector.
pub struct Pass<'a, 'o, T> {
    /// What is computed.
    pub task: &'a T,
    /// Where.
    pub poses: Slices<'a>,
    /// Where to.
    pub out: Output<'o>,
    /// Poses that the kernel could not do.
    pub beyond: &'a mut Vec<usize>,
}

/// What memory is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Traffic {
    /// Everything is in the caches.
    Near,
    /// Lines are asked for before they are read or written.
    Expected,
    /// Likewise those that are read; deviations are stored past the caches.
    Past,
}

impl<T: Task> Kernel for Pass<'_, '_, T> {
    #[inline(always)]
    fn run<V: Lanes>(mut self) {
        let mut lookup = (vec![Lookup::NONE; self.poses.axes.len()], T::ROOM);
        let count = self.out.len();
        let traffic = match self.poses.whole {
            0..=IN_CACHE => Traffic::Near,
            _ if V::LINE && self.poses.whole > PAST_CACHES => Traffic::Past,
            _ => Traffic::Expected,
        };
        // So that vectors are whole lines, the numbers before the first line are done by themselves; and the last vector ends
        // where the batch does. Both overlap others, with the same bits.
        let before = if traffic == Traffic::Near || count < LINE { 0 } else { before_line(self.out.position[0]) };
        let mut from = 0;
        while from < count {
            let start = from.min(count - V::COUNT);
            let room = (count - start) / V::COUNT * V::COUNT;
            let (end, next) = match from {
                0 if before > 0 => (before.next_multiple_of(V::COUNT), before),
                _ => (start + room.min(CHUNK), start + room.min(CHUNK)),
            };
            self.chunk::<V>(&mut lookup, start, end, traffic);
            from = next;
        }
        if traffic == Traffic::Past {
            settle();
        }
    }
}

/// Numbers before the first that begins a cache line.
fn before_line(column: &[f64]) -> usize {
    column.as_ptr().align_offset(64).min(LINE - 1)
}

impl<T: Task> Pass<'_, '_, T> {
    /// A vector from here on will be read and written: eleven columns are more than a processor foresees by itself.
    #[inline(always)]
    fn expect(&self, at: usize, traffic: Traffic) {
        if traffic != Traffic::Near {
            for column in self.poses.axes {
                expect(column, at);
            }
        }
        if traffic == Traffic::Expected {
            for column in self.out.position.iter().chain(&self.out.rotation) {
                expect(column, at);
            }
        }
    }

    #[inline(always)]
    fn chunk<V: Lanes>(&mut self, (axes, room): &mut (Vec<Lookup>, T::Room), from: usize, to: usize, traffic: Traffic) {
        self.task.lookup::<V>(axes, room, Part { poses: self.poses, from, count: to - from });
        let mut at = from;
        while at < to {
            if (at - from).is_multiple_of(LINE) {
                self.expect(at + EXPECTED, traffic);
            }
            // The mask changes nothing, and shows the compiler that the vector lies within the chunk.
            let i = (at - from) & (CHUNK - V::COUNT);
            self.step::<V>(room, Scattered { poses: self.poses, at, axes, i }, traffic);
            at += V::COUNT;
        }
    }

    #[inline(always)]
    fn step<V: Lanes>(&mut self, room: &T::Room, inputs: Scattered<'_>, traffic: Traffic) {
        let at = inputs.at;
        let (d, w, far) = self.task.at::<V>(room, inputs);
        for k in 0..3 {
            let (position, rotation) = (&mut self.out.position[k][at..], &mut self.out.rotation[k][at..]);
            if traffic == Traffic::Past {
                d[k].store_past(position);
                w[k].store_past(rotation);
            } else {
                d[k].store(position);
                w[k].store(rotation);
            }
        }
        let far = far.spread();
        for (lane, far) in far.iter().enumerate().take(V::COUNT) {
            if *far > FARTHEST {
                self.beyond.push(at + lane);
            }
        }
    }
}
