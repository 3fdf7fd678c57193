//! # abbe: from a machine configuration to volumetric compensation

pub mod algebra;
pub mod analysis;
pub mod cli;
pub mod compensation;
pub mod diagnostic;
pub mod evaluate;
pub mod identify;
pub mod lower;
pub mod machine;
pub mod report;
pub mod syntax;
pub mod target;
pub mod units;
