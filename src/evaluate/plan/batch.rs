//! Batches: many poses in columns, and where their deviations go.

use super::lanes::{Kernel, Lanes};
use super::links::Vector;

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
}

/// Something that has a deviation at a pose, lane by lane.
pub trait Task {
    /// Position, rotation, and a number that is above [`FARTHEST`] where they must not be trusted.
    fn at<V: Lanes>(&self, poses: &Slices<'_>, at: usize) -> (Vector<V>, Vector<V>, V);
}

/// Squared half angle (rad) up to which the series of the kernels are good to the last bit.
pub const FARTHEST: f64 = 0.0225;

/// A task over a batch.
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

impl<T: Task> Kernel for Pass<'_, '_, T> {
    #[inline(always)]
    fn run<V: Lanes>(mut self) {
        let (count, mut at) = (self.out.len(), 0);
        while at + V::COUNT <= count {
            self.step::<V>(at);
            at += V::COUNT;
        }
        self.rest(at);
    }
}

impl<T: Task> Pass<'_, '_, T> {
    /// What is less than a vector: compiled once, for its bits are the same at any width.
    #[inline(never)]
    fn rest(&mut self, from: usize) {
        (from..self.out.len()).for_each(|at| self.step::<f64>(at));
    }

    #[inline(always)]
    fn step<V: Lanes>(&mut self, at: usize) {
        let (d, w, far) = self.task.at::<V>(&self.poses, at);
        for k in 0..3 {
            d[k].store(&mut self.out.position[k][at..]);
            w[k].store(&mut self.out.rotation[k][at..]);
        }
        let far = far.spread();
        for (lane, far) in far.iter().enumerate().take(V::COUNT) {
            if *far > FARTHEST {
                self.beyond.push(at + lane);
            }
        }
    }
}
