//! What a verb gives back.

use crate::diagnostics::list;
use abbe::verbs::VerbAnswer;
use numpy::{PyArray1, ToPyArray};
use pyo3::prelude::*;

/// The outcome of a verb.
#[pyclass(module = "abbe._abbe", frozen)]
pub struct NativeOutcome(pub VerbAnswer);

#[pymethods]
impl NativeOutcome {
    /// The result, as the program prints it with `--format json`.
    fn json(&self) -> String {
        self.0.document.to_string()
    }

    /// The first lines of the result as text; empty where nothing decides.
    fn headline(&self) -> &str {
        self.0.headline.trim_end()
    }

    /// The warnings of the call, as a JSON list of diagnostics.
    fn warnings(&self) -> String {
        list(&self.0.warnings)
    }

    /// Texts by name.
    fn texts(&self) -> Vec<(String, String)> {
        self.0.texts.clone()
    }

    /// Files by name.
    fn files(&self) -> Vec<(String, Vec<u8>)> {
        self.0.files.clone()
    }

    /// The bytes of a NumPy file with a row for every pose; none if it was not asked for.
    fn rows<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<u8>>> {
        self.0.rows.as_ref().map(|bytes| bytes.to_pyarray(py))
    }
}
