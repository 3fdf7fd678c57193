//! Choosing a design: machines side by side, tolerances to the volumetric error, and arrangements of the axes.

pub mod budget;
pub(super) mod compare;
pub(super) mod contributions;
pub mod enumerate;
pub(super) mod sources;
