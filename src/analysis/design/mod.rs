//! Choosing a design.
//!
//! - `compare`: machines side by side on the same tool poses; `contributions`: each error alone on them;
//! - `error_statistics`: each error alone over a volume;
//! - [`budget`]: tolerances to the volumetric error;
//! - [`enumerate`]: all arrangements of the axes, ranked.

pub mod budget;
mod compare;
mod contributions;
pub mod enumerate;
mod error_statistics;

pub use compare::{Comparison, MachineResult, UnreachableCount, compare};
pub use contributions::{ErrorContribution, contributions};
pub use error_statistics::{ErrorStatistics, error_statistics};
