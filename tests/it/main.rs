//! Integration tests.

mod compare;
mod configs;
mod language;
mod show;
