//! The effect of a set on a machine, whatever its mechanism is: mapped like a bare machine.

use super::tables::TablesUnderTest;
use crate::compensation::CorrectionTables;
use crate::controller::kinematics::{KinematicsModule, ModuleField};
use crate::controller::manifest::ControllerTarget;
use crate::controller::replay::Replay;
use crate::evaluate::Field;
use crate::machine::{Machine, OperatingPoint};

/// Motions that are added to a command (mm, deg).
pub type Added<'a> = Box<dyn Fn(&OperatingPoint<'_>) -> Vec<f64> + 'a>;

/// The set that a controller has read.
#[derive(Debug, Clone)]
pub enum ControllerEffect {
    /// Tables beside the motion.
    CorrectionTables(CorrectionTables),
    /// A module in place of the kinematics, and the tables beside it.
    Module(Box<KinematicsModule>, CorrectionTables),
}

impl ControllerEffect {
    /// Returns the motions that the controller adds to commands.
    pub fn addition<'a>(&'a self, machine: &'a Machine, target: &'a ControllerTarget) -> Added<'a> {
        match self {
            Self::CorrectionTables(tables) => {
                let replay = Replay::new(machine, target, tables);
                Box::new(move |at| replay.addition(at))
            }
            Self::Module(carried, beside) => {
                let driven = ModuleField::new(machine, carried).beside(Replay::new(machine, target, beside));
                Box::new(move |at| driven.addition(at))
            }
        }
    }

    /// Returns the machine with the set, as the certificate judges it.
    pub fn field<'a>(&'a self, machine: &'a Machine, target: &'a ControllerTarget) -> Box<dyn Field + 'a> {
        let judged = |tables| TablesUnderTest { target, tables, installed: None };
        match self {
            Self::CorrectionTables(tables) => Box::new(judged(tables).field(machine)),
            Self::Module(carried, beside) => Box::new(judged(beside).beside(machine, carried)),
        }
    }
}
