//! Choosing a design: machines side by side, tolerances to the volumetric error, and arrangements of the axes.

pub mod budget;
mod compare;
mod contributions;
pub mod enumerate;
mod error_statistics;

pub use compare::{Comparison, MachineResult, UnreachableCount, compare};
pub use contributions::{ErrorContribution, contributions};
pub use error_statistics::{ErrorStatistics, error_statistics};
