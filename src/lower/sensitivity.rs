//! First-order sensitivities in the structured form: each error source lives in one joint, so
//! dT = P dG S with the nominal prefix P and suffix S of the walk.

use super::joint::{JointElements, Position, joint};
use crate::algebra::{Algebra, Dual, Htm};
use crate::machine::{Direction, ErrorId, Machine};
use nalgebra::Vector3;

/// What a unit error (1 mm or 1 rad) does to first order, workpiece frame.
#[derive(Debug, Clone)]
pub struct Sensitivity {
    /// The error.
    pub error: ErrorId,
    /// Displacement of the functional point (mm per mm or per rad).
    pub deviation: Vector3<f64>,
    /// Rotation of the tool (rad per mm or per rad).
    pub rotation: Vector3<f64>,
}

/// Sensitivities to the errors that `wanted` accepts, at a pose (mm, deg).
pub fn sensitivities(machine: &Machine, pose: &[f64], wanted: impl Fn(&ErrorId) -> bool) -> Vec<Sensitivity> {
    let ids: Vec<ErrorId> = machine.errors().map(|(id, _)| id).filter(|id| wanted(id)).collect();
    sensitivities_to(machine, pose, &ids)
}

/// Sensitivities to any errors of the chain's axes and spindle, given in the machine file or not.
pub fn sensitivities_to(machine: &Machine, pose: &[f64], errors: &[ErrorId]) -> Vec<Sensitivity> {
    let frames = Frames::new(machine, pose);
    errors.iter().map(|error| frames.sensitivity(machine, pose, error.clone())).collect()
}

/// Nominal prefixes and suffixes of every joint.
struct Frames {
    prefix: Vec<Htm<f64>>,
    suffix: Vec<Htm<f64>>,
    rotation: nalgebra::Matrix3<f64>,
}

impl Frames {
    fn new(machine: &Machine, pose: &[f64]) -> Self {
        let chain = super::Chain::<f64>::nominal(machine, pose);
        let mut prefix = vec![Htm::identity()];
        for (i, joint) in chain.joints.iter().enumerate() {
            prefix.push(prefix[i].compose(joint));
        }
        let mut suffix = vec![Htm::identity()];
        for (i, joint) in chain.joints.iter().rev().enumerate() {
            suffix.push(joint.compose(&suffix[i]));
        }
        suffix.reverse();
        let rotation = prefix[pose.len()].linear;
        Self { prefix, suffix, rotation }
    }

    fn sensitivity(&self, machine: &Machine, pose: &[f64], error: ErrorId) -> Sensitivity {
        let index = machine.axis_index(error.axis.as_str()).unwrap_or(pose.len());
        let unit = unit_joint(machine, pose, index, &error);
        // The suffix of a joint begins after it; the spindle, like the last axis, has none.
        let suffix = self.suffix.get(index + 1).or(self.suffix.last());
        let (tip, right) = suffix.map_or((machine.tool().tip.into(), nalgebra::Matrix3::identity()), |s| {
            (s.apply(&machine.tool().tip), s.linear)
        });
        let moved = unit.apply(&tip.into()).map(|x: Dual<2>| x.0[1]);
        let turned = self.prefix[index].linear * unit.linear.map(|x| x.0[1]) * right * self.rotation.transpose();
        Sensitivity {
            error,
            deviation: self.prefix[index].linear * moved,
            rotation: crate::algebra::skew_vector(&turned),
        }
    }
}

/// The joint over D_1 with this error alone, as large as the generator.
fn unit_joint(machine: &Machine, pose: &[f64], index: usize, error: &ErrorId) -> Htm<Dual<2>> {
    let unit = |direction: Direction| Dual::first_order(f64::from(u8::from(direction == error.direction)));
    let six = Some(Direction::ALL.map(unit));
    let (location, component) = if error.is_location() { (six, None) } else { (None, six) };
    match machine.axes().get(index) {
        Some(axis) => {
            let at = Position::at(axis, pose[index]);
            joint(axis, machine.conventions(), &at, &JointElements { location, component })
        }
        None => {
            let elements = location.unwrap_or_else(|| Direction::ALL.map(|_| Dual::from_real(0.0)));
            Htm::about(&machine.tool().gauge, super::joint::error_motion(&elements, machine.conventions().joints))
        }
    }
}
