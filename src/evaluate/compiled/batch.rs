//! Batches: many poses in columns, and columns of their deviations.

use crate::evaluate::terms::Deviation;
use nalgebra::Vector3;

/// Poses by columns: one slice of positions (mm or deg) per axis, in the order of the machine's axes.
#[derive(Debug, Clone)]
pub struct Batch<'a> {
    axes: Vec<&'a [f64]>,
    len: usize,
}

impl<'a> Batch<'a> {
    /// Returns a batch of `len` poses (mm, deg) with a column per axis; `None` if a column has another length.
    pub fn new(axes: Vec<&'a [f64]>, len: usize) -> Option<Self> {
        axes.iter().all(|column| column.len() == len).then_some(Self { axes, len })
    }

    /// Returns the number of poses.
    pub fn len(&self) -> usize {
        self.len
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Returns the columns, one per axis.
    pub fn axes(&self) -> &[&'a [f64]] {
        &self.axes
    }

    /// Returns one pose (mm, deg), in the order of the axes.
    pub fn pose(&self, index: usize) -> Vec<f64> {
        self.axes.iter().map(|column| column[index]).collect()
    }

    /// Returns the first `at` poses, and the others.
    pub fn split_at(&self, at: usize) -> (Self, Self) {
        let (low, high) = self.axes.iter().map(|column| column.split_at(at)).unzip();
        (Self { axes: low, len: at }, Self { axes: high, len: self.len - at })
    }
}

/// Poses by columns, owned.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PoseColumns {
    /// One column of positions (mm or deg) per axis.
    pub axes: Vec<Vec<f64>>,
    len: usize,
}

impl PoseColumns {
    /// Returns no poses, for a number of axes.
    pub fn new(axes: usize) -> Self {
        Self { axes: vec![Vec::new(); axes], len: 0 }
    }

    /// Returns the poses of a list (mm, deg), each in the order of the axes.
    pub fn of<'p>(axes: usize, poses: impl IntoIterator<Item = &'p [f64]>) -> Self {
        let mut columns = Self::new(axes);
        poses.into_iter().for_each(|pose| columns.push(pose));
        columns
    }

    /// Appends a pose (mm, deg), in the order of the axes.
    pub fn push(&mut self, pose: &[f64]) {
        self.axes.iter_mut().zip(pose).for_each(|(column, q)| column.push(*q));
        self.len += 1;
    }

    /// Removes all poses; keeps the memory.
    pub fn clear(&mut self) {
        self.axes.iter_mut().for_each(Vec::clear);
        self.len = 0;
    }

    /// Borrows the poses as a batch.
    pub fn batch(&self) -> Batch<'_> {
        Batch { axes: self.axes.iter().map(|column| &column[..self.len]).collect(), len: self.len }
    }
}

/// The caller's slices for deviations, each as long as the batch.
#[derive(Debug)]
pub struct Output<'a> {
    /// Deviation of the functional point by component (mm), unturned workpiece frame.
    pub position: [&'a mut [f64]; 3],
    /// Rotation vector of the tool by component (rad), unturned workpiece frame.
    pub rotation: [&'a mut [f64]; 3],
}

impl<'a> Output<'a> {
    /// Returns the length of the shortest slice.
    pub fn len(&self) -> usize {
        self.position.iter().chain(&self.rotation).map(|column| column.len()).min().unwrap_or(0)
    }

    /// True if a slice is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Reborrows the output slices.
    pub fn reborrow(&mut self) -> Output<'_> {
        Output {
            position: self.position.each_mut().map(|c| &mut **c),
            rotation: self.rotation.each_mut().map(|c| &mut **c),
        }
    }

    /// Writes one deviation.
    pub fn put(&mut self, index: usize, deviation: &Deviation) {
        for k in 0..3 {
            self.position[k][index] = deviation.position[k];
            self.rotation[k][index] = deviation.rotation[k];
        }
    }

    /// Returns the slices of the first `at` poses, and those of the others.
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
    /// Deviation of the functional point by component (mm), unturned workpiece frame.
    pub position: [Vec<f64>; 3],
    /// Rotation vector of the tool by component (rad), unturned workpiece frame.
    pub rotation: [Vec<f64>; 3],
}

impl Columns {
    /// Returns `len` deviations of zero.
    pub fn new(len: usize) -> Self {
        let three = || std::array::from_fn(|_| vec![0.0; len]);
        Self { position: three(), rotation: three() }
    }

    /// Returns the number of deviations.
    pub fn len(&self) -> usize {
        self.position[0].len()
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Borrows the first `len` deviations as an output.
    pub fn output(&mut self, len: usize) -> Output<'_> {
        Output {
            position: self.position.each_mut().map(|c| &mut c[..len]),
            rotation: self.rotation.each_mut().map(|c| &mut c[..len]),
        }
    }

    /// Returns one deviation.
    pub fn get(&self, index: usize) -> Deviation {
        let of = |columns: &[Vec<f64>; 3]| Vector3::from_fn(|k, _| columns[k][index]);
        Deviation { position: of(&self.position), rotation: of(&self.rotation) }
    }
}

/// The columns that a kernel reads.
#[derive(Debug, Clone, Copy)]
pub struct Slices<'a> {
    /// Positions (mm or deg), one column per axis.
    pub axes: &'a [&'a [f64]],
    /// Corrections (mm or deg) added to the positions of the actual machine only; empty without corrections.
    pub added: &'a [&'a [f64]],
    /// Number of poses of the batch to which these belong.
    pub whole: usize,
}
