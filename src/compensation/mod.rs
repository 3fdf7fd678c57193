//! Compensation: corrections of commands with which the actual machine does what the nominal one would.
//!
//! - [`correct()`] solves actual(q + c) = nominal(q) for one pose by Newton's iteration;
//! - [`Mechanisms`] states what a controller can hold;
//! - [`tables()`] assigns the corrections to tables and fills these, rounded.
//!
//! A [`Correction`] is added to a command; a `Deviation` is actual minus nominal. They are different types, and the
//! sign changes in exactly one function, `jacobian::against`.

mod batch;
mod capability;
mod combine;
mod correct;
mod curves;
mod increment;
mod jacobian;
mod lattice;
mod nodes;
mod own_axis;
mod parameters;
mod plan;
mod product;
mod room;
mod scale;
mod scope;
mod single_error;
mod sum;
mod tables;

pub use batch::correct_all;
pub use capability::{
    Directions, Encoding, Fit, KinematicsMechanism, LatticeRules, Mechanisms, ModuleContent, OwnAxisContent,
    OwnAxisRules, PlaneGrid, PlaneRules, Reference, Spacing, Stored, TableRules,
};
pub use correct::{Corrected, correct};
pub use increment::{Increment, round};
pub use jacobian::Jacobian;
pub use lattice::{LatticeRequest, lattice};
pub use own_axis::{own_axis_table, reversal_tables, thinned_axes};
pub use parameters::{AssumedAxis, MachinePart, ParameterRules, ParameterVector, RotaryPlacement};
pub use plan::{lacking, tables};
pub use product::TABLES_OF_A_PRODUCT;
pub use room::Crowded;
pub use scale::DriveScale;
pub use scope::{Correction, Goal, Scope};
pub use single_error::{SetLayout, single_errors};
pub use tables::{
    AxisErrorCurve, CorrectionTable, CorrectionTables, Factors, LatticeCells, SingleErrorTables, SingleErrors,
};
