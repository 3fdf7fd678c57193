//! Compensation: what must be added to commands so that the real machine does what the nominal one would.
//!
//! - [`correct()`] solves actual(q + c) = nominal(q) for one pose by Newton's iteration;
//! - [`Mechanisms`] says what a controller can hold;
//! - [`tables()`] decides what is compensated where and fills its tables, rounded.
//!
//! A [`Correction`] is what is added to a command; a `Deviation` is actual minus nominal. They are
//! different types, and the sign changes in exactly one function, `jacobian::against`.

mod batch;
mod capability;
mod combine;
mod correct;
mod curves;
mod jacobian;
mod lattice;
mod nodes;
mod own_axis;
mod plan;
mod product;
mod sum;
mod tables;

pub use batch::correct_all;
pub use capability::{
    CrossAxisRules, Directions, Encoding, Fit, Holds, Increment, KinematicsMechanism, LatticeRules, Mechanisms,
    ModuleContent, OwnAxisRules, PlaneGrid, PlaneRules, Reference, Scale, Spacing, Stored, TableRules,
};
pub use correct::{Corrected, Goal, Scope, correct};
pub use curves::model_correction;
pub use jacobian::{Correction, Jacobian};
pub use lattice::{LatticeRequest, lattice, lattice_nodes};
pub use own_axis::{own_axis_error, own_axis_table, own_axis_wanted, resampled, reversal_tables};
pub use plan::{lacking, single_error_tables, tables};
pub use product::{Factors, TABLES_OF_A_PRODUCT};
pub use tables::{CorrectionTable, CorrectionTables, ErrorCurve};
