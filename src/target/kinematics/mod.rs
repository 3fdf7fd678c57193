//! Targets that replace the controller's kinematics: instead of tables beside the motion, the way from
//! the programmed pose to the joints itself.
//!
//! 1. [`Carried::of`] takes from the machine what such a module can carry, as plain numbers;
//! 2. [`Target::render_kinematics`] writes the files, [`Target::read_kinematics`] reads the numbers back;
//! 3. [`Driven`] does what the module does with them, in own arithmetic: nothing here uses the lowering
//!    of the machine, and only numbers that were read from the files count;
//! 4. [`certify_kinematics`] says what is left.
//!
//! Two frames are in use. The controller's *world* holds the tip of the tool relative to where the gauge
//! point is with all axes at 0, plus the tool's length (so that world and joints agree while no rotary
//! axis is turned, and a tool length offset is the controller's own), and the programmed positions of
//! the other axes. A *command* is the position of every axis in the order of the walk (mm, deg).

mod arrays;
mod carry;
mod certificate;
mod constants;
mod context;
mod data;
mod driven;
mod files;
mod solve;

pub(super) use files::layout_fits;

pub use carry::Carried;
pub use certificate::{Depth, certify_kinematics};
pub use data::Model;
pub use driven::Driven;
pub use solve::{Setting, World};

pub use crate::compensation::{Carries, KinematicsMechanism};

impl KinematicsMechanism {
    /// What makes it impossible to work with, in words.
    pub fn fault(&self) -> Option<String> {
        let damped = self.damping > 0.0 && self.damping <= 0.5;
        (self.carries == Carries::FullModel && !damped)
            .then(|| "damping: the sine of an angle, above 0 and at most 0.5".to_owned())
    }
}
