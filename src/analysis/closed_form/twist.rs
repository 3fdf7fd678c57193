//! First-order effects of the errors of every joint, in the structured form: each error lives in one
//! joint, so an error twist about the joint's origin acts either before or after the joint's motion.
//!
//! With R the nominal rotation up to the joint and r the arm from its origin to the functional point,
//! a small displacement (delta, eps) there moves the point by `R (delta + eps x r)`. *Outer* is the
//! side of the workpiece, before the motion; *inner* the side of the tool, after it. Conventions only
//! decide how much of either a component or location error takes: [`Share`].

use crate::algebra::rotation_about;
use crate::machine::{Axis, AxisKind, Conventions, ErrorFactor, LocationAction, Machine, MotionSide, sin_cos_degrees};
use nalgebra::{Matrix3, Vector3};

/// Three rows, for x, y, z of the workpiece frame; six columns, per mm and rad of a joint's errors.
pub type Map = [[f64; 6]; 3];

/// What is moved: the functional point (mm), or the orientation of the tool (rad).
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
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
    /// Of a displacement before the motion.
    pub outer: Map,
    /// Of a displacement after it.
    pub inner: Map,
}

/// How much of the outer and of the inner map an error takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Of the outer map.
    pub outer: f64,
    /// Of the inner map.
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

/// Where the nominal motion takes a point.
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
fn map(r: &Matrix3<f64>, arm: &Vector3<f64>, quantity: Quantity) -> Map {
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

impl Share {
    /// Of a component error of an axis.
    pub fn component(axis: &Axis, conventions: &Conventions) -> Self {
        Self::of_factor(axis.convention(conventions).component)
    }

    /// Of a location error of an axis: `Loc N Loc^-1` takes the outer map and gives back the inner one.
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

    /// Of a location error of the spindle.
    pub const SPINDLE: Self = Self { outer: 1.0, inner: 0.0 };

    /// The map of an error with this share.
    pub fn of(self, twist: &Twist) -> Map {
        let entry = |i: usize, k: usize| self.outer * twist.outer[i][k] + self.inner * twist.inner[i][k];
        std::array::from_fn(|i| std::array::from_fn(|k| entry(i, k)))
    }
}
