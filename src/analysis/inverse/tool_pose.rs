//! Poses of the tool in the workpiece frame, and why one may be out of reach.

use crate::lower::NominalPose;
use crate::machine::{Axis, Machine, Pose, Travel};
use nalgebra::Vector3;

/// Maximum distance of the place reached from the one requested, mm.
pub const PLACE_TOLERANCE: f64 = 1e-9;

/// Maximum angle of the direction reached from the one requested, rad.
pub const DIRECTION_TOLERANCE: f64 = 1e-12;

/// A pose of the tool in the workpiece frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToolPose {
    /// The functional point, from the workpiece origin, mm.
    pub tip: Vector3<f64>,
    /// Unit vector of the tool axis, from the tip towards the holder: the tool's own at the zero pose.
    pub direction: Vector3<f64>,
}

/// The reason why a machine cannot take a tool pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unreachable {
    /// Its rotary axes cannot point the tool there.
    Direction,
    /// Its linear axes do not span the place.
    Place,
    /// An axis would have to leave its travel.
    Travel,
}

impl Unreachable {
    /// Returns the reason in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Direction => "the tool cannot be held in this direction",
            Self::Place => "the linear axes do not span it",
            Self::Travel => "an axis would leave its travel",
        }
    }
}

/// Returns the tool pose of the nominal machine at a pose (mm, deg).
pub fn tool_pose(machine: &Machine, pose: &[f64]) -> ToolPose {
    let nominal = NominalPose::at(machine, pose).pose;
    ToolPose { tip: nominal.translation, direction: nominal.linear * Vector3::from(machine.tool().direction) }
}

/// Returns the pose of zeros, each moved into its axis's travel (mm, deg).
pub fn rest(machine: &Machine) -> Pose {
    machine.axes().iter().map(|axis| within_travel(axis, 0.0)).collect()
}

/// Returns a position (mm or deg) moved into the travel.
pub fn within_travel(axis: &Axis, position: f64) -> f64 {
    match axis.travel {
        Travel::Range(min, max) => position.clamp(min, max),
        Travel::Continuous => position,
    }
}
