//! The certificate: the residual after the controller has applied the files just written.
//!
//! The poses are spread over the volume from a seed and are no table points. Where forward and reverse curves were
//! given the worse of the two directions counts, for single errors too. The residual of a single error is the 95 %
//! deviation of a machine with that error alone and with tables made for it alone, replayed like the real ones.
//!
//! Nothing here or in [`super::replay`] shares code with the filling of the tables: machines are evaluated one pose at
//! a time by the general algebra, controllers in their own arithmetic, derivatives are differences, and tables, also
//! those of single errors, are values that are handed in. Of `compensation` only types are used, and a test holds both
//! folders to that.

mod ball_check;
mod content;
mod depth;
mod drives;
mod effect;
mod figures;
mod module;
mod sign_test;
mod single_error;
mod tables;
mod zero_shift;

pub use ball_check::BallCheck;
pub(crate) use ball_check::ball_checks;
pub use content::{Certificate, ProgrammingFigures, ToolDirection};
pub use depth::Depth;
pub(super) use depth::{LatticeSubset, single_error_poses};
pub use drives::DriveDemand;
pub(crate) use drives::drive_demands;
pub use effect::ControllerEffect;
pub(crate) use figures::raised_figures;
pub use figures::{Figures, Judgement, ROUNDING_UM, RaisedFigure, figures, judge_by, micro};
pub(super) use module::{ModuleSet, SingleErrorModule, judge_module};
pub use sign_test::Strongest;
pub use single_error::{CompensationDegree, SingleErrorResidual};
pub use tables::TablesUnderTest;
pub(super) use tables::judge_tables;
pub use zero_shift::ZeroShift;
