//! An independent oracle: an exact rigid-body model written from the theory alone, random machines
//! for it, and the program under test seen only through its command line.
//!
//! Nothing here may use the library: the oracle is worth as much as it is independent.

pub mod curves;
pub mod machines;
pub mod matrix;
pub mod program;
pub mod random;
pub mod rigid;
pub mod yaml;
