//! Diagnostics as the exception of the package.

use abbe::text::{Rendering, counts, render};
use abbe::{Diagnostic, Diagnostics};
use pyo3::prelude::*;

/// Returns the JSON list of diagnostics, each with code, severity, message, help and places.
pub fn list(diagnostics: &Diagnostics) -> String {
    serde_json::json!(diagnostics.records()).to_string()
}

/// Returns `abbe.DiagnosticError` for diagnostics, with the text that the program prints.
pub fn refusal(py: Python<'_>, diagnostics: &Diagnostics) -> PyErr {
    let text = render(diagnostics, Rendering::default()) + &counts(diagnostics);
    let make = || {
        let module = py.import("abbe._diagnostics")?;
        module.getattr("refusal")?.call1((text.trim_end(), list(diagnostics)))
    };
    make().map_or_else(|failure| failure, PyErr::from_value)
}

/// Returns the same for one diagnostic about no file.
pub fn one(py: Python<'_>, diagnostic: Diagnostic) -> PyErr {
    refusal(py, &Diagnostics::from(diagnostic))
}
