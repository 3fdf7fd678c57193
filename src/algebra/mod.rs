//! Algebras over which a machine is lowered: the reals, the dual numbers of order n, Weil algebras.
//!
//! An element is a real part plus a nilpotent part; everything analytic lifts by its finite Taylor
//! series at the real part. `f64` has no nilpotent part, so over it the same lowering is the exact
//! model. An element of an algebra chosen at run time is a plain constant or carries its basis:
//! nothing in the trait makes an element from an algebra alone but [`Algebra::from_real`].

mod dual;
mod element;
mod group;
mod htm;
mod lift;
pub mod linear;
mod solve;
pub mod symbolic;
mod tangent;
pub mod weil;

pub use dual::Dual;
pub use element::{Algebra, MAX_ORDER, difference};
pub use group::{AdmissibilityFailure, DualMatrix, ErrorOfDegree, Split, commutator_defect, error_class, split};
pub use htm::{Htm, exp_hat, hat, left_jacobian, product, rotation_about, rotation_vector, skew_vector, transform};
pub use solve::{Singular, newton_step, newton_steps, solve};
pub use symbolic::Symbolic;
pub use tangent::Tangent;
pub use weil::Weil;
