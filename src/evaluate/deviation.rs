//! Deviation, rotation and E_VE at one pose, exact or to order n.

use crate::algebra::{Algebra, Dual, Htm, difference, rotation_vector, skew_vector};
use crate::lower::{Chain, ErrorLift, ErrorValues, Exact, NominalPose, OrderN, values};
use crate::machine::{Approach, Joints, Machine};
use nalgebra::{Matrix3, Matrix4, Vector3};

/// Highest order of the dedicated dual numbers.
pub const MAX_DUAL_ORDER: u8 = 6;

/// How far the errors are followed; as text `exact` or `1` to `6`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
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
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnknownOrder;

impl std::fmt::Display for UnknownOrder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "an order is 1 to {MAX_DUAL_ORDER}, or `exact`")
    }
}

impl std::error::Error for UnknownOrder {}

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

/// Frame in which vectors are given; all are parallel to the machine frame at the zero pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Frame {
    /// Turns with the workpiece.
    #[default]
    Workpiece,
    /// Stands still with the bed.
    Machine,
    /// Turns with the tool.
    Tool,
}

/// Actual minus nominal, of the tool relative to the workpiece. Not a correction: the sign of what
/// is added to a command is opposite, and only `compensation` makes one from the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// Of the functional point, mm.
    pub position: Vector3<f64>,
    /// Of the tool's orientation, rad.
    pub rotation: Vector3<f64>,
}

/// Everything `eval` prints about a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// Nominal position of the functional point from the workpiece origin, mm.
    pub nominal: Vector3<f64>,
    /// Actual minus nominal.
    pub deviation: Deviation,
    /// (T_tool^-1 T_work) real minus nominal, between workpiece frame and tool frame.
    pub e_ve: Matrix4<f64>,
}

/// Evaluates a machine at a pose (mm, deg). Order 0 and orders above 6 are those nearest to them.
pub fn evaluate(machine: &Machine, pose: &[f64], order: Order, approach: Approach, frame: Frame) -> Evaluation {
    let at = At { machine, pose, approach };
    let evaluation = match order {
        Order::Exact => at.over::<f64>(&Exact),
        Order::Degree(0 | 1) => at.over::<Dual<2>>(&OrderN),
        Order::Degree(2) => at.over::<Dual<3>>(&OrderN),
        Order::Degree(3) => at.over::<Dual<4>>(&OrderN),
        Order::Degree(4) => at.over::<Dual<5>>(&OrderN),
        Order::Degree(5) => at.over::<Dual<6>>(&OrderN),
        Order::Degree(_) => at.over::<Dual<7>>(&OrderN),
    };
    framed(evaluation, machine, pose, frame)
}

/// The same over any algebra: errors enter through `lift`, and all degrees are summed.
pub fn evaluate_over<S: Algebra>(
    machine: &Machine,
    pose: &[f64],
    lift: &impl ErrorLift<S>,
    approach: Approach,
    frame: Frame,
) -> Evaluation {
    framed(At { machine, pose, approach }.over(lift), machine, pose, frame)
}

/// The elements behind an evaluation: what each interference of errors does. Workpiece frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Response<S: Algebra> {
    /// Nominal position of the functional point from the workpiece origin, mm.
    pub nominal: Vector3<f64>,
    /// Its deviation, mm.
    pub position: Vector3<S>,
    /// Of the tool's orientation, rad.
    pub rotation: Vector3<S>,
}

/// Deviations as elements of the algebra, errors entering through `lift`.
pub fn response<S: Algebra>(
    machine: &Machine,
    pose: &[f64],
    errors: &ErrorValues,
    lift: &impl ErrorLift<S>,
) -> Response<S> {
    let origin = machine.workpiece();
    let real = Chain::actual(machine, pose, errors, lift).tool_in_workpiece(&origin);
    let nominal = Chain::<f64>::nominal(machine, pose).tool_in_workpiece(&origin);
    Response {
        nominal: nominal.translation,
        position: Vector3::from_fn(|i, _| real.translation[i].clone() - S::from_real(nominal.translation[i])),
        rotation: rotation(&real.linear, &nominal.linear.map(S::from_real), machine.conventions().joints),
    }
}

/// Vectors in the frame asked for.
fn framed(evaluation: Evaluation, machine: &Machine, pose: &[f64], frame: Frame) -> Evaluation {
    match frame {
        Frame::Workpiece => evaluation,
        Frame::Machine => turned(evaluation, &NominalPose::at(machine, pose).r_work),
        Frame::Tool => turned(evaluation, &NominalPose::at(machine, pose).pose.linear.transpose()),
    }
}

/// Where the exact model of the machine is at a *command*, compared with where the nominal machine
/// would be at a *pose* (both mm, deg): workpiece frame, actual minus nominal.
pub fn command_deviation(machine: &Machine, nominal: &Htm<f64>, command: &[f64], approach: Approach) -> Deviation {
    let errors = values(machine, command, approach);
    let real = Chain::actual(machine, command, &errors, &Exact).tool_in_workpiece(&machine.workpiece());
    Deviation {
        position: real.translation - nominal.translation,
        rotation: rotation(&real.linear, &nominal.linear, machine.conventions().joints),
    }
}

/// Vectors in another frame; E_VE does not depend on it.
fn turned(evaluation: Evaluation, r: &Matrix3<f64>) -> Evaluation {
    let Deviation { position, rotation } = evaluation.deviation;
    Evaluation {
        nominal: r * evaluation.nominal,
        deviation: Deviation { position: r * position, rotation: r * rotation },
        e_ve: evaluation.e_ve,
    }
}

/// A machine at a pose.
struct At<'a> {
    machine: &'a Machine,
    pose: &'a [f64],
    approach: Approach,
}

impl At<'_> {
    fn over<S: Algebra>(&self, lift: &impl ErrorLift<S>) -> Evaluation {
        let origin = self.machine.workpiece();
        let errors = values(self.machine, self.pose, self.approach);
        let real = Chain::actual(self.machine, self.pose, &errors, lift).tool_in_workpiece(&origin);
        let nominal = Chain::<f64>::nominal(self.machine, self.pose).tool_in_workpiece(&origin);
        Evaluation {
            nominal: nominal.translation,
            deviation: Deviation {
                position: Vector3::from_fn(|i, _| difference(&real.translation[i], nominal.translation[i])),
                rotation: rotation(&real.linear, &nominal.linear.map(S::from_real), self.machine.conventions().joints)
                    .map(|x| difference(&x, 0.0)),
            },
            e_ve: e_ve(&real, &nominal),
        }
    }
}

/// Vector of log(R_real R_ideal^T); with linearised joints, of the skew part (R_real is not orthogonal).
pub fn rotation<S: Algebra>(real: &Matrix3<S>, nominal: &Matrix3<S>, joints: Joints) -> Vector3<S> {
    let relative = real * nominal.transpose();
    match joints {
        Joints::Orthogonal => rotation_vector(&relative),
        Joints::Linearised => skew_vector(&relative),
    }
}

fn e_ve<S: Algebra>(real: &Htm<S>, nominal: &Htm<f64>) -> Matrix4<f64> {
    match (real.inverse(), nominal.inverse()) {
        (Some(real), Some(nominal)) => {
            let (real, nominal) = (real.to_matrix(), nominal.to_matrix());
            Matrix4::from_fn(|i, j| difference(&real[(i, j)], nominal[(i, j)]))
        }
        // Products of joints near rotations always have an inverse.
        _ => Matrix4::zeros(),
    }
}
