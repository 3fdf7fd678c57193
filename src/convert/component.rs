//! The component errors of an axis after conversion, as functions of its new position.

use super::changes_side;
use super::constants::{inverse, six_of};
use crate::algebra::Htm;
use crate::lower::{JointElements, JointPosition, error_motion, invert_if, joint};
use crate::machine::{Axis, AxisKind, JointConvention, Joints, Machine, MachineParts, MotionSide, OperatingConditions};

/// The errors of one axis under old and new conventions.
#[derive(Debug)]
pub struct ComponentErrors<'a> {
    machine: &'a Machine,
    index: usize,
    /// The joint before and after.
    conventions: [JointConvention; 2],
    /// The shape of error matrices before and after.
    joints: [Joints; 2],
    /// The frames C and D: X holds C^-1 E C, and E' = D X D^-1.
    frames: [Htm<f64>; 2],
    /// D C^-1 is not the identity.
    moved: bool,
    mirrored: bool,
    changes_side: bool,
}

impl<'a> ComponentErrors<'a> {
    /// Prepares the axis with this index.
    pub fn new(machine: &'a Machine, index: usize, parts: &MachineParts, [old, new]: [&Htm<f64>; 2]) -> Self {
        let axis = &machine.axes()[index];
        let both = new.compose(&inverse(old));
        let gap = (both.linear - nalgebra::Matrix3::identity()).amax();
        Self {
            machine,
            index,
            conventions: [machine.conventions(), &parts.conventions].map(|c| axis.convention(c)),
            joints: [machine.conventions(), &parts.conventions].map(|c| c.joints),
            frames: [old.clone(), new.clone()],
            moved: gap > super::TINY[1] || both.translation.amax() > super::TINY[0],
            mirrored: parts.axes[index].sign() != axis.sign(),
            changes_side: changes_side(axis, machine.conventions(), &parts.conventions),
        }
    }

    fn axis(&self) -> &'a Axis {
        &self.machine.axes()[self.index]
    }

    /// True if the new position is the negative of the old one.
    pub fn is_mirrored(&self) -> bool {
        self.mirrored
    }

    /// True if the new errors depend on several old ones to first order.
    pub fn mixes(&self) -> bool {
        self.changes_side
    }

    /// True if the six are the same numbers as before.
    pub fn keeps_numbers(&self) -> bool {
        let [was, is] = self.conventions.map(|convention| convention.component.inverse);
        !self.changes_side && !self.moved && was == is && self.joints[0] == self.joints[1]
    }

    /// The reason, in words, for which a curve of the language may not hold the error.
    pub fn nature(&self) -> &'static str {
        match (self.changes_side, self.axis().kind) {
            (true, AxisKind::Linear) => "the position times an angle",
            (true, AxisKind::Rotary) => "an error times sine and cosine of the position",
            (false, _) => "the product of two errors",
        }
    }

    /// The new six at a new position (mm or deg).
    pub fn six(&self, position: f64, conditions: OperatingConditions) -> [f64; 6] {
        let at =
            if self.mirrored { conditions.reversed().at_position(-position) } else { conditions.at_position(position) };
        let old = self.machine.component_values(self.index, &at);
        if self.keeps_numbers() {
            return old;
        }
        let [was, is] = self.conventions.map(|convention| convention.component);
        let error = invert_if(was.inverse, error_motion(&old, self.joints[0]));
        let [from, to] = &self.frames;
        let mut frame = to.clone();
        if self.changes_side {
            let nominal = self.nominal(at.position);
            // N X = (N X N^-1) N.
            let across = if was.side == MotionSide::Outer { inverse(&nominal) } else { nominal };
            frame = frame.compose(&across);
        }
        if self.changes_side || self.moved {
            frame = frame.compose(&inverse(from));
            let moved = frame.compose(&error).compose(&inverse(&frame));
            return six_of(&invert_if(is.inverse, moved), self.joints[1]);
        }
        six_of(&invert_if(is.inverse, error), self.joints[1])
    }

    /// The nominal motion at an old position, seen from the joint.
    fn nominal(&self, position: f64) -> Htm<f64> {
        let axis = Axis { origin: [0.0; 3], ..self.axis().clone() };
        let none = JointElements { location: None, component: None };
        joint(&axis, self.machine.conventions(), &JointPosition::at(&axis, position), &none)
    }
}
