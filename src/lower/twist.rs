//! First-order effects of the errors of every joint, in the structured form: each error lives in one
//! joint, so an error twist about the joint's origin acts either before or after the joint's motion.
//!
//! With R the nominal rotation up to the joint and r the arm from its origin to the functional point,
//! a small displacement (delta, eps) there moves the point by `R (delta + eps x r)`. *Outer* is the
//! side of the workpiece, before the motion; *inner* the side of the tool, after it. Conventions only
//! decide the weights of both for a component or location error: [`SideWeights`].

use crate::algebra::rotation_about;
use crate::machine::{
    Axis, AxisKind, Conventions, CurveArgument, ErrorFactor, ErrorFamily, ErrorId, LocationAction, Machine, MotionSide,
    OperatingPoint, sin_cos_degrees,
};
use nalgebra::{Matrix3, Vector3};

/// Three rows, for x, y, z of the unturned workpiece frame; six columns, per mm and rad of a joint's errors.
pub type TwistMap = [[f64; 6]; 3];

/// The quantity moved: the functional point (mm), or the orientation of the tool (rad).
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// The functional point.
    Position,
    /// The tool's orientation.
    Rotation,
}

/// Both maps of a joint at a pose.
#[derive(Debug, Clone, Copy)]
pub struct Twist {
    /// The map of a displacement before the motion.
    pub outer: TwistMap,
    /// The map of a displacement after it.
    pub inner: TwistMap,
}

/// The weights of the outer and of the inner map for an error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SideWeights {
    /// Weight of the outer map.
    pub outer: f64,
    /// Weight of the inner map.
    pub inner: f64,
}

/// Returns the maps of all axes at a pose (mm, deg) on the walk, then of the spindle.
pub fn twists(machine: &Machine, pose: &[f64], quantity: Quantity) -> Vec<Twist> {
    let map = |side: &JointSide| side.map(quantity);
    JointSide::of_all(machine, pose)
        .iter()
        .map(|[outer, inner]| Twist { outer: map(outer), inner: map(inner) })
        .collect()
}

/// A side of a joint at a pose: the nominal rotation up to it, and the arm to the functional point.
#[derive(Debug, Clone, Copy)]
struct JointSide {
    rotation: Matrix3<f64>,
    arm: Vector3<f64>,
}

impl JointSide {
    /// Returns the outer and the inner side of all axes at a pose (mm, deg) on the walk, then of the spindle.
    fn of_all(machine: &Machine, pose: &[f64]) -> Vec<[Self; 2]> {
        let axes = machine.axes();
        let turns: Vec<Matrix3<f64>> = axes.iter().zip(pose).map(|(axis, q)| rotation_by(axis, *q)).collect();
        let tip = Vector3::from(machine.tool().tip);
        let mut after = vec![tip];
        for ((axis, q), turn) in axes.iter().zip(pose).zip(&turns).rev() {
            let point = after[after.len() - 1];
            after.push(image_of(axis, *q, turn, &point));
        }
        after.reverse();
        let mut rotation = Matrix3::identity();
        let mut all = Vec::with_capacity(axes.len() + 1);
        for (i, (axis, turn)) in axes.iter().zip(&turns).enumerate() {
            let origin = Vector3::from(axis.origin);
            let outer = Self { rotation, arm: after[i] - origin };
            rotation *= turn;
            all.push([outer, Self { rotation, arm: after[i + 1] - origin }]);
        }
        all.push([Self { rotation, arm: tip - Vector3::from(machine.tool().gauge) }; 2]);
        all
    }

    /// Returns a column of the map: `R e_k` for a translation and `R (e_k x r)` for a rotation; of the orientation,
    /// `R e_k` for a rotation.
    fn column(&self, letter: usize, quantity: Quantity) -> Vector3<f64> {
        let k = letter % 3;
        let (next, last) = ((k + 1) % 3, (k + 2) % 3);
        match (quantity, letter >= 3) {
            (Quantity::Position, true) => {
                self.rotation.column(last) * self.arm[next] - self.rotation.column(next) * self.arm[last]
            }
            (Quantity::Rotation, false) => Vector3::zeros(),
            _ => self.rotation.column(k).into_owned(),
        }
    }

    fn map(&self, quantity: Quantity) -> TwistMap {
        let columns: [Vector3<f64>; 6] = std::array::from_fn(|letter| self.column(letter, quantity));
        std::array::from_fn(|i| columns.map(|column| column[i]))
    }
}

fn rotation_by(axis: &Axis, q: f64) -> Matrix3<f64> {
    match axis.kind {
        AxisKind::Linear => Matrix3::identity(),
        AxisKind::Rotary => {
            let (sine, cosine) = sin_cos_degrees(q);
            rotation_about(&axis.direction, (sine * axis.sign(), cosine))
        }
    }
}

/// Applies the nominal motion to a point.
fn image_of(axis: &Axis, q: f64, turn: &Matrix3<f64>, point: &Vector3<f64>) -> Vector3<f64> {
    match axis.kind {
        AxisKind::Linear => point + Vector3::from(axis.direction) * (axis.sign() * q),
        AxisKind::Rotary => {
            let origin = Vector3::from(axis.origin);
            origin + turn * (point - origin)
        }
    }
}

impl SideWeights {
    /// The weights of a location error of the spindle.
    pub const SPINDLE: Self = Self { outer: 1.0, inner: 0.0 };

    /// Returns the weights of a component error of an axis.
    pub fn component(axis: &Axis, conventions: &Conventions) -> Self {
        Self::of_factor(axis.convention(conventions).component)
    }

    /// Returns the weights of a location error of an axis: `Loc N Loc^-1` adds the outer map and subtracts the inner
    /// one.
    pub fn location(axis: &Axis, conventions: &Conventions) -> Self {
        match axis.convention(conventions).location {
            LocationAction::Displaces => Self { outer: 1.0, inner: -1.0 },
            LocationAction::Factor(factor) => Self::of_factor(factor),
        }
    }

    fn of_factor(factor: ErrorFactor) -> Self {
        match factor.side {
            MotionSide::Outer => Self { outer: factor.sign(), inner: 0.0 },
            MotionSide::Inner => Self { outer: 0.0, inner: factor.sign() },
        }
    }

    /// Returns the map of an error with these weights.
    pub fn map(self, twist: &Twist) -> TwistMap {
        let entry = |i: usize, k: usize| self.outer * twist.outer[i][k] + self.inner * twist.inner[i][k];
        std::array::from_fn(|i| std::array::from_fn(|k| entry(i, k)))
    }
}

/// A machine at a pose: what first-order effects of its errors hang on.
#[derive(Debug, Clone)]
pub struct NominalJoints(Vec<[JointSide; 2]>);

impl NominalJoints {
    /// Returns the joints of a machine at a pose (mm, deg).
    pub fn at(machine: &Machine, pose: &[f64]) -> Self {
        Self(JointSide::of_all(machine, pose))
    }
}

/// An error of a joint, looked up once for many poses.
#[derive(Debug, Clone, Copy)]
pub struct JointError {
    joint: usize,
    letter: usize,
    weights: SideWeights,
}

impl JointError {
    /// Returns an error of an axis or the spindle of the chain.
    pub fn new(machine: &Machine, error: &ErrorId) -> Self {
        let joint = machine.axis_index(error.axis.as_str()).unwrap_or(machine.axes().len());
        let weights = match (machine.axes().get(joint), error.family) {
            (Some(axis), ErrorFamily::Location) => SideWeights::location(axis, machine.conventions()),
            (Some(axis), ErrorFamily::Component) => SideWeights::component(axis, machine.conventions()),
            (None, _) => SideWeights::SPINDLE,
        };
        Self { joint, letter: error.direction.index(), weights }
    }

    /// Returns what its curve depends on at an operating point.
    pub fn argument<'a>(&self, at: &OperatingPoint<'a>) -> CurveArgument<'a> {
        at.argument(self.joint)
    }

    /// Returns the effect of one unit of it (per mm or rad), unturned workpiece frame.
    pub fn effect(&self, joints: &NominalJoints, quantity: Quantity) -> Vector3<f64> {
        let [outer, inner] = &joints.0[self.joint];
        let of = |side: &JointSide, weight: f64| match weight {
            0.0 => Vector3::zeros(),
            _ => side.column(self.letter, quantity) * weight,
        };
        of(outer, self.weights.outer) + of(inner, self.weights.inner)
    }
}

/// The first-order effect of a unit error (1 mm or 1 rad), unturned workpiece frame.
#[derive(Debug, Clone)]
pub struct Sensitivity {
    /// The error.
    pub error: ErrorId,
    /// Displacement of the functional point (mm per mm or per rad).
    pub deviation: Vector3<f64>,
    /// Rotation of the tool (rad per mm or per rad).
    pub rotation: Vector3<f64>,
}

/// Returns the sensitivities to the errors that `wanted` accepts, at a pose (mm, deg).
pub fn sensitivities(machine: &Machine, pose: &[f64], wanted: impl Fn(&ErrorId) -> bool) -> Vec<Sensitivity> {
    let ids: Vec<ErrorId> = machine.errors().map(|(id, _)| id).filter(|id| wanted(id)).collect();
    sensitivities_to(machine, pose, &ids)
}

/// Returns the sensitivities to any errors of the chain's axes and spindle, given in the machine file or not.
pub fn sensitivities_to(machine: &Machine, pose: &[f64], errors: &[ErrorId]) -> Vec<Sensitivity> {
    let joints = NominalJoints::at(machine, pose);
    let one = |id: &ErrorId| {
        let error = JointError::new(machine, id);
        let [deviation, rotation] = [Quantity::Position, Quantity::Rotation].map(|of| error.effect(&joints, of));
        Sensitivity { error: id.clone(), deviation, rotation }
    };
    errors.iter().map(one).collect()
}
