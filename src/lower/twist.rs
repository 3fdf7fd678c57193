//! First-order effects of the errors of every joint, in the structured form: each error lives in one
//! joint, so an error twist about the joint's origin acts either before or after the joint's motion.
//!
//! With R the nominal rotation up to the joint and r the arm from its origin to the functional point,
//! a small displacement (delta, eps) there moves the point by `R (delta + eps x r)`. *Outer* is the
//! side of the workpiece, before the motion; *inner* the side of the tool, after it. Conventions only
//! decide the weights of both for a component or location error: [`SideWeights`].

use crate::algebra::rotation_about;
use crate::machine::{
    Axis, AxisKind, Conventions, ErrorFactor, ErrorFamily, ErrorId, LocationAction, Machine, MotionSide,
    sin_cos_degrees,
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

/// The maps of all axes at a pose (mm, deg) on the walk, then of the spindle.
pub fn twists(machine: &Machine, pose: &[f64], quantity: Quantity) -> Vec<Twist> {
    let axes = machine.axes();
    let mut after = vec![Vector3::from(machine.tool().tip)];
    for (axis, q) in axes.iter().zip(pose).rev() {
        let point = after[after.len() - 1];
        after.push(moved(axis, *q, &point));
    }
    after.reverse();
    let mut rotation = Matrix3::identity();
    let mut all = Vec::with_capacity(axes.len() + 1);
    for (i, (axis, q)) in axes.iter().zip(pose).enumerate() {
        let origin = Vector3::from(axis.origin);
        let outer = map(&rotation, &(after[i] - origin), quantity);
        rotation *= turned(axis, *q);
        all.push(Twist { outer, inner: map(&rotation, &(after[i + 1] - origin), quantity) });
    }
    let spindle = map(&rotation, &(Vector3::from(machine.tool().tip) - Vector3::from(machine.tool().gauge)), quantity);
    all.push(Twist { outer: spindle, inner: spindle });
    all
}

fn turned(axis: &Axis, q: f64) -> Matrix3<f64> {
    match axis.kind {
        AxisKind::Linear => Matrix3::identity(),
        AxisKind::Rotary => {
            let (sine, cosine) = sin_cos_degrees(q);
            rotation_about(&axis.direction, (sine * axis.sign(), cosine))
        }
    }
}

/// Applies the nominal motion to a point.
fn moved(axis: &Axis, q: f64, point: &Vector3<f64>) -> Vector3<f64> {
    match axis.kind {
        AxisKind::Linear => point + Vector3::from(axis.direction) * (axis.sign() * q),
        AxisKind::Rotary => {
            let origin = Vector3::from(axis.origin);
            origin + turned(axis, q) * (point - origin)
        }
    }
}

/// Columns `R e_k` for translations and `R (e_k x r)` for rotations; of the orientation, `R e_k` for rotations.
fn map(r: &Matrix3<f64>, arm: &Vector3<f64>, quantity: Quantity) -> TwistMap {
    let mut map = [[0.0; 6]; 3];
    for k in 0..3 {
        let column = r.column(k);
        let lever = r * Vector3::ith(k, 1.0).cross(arm);
        for (i, row) in map.iter_mut().enumerate() {
            (row[k], row[k + 3]) = match quantity {
                Quantity::Position => (column[i], lever[i]),
                Quantity::Rotation => (0.0, column[i]),
            };
        }
    }
    map
}

impl SideWeights {
    /// The weights of a location error of the spindle.
    pub const SPINDLE: Self = Self { outer: 1.0, inner: 0.0 };

    /// The weights of a component error of an axis.
    pub fn component(axis: &Axis, conventions: &Conventions) -> Self {
        Self::of_factor(axis.convention(conventions).component)
    }

    /// The weights of a location error of an axis: `Loc N Loc^-1` adds the outer map and subtracts the inner one.
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
        std::array::from_fn(|i| std::array::from_fn(|k| self.entry(twist, i, k)))
    }

    fn entry(self, twist: &Twist, i: usize, k: usize) -> f64 {
        self.outer * twist.outer[i][k] + self.inner * twist.inner[i][k]
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
    let [position, rotation] = [Quantity::Position, Quantity::Rotation].map(|q| twists(machine, pose, q));
    let one = |error: &ErrorId| {
        let joint = machine.axis_index(error.axis.as_str()).unwrap_or(machine.axes().len());
        let weights = match (machine.axes().get(joint), error.family) {
            (Some(axis), ErrorFamily::Location) => SideWeights::location(axis, machine.conventions()),
            (Some(axis), ErrorFamily::Component) => SideWeights::component(axis, machine.conventions()),
            (None, _) => SideWeights::SPINDLE,
        };
        let column =
            |twists: &[Twist]| Vector3::from_fn(|i, _| weights.entry(&twists[joint], i, error.direction.index()));
        Sensitivity { error: error.clone(), deviation: column(&position), rotation: column(&rotation) }
    };
    errors.iter().map(one).collect()
}
