//! The place of a part on the workpiece frame.

use super::numbers::three;
use crate::algebra::rotation_about;
use crate::machine::sin_cos_degrees;
use nalgebra::{Matrix3, Vector3};

/// The place of a part on the workpiece frame: a point p of the part lies at origin + Rz(c) Ry(b) Rx(a) p.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Placement {
    /// Origin of the part, mm.
    #[serde(deserialize_with = "three")]
    pub origin: [f64; 3],
    /// Rotations about X, then Y, then Z of the workpiece frame, deg.
    #[serde(deserialize_with = "three")]
    pub rotation: [f64; 3],
}

impl Placement {
    /// Returns the six numbers: origin (mm), rotation (deg).
    pub(crate) fn numbers(&self) -> [f64; 6] {
        let ([x, y, z], [a, b, c]) = (self.origin, self.rotation);
        [x, y, z, a, b, c]
    }

    /// Returns the place of six numbers: origin (mm), rotation (deg).
    pub(crate) fn of_numbers([x, y, z, a, b, c]: [f64; 6]) -> Self {
        Self { origin: [x, y, z], rotation: [a, b, c] }
    }

    fn turn(&self) -> Matrix3<f64> {
        let units = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let turns = units.iter().zip(self.rotation);
        turns.fold(Matrix3::identity(), |before, (about, deg)| rotation_about(about, sin_cos_degrees(deg)) * before)
    }

    /// Returns a point of the part (mm) in the workpiece frame.
    pub(crate) fn point(&self, point: Vector3<f64>) -> Vector3<f64> {
        if *self == Self::default() { point } else { Vector3::from(self.origin) + self.turn() * point }
    }

    /// Returns a direction of the part in the workpiece frame.
    pub(crate) fn direction(&self, direction: Vector3<f64>) -> Vector3<f64> {
        if *self == Self::default() { direction } else { self.turn() * direction }
    }
}
