//! A file of a set: its text, its numbers, and the fault of one of its lines.

use crate::diagnostic::{Diagnostic, Diagnostics, Place, SourceId, codes};
use crate::units;

/// A file of a set.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadBack {
    /// Its name in the set, by which its place is known.
    pub name: String,
    /// The name under which it was found.
    pub found: String,
    /// Its text.
    pub text: String,
}

impl ReadBack {
    /// A file found under the name that it has in the set.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        let name = name.into();
        Self { found: name.clone(), name, text: text.into() }
    }
}

/// The reason why a cell holds no number of a machine.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BadNumber {
    /// It is no number.
    #[error(transparent)]
    Unreadable(units::Failure),
    /// It is larger than any position or correction.
    #[error("`{0}` is no position or correction of a machine")]
    Large(String),
}

impl From<BadNumber> for String {
    fn from(bad: BadNumber) -> Self {
        bad.to_string()
    }
}

/// Reads a number of a compensation file, up to a kilometre in nanometres.
pub fn number(cell: &str) -> Result<f64, BadNumber> {
    const LARGEST: f64 = 1e12;
    let value = units::number(cell).map_err(BadNumber::Unreadable)?;
    if value.abs() <= LARGEST { Ok(value) } else { Err(BadNumber::Large(cell.trim().to_owned())) }
}

/// A fault in a line (counted from 0).
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    pub line: usize,
    pub message: String,
}

impl Fault {
    pub fn new(line: usize, message: impl Into<String>) -> Self {
        Self { line, message: message.into() }
    }

    pub fn report(&self, file: &ReadBack, diagnostics: &mut Diagnostics) {
        let source = diagnostics.sources.add(&*file.found, &*file.text);
        diagnostics.push(self.diagnostic(&file.found, &file.text, source));
    }

    pub fn diagnostic(&self, name: &str, text: &str, source: SourceId) -> Diagnostic {
        at_line(self.line, &self.message, name, text, source)
    }
}

/// Returns the diagnostic of a fault in a line (counted from 0).
fn at_line(line: usize, message: &str, name: &str, text: &str, source: SourceId) -> Diagnostic {
    let start: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
    let length = text.get(start..).and_then(|rest| rest.lines().next()).map_or(0, str::len);
    let place = Place { source, range: start..start + length };
    Diagnostic::new(codes::E0704, format!("`{name}`: {message}"))
        .at(Some(place), "")
        .help("compile the file set again; do not edit compensation files by hand")
}
