//! Integration tests.

mod language;
