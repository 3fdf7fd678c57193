//! Closed forms, which take no grid.
//!
//! - `equations`, `symbols`: E_VE and deviations as polynomials in symbols;
//! - `interactions`: effects of errors one by one and two by two, read off the algebra;
//! - `lemmas`: the statements of the papers on matrices over the dual numbers, at one matrix;
//! - `location_set`: the minimal set of location errors.

mod equations;
mod interactions;
mod lemmas;
mod location_set;
mod symbols;

pub use equations::{Equations, FactorsOfJoint, Options, OwnParameter, ParameterShare, equations, equations_in};
pub use interactions::{Interactions, ProductEffect, interactions};
pub use lemmas::{Lemma, lemmas, lie_algebra};
pub use location_set::{Displacement, LocationSet, Status, minimal_set};
pub use symbols::{Naming, Symbol, SymbolMeaning};
