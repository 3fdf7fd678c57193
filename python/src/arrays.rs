//! Poses and deviations as NumPy arrays, without copies in column order.

use crate::diagnostics::one;
use crate::interrupt::run_borrowed;
use abbe::options::Frame;
use abbe::results::CompiledModel;
use abbe::results::DeviationSlices;
use abbe::{Cancellation, Diagnostic};
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;

/// Positions (mm) and rotations (rad).
pub type Pair<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

/// What is evaluated and how.
pub struct Evaluation<'a> {
    /// The compiled machine.
    pub model: &'a CompiledModel,
    /// Frame of the vectors.
    pub frame: Frame,
    /// Number of threads; 0 for the default.
    pub threads: usize,
}

/// Least number of poses of a task, and that of rows, whose columns stay in the caches while they are gathered.
const CHUNK: usize = 1 << 12;

/// Largest number of poses of a task: a task takes about a millisecond.
const MAX_CHUNK: usize = 1 << 15;

/// Least number of tasks of a large batch, so that all threads end together.
const MIN_TASKS: usize = 32;

/// Up to so many poses are evaluated in the calling thread: it takes less time than to wake another.
const MAX_ALONE: usize = CHUNK;

/// Positions as the caller has them.
enum Positions<'a> {
    /// A slice for each axis.
    Columns(Vec<&'a [f64]>),
    /// Pose after pose, with the number of axes.
    Rows(&'a [f64], usize),
}

impl Positions<'_> {
    fn len(&self) -> usize {
        match self {
            Self::Columns(columns) => columns.first().map_or(0, |column| column.len()),
            Self::Rows(numbers, axes) => numbers.len() / axes,
        }
    }

    /// Calls `job` with the columns of the poses from `first` to `end`; rows are gathered for it.
    fn with_columns<T>(&self, first: usize, end: usize, job: impl FnOnce(&[&[f64]]) -> T) -> T {
        match self {
            Self::Columns(columns) => job(&columns.iter().map(|column| &column[first..end]).collect::<Vec<_>>()),
            Self::Rows(numbers, axes) => {
                let rows = &numbers[first * axes..end * axes];
                let column = |axis: usize| rows.iter().skip(axis).step_by(*axes).copied().collect::<Vec<f64>>();
                let columns: Vec<Vec<f64>> = (0..*axes).map(column).collect();
                job(&columns.iter().map(Vec::as_slice).collect::<Vec<_>>())
            }
        }
    }
}

/// The slices of a task, and its first pose.
type Task<'a> = (usize, [&'a mut [f64]; 3], [&'a mut [f64]; 3]);

/// Evaluates poses: an array of shape (N, axes), or a list of columns. Writes into `out`, if there is one.
pub fn deviations<'py>(
    py: Python<'py>,
    positions: &Bound<'py, PyAny>,
    evaluation: &Evaluation<'_>,
    out: Option<Pair<'py>>,
) -> PyResult<Pair<'py>> {
    if let Ok(array) = positions.extract::<PyReadonlyArray2<'_, f64>>() {
        let axes = array.shape()[1];
        let numbers = array.as_slice()?;
        let poses = array.shape()[0];
        if axes == 0 || poses == 0 {
            return evaluated(py, &Positions::Columns(vec![&[]; axes]), evaluation, out);
        }
        // A single pose or axis is both.
        let by_columns = array.is_fortran_contiguous();
        let positions = if by_columns {
            Positions::Columns(numbers.chunks(poses).collect())
        } else {
            Positions::Rows(numbers, axes)
        };
        return evaluated(py, &positions, evaluation, out);
    }
    let arrays: Vec<PyReadonlyArray1<'_, f64>> = positions.extract()?;
    let columns = arrays.iter().map(|array| array.as_slice()).collect::<Result<Vec<_>, _>>()?;
    if columns.iter().any(|column| column.len() != columns[0].len()) {
        return Err(PyValueError::new_err("the columns of positions are not of one length"));
    }
    evaluated(py, &Positions::Columns(columns), evaluation, out)
}

fn evaluated<'py>(
    py: Python<'py>,
    positions: &Positions<'_>,
    evaluation: &Evaluation<'_>,
    out: Option<Pair<'py>>,
) -> PyResult<Pair<'py>> {
    let len = positions.len();
    let new = || PyArray2::<f64>::zeros(py, [len, 3], true);
    let (position, rotation) = out.unwrap_or_else(|| (new(), new()));
    if [&position, &rotation].iter().any(|array| array.shape() != [len, 3] || !array.is_fortran_contiguous()) {
        return Err(PyValueError::new_err(format!("out: two arrays of shape ({len}, 3) in column order")));
    }
    {
        let (mut position, mut rotation) = (position.try_readwrite()?, rotation.try_readwrite()?);
        let chunk = chunk(positions, evaluation.model);
        let tasks = tasks(columns(position.as_slice_mut()?, len), columns(rotation.as_slice_mut()?, len), chunk);
        let result = if len <= MAX_ALONE {
            py.detach(|| all(tasks, positions, evaluation, &Cancellation::default()))
        } else {
            run_borrowed(py, evaluation.threads, |cancellation| all(tasks, positions, evaluation, cancellation))?
        };
        result.map_err(|refusal| one(py, refusal))?;
    }
    Ok((position, rotation))
}

/// The three columns of an array in column order.
fn columns(numbers: &mut [f64], len: usize) -> [&mut [f64]; 3] {
    let (x, rest) = numbers.split_at_mut(len);
    let (y, z) = rest.split_at_mut(len);
    [x, y, z]
}

/// Returns the number of poses of a task. Ctrl-C waits for the end of one, and each costs a little.
fn chunk(positions: &Positions<'_>, model: &CompiledModel) -> usize {
    match positions {
        Positions::Columns(_) if model.is_compiled() => (positions.len() / MIN_TASKS).clamp(CHUNK, MAX_CHUNK),
        _ => CHUNK,
    }
}

/// One task at least: also without poses the number of columns is checked.
fn tasks<'a>(position: [&'a mut [f64]; 3], rotation: [&'a mut [f64]; 3], chunk: usize) -> Vec<Task<'a>> {
    let len = position[0].len();
    let mut position = position.map(|column| column.chunks_mut(chunk));
    let mut rotation = rotation.map(|column| column.chunks_mut(chunk));
    let task = |first| {
        let position = position.each_mut().map(|chunks| chunks.next().unwrap_or_default());
        (first, position, rotation.each_mut().map(|chunks| chunks.next().unwrap_or_default()))
    };
    (0..len.max(1)).step_by(chunk).map(task).collect()
}

/// Does all tasks; of several refusals the first in the order of the poses counts.
fn all(
    tasks: Vec<Task<'_>>,
    positions: &Positions<'_>,
    evaluation: &Evaluation<'_>,
    cancellation: &Cancellation,
) -> Result<(), Diagnostic> {
    let one = |(first, position_mm, rotation_rad): Task<'_>| {
        if cancellation.is_asked() {
            return Ok(());
        }
        let end = first + position_mm[0].len();
        let out = DeviationSlices { position_mm, rotation_rad };
        let (model, frame, len) = (evaluation.model, evaluation.frame, positions.len());
        positions.with_columns(first, end, |columns| model.piece_into(columns, frame, len, out))
    };
    if let [_] = tasks.as_slice() {
        return tasks.into_iter().try_for_each(one);
    }
    let results: Vec<Result<(), Diagnostic>> = tasks.into_par_iter().map(one).collect();
    results.into_iter().collect()
}
