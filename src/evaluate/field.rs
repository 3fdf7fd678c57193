//! Fields of deviations over the poses of a machine.

use super::compiled::batch::{Batch, Output};
use super::compiled::model::CompiledModel;
use super::deviation::{Deviation, Frame, Order, command_deviation, evaluate};
use crate::lower::{NominalPose, sensitivities};
use crate::machine::{Approach, ErrorId, Machine};
use std::sync::OnceLock;

/// Pose (mm, deg) to deviation in the workpiece frame. A compensated machine is mapped like a bare one.
pub trait Field: Sync {
    /// The machine whose poses these are.
    fn machine(&self) -> &Machine;

    /// Actual minus nominal at a pose, approached from one side.
    fn deviation(&self, pose: &[f64], approach: Approach) -> Deviation;

    /// The same at many poses, as many as `out` has room for: one by one, unless the field knows better.
    fn deviations(&self, poses: &Batch<'_>, approach: Approach, mut out: Output<'_>) {
        for i in 0..out.len() {
            out.put(i, &self.deviation(&poses.pose(i), approach));
        }
    }

    /// The compiled evaluator behind it, if there is one.
    fn plan(&self, _approach: Approach) -> Option<&CompiledModel> {
        None
    }
}

/// A machine without compensation.
#[derive(Debug, Clone, Copy)]
pub struct Bare<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// How far errors are followed.
    pub order: Order,
}

impl Field for Bare<'_> {
    fn machine(&self) -> &Machine {
        self.machine
    }

    fn deviation(&self, pose: &[f64], approach: Approach) -> Deviation {
        evaluate(self.machine, pose, self.order, approach, Frame::Workpiece).deviation
    }

    /// Compiled for the batch: worth it from some ten poses on.
    fn deviations(&self, poses: &Batch<'_>, approach: Approach, out: Output<'_>) {
        CompiledModel::new(self.machine, self.order, approach).deviations(poses, out);
    }
}

/// A machine without compensation, compiled: the same deviations up to rounding, at many poses a second.
#[derive(Debug, Clone)]
pub struct CompiledField {
    machine: Machine,
    order: Order,
    /// By side of approach, each compiled when it is first asked for.
    plans: [OnceLock<CompiledModel>; 3],
}

impl CompiledField {
    /// A machine and how far its errors are followed.
    pub fn new(machine: &Machine, order: Order) -> Self {
        Self { machine: machine.clone(), order, plans: Default::default() }
    }

    fn compiled(&self, approach: Approach) -> &CompiledModel {
        let slot = match approach {
            Approach::Mean => 0,
            Approach::Forward => 1,
            Approach::Reverse => 2,
        };
        self.plans[slot].get_or_init(|| CompiledModel::new(&self.machine, self.order, approach))
    }
}

impl Field for CompiledField {
    fn machine(&self) -> &Machine {
        &self.machine
    }

    fn deviation(&self, pose: &[f64], approach: Approach) -> Deviation {
        self.compiled(approach).deviation(pose)
    }

    fn deviations(&self, poses: &Batch<'_>, approach: Approach, out: Output<'_>) {
        self.compiled(approach).deviations(poses, out);
    }

    fn plan(&self, approach: Approach) -> Option<&CompiledModel> {
        Some(self.compiled(approach))
    }
}

/// Deviation at a pose when the controller sends another command instead (both mm, deg): exact model.
pub fn commanded_deviation(machine: &Machine, pose: &[f64], command: &[f64], approach: Approach) -> Deviation {
    command_deviation(machine, &NominalPose::at(machine, pose).pose, command, approach)
}

/// What each error alone does at a pose, to first order, in the order of [`Machine::errors`].
pub fn error_by_error(machine: &Machine, pose: &[f64], approach: Approach) -> Vec<(ErrorId, Deviation)> {
    let values = machine.errors().map(|(id, term)| {
        let position = machine.axis_index(id.axis.as_str()).map_or(0.0, |axis| pose[axis]);
        term.value(position, approach)
    });
    let alone = |(s, value): (crate::lower::Sensitivity, f64)| {
        (s.error, Deviation { position: s.deviation * value, rotation: s.rotation * value })
    };
    sensitivities(machine, pose, |_| true).into_iter().zip(values).map(alone).collect()
}

/// The part of a rotation that tilts the tool axis (workpiece frame, rad): the rotation about the
/// tool axis itself, which no compensation corrects and a turning tool does not show, is taken off.
pub fn tool_axis_tilt(machine: &Machine, pose: &[f64], rotation: &nalgebra::Vector3<f64>) -> nalgebra::Vector3<f64> {
    let axis = NominalPose::at(machine, pose).pose.linear.column(2).into_owned();
    rotation - axis * axis.dot(rotation)
}
