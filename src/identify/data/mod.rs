//! Measurements: files, columns, stations, repeats, and the exports of instruments.

pub(super) mod columns;
pub mod import;
pub(super) mod measurement;
pub(super) mod reader;
pub(super) mod repeats;
pub(super) mod station;
