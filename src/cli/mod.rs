//! The command line: one file per verb. The only place that touches files, prints or exits.
//!
//! Exit codes: 0 done, 1 input refused, 2 usage, 3 our own fault.

mod arguments;
mod confined;
mod global;
mod how;
#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that panics is a test that fails")]
mod option_table;
mod output;
mod program;
mod serve;
mod store;
mod threads;
mod tolerances;
mod verbs;

use global::{Color, Exit, Format, FormatArg, Global, Outcome};
pub use program::run;
