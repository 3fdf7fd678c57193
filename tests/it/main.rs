//! Integration tests.

mod diagnostics;
mod language;
