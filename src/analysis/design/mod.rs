//! Choosing a design: machines side by side, tolerances to the volumetric error, and arrangements of the axes.

pub mod budget;
mod compare;
mod contributions;
pub mod enumerate;
mod sources;

pub use compare::{Compared, Comparison, Missed, compare};
pub use contributions::{ErrorAlone, contributions};
pub use sources::{Source, sources};
