//! A machine whose controller has a kinematics module loaded: mapped like a bare one.

use super::{Carried, Model, World};
use crate::evaluate::{Bare, Deviation, Field, Frame, Order, commanded_deviation, evaluate};
use crate::machine::{Approach, Machine};
use crate::target::Replay;
use nalgebra::Vector3;

/// A machine driven through a module.
#[derive(Debug, Clone, Copy)]
pub struct Driven<'a> {
    machine: &'a Machine,
    carried: &'a Carried,
    /// Tables beside the module, looked up at its joint commands.
    beside: Option<&'a Replay<'a>>,
}

impl<'a> Driven<'a> {
    /// Loads what a module carries.
    pub fn new(machine: &'a Machine, carried: &'a Carried) -> Self {
        Self { machine, carried, beside: None }
    }

    /// With tables that the controller adds to the joints behind the module.
    pub fn beside(self, tables: &'a Replay<'a>) -> Self {
        Self { beside: Some(tables), ..self }
    }

    /// What the module sends to the joints for a pose (mm, deg, order of the walk); `None` if it stops.
    pub fn command(&self, pose: &[f64]) -> Option<Vec<f64>> {
        let tip = ideal_tip(self.machine, pose);
        match self.carried {
            Carried::FullModel(model) => model.command(&model.setting(), &world(model, &tip, pose)),
            Carried::LinearMap(map) => Some(map.command(pose)),
            Carried::RotaryCentres(centres) => Some(centres.command(&tip, pose)),
        }
    }

    /// What the motors are sent, approached from one side; `None` if the module stops.
    fn sent(&self, pose: &[f64], approach: Approach) -> Option<Vec<f64>> {
        let command = self.command(pose)?;
        let trims = self.beside.map_or_else(|| vec![0.0; command.len()], |tables| tables.added(&command, approach));
        Some(command.iter().zip(trims).map(|(c, trim)| c + trim).collect())
    }

    /// What is added to a pose approached from one side; nothing where the module stops.
    pub fn added(&self, pose: &[f64], approach: Approach) -> Vec<f64> {
        let command = self.sent(pose, approach).unwrap_or_else(|| pose.to_vec());
        command.iter().zip(pose).map(|(c, q)| c - q).collect()
    }
}

/// The tip of the ideal machine in the world: from where it is with all axes at 0, turning with the workpiece.
fn ideal_tip(machine: &Machine, pose: &[f64]) -> Vector3<f64> {
    let nominal = evaluate(machine, pose, Order::Exact, Approach::Mean, Frame::Workpiece).nominal;
    nominal + Vector3::from(machine.workpiece()) - Vector3::from(machine.tool().tip)
}

/// A pose as a program says it: where the tip shall be, and the other axes.
fn world(model: &Model, tip: &Vector3<f64>, pose: &[f64]) -> World {
    let mut world = [0.0; 9];
    model.joints.iter().zip(pose).filter(|(joint, _)| !joint.solved).for_each(|(j, q)| world[j.letter] = *q);
    world[..3].copy_from_slice(tip.as_slice());
    world
}

impl Field for Driven<'_> {
    fn machine(&self) -> &Machine {
        self.machine
    }

    /// Where the module stops, the machine is as bad as without it.
    fn deviation(&self, pose: &[f64], approach: Approach) -> Deviation {
        match self.sent(pose, approach) {
            Some(command) => commanded_deviation(self.machine, pose, &command, approach),
            None => Bare { machine: self.machine, order: Order::Exact }.deviation(pose, approach),
        }
    }
}
