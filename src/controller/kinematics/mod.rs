//! Targets that replace the controller's kinematics: instead of tables beside the motion, the way from
//! the programmed pose to the joints itself.
//!
//! 1. [`KinematicsModule::of`] takes from the machine what such a module can carry, as plain numbers;
//! 2. [`render_kinematics`](super::ControllerTarget::render_kinematics) writes the files, [`read_kinematics`](super::ControllerTarget::read_kinematics) reads the numbers back;
//! 3. [`ModuleField`] does what the module does with them, in own arithmetic: nothing here uses the lowering
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
mod hold;
mod nominal;
mod real;
mod solve;
mod topology;

pub(super) use files::layout_fits;

pub use carry::KinematicsModule;
pub use certificate::certify_kinematics;
pub use data::{Model, ModuleWords};
pub use driven::ModuleField;
pub use nominal::Setting;
pub use solve::World;

pub use crate::compensation::{KinematicsMechanism, ModuleContent};

impl KinematicsMechanism {
    /// What makes it impossible to work with, in words.
    pub fn fault(&self) -> Option<String> {
        let damped = self.damping > 0.0 && self.damping <= 0.5;
        if self.carries == ModuleContent::FullModel && !damped {
            return Some("damping: the sine of an angle, above 0 and at most 0.5".to_owned());
        }
        let wanted = self.carries.constants();
        let plain = |name: &String| {
            !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_'))
        };
        let twice = (1..self.constants.len()).any(|i| self.constants[..i].contains(&self.constants[i]));
        let fits = self.constants.len() == wanted && self.constants.iter().all(plain) && !twice;
        let modules = self.carries.components();
        let named = self.components.len() == modules && self.components.iter().all(plain);
        if !fits {
            return Some(format!("constants: {wanted} different names of letters, digits, - and _"));
        }
        (!named).then(|| format!("components: {modules} names of modules, of letters, digits, - and _"))
    }
}

impl ModuleContent {
    /// How many modules of the controller have them.
    fn components(self) -> usize {
        match self {
            Self::FullModel => 0,
            Self::LinearMap => 1,
            Self::RotaryCentres => 2,
        }
    }

    /// How many constants it has.
    fn constants(self) -> usize {
        match self {
            Self::FullModel => 0,
            Self::LinearMap => 9,
            Self::RotaryCentres => 7,
        }
    }
}
