//! The conventions decoded for one axis: lowering, compilation, conversion and checks read this value and
//! never the words of [`Conventions`] about order, side and sense.

use super::{Axis, AxisKind, Branch, Conventions, ErrorsAre, LinearOrder, Location, RotaryOrder};

/// A side of a joint's motion on the walk from the workpiece to the tool.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionSide {
    /// Before the motion, on the side of the workpiece: `E M`.
    Outer,
    /// After the motion, on the side of the tool: `M E`.
    Inner,
}

/// An error matrix as a factor beside the motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ErrorFactor {
    /// Its side of the motion.
    pub side: MotionSide,
    /// True if the inverse of the matrix is the factor.
    pub inverse: bool,
}

impl ErrorFactor {
    /// Returns the sign with which the errors count to first order.
    pub fn sign(self) -> f64 {
        if self.inverse { -1.0 } else { 1.0 }
    }
}

/// The action of a location error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LocationAction {
    /// `Loc N Loc^-1`: the line of motion is displaced.
    Displaces,
    /// A factor beside motion and component errors.
    Factor(ErrorFactor),
}

/// The order of the factors of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointConvention {
    /// +1, or -1 where a positive command moves the tool in minus relative to the workpiece.
    pub motion_sign: f64,
    /// The point (mm) about which motion and errors turn.
    pub pivot: [f64; 3],
    /// The component errors.
    pub component: ErrorFactor,
    /// The location error, outside motion and component errors where it is a factor.
    pub location: LocationAction,
}

impl Axis {
    /// Decodes conventions for this axis. The two sides of the bed are mirror images: the matrix of a joint is
    /// always the motion of the tool relative to the workpiece.
    pub fn convention(&self, conventions: &Conventions) -> JointConvention {
        let inverse = conventions.errors_are == ErrorsAre::Body && self.branch == Branch::Workpiece;
        let on_guide = match self.kind {
            AxisKind::Linear => conventions.linear == LinearOrder::Before,
            AxisKind::Rotary => conventions.rotary == RotaryOrder::Stationary,
        };
        let towards_bed = match self.branch {
            Branch::Workpiece => MotionSide::Inner,
            Branch::Tool => MotionSide::Outer,
        };
        let location = match conventions.location {
            Location::AxisOnly => LocationAction::Displaces,
            Location::CarriedBody => LocationAction::Factor(ErrorFactor { side: towards_bed, inverse }),
        };
        let side = if on_guide { towards_bed } else { towards_bed.opposite() };
        let component = ErrorFactor { side, inverse };
        JointConvention { motion_sign: self.sign(), pivot: self.origin, component, location }
    }
}

impl MotionSide {
    fn opposite(self) -> Self {
        match self {
            Self::Outer => Self::Inner,
            Self::Inner => Self::Outer,
        }
    }
}
