//! Integration tests.

mod bad_input;
mod diagnostics;
mod language;
mod schema;
