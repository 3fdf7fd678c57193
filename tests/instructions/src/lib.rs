//! The stages of abbe up to the compiled evaluator, from the sources of the library.

#[path = "../../../src/algebra/mod.rs"]
pub mod algebra;
#[path = "../../../src/diagnostic/mod.rs"]
pub mod diagnostic;
#[path = "../../../src/evaluate/mod.rs"]
pub mod evaluate;
#[path = "../../../src/lower/mod.rs"]
pub mod lower;
#[path = "../../../src/machine/mod.rs"]
pub mod machine;
#[path = "../../../src/syntax/mod.rs"]
pub mod syntax;
#[path = "../../../src/units/mod.rs"]
pub mod units;
