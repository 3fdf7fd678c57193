//! Targets that replace the controller's kinematics: instead of tables beside the motion, the way from
//! the programmed pose to the joints itself.
//!
//! 1. [`Carried::of`] takes from the machine what such a module can carry, as plain numbers;
//! 2. [`render_kinematics`](super::Target::render_kinematics) writes the files, [`read_kinematics`](super::Target::read_kinematics) reads the numbers back;
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

use crate::compensation::Increment;
use serde::Deserialize;

/// The kinematics are replaced.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KinematicsMechanism {
    /// What the module carries.
    pub carries: Carries,
    /// Sine of the angle from a singular pose below which corrections of rotary axes are bounded.
    #[serde(default)]
    pub damping: f64,
    /// The controller's names of the constants, in the order of [`Carries`]; none for a full model.
    #[serde(default)]
    pub constants: Vec<String>,
    /// Decimals of constants; numbers of a full model are written exactly.
    pub increment: Increment,
}

/// What a kinematics module can carry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Carries {
    /// The chain with every error.
    FullModel,
    /// A 3x3 matrix from the axes X, Y, Z to their joints; constants row by row.
    LinearMap,
    /// The lines of a tilting table: A or B, and C on it, tables turning right-handed. Constants: a point of
    /// C's line (X, Y, Z), the way from it to the tilting line (X, Y, Z), the length of the tool.
    RotaryCentres,
}

impl KinematicsMechanism {
    /// What makes it impossible to work with, in words.
    pub fn fault(&self) -> Option<String> {
        let damped = self.damping > 0.0 && self.damping <= 0.5;
        if self.carries == Carries::FullModel && !damped {
            return Some("damping: the sine of an angle, above 0 and at most 0.5".to_owned());
        }
        let wanted = self.carries.constants();
        let plain = |name: &String| {
            !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_'))
        };
        let twice = (1..self.constants.len()).any(|i| self.constants[..i].contains(&self.constants[i]));
        let fits = self.constants.len() == wanted && self.constants.iter().all(plain) && !twice;
        (!fits).then(|| format!("constants: {wanted} different names of letters, digits, - and _"))
    }
}

impl Carries {
    /// How many constants it has.
    fn constants(self) -> usize {
        match self {
            Self::FullModel => 0,
            Self::LinearMap => 9,
            Self::RotaryCentres => 7,
        }
    }
}
