//! What is known without a grid: equations in the errors, interactions of errors, the twist of each error, and the
//! minimal set of location errors.

mod equations;
mod interactions;
mod location_set;
mod symbols;
mod twist;

pub use equations::{Equations, Options, equations};
pub use interactions::{Calculation, Effect, Interactions, interactions};
pub use location_set::{LocationSet, Status};
pub use symbols::{Meaning, Naming, Symbol};
pub use twist::{Map as TwistMap, Quantity, Share, Twist, twists};
