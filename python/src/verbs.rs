//! The verbs, from the table of the façade: the methods of the package are generated from it.

use crate::diagnostics::refusal;
use crate::interrupt::run_owned;
use crate::machine::NativeMachine;
use crate::outcome::NativeOutcome;
use crate::request::{Request, TextsAndDisk};
use abbe::verbs::{Verb, answers as answers_of_page, options, results as results_of_verbs};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;

/// Runs a verb. `options` is a JSON object, `words` are paths or names, `texts` are files by name that come before
/// those of the disk, `rows` asks for every pose as an array, `threads` is 0 for the default,
/// `progress` is called with phase, steps done, and their number, which is 0 where nobody knows it.
#[pyfunction]
#[pyo3(signature = (verb, machines, words, options, texts, rows, threads, progress=None))]
#[allow(clippy::too_many_arguments, reason = "one call for all verbs")]
pub fn run(
    py: Python<'_>,
    verb: String,
    machines: Vec<PyRef<'_, NativeMachine>>,
    words: Vec<String>,
    options: String,
    texts: Vec<(String, String)>,
    rows: bool,
    threads: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<NativeOutcome> {
    let machines = machines.iter().map(|machine| machine.loaded.clone()).collect();
    let request = Request { machines, words, options, texts, rows };
    let known = Verb::find(&verb).ok_or_else(|| PyKeyError::new_err(verb))?;
    let found = run_owned(py, threads, progress, move |monitor| {
        let files = TextsAndDisk::of(&request);
        request.ask(known, files.run(monitor))
    })?;
    found.map(NativeOutcome).map_err(|diagnostics| refusal(py, &diagnostics))
}

/// Returns the verbs with options as JSON: by name, the JSON Schema of their options, and their default.
#[pyfunction]
pub fn verbs() -> String {
    options().to_string()
}

/// Returns the JSON Schema of the result of every verb by its name, with the definitions that they refer to.
#[pyfunction]
pub fn results() -> String {
    results_of_verbs().to_string()
}

/// Returns the JSON Schemas of the answers that the page of the workbench gets, by the names of their types.
#[pyfunction]
pub fn answers() -> String {
    answers_of_page().to_string()
}
