//! A chain as a product of exponentials over the walk from workpiece to tool: `T_wt = exp_1(q_1) ... exp_n(q_n)`.

use crate::algebra::rotation_about;
use crate::machine::{Axis, AxisKind, Machine, sin_cos_degrees};
use nalgebra::{Matrix3, Vector3};

/// A rigid motion `p -> r p + t`, mm.
#[derive(Debug, Clone, Copy)]
pub struct ScrewMotion {
    /// Rotation.
    pub r: Matrix3<f64>,
    /// Translation, mm.
    pub t: Vector3<f64>,
}

impl ScrewMotion {
    /// Returns the identity.
    pub fn identity() -> Self {
        Self { r: Matrix3::identity(), t: Vector3::zeros() }
    }

    /// Returns this motion after another.
    pub fn after(&self, inner: &Self) -> Self {
        Self { r: self.r * inner.r, t: self.r * inner.t + self.t }
    }

    /// Returns the inverse.
    pub fn inverse(&self) -> Self {
        let r = self.r.transpose();
        Self { r, t: -(r * self.t) }
    }

    /// Returns the image of a point (mm).
    pub fn apply(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.r * point + self.t
    }
}

/// An axis at the zero pose, in machine coordinates.
#[derive(Debug, Clone, Copy)]
pub struct Screw {
    /// Unit vector, with the sense of a positive command.
    pub w: Vector3<f64>,
    /// A point of the axis, mm.
    pub o: Vector3<f64>,
    /// True for a rotary axis.
    pub turns: bool,
}

impl Screw {
    /// Returns the screw of an axis.
    pub fn of(axis: &Axis) -> Self {
        let w = Vector3::from(axis.direction) * axis.sign();
        Self { w, o: axis.origin.into(), turns: axis.kind == AxisKind::Rotary }
    }

    /// Returns the rotation at an angle (rad).
    pub fn rotation(&self, angle: f64) -> Matrix3<f64> {
        rotation_about(&self.w.into(), (libm::sin(angle), libm::cos(angle)))
    }

    /// Returns the motion at an angle (rad) of a rotary axis.
    pub fn motion_at(&self, angle: f64) -> ScrewMotion {
        let r = self.rotation(angle);
        ScrewMotion { r, t: self.o - r * self.o }
    }

    /// Returns the motion at a position (mm, deg).
    pub fn motion(&self, position: f64) -> ScrewMotion {
        if !self.turns {
            return ScrewMotion { t: self.w * position, ..ScrewMotion::identity() };
        }
        let r = rotation_about(&self.w.into(), sin_cos_degrees(position));
        ScrewMotion { r, t: self.o - r * self.o }
    }
}

/// Returns the screws of a machine on the walk from workpiece to tool.
pub fn screws(machine: &Machine) -> Vec<Screw> {
    machine.axes().iter().map(Screw::of).collect()
}

/// Returns the screws of the walk from tool to workpiece: at the same angles they make the inverse motion.
pub fn reverse(screws: &[Screw; 6]) -> [Screw; 6] {
    let mut back = *screws;
    back.reverse();
    back.iter_mut().for_each(|screw| screw.w = -screw.w);
    back
}

/// Returns the point at which three rotary axes meet; `None` if they do not within the tolerance (mm).
pub fn meeting_point(screws: &[Screw], tolerance_mm: f64) -> Option<Vector3<f64>> {
    let across = |s: &Screw| Matrix3::identity() - s.w * s.w.transpose();
    let sum = screws.iter().fold(Matrix3::zeros(), |sum, s| sum + across(s));
    let right = screws.iter().fold(Vector3::zeros(), |sum, s| sum + across(s) * s.o);
    let point = sum.try_inverse()? * right;
    screws.iter().all(|s| (across(s) * (point - s.o)).norm() <= tolerance_mm).then_some(point)
}

/// True if two axes are parallel, in the same or in opposite senses.
pub fn parallel(a: &Screw, b: &Screw) -> bool {
    a.w.cross(&b.w).norm() < 1e-9
}
