//! Batches: many poses in columns, and where their deviations go.

use crate::evaluate::deviation::Deviation;
use nalgebra::Vector3;

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
    pub fn put(&mut self, index: usize, deviation: &Deviation) {
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
    pub fn get(&self, index: usize) -> Deviation {
        let of = |columns: &[Vec<f64>; 3]| Vector3::from_fn(|k, _| columns[k][index]);
        Deviation { position: of(&self.position), rotation: of(&self.rotation) }
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
