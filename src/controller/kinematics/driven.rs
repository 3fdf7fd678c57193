//! A machine whose controller has a kinematics module loaded: mapped like a bare one.

use super::nominal::to_roll_pitch_yaw;
use super::transformation::ProgrammedTool;
use super::{KinematicsModule, ModuleModel, ModuleWords, World};
use crate::algebra::rotation_about;
use crate::controller::replay::Replay;
use crate::evaluate::{Bare, Deviation, Field, Order, commanded_deviation};
use crate::lower::NominalPose;
use crate::machine::{AxisKind, Machine, OperatingPoint, sin_cos_degrees};
use nalgebra::{Matrix3, Vector3};

/// A machine driven through a module.
#[derive(Debug, Clone)]
pub struct ModuleField<'a> {
    machine: &'a Machine,
    carried: &'a KinematicsModule,
    /// Tables beside the module, looked up at its joint commands.
    beside: Option<Replay<'a>>,
}

impl<'a> ModuleField<'a> {
    /// Loads the data of a module.
    pub fn new(machine: &'a Machine, carried: &'a KinematicsModule) -> Self {
        Self { machine, carried, beside: None }
    }

    /// Adds tables that the controller applies to the joints behind the module.
    pub fn beside(self, tables: Replay<'a>) -> Self {
        Self { beside: Some(tables), ..self }
    }

    /// Returns the joint positions that the module commands for a pose (mm, deg, order of the walk); `None` if it
    /// stops.
    pub fn command(&self, pose: &[f64]) -> Option<Vec<f64>> {
        let tip = ideal_tip(self.machine, pose);
        match self.carried {
            KinematicsModule::FullModel(model) => {
                model.command(&model.setting(), &world(self.machine, model, &tip, pose), pose)
            }
            KinematicsModule::LinearMap(map) => Some(map.command(pose)),
            KinematicsModule::KinematicParameters(parameters) => {
                Some(parameters.transformation().command(&programmed_block(self.machine, parameters.vectors, pose)))
            }
        }
    }

    /// True where the controller keeps a rotary axis at a pole, so that the tool lacks the programmed direction.
    pub fn at_pole(&self, pose: &[f64]) -> bool {
        self.carried.parameters().is_some_and(|parameters| {
            parameters.transformation().at_pole(&programmed_block(self.machine, parameters.vectors, pose))
        })
    }

    /// Returns the commands of the motors; `None` if the module stops.
    fn motor_commands(&self, at: &OperatingPoint<'_>) -> Option<Vec<f64>> {
        let command = self.command(at.axes)?;
        let trim = |tables: &Replay<'_>| tables.addition(&at.conditions.at_pose(&command));
        let trims = self.beside.as_ref().map_or_else(|| vec![0.0; command.len()], trim);
        Some(command.iter().zip(trims).map(|(c, trim)| c + trim).collect())
    }

    /// Returns the corrections that are added to a pose; zeros where the module stops.
    pub fn addition(&self, at: &OperatingPoint<'_>) -> Vec<f64> {
        let command = self.motor_commands(at).unwrap_or_else(|| at.axes.to_vec());
        command.iter().zip(at.axes).map(|(c, q)| c - q).collect()
    }
}

pub(super) fn programmed_block<'a>(machine: &Machine, vectors: bool, pose: &'a [f64]) -> ProgrammedTool<'a> {
    let nominal = NominalPose::at(machine, pose).pose;
    let [gauge, tip, nominal_axis] =
        [machine.tool().gauge, machine.tool().tip, machine.tool().direction].map(Vector3::from);
    ProgrammedTool {
        tip: nominal.translation + Vector3::from(machine.workpiece()) - gauge,
        tool: tip - gauge,
        nominal_axis,
        axes: pose,
        vector: vectors.then(|| nominal.linear * nominal_axis),
    }
}

/// The tip of the nominal machine in the world: from where it is with all axes at 0, turning with the workpiece.
pub(super) fn ideal_tip(machine: &Machine, pose: &[f64]) -> Vector3<f64> {
    let nominal = NominalPose::at(machine, pose).pose.translation;
    nominal + Vector3::from(machine.workpiece()) - Vector3::from(machine.tool().tip)
}

/// Returns a pose in the coordinates of a program.
pub(super) fn world(machine: &Machine, model: &ModuleModel, tip: &Vector3<f64>, pose: &[f64]) -> World {
    let mut world = [0.0; 9];
    if model.words != ModuleWords::Axes {
        world[..3].copy_from_slice(tip.as_slice());
    }
    if model.words == ModuleWords::Pose {
        world[3..6].copy_from_slice(&to_roll_pitch_yaw(&ideal_rotation(machine, pose)));
    }
    for (joint, q) in model.joints.iter().zip(pose) {
        if let Some(letter) = joint.letter {
            world[letter] = *q;
        }
    }
    world
}

/// Returns the rotation of the nominal machine's tool.
fn ideal_rotation(machine: &Machine, pose: &[f64]) -> Matrix3<f64> {
    let rotary = machine.axes().iter().zip(pose).filter(|(axis, _)| axis.kind == AxisKind::Rotary);
    rotary.fold(Matrix3::identity(), |turned, (axis, q)| {
        turned * rotation_about(&axis.direction.map(|u| u * axis.sign()), sin_cos_degrees(*q))
    })
}

impl Field for ModuleField<'_> {
    fn machine(&self) -> &Machine {
        self.machine
    }

    /// A pose where the module stops has the deviation without it.
    fn deviation(&self, at: &OperatingPoint<'_>) -> Deviation {
        match self.motor_commands(at) {
            Some(command) => commanded_deviation(self.machine, at.axes, &at.conditions.at_pose(&command)),
            None => Bare { machine: self.machine, order: Order::Exact }.deviation(at),
        }
    }
}
