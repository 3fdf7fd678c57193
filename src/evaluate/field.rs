//! Fields: deviations as functions of the pose.

use super::compiled::batch::{Batch, Output};
use super::compiled::model::CompiledModel;
use super::deviation::{Order, command_deviation, unturned_deviation, unturned_part};
use super::terms::Deviation;
use crate::lower::{NominalPose, Sensitivity, sensitivities};
use crate::machine::{ErrorId, Machine, OperatingConditions, OperatingPoint};
use nalgebra::Vector3;
use std::sync::OnceLock;

/// A function from pose (mm, deg) to deviation (mm, rad) in the unturned workpiece frame: it rotates with the workpiece
/// and is parallel to the machine at the zero pose, so that no correction depends on the rotation of the workpiece
/// ([`frame_rotation`](super::frame_rotation()) leads to the coordinates of the part). A compensated machine is mapped
/// like a bare one.
pub trait Field: Sync {
    /// Returns the machine whose poses these are.
    fn machine(&self) -> &Machine;

    /// Returns actual minus nominal at an operating point.
    fn deviation(&self, at: &OperatingPoint<'_>) -> Deviation;

    /// Computes the deviations at the first `out.len()` poses; one by one, unless the implementation has a faster
    /// method.
    fn deviations(&self, poses: &Batch<'_>, conditions: OperatingConditions, mut out: Output<'_>) {
        for i in 0..out.len() {
            out.put(i, &self.deviation(&conditions.at_pose(&poses.pose(i))));
        }
    }

    fn compiled_model(&self, _conditions: OperatingConditions) -> Option<&CompiledModel> {
        None
    }
}

/// A machine without compensation.
#[derive(Debug, Clone, Copy)]
pub struct Bare<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// The order to which errors are followed.
    pub order: Order,
}

impl Field for Bare<'_> {
    fn machine(&self) -> &Machine {
        self.machine
    }

    fn deviation(&self, at: &OperatingPoint<'_>) -> Deviation {
        unturned_deviation(self.machine, at, self.order)
    }

    /// Compiles the machine for the batch: faster from about ten poses on.
    fn deviations(&self, poses: &Batch<'_>, conditions: OperatingConditions, out: Output<'_>) {
        CompiledModel::new(self.machine, self.order, conditions).deviations(poses, out);
    }
}

/// A machine without compensation, compiled: the deviations of [`Bare`] up to rounding, at millions of poses per
/// second.
#[derive(Debug, Clone)]
pub struct CompiledField {
    machine: Machine,
    order: Order,
    /// Models by side of approach, each compiled at its first use.
    models: [OnceLock<CompiledModel>; 3],
}

impl CompiledField {
    /// Returns the field of a machine, which is copied, to an order.
    pub fn new(machine: &Machine, order: Order) -> Self {
        Self { machine: machine.clone(), order, models: Default::default() }
    }

    fn model(&self, conditions: OperatingConditions) -> &CompiledModel {
        self.models[conditions.approach as usize]
            .get_or_init(|| CompiledModel::new(&self.machine, self.order, conditions))
    }
}

impl Field for CompiledField {
    fn machine(&self) -> &Machine {
        &self.machine
    }

    fn deviation(&self, at: &OperatingPoint<'_>) -> Deviation {
        self.model(at.conditions).deviation(at.axes)
    }

    fn deviations(&self, poses: &Batch<'_>, conditions: OperatingConditions, out: Output<'_>) {
        self.model(conditions).deviations(poses, out);
    }

    fn compiled_model(&self, conditions: OperatingConditions) -> Option<&CompiledModel> {
        Some(self.model(conditions))
    }
}

/// The part of the deviation that is of one degree in the errors.
#[derive(Debug, Clone, Copy)]
pub struct OneDegree<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// 1 to 6.
    pub degree: u8,
}

impl Field for OneDegree<'_> {
    fn machine(&self) -> &Machine {
        self.machine
    }

    fn deviation(&self, at: &OperatingPoint<'_>) -> Deviation {
        unturned_part(self.machine, at, self.degree)
    }
}

/// Returns the deviation at a pose (mm, deg) when the controller sends another command in its place, by the exact
/// model, unturned workpiece frame.
pub fn commanded_deviation(machine: &Machine, pose: &[f64], command: &OperatingPoint<'_>) -> Deviation {
    command_deviation(machine, &NominalPose::at(machine, pose).pose, command)
}

/// Returns the deviation by each error alone at an operating point, to first order, in the order of
/// [`Machine::errors`]; unturned workpiece frame.
pub fn error_by_error(machine: &Machine, at: &OperatingPoint<'_>) -> Vec<(ErrorId, Deviation)> {
    let values = machine.errors().map(|(id, term)| {
        let axis = machine.axis_index(id.axis.as_str()).unwrap_or(machine.axes().len());
        term.value(&at.argument(axis))
    });
    let effect = |(s, value): (Sensitivity, f64)| {
        (s.error, Deviation { position: s.deviation * value, rotation: s.rotation * value })
    };
    sensitivities(machine, at.axes, |_| true).into_iter().zip(values).map(effect).collect()
}

/// Returns the part of a rotation vector (rad, unturned workpiece frame) that tilts the tool axis: without the rotation
/// about the tool axis itself, which no compensation corrects and a rotating tool does not show.
pub fn tool_axis_tilt(machine: &Machine, pose: &[f64], rotation: &Vector3<f64>) -> Vector3<f64> {
    let axis = NominalPose::at(machine, pose).pose.linear * Vector3::from(machine.tool().direction);
    rotation - axis * axis.dot(rotation)
}
