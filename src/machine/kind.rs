//! Kinds of errors, by which classes bound them and cost models price them.

use super::{Axis, AxisKind, Direction, ErrorFamily, ErrorId};
use serde::Serialize;

/// The kind of an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ErrorKind {
    /// A translation of a linear axis along itself.
    Positioning,
    /// A translation of a linear axis across itself.
    Straightness,
    /// A rotation of the carriage of a linear axis.
    Angular,
    /// The orientation of a linear axis, or of the spindle.
    Squareness,
    /// The position of an axis.
    Position,
    /// The orientation of a rotary axis.
    Orientation,
    /// A translation of a rotary axis across itself.
    Radial,
    /// A translation of a rotary axis along itself.
    Axial,
    /// A rotation of a rotary axis across itself.
    Tilt,
    /// A rotation of a rotary axis about itself.
    AngularPositioning,
}

impl ErrorKind {
    /// All of them, in the order of their numbers in a class; the first [`ErrorKind::OF_LINEAR_AXES`] belong to linear
    /// axes.
    pub const ALL: [Self; 10] = [
        Self::Positioning,
        Self::Straightness,
        Self::Angular,
        Self::Squareness,
        Self::Position,
        Self::Orientation,
        Self::Radial,
        Self::Axial,
        Self::Tilt,
        Self::AngularPositioning,
    ];

    /// Number of the kinds of linear axes.
    pub const OF_LINEAR_AXES: usize = 4;

    /// Returns the name in a class and in a cost model.
    pub fn name(self) -> &'static str {
        match self {
            Self::Positioning => "positioning",
            Self::Straightness => "straightness",
            Self::Angular => "angular",
            Self::Squareness => "squareness",
            Self::Position => "position",
            Self::Orientation => "orientation",
            Self::Radial => "radial",
            Self::Axial => "axial",
            Self::Tilt => "tilt",
            Self::AngularPositioning => "angular_positioning",
        }
    }

    /// Returns the section of a class that has its number.
    pub fn section(self) -> &'static str {
        if (self as usize) < Self::OF_LINEAR_AXES { "linear" } else { "rotary" }
    }

    /// Returns a direction that decides the unit of its number: a length or an angle.
    pub fn direction(self) -> Direction {
        match self {
            Self::Positioning | Self::Straightness | Self::Position | Self::Radial | Self::Axial => Direction::X,
            _ => Direction::A,
        }
    }

    /// True if its number in a class is per length of travel.
    pub fn grows_with_travel(self) -> bool {
        matches!(self, Self::Positioning | Self::Straightness)
    }

    /// Returns the kind of an error of an axis, or of the spindle without an axis; `along` says that it acts along or
    /// about the axis itself.
    pub fn of(axis: Option<&Axis>, error: &ErrorId, along: bool) -> Self {
        let rotary = axis.is_some_and(|axis| axis.kind == AxisKind::Rotary);
        match (error.family, error.direction.is_rotation()) {
            (ErrorFamily::Location, false) => Self::Position,
            (ErrorFamily::Location, true) if rotary => Self::Orientation,
            (ErrorFamily::Location, true) => Self::Squareness,
            (ErrorFamily::Component, true) if rotary && along => Self::AngularPositioning,
            (ErrorFamily::Component, true) if rotary => Self::Tilt,
            (ErrorFamily::Component, true) => Self::Angular,
            (ErrorFamily::Component, false) if rotary && along => Self::Axial,
            (ErrorFamily::Component, false) if rotary => Self::Radial,
            (ErrorFamily::Component, false) if along => Self::Positioning,
            (ErrorFamily::Component, false) => Self::Straightness,
        }
    }
}
