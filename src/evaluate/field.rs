//! Fields of deviations over the poses of a machine.

use super::{Deviation, Frame, Order, evaluate};
use crate::machine::{Approach, Machine};

/// Pose (mm, deg) to deviation in the workpiece frame. A compensated machine is mapped like a bare one.
pub trait Field: Sync {
    /// The machine whose poses these are.
    fn machine(&self) -> &Machine;

    /// Actual minus nominal at a pose, approached from one side.
    fn deviation(&self, pose: &[f64], approach: Approach) -> Deviation;
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
}
