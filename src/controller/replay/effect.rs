//! What a target does to a machine, whatever its mechanism is: mapped like a bare machine.

use crate::compensation::Tables;
use crate::controller::{Carried, Compensated, Driven, Replay, Target};
use crate::evaluate::Field;
use crate::machine::{Approach, Machine};

/// What is added to a command approached from one side (mm, deg).
pub type Added<'a> = Box<dyn Fn(&[f64], Approach) -> Vec<f64> + 'a>;

/// What the controller has read from the files of a target.
#[derive(Debug, Clone)]
pub enum Effect {
    /// Tables beside the motion.
    Tables(Tables),
    /// A module in place of the kinematics, and the tables beside it.
    Module(Box<Carried>, Tables),
}

impl Effect {
    /// What the controller adds to commands.
    pub fn added<'a>(&'a self, machine: &'a Machine, target: &'a Target) -> Added<'a> {
        match self {
            Self::Tables(tables) => {
                let replay = Replay::new(machine, target, tables);
                Box::new(move |pose, approach| replay.added(pose, approach))
            }
            Self::Module(carried, beside) => {
                let driven = Driven::new(machine, carried).beside(Replay::new(machine, target, beside));
                Box::new(move |pose, approach| driven.added(pose, approach))
            }
        }
    }

    /// The machine with it.
    pub fn field<'a>(&'a self, machine: &'a Machine, target: &'a Target) -> Box<dyn Field + 'a> {
        match self {
            Self::Tables(tables) => Box::new(Compensated { machine, replay: Replay::new(machine, target, tables) }),
            Self::Module(carried, beside) => {
                Box::new(Driven::new(machine, carried).beside(Replay::new(machine, target, beside)))
            }
        }
    }
}
