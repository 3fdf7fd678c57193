//! Targets that replace the controller's kinematics: instead of tables beside the motion, the path from the programmed
//! pose to the joints itself.
//!
//! 1. [`KinematicsModule::of`] takes the data of such a module from the machine, as plain numbers;
//! 2. [`render_kinematics`](super::ControllerTarget::render_kinematics) writes the files,
//!    [`read_kinematics`](super::ControllerTarget::read_kinematics) reads the numbers back;
//! 3. [`ModuleField`] computes with them as the module does, in own arithmetic: nothing here uses the lowering of the
//!    machine, and only numbers that were read from the files count;
//! 4. [`certify_kinematics`](crate::controller::certify_kinematics) states the residual.
//!
//! Kinematic parameters ([`Parameters`]) are the numbers of a transformation that the controller has already: the lines
//! of its rotary axes. `rotary_lines` takes them from the machine, `transformation` computes with the numbers that were
//! read from the files.
//!
//! Two frames are in use. The controller's *world* holds the position of the tip of the tool relative to the gauge
//! point with all axes at 0, plus the tool's length (so that world and joints agree while no rotary axis is turned, and
//! a tool length offset is the controller's own), and the programmed positions of the other axes. A *command* is the
//! position of every axis in the order of the walk (mm, deg).

mod assumed;
mod carry;
mod constants;
mod context;
mod data;
mod demand;
mod driven;
mod files;
mod found_lines;
mod hold;
mod in_force;
mod located;
mod nominal;
mod parameters;
mod real;
mod rotary_lines;
mod solve;
mod topology;
mod transformation;
mod trials;

pub use carry::KinematicsModule;
pub(crate) use data::WORLD;
pub use data::{CurveData, Form, ModuleJoint, ModuleModel, ModuleWords};
pub use demand::TurnCommand;
pub use driven::ModuleField;
pub(crate) use found_lines::{FoundLine, found_lines};
pub use parameters::Parameters;
pub use solve::World;
pub use transformation::{RotaryLine, Transformation};
pub use trials::{MIN_READING_MM, NumberChange, SignTrial, SignTrials};
