//! The native module of the Python package: the façade of abbe with NumPy arrays and JSON in between.
//!
//! Nothing is computed here. Options come as JSON and are read by the façade's own types; results leave as the JSON
//! that docs/formats/json.md describes, with pictures, files and arrays beside it. The package `abbe` around this module is
//! written in Python.

mod arrays;
mod diagnostics;
mod interrupt;
mod machine;
mod outcome;
mod pools;
mod pose_arrays;
mod readings;
mod request;
mod verbs;

use pyo3::prelude::*;

/// The native part of the package `abbe`.
#[pymodule(gil_used = false)]
fn _abbe(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("CLASS_NAMES", abbe::CLASS_NAMES.to_vec())?;
    module.add_class::<machine::NativeMachine>()?;
    module.add_class::<outcome::NativeOutcome>()?;
    module.add_function(wrap_pyfunction!(machine::load, module)?)?;
    module.add_function(wrap_pyfunction!(verbs::run, module)?)?;
    module.add_function(wrap_pyfunction!(verbs::verbs, module)?)?;
    module.add_function(wrap_pyfunction!(verbs::results, module)?)?;
    module.add_function(wrap_pyfunction!(verbs::answers, module)?)?;
    module.add_function(wrap_pyfunction!(machine::length_mm, module)?)?;
    module.add_function(wrap_pyfunction!(readings::csv, module)?)?;
    module.add_function(wrap_pyfunction!(pose_arrays::nominal, module)?)?;
    module.add_function(wrap_pyfunction!(pose_arrays::jacobian, module)?)?;
    module.add_function(wrap_pyfunction!(pose_arrays::uncertainty, module)?)?;
    module.add_function(wrap_pyfunction!(pose_arrays::drawn, module)?)?;
    module.add_function(wrap_pyfunction!(pose_arrays::curve, module)?)?;
    Ok(())
}
