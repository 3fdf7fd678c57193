//! The frame of a call: what it may read, who hears of its progress, what it has found wrong.
//!
//! - [`Run`] is what a caller hands over, [`Answer`] what it gets back; [`Monitor`] hears of the progress.
//! - `Call` is the state of a call: its diagnostics, and the job that returns early when it is refused.
//! - `finite` refuses numbers that are not finite; `hash` is the SHA-256 of files.

mod call;
pub(crate) mod finite;
pub(crate) mod hash;

pub use call::{Advance, Answer, Cancellation, Cancelled, Monitor, Reply, Run, unheard};
pub(crate) use call::{Call, Count, Refused};
pub use hash::{Hashed, sha256};
