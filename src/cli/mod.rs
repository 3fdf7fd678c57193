//! The only place that touches files, prints or exits.

pub mod files;
