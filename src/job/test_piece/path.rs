//! The path of the tool along a test piece.

use super::options::ConeMotion;
use crate::analysis::zone::CharacteristicKind;
use nalgebra::Vector3;

/// A tool pose on a surface, part coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PathPoint {
    /// The functional point, mm.
    pub tip: Vector3<f64>,
    /// Unit vector from the tip to the holder.
    pub axis: Vector3<f64>,
    /// Unit normal out of the material.
    pub normal: Vector3<f64>,
    /// Index of its name.
    pub feature: usize,
}

/// A tolerance of a feature.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PieceTolerance {
    /// Name of the feature.
    pub name: String,
    /// The characteristic.
    pub kind: CharacteristicKind,
    /// Its largest value, um.
    pub um: f64,
    /// Name of the datum feature.
    pub datum: Option<String>,
}

/// A test piece: its path and its tolerances.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Piece {
    /// The piece in a line.
    pub title: String,
    /// Names of features.
    pub names: Vec<String>,
    pub points: Vec<PathPoint>,
    /// True if the points are single poses, and no continuous path.
    pub are_single: bool,
    /// Point at which the part is zeroed, mm; its origin by default.
    pub zero: Option<Vector3<f64>>,
    pub features: Vec<PieceTolerance>,
    pub c_motion: Option<ConeMotion>,
    pub notes: Vec<String>,
}

impl Piece {
    /// Begins a feature.
    pub fn name(&mut self, name: impl Into<String>) {
        self.names.push(name.into());
    }

    /// Adds a tool pose of the last feature.
    pub fn point(&mut self, tip: Vector3<f64>, axis: Vector3<f64>, normal: Vector3<f64>) {
        self.points.push(PathPoint { tip, axis, normal, feature: self.names.len().saturating_sub(1) });
    }

    /// States a tolerance of a feature.
    pub fn tolerance(&mut self, name: &str, kind: CharacteristicKind, um: f64, datum: Option<&str>) {
        self.features.push(PieceTolerance { name: name.to_owned(), kind, um, datum: datum.map(str::to_owned) });
    }
}
