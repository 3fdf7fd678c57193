//! Parts of a long computation, made on other machines or before an interruption, and put together.
//!
//! - [`budget_parts`]: machines of a budget that are drawn in parts;
//! - [`study`]: results of a study of arrangements, kept walk by walk; `journal` is their text.

pub mod budget_parts;
mod journal;
pub mod study;
