//! What a target does to a machine, whatever its mechanism is: mapped like a bare machine.

use super::{Carried, Compensated, Driven, Replay, Target};
use crate::compensation::Tables;
use crate::evaluate::Field;
use crate::machine::Machine;

/// What the controller has read from the files of a target.
#[derive(Debug, Clone)]
pub enum Effect {
    /// Tables beside the motion.
    Tables(Tables),
    /// A module in place of the kinematics.
    Module(Box<Carried>),
}

impl Effect {
    /// The machine with it.
    pub fn field<'a>(&'a self, machine: &'a Machine, target: &'a Target) -> Box<dyn Field + 'a> {
        match self {
            Self::Tables(tables) => Box::new(Compensated { machine, replay: Replay::new(machine, target, tables) }),
            Self::Module(carried) => Box::new(Driven::new(machine, carried)),
        }
    }
}
