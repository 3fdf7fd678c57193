//! Deviation, rotation and E_VE at one pose, exact or to order n.

use super::terms::{Deviation, Elements, Evaluation, Term};
use crate::algebra::weil::Coefficients;
use crate::algebra::{Algebra, Dual, Htm, rotation_vector, skew_vector};
use crate::lower::{Chain, ErrorLift, ErrorValues, Exact, NominalPose, OrderN, into_part, values};
use crate::machine::{Joints, LocationOrder, Machine, OperatingPoint};
use nalgebra::{Matrix3, Matrix4, Vector3};

/// Highest order of the dedicated dual numbers.
pub const MAX_DUAL_ORDER: u8 = 6;

/// The order to which errors are followed; as text `exact` or `1` to `6`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(try_from = "String", into = "String")]
pub enum Order {
    /// Plain numbers: the true rigid body (with orthogonal joints).
    Exact,
    /// Degrees 1..=n of the dual numbers of order n, n in 1..=6.
    Degree(u8),
}

/// `exact`, or the degree.
impl std::fmt::Display for Order {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Exact => f.write_str("exact"),
            Self::Degree(n) => n.fmt(f),
        }
    }
}

/// A text that is no [`Order`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("an order is 1 to {MAX_DUAL_ORDER}, or `exact`")]
pub struct UnknownOrder;

impl std::str::FromStr for Order {
    type Err = UnknownOrder;

    fn from_str(text: &str) -> Result<Self, UnknownOrder> {
        match text.parse::<u8>() {
            Ok(n) if (1..=MAX_DUAL_ORDER).contains(&n) => Ok(Self::Degree(n)),
            _ if text == "exact" => Ok(Self::Exact),
            _ => Err(UnknownOrder),
        }
    }
}

impl TryFrom<String> for Order {
    type Error = UnknownOrder;

    fn try_from(text: String) -> Result<Self, UnknownOrder> {
        text.parse()
    }
}

impl From<Order> for String {
    fn from(order: Order) -> Self {
        order.to_string()
    }
}

/// Frame of vectors; all are parallel to the machine frame at the zero pose, but for the rotation of the workpiece.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "snake_case")]
pub enum Frame {
    /// Coordinates of the part: rotates with the workpiece, turned by its `rotation`.
    #[default]
    Workpiece,
    /// Directions of the machine, fixed to the bed.
    Machine,
    /// Rotates with the tool.
    Tool,
}

/// Returns the evaluation at an operating point, its vectors in `frame`. Order 0 counts as 1, orders above
/// `MAX_DUAL_ORDER` as that.
pub fn evaluate(machine: &Machine, at: &OperatingPoint<'_>, order: Order, frame: Frame) -> Evaluation {
    expand_unturned(machine, at, order, false).in_frame(machine, at.axes, frame).sum
}

/// Returns the same with the terms of each degree, in one generator.
pub fn expand(machine: &Machine, at: &OperatingPoint<'_>, order: Order, frame: Frame) -> Expansion {
    expand_unturned(machine, at, order, true).in_frame(machine, at.axes, frame)
}

/// Returns the deviation at an operating point in the unturned workpiece frame, which the rotation of the workpiece
/// does not touch.
pub fn unturned_deviation(machine: &Machine, at: &OperatingPoint<'_>, order: Order) -> Deviation {
    expand_unturned(machine, at, order, false).sum.deviation
}

/// Returns the part of the deviation of one degree in the errors, 1 to 6, in the unturned workpiece frame.
pub(super) fn unturned_part(machine: &Machine, at: &OperatingPoint<'_>, degree: u8) -> Deviation {
    let terms = expand_unturned(machine, at, Order::Degree(degree), true).terms;
    let own = terms.iter().filter(|term| term.monomial.degree() == usize::from(degree)).map(|term| term.deviation);
    own.reduce(|a, b| Deviation { position: a.position + b.position, rotation: a.rotation + b.rotation })
        .unwrap_or_else(|| Deviation { position: Vector3::zeros(), rotation: Vector3::zeros() })
}

/// An evaluation with its terms.
#[derive(Debug, Clone, PartialEq)]
pub struct Expansion {
    /// The sum of all degrees.
    pub sum: Evaluation,
    /// The parts of monomials, lowest degree first; none of the exact model.
    pub terms: Vec<Term>,
}

fn expand_unturned(machine: &Machine, at: &OperatingPoint<'_>, order: Order, terms: bool) -> Expansion {
    match order {
        Order::Exact => Expansion { sum: elements::<f64>(machine, at, &Exact).sum(), terms: Vec::new() },
        Order::Degree(0 | 1) => expand_unturned_over::<Dual<2>>(machine, at, &OrderN, terms),
        Order::Degree(2) => expand_unturned_over::<Dual<3>>(machine, at, &OrderN, terms),
        Order::Degree(3) => expand_unturned_over::<Dual<4>>(machine, at, &OrderN, terms),
        Order::Degree(4) => expand_unturned_over::<Dual<5>>(machine, at, &OrderN, terms),
        Order::Degree(5) => expand_unturned_over::<Dual<6>>(machine, at, &OrderN, terms),
        Order::Degree(_) => expand_unturned_over::<Dual<7>>(machine, at, &OrderN, terms),
    }
}

/// Returns the evaluation at an operating point over any algebra, with its terms: errors enter through `lift`.
pub fn expand_over<S: Coefficients>(
    machine: &Machine,
    at: &OperatingPoint<'_>,
    lift: &impl ErrorLift<S>,
    frame: Frame,
) -> Expansion {
    expand_unturned_over(machine, at, lift, true).in_frame(machine, at.axes, frame)
}

fn expand_unturned_over<S: Coefficients>(
    machine: &Machine,
    at: &OperatingPoint<'_>,
    lift: &impl ErrorLift<S>,
    terms: bool,
) -> Expansion {
    let elements = elements(machine, at, lift);
    let is_real = machine.conventions().location_order == LocationOrder::Real;
    Expansion { sum: elements.sum(), terms: if terms { elements.terms(is_real) } else { Vec::new() } }
}

fn elements<S: Algebra>(machine: &Machine, at: &OperatingPoint<'_>, lift: &impl ErrorLift<S>) -> Elements<S> {
    let origin = machine.workpiece();
    let actual = Chain::actual(machine, at.axes, &values(machine, at), lift).tool_in_workpiece(&origin);
    let nominal = Chain::<f64>::nominal(machine, at.axes).tool_in_workpiece(&origin);
    Elements {
        nominal: nominal.translation,
        position: Vector3::from_fn(|i, _| actual.translation[i].clone() - S::from_real(nominal.translation[i])),
        rotation: rotation(&actual.linear, &nominal.linear.map(S::from_real), machine.conventions().joints),
        e_ve: e_ve(&actual, &nominal),
    }
}

/// The deviations at a pose as elements of an algebra, workpiece frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Response<S: Algebra> {
    /// Nominal position of the functional point from the workpiece origin, mm.
    pub nominal: Vector3<f64>,
    /// Displacement of the functional point, mm.
    pub position: Vector3<S>,
    /// Rotation vector of the tool, rad.
    pub rotation: Vector3<S>,
}

/// Returns the deviations at a pose (mm, deg) as elements of the algebra; errors (mm, rad) enter through `lift`.
pub fn response<S: Algebra>(
    machine: &Machine,
    pose: &[f64],
    errors: &ErrorValues,
    lift: &impl ErrorLift<S>,
) -> Response<S> {
    let origin = machine.workpiece();
    let actual = Chain::actual(machine, pose, errors, lift).tool_in_workpiece(&origin);
    let nominal = Chain::<f64>::nominal(machine, pose).tool_in_workpiece(&origin);
    let position = Vector3::from_fn(|i, _| actual.translation[i].clone() - S::from_real(nominal.translation[i]));
    let turn = rotation(&actual.linear, &nominal.linear.map(S::from_real), machine.conventions().joints);
    Response {
        nominal: into_part(machine, nominal.translation),
        position: into_part(machine, position),
        rotation: into_part(machine, turn),
    }
}

impl Expansion {
    /// Returns that of the unturned workpiece frame with its vectors in a frame, and E_VE from the part's.
    fn in_frame(mut self, machine: &Machine, pose: &[f64], frame: Frame) -> Self {
        let part = machine.workpiece_rotation().map(|rotation| rotation.to_homogeneous());
        let turn = frame_rotation(machine, pose, frame);
        let parts = self.terms.iter_mut().map(|term| (&mut term.deviation, &mut term.e_ve));
        for (deviation, e_ve) in parts.chain([(&mut self.sum.deviation, &mut self.sum.e_ve)]) {
            *e_ve = part.map_or(*e_ve, |part| *e_ve * part);
            *deviation = turn.map_or(*deviation, |turn| deviation.rotated(&turn));
        }
        self.sum.nominal = turn.map_or(self.sum.nominal, |turn| turn * self.sum.nominal);
        self
    }
}

/// Returns the rotation from the unturned workpiece frame, that of fields, into a frame at a pose (mm, deg) of the
/// nominal machine; `None` is the identity.
pub fn frame_rotation(machine: &Machine, pose: &[f64], frame: Frame) -> Option<Matrix3<f64>> {
    match frame {
        Frame::Workpiece => machine.workpiece_rotation().map(|rotation| rotation.transpose()),
        Frame::Machine => Some(NominalPose::at(machine, pose).r_work),
        Frame::Tool => Some(NominalPose::at(machine, pose).pose.linear.transpose()),
    }
}

/// Returns the exact model at a *command* minus the `nominal` pose of the tool, unturned workpiece frame.
pub fn command_deviation(machine: &Machine, nominal: &Htm<f64>, command: &OperatingPoint<'_>) -> Deviation {
    let errors = values(machine, command);
    let actual = Chain::actual(machine, command.axes, &errors, &Exact).tool_in_workpiece(&machine.workpiece());
    Deviation {
        position: actual.translation - nominal.translation,
        rotation: rotation(&actual.linear, &nominal.linear, machine.conventions().joints),
    }
}

/// Returns the vector of log(R_actual R_nominal^T), rad; with linearised joints that of the skew part, for R_actual is
/// not orthogonal.
pub fn rotation<S: Algebra>(actual: &Matrix3<S>, nominal: &Matrix3<S>, joints: Joints) -> Vector3<S> {
    let relative = actual * nominal.transpose();
    match joints {
        Joints::Orthogonal => rotation_vector(&relative),
        Joints::Linearised => skew_vector(&relative),
    }
}

fn e_ve<S: Algebra>(actual: &Htm<S>, nominal: &Htm<f64>) -> Matrix4<S> {
    match (actual.inverse(), nominal.inverse()) {
        (Some(actual), Some(nominal)) => {
            let (actual, nominal) = (actual.to_matrix(), nominal.to_matrix());
            Matrix4::from_fn(|i, j| actual[(i, j)].clone() - S::from_real(nominal[(i, j)]))
        }
        // Products of joints near rotations always have an inverse.
        _ => Matrix4::from_element(S::zero()),
    }
}
