//! Arrays over many poses beside deviations: rows of poses in, numbers in C order out.

use crate::diagnostics::one;
use crate::interrupt::run_borrowed;
use crate::machine::{NativeMachine, word};
use abbe::options::Order;
use abbe::{Diagnostic, DrawnConditions, DrawnValues, PoseRows, error_values};
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

type Numbers<'py> = Bound<'py, PyArray1<f64>>;

/// Runs a job about rows of poses without the interpreter's lock.
fn over<T: Send>(
    machine: &PyRef<'_, NativeMachine>,
    poses: &PyReadonlyArray2<'_, f64>,
    threads: usize,
    job: impl FnOnce(PoseRows<'_>) -> Result<T, Diagnostic> + Send,
) -> PyResult<T> {
    let (py, rows, file) = (machine.py(), poses.as_slice()?, &machine.loaded.file);
    let found = run_borrowed(py, threads, |cancellation| job(PoseRows { machine: file, rows, cancellation }))?;
    found.map_err(|refusal| one(py, refusal))
}

/// Nominal tips (mm) and directions: six numbers for each pose.
#[pyfunction]
pub fn nominal<'py>(
    machine: PyRef<'py, NativeMachine>,
    poses: PyReadonlyArray2<'py, f64>,
    threads: usize,
) -> PyResult<Numbers<'py>> {
    let found = over(&machine, &poses, threads, |rows| rows.nominal())?;
    Ok(PyArray1::from_vec(machine.py(), found))
}

/// Deviations for 1 mm or 1 rad of each error: six rows of a number for each error, for each pose.
#[pyfunction]
pub fn jacobian<'py>(
    machine: PyRef<'py, NativeMachine>,
    poses: PyReadonlyArray2<'py, f64>,
    errors: Vec<String>,
    frame: &str,
    threads: usize,
) -> PyResult<Numbers<'py>> {
    let frame = word("frame", frame).map_err(|refusal| one(machine.py(), refusal))?;
    let found = over(&machine, &poses, threads, |rows| rows.jacobian(&errors, frame))?;
    Ok(PyArray1::from_vec(machine.py(), found))
}

/// Expanded uncertainties: six numbers for each pose; none where the machine states none.
#[pyfunction]
pub fn uncertainty<'py>(
    machine: PyRef<'py, NativeMachine>,
    poses: PyReadonlyArray2<'py, f64>,
    approach: &str,
    frame: &str,
    threads: usize,
) -> PyResult<Option<Numbers<'py>>> {
    let py = machine.py();
    let frame = word("frame", frame).map_err(|refusal| one(py, refusal))?;
    let approach = word("approach", approach).map_err(|refusal| one(py, refusal))?;
    let found = over(&machine, &poses, threads, |rows| rows.uncertainty(approach, frame))?;
    Ok(found.map(|found| PyArray1::from_vec(py, found)))
}

/// Deviations of machines with constants in place of location errors: six rows of a number for each pose, for each
/// machine.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "what a Python caller names")]
pub fn drawn<'py>(
    machine: PyRef<'py, NativeMachine>,
    poses: PyReadonlyArray2<'py, f64>,
    errors: Vec<String>,
    values: PyReadonlyArray2<'py, f64>,
    order: Option<String>,
    approach: &str,
    threads: usize,
) -> PyResult<Numbers<'py>> {
    let py = machine.py();
    let known = |of: &str| word::<Order>("order", of).map_err(|refusal| one(py, refusal));
    let order = order.map_or_else(|| Ok(machine.loaded.file.default_order()), |of| known(&of))?;
    let approach = word("approach", approach).map_err(|refusal| one(py, refusal))?;
    let values = DrawnValues { names: &errors, rows: values.as_slice()? };
    let found = over(&machine, &poses, threads, |rows| rows.drawn(values, DrawnConditions { order, approach }))?;
    Ok(PyArray1::from_vec(py, found))
}

/// Values of an error at positions of its axis, mm or rad.
#[pyfunction]
pub fn curve<'py>(
    machine: PyRef<'py, NativeMachine>,
    error: &str,
    positions: PyReadonlyArray1<'py, f64>,
    approach: &str,
) -> PyResult<Numbers<'py>> {
    let py = machine.py();
    let refused = |refusal| one(py, refusal);
    let approach = word("approach", approach).map_err(refused)?;
    let found = error_values(&machine.loaded.file, error, positions.as_slice()?, approach).map_err(refused)?;
    Ok(PyArray1::from_vec(py, found))
}
