//! What is left after the controller has applied the files:
//!
//! 1. [`Effect`] is the machine with tables or a module in force, mapped like a bare one;
//! 2. [`certify`] judges tables, [`certify_kinematics`] a module and the tables beside it.

mod effect;
mod judge;
mod module;

pub use effect::Effect;
pub use judge::{
    Certificate, ErrorLeft, Figures, Handled, JudgedTables, ROUNDING_UM, RaisedFigure, ZeroShift, certify, micro,
};
pub use module::{Depth, certify_kinematics};
