//! What a verb gives back.

use crate::diagnostics::list;
use crate::request::Request;
use abbe::{Answer, Diagnostics};
use numpy::{PyArray1, ToPyArray};
use pyo3::prelude::*;
use serde::Serialize;
use serde_json::{Value, json};

/// A result, with what lies beside its JSON.
pub struct Outcome {
    /// The JSON document.
    pub document: Value,
    /// The warnings of the call; those of the reading of machines were given before.
    pub warnings: Diagnostics,
    /// Texts by name: pictures (`.svg`), machine files, tables.
    pub texts: Vec<(String, String)>,
    /// Files by name.
    pub files: Vec<(String, Vec<u8>)>,
    /// A table of every pose as the bytes of a NumPy file.
    pub rows: Option<Vec<u8>>,
}

impl Outcome {
    /// Returns the outcome of a call of the façade: the document has the warnings of the reading of all machines too.
    pub fn of<T: Serialize>(request: &Request, answer: Answer<T>) -> (Self, T) {
        let mut all = Diagnostics::default();
        for loaded in &request.machines {
            let count = all.count();
            all.absorb(loaded.warnings.clone());
            if request.machines.len() > 1 {
                all.name_file(count, loaded.file.path());
            }
        }
        all.absorb(answer.warnings.clone());
        let document = all.document(json!(answer.value));
        let (texts, files, rows) = (Vec::new(), Vec::new(), None);
        (Self { document, warnings: answer.warnings, texts, files, rows }, answer.value)
    }

    /// Returns the outcome of a call that needs no machine and warns of nothing.
    pub fn plain(document: Value) -> Self {
        let (texts, files, rows) = (Vec::new(), Vec::new(), None);
        Self { document, warnings: Diagnostics::default(), texts, files, rows }
    }

    /// Adds a text.
    #[must_use]
    pub fn text(mut self, name: impl Into<String>, text: impl Into<String>) -> Self {
        self.texts.push((name.into(), text.into()));
        self
    }
}

/// The outcome of a verb.
#[pyclass(module = "abbe._abbe", frozen)]
pub struct NativeOutcome(pub Outcome);

#[pymethods]
impl NativeOutcome {
    /// The result, as the program prints it with `--format json`.
    fn json(&self) -> String {
        self.0.document.to_string()
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
