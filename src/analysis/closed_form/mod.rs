//! Closed forms, which take no grid.
//!
//! - `equations`, `symbols`: E_VE and deviations as polynomials in symbols;
//! - `interactions`: effects of errors one by one and two by two, read off the algebra;
//! - `location_set`: the minimal set of location errors.

mod equations;
mod interactions;
mod location_set;
mod symbols;

pub use equations::{Equations, Options, equations};
pub use interactions::{Interactions, ProductEffect, interactions};
pub use location_set::{Displacement, LocationSet, Status, minimal_set};
pub use symbols::{Naming, Symbol, SymbolMeaning};
