//! # abbe: from a machine configuration to volumetric compensation

pub mod cli;
pub mod diagnostic;
pub mod machine;
pub mod syntax;
pub mod units;
