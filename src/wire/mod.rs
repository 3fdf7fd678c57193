//! What the page and its evaluators speak: questions of JSON in, documents of JSON out.
//!
//! 1. [`workbench`] reads a request, asks the facade, and puts the answers together.
//! 2. [`verbs`] is the table of all verbs: options to document, with the files beside it; [`headline`] puts the figure
//!    that decides into words.
//! 3. `share` lets several engines compute one map.
//! 4. [`report`] makes the page; `mailed` gives it the answers that it shows first.

pub mod headline;
mod mailed;
pub mod report;
pub mod report_options;
mod share;
pub mod verbs;
pub mod workbench;
