//! Compensation: what must be added to commands so that the real machine does what the ideal one would.
//!
//! - [`correct()`] solves actual(q + c) = ideal(q) for one pose by Newton's iteration;
//! - [`Capability`] says what a controller's mechanism can hold;
//! - [`own_axis_tables`] and [`lattice()`] fill its tables; [`Tables::quantise`] rounds them.
//!
//! A [`Correction`] is what is added to a command; a `Deviation` is actual minus nominal. They are
//! different types, and the sign changes in exactly one function, `jacobian::against`.

mod batch;
mod capability;
mod correct;
mod jacobian;
mod lattice;
mod own_axis;
mod tables;

pub use batch::correct_all;
pub use capability::{Capability, LatticeCapability, OwnAxisCapability, Spacing};
pub use correct::{Corrected, Goal, Scope, correct};
pub use jacobian::{Correction, Jacobian};
pub use lattice::{LatticeRequest, lattice, lattice_nodes};
pub use own_axis::{own_axis_error, own_axis_tables, resampled};
pub use tables::{Increment, Lattice, OwnAxisTable, Strongest, Tables};
