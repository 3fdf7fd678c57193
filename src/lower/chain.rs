//! The chain: joints on the walk from workpiece to tool, their product and its halves.

use super::joint::{JointElements, JointFactor, JointPosition, between, error_motion, invert_if, joint, joint_factors};
use super::source::{AxisErrorValues, Elements, ErrorLift, ErrorSite, ErrorValues};
use crate::algebra::{Algebra, Htm};
use crate::machine::{Branch, Machine};
use nalgebra::Vector3;

/// Returns the errors of an axis as elements.
fn errors_of<S: Algebra, L: ErrorLift<S>>(
    elements: &Elements<'_, L>,
    values: &ErrorValues,
    i: usize,
) -> JointElements<S> {
    let AxisErrorValues { location, component } = &values.axes[i];
    JointElements {
        location: elements.six(ErrorSite::Location(i), location),
        component: elements.six(ErrorSite::Component(i), component),
    }
}

/// A machine at a pose, lowered: every joint as a matrix over the algebra.
#[derive(Debug, Clone)]
pub struct Chain<S: Algebra> {
    /// G of each axis in the order of [`Machine::axes`].
    pub joints: Vec<Htm<S>>,
    /// G of the spindle (identity if there is none).
    pub spindle: Htm<S>,
    /// Motion of the nominal against the clamped workpiece (identity without set-up errors).
    pub workpiece_setup: Htm<S>,
    /// The functional point at the zero pose, machine coordinates.
    pub tip: Vector3<S>,
    /// The number of joints on the workpiece side: they come first.
    workpiece_side: usize,
}

impl<S: Algebra> Chain<S> {
    /// Returns the actual machine: errors as given by `values`, entering the algebra through `lift`.
    pub fn actual(machine: &Machine, pose: &[f64], values: &ErrorValues, lift: &impl ErrorLift<S>) -> Self {
        Self::actual_at(machine, &positions(machine, pose), values, lift)
    }

    /// Returns the actual machine at positions that are elements of the algebra themselves.
    pub fn actual_at(
        machine: &Machine,
        at: &[JointPosition<S>],
        values: &ErrorValues,
        lift: &impl ErrorLift<S>,
    ) -> Self {
        let conventions = machine.conventions();
        let elements = Elements::new(machine, lift);
        let axis = |i: usize| joint(&machine.axes()[i], conventions, &at[i], &errors_of(&elements, values, i));
        let motion = |place, six: &[f64; 6]| elements.six(place, six).map(|six| error_motion(&six, conventions.joints));
        let gauge = machine.tool().gauge;
        let spindle = values.spindle.and_then(|six| motion(ErrorSite::Location(at.len()), &six));
        let workpiece_setup = motion(ErrorSite::Workpiece, &values.workpiece);
        Self {
            joints: (0..at.len()).map(axis).collect(),
            spindle: spindle.map_or_else(Htm::identity, |g| Htm::about(&gauge, g)),
            workpiece_setup: workpiece_setup
                .map_or_else(Htm::identity, |g| Htm::about(&machine.workpiece(), invert_if(true, g))),
            tip: elements.tip(machine.tool().tip, values.tool),
            workpiece_side: workpiece_side(machine),
        }
    }

    /// Returns the factors of every joint of [`Self::actual_at`], those of the spindle last if it has errors.
    pub fn factors_at(
        machine: &Machine,
        at: &[JointPosition<S>],
        values: &ErrorValues,
        lift: &impl ErrorLift<S>,
    ) -> Vec<Vec<JointFactor<S>>> {
        let conventions = machine.conventions();
        let elements = Elements::new(machine, lift);
        let axis = |i: usize| joint_factors(&machine.axes()[i], conventions, &at[i], &errors_of(&elements, values, i));
        let spindle = values.spindle.and_then(|six| elements.six(ErrorSite::Location(at.len()), &six)).map(|six| {
            let matrix = error_motion(&six, conventions.joints);
            between(&machine.tool().gauge, vec![JointFactor { name: "Loc", matrix }])
        });
        (0..at.len()).map(axis).chain(spindle).collect()
    }

    /// Returns the nominal machine: no errors at all.
    pub fn nominal(machine: &Machine, pose: &[f64]) -> Self {
        Self::nominal_at(machine, &positions(machine, pose))
    }

    /// Returns the nominal machine at positions that are elements of the algebra.
    pub fn nominal_at(machine: &Machine, at: &[JointPosition<S>]) -> Self {
        let none = JointElements { location: None, component: None };
        let axes = machine.axes().iter().zip(at);
        Self {
            joints: axes.map(|(axis, q)| joint(axis, machine.conventions(), q, &none)).collect(),
            spindle: Htm::identity(),
            workpiece_setup: Htm::identity(),
            tip: Vector3::from(machine.tool().tip).map(S::from_real),
            workpiece_side: workpiece_side(machine),
        }
    }

    /// Returns the factors of [`Self::t_work_inverse`].
    pub fn workpiece_walk(&self) -> impl DoubleEndedIterator<Item = &Htm<S>> {
        std::iter::once(&self.workpiece_setup).chain(&self.joints[..self.workpiece_side])
    }

    /// Returns the factors of [`Self::t_wt`].
    pub fn walk(&self) -> impl DoubleEndedIterator<Item = &Htm<S>> {
        std::iter::once(&self.workpiece_setup).chain(&self.joints).chain([&self.spindle])
    }

    /// T_work^-1: from the bed to the workpiece.
    pub fn t_work_inverse(&self) -> Htm<S> {
        product(self.workpiece_walk())
    }

    /// T_tool: from the bed to the tool.
    pub fn t_tool(&self) -> Htm<S> {
        product(self.joints[self.workpiece_side..].iter().chain([&self.spindle]))
    }

    /// T_wt = T_work^-1 T_tool, the product over the whole walk (machine coordinates at the zero pose).
    pub fn t_wt(&self) -> Htm<S> {
        product(self.walk())
    }

    /// T_wt between the frames at the workpiece origin and at the functional point.
    pub fn tool_in_workpiece(&self, origin: &[f64; 3]) -> Htm<S> {
        let t_wt = self.t_wt();
        let image = &t_wt.linear * &self.tip + &t_wt.translation;
        let translation = Vector3::from_fn(|i, _| image[i].clone() - S::from_real(origin[i]));
        Htm { linear: t_wt.linear, translation }
    }
}

/// Returns a pose (mm, deg) as elements.
pub fn positions<S: Algebra>(machine: &Machine, pose: &[f64]) -> Vec<JointPosition<S>> {
    machine.axes().iter().zip(pose).map(|(axis, q)| JointPosition::at(axis, *q)).collect()
}

fn workpiece_side(machine: &Machine) -> usize {
    machine.axes().iter().filter(|axis| axis.branch == Branch::Workpiece).count()
}

fn product<'a, S: Algebra>(mut joints: impl Iterator<Item = &'a Htm<S>>) -> Htm<S> {
    let first = joints.next().cloned().unwrap_or_else(Htm::identity);
    joints.fold(first, |product, joint| product.compose(joint))
}

/// The pose of functional point and tool axis of the nominal machine.
#[derive(Debug, Clone)]
pub struct NominalPose {
    /// T_wt between workpiece frame and tool frame.
    pub pose: Htm<f64>,
    /// Rotation of T_work: from the workpiece frame to machine directions.
    pub r_work: nalgebra::Matrix3<f64>,
}

impl NominalPose {
    /// Returns the nominal machine at a pose (mm, deg), the workpiece frame unturned: parallel to the machine at the
    /// zero pose, whatever the rotation of the workpiece.
    pub fn at(machine: &Machine, pose: &[f64]) -> Self {
        let chain = Chain::<f64>::nominal(machine, pose);
        Self { pose: chain.tool_in_workpiece(&machine.workpiece()), r_work: chain.t_work_inverse().linear.transpose() }
    }

    /// Returns the nominal machine at a pose (mm, deg), the workpiece frame turned as the workpiece is.
    pub fn in_part(machine: &Machine, pose: &[f64]) -> Self {
        let unturned = Self::at(machine, pose);
        let Some(rotation) = machine.workpiece_rotation() else { return unturned };
        let Htm { linear, translation } = unturned.pose;
        let back = rotation.transpose();
        Self {
            pose: Htm { linear: back * linear, translation: back * translation },
            r_work: unturned.r_work * rotation,
        }
    }
}

/// Returns a vector of the unturned workpiece frame in that of the part, which is turned as the workpiece is.
pub fn into_part<S: Algebra>(machine: &Machine, x: Vector3<S>) -> Vector3<S> {
    let Some(rotation) = machine.workpiece_rotation() else { return x };
    Vector3::from_fn(|i, _| (0..3).map(|k| x[k].scaled(rotation[(k, i)])).fold(S::zero(), |sum, term| sum + term))
}
