//! Batches: many poses in columns, and where their deviations go.

use super::chain::Vector;
use super::lanes::{Kernel, Lanes, expect, settle};
use super::lookup::{CHUNK, Lookup, Part, Scattered};

/// Poses by columns: one slice of positions (mm or deg) per axis, in the order of the machine's axes.
#[derive(Debug, Clone)]
pub struct Batch<'a> {
    axes: Vec<&'a [f64]>,
    len: usize,
}

impl<'a> Batch<'a> {
    /// `None` if the columns are not of one length; a machine without axes has `len` poses.
    pub fn new(axes: Vec<&'a [f64]>, len: usize) -> Option<Self> {
        axes.iter().all(|column| column.len() == len).then_some(Self { axes, len })
    }

    /// How many poses.
    pub fn len(&self) -> usize {
        self.len
    }

    /// None at all?
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The columns.
    pub fn axes(&self) -> &[&'a [f64]] {
        &self.axes
    }

    /// One pose.
    pub fn pose(&self, index: usize) -> Vec<f64> {
        self.axes.iter().map(|column| column[index]).collect()
    }

    /// The first `at` poses, and the rest.
    pub fn split_at(&self, at: usize) -> (Self, Self) {
        let (low, high) = self.axes.iter().map(|column| column.split_at(at)).unzip();
        (Self { axes: low, len: at }, Self { axes: high, len: self.len - at })
    }
}

/// Poses by columns, owned.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PoseColumns {
    /// One column per axis.
    pub axes: Vec<Vec<f64>>,
    len: usize,
}

impl PoseColumns {
    /// No poses of so many axes.
    pub fn new(axes: usize) -> Self {
        Self { axes: vec![Vec::new(); axes], len: 0 }
    }

    /// Of a list.
    pub fn of<'p>(axes: usize, poses: impl IntoIterator<Item = &'p [f64]>) -> Self {
        let mut columns = Self::new(axes);
        poses.into_iter().for_each(|pose| columns.push(pose));
        columns
    }

    /// One pose more; its positions in the order of the axes.
    pub fn push(&mut self, pose: &[f64]) {
        self.axes.iter_mut().zip(pose).for_each(|(column, q)| column.push(*q));
        self.len += 1;
    }

    /// No poses any more; the memory stays.
    pub fn clear(&mut self) {
        self.axes.iter_mut().for_each(Vec::clear);
        self.len = 0;
    }

    /// As a batch.
    pub fn batch(&self) -> Batch<'_> {
        Batch { axes: self.axes.iter().map(|column| &column[..self.len]).collect(), len: self.len }
    }
}

/// Where deviations go: slices of the caller's, as long as the batch.
#[derive(Debug)]
pub struct Output<'a> {
    /// Of the functional point (mm).
    pub position: [&'a mut [f64]; 3],
    /// Of the tool's orientation (rad).
    pub rotation: [&'a mut [f64]; 3],
}

impl<'a> Output<'a> {
    /// The length of the shortest slice.
    pub fn len(&self) -> usize {
        self.position.iter().chain(&self.rotation).map(|column| column.len()).min().unwrap_or(0)
    }

    /// No room at all?
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// For a while.
    pub fn reborrow(&mut self) -> Output<'_> {
        Output {
            position: self.position.each_mut().map(|c| &mut **c),
            rotation: self.rotation.each_mut().map(|c| &mut **c),
        }
    }

    /// One deviation.
    pub fn put(&mut self, index: usize, deviation: &crate::evaluate::Deviation) {
        for k in 0..3 {
            self.position[k][index] = deviation.position[k];
            self.rotation[k][index] = deviation.rotation[k];
        }
    }

    /// Room for the first `at` poses, and for the rest.
    pub fn split_at(self, at: usize) -> (Self, Self) {
        let halves = |columns: [&'a mut [f64]; 3]| {
            let [(a, b), (c, d), (e, f)] = columns.map(|column| column.split_at_mut(at));
            ([a, c, e], [b, d, f])
        };
        let ((p, q), (r, s)) = (halves(self.position), halves(self.rotation));
        (Self { position: p, rotation: r }, Self { position: q, rotation: s })
    }
}

/// Deviations by columns, owned.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    /// Of the functional point (mm).
    pub position: [Vec<f64>; 3],
    /// Of the tool's orientation (rad).
    pub rotation: [Vec<f64>; 3],
}

impl Columns {
    /// Zeros.
    pub fn new(len: usize) -> Self {
        let three = || std::array::from_fn(|_| vec![0.0; len]);
        Self { position: three(), rotation: three() }
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.position[0].len()
    }

    /// None at all?
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Where deviations go: the first `len`.
    pub fn output(&mut self, len: usize) -> Output<'_> {
        Output {
            position: self.position.each_mut().map(|c| &mut c[..len]),
            rotation: self.rotation.each_mut().map(|c| &mut c[..len]),
        }
    }

    /// One deviation.
    pub fn get(&self, index: usize) -> crate::evaluate::Deviation {
        let of = |columns: &[Vec<f64>; 3]| nalgebra::Vector3::from_fn(|k, _| columns[k][index]);
        crate::evaluate::Deviation { position: of(&self.position), rotation: of(&self.rotation) }
    }
}

/// Columns that a kernel reads.
#[derive(Debug, Clone, Copy)]
pub struct Slices<'a> {
    /// Positions.
    pub axes: &'a [&'a [f64]],
    /// What is added to them for the real machine only; nothing if there are none.
    pub added: &'a [&'a [f64]],
    /// Poses of the batch that they are a part of.
    pub whole: usize,
}

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
