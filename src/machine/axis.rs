//! An axis of the resolved machine.

use super::{AxisName, Branch, ControllerAxis, Sense};
use crate::syntax::DatumZero;

/// The kind of motion of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum AxisKind {
    /// It moves along its direction; positions in mm.
    Linear,
    /// It turns about its direction through its origin; positions in deg.
    Rotary,
}

impl AxisKind {
    /// Returns the unit of positions.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Linear => "mm",
            Self::Rotary => "deg",
        }
    }

    /// Returns the step (mm, deg) of maps and tables of a file that states none.
    pub fn default_step(self) -> f64 {
        match self {
            Self::Linear => 25.0,
            Self::Rotary => 15.0,
        }
    }
}

/// The travel of an axis, in mm or deg as programmed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Travel {
    /// Minimum and maximum.
    Range(f64, f64),
    /// Any number of turns; curves have the period 360 deg.
    Continuous,
}

impl Travel {
    /// Returns the interval in which maps and tables are computed by default.
    pub fn interval(self) -> (f64, f64) {
        match self {
            Self::Range(min, max) => (min, max),
            Self::Continuous => (0.0, 360.0),
        }
    }

    /// True if the position (mm or deg) is within the travel.
    pub fn contains(self, position: f64) -> bool {
        match self {
            Self::Range(min, max) => (min..=max).contains(&position),
            Self::Continuous => true,
        }
    }
}

/// An axis: geometry in machine coordinates at the zero pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Its name.
    pub name: AxisName,
    /// Linear or rotary.
    pub kind: AxisKind,
    /// Unit vector.
    pub direction: [f64; 3],
    /// A point of a rotary axis's line; the point about which a linear axis's angular errors turn (mm).
    pub origin: [f64; 3],
    /// Its travel.
    pub travel: Travel,
    /// Its side of the bed.
    pub branch: Branch,
    /// Sense of a positive command if it is on the workpiece side; without effect on the tool side.
    pub sense: Sense,
    /// Its letter and number in the controller, where the file states them.
    pub controller: ControllerAxis,
    /// The position (mm or deg) at which the control homes it, where the file states it.
    pub home: Option<f64>,
}

impl Axis {
    /// +1, or -1 where a positive command moves the tool in minus relative to the workpiece.
    pub fn sign(&self) -> f64 {
        if self.branch == Branch::Workpiece && self.sense == Sense::Direct { -1.0 } else { 1.0 }
    }

    /// Returns the position (mm or deg) in a range at which a fit brings its positioning and angular errors to zero;
    /// `None` where it leaves them.
    pub fn datum_zero(&self, zero: DatumZero, [min, max]: [f64; 2]) -> Option<f64> {
        let turns = self.kind == AxisKind::Rotary && self.travel == Travel::Continuous;
        match zero {
            DatumZero::Free => None,
            _ if turns => Some(0.0),
            DatumZero::Start => Some(min),
            DatumZero::Middle => Some(0.5 * (min + max)),
            DatumZero::Machine => Some(0.0_f64.clamp(min, max)),
        }
    }

    /// Returns the unit of its positions.
    pub fn unit(&self) -> &'static str {
        self.kind.unit()
    }
}
