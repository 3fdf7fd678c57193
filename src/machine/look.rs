//! Drawing directions of a machine file: no number depends on them.

use crate::diagnostic::Place;
use std::path::PathBuf;

/// Appearance of a machine.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Look {
    /// Upwards, where the file says so: a unit vector in machine coordinates.
    pub up: Option<[f64; 3]>,
    /// Meshes of bodies.
    pub meshes: Vec<BodyMesh>,
}

/// The mesh of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyMesh {
    /// `bed`, `workpiece`, `tool`, or the name of an axis.
    pub body: String,
    /// The file, as it is opened.
    pub path: PathBuf,
    /// Unit of its coordinates, mm; that of its format by default.
    pub unit_mm: Option<f64>,
    /// Place of its origin, mm: in the workpiece frame for `workpiece`, else in machine coordinates at the zero pose.
    pub origin: [f64; 3],
    /// Rotation about X, then Y, then Z, deg.
    pub rotation: [f64; 3],
    /// The place in the file that names it.
    pub place: Option<Place>,
}
