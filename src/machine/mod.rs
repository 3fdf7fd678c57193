//! The resolved machine: what every later stage works on. It can only be built valid.
//!
//! Geometry is in machine coordinates at the zero pose (all axes at 0), mm; errors are in mm and
//! rad; positions of axes are as programmed, mm and deg. A [`Pose`] lists them in the order of
//! [`Machine::axes`], the walk from workpiece to tool.

mod algebra;
mod arrangement;
mod axis;
mod basis_words;
mod bspline;
mod chain;
mod class;
mod controller_axis;
mod conventions;
mod curve;
mod difference;
mod errors;
mod form;
mod frame;
mod geometry;
mod joint;
mod joint_uncertainty;
mod kind;
mod knots;
mod look;
mod model;
mod name;
mod operating_point;
mod resolve;
mod set_up;
mod tolerances;
mod uncertainty;
mod unheld;
mod written;

pub use algebra::{AlgebraChoice, Generators, NamedRelation};
pub use axis::{Axis, AxisKind, Travel};
pub(crate) use basis_words::basis_of_term;
pub use bspline::{BSpline, BSplineFailure};
pub use chain::{Body, Branch, KinematicChain, RepeatedJoints};
pub use class::{CLASS_NAMES, Class, ClassNumbers, NamedClass, classes};
pub use controller_axis::ControllerAxis;
pub use conventions::{Conventions, ErrorsAre, Joints, LinearOrder, Location, LocationOrder, RotaryOrder, Sense};
pub use curve::{Curve, sin_cos_degrees};
pub use difference::{ErrorSizes, MachineProperty};
pub use errors::{ComponentError, ErrorTerm, JointErrors};
pub use form::ResidualForm;
pub use frame::{Frames, JointFrame};
pub use geometry::{AxisGeometry, Geometry, Origins, Position, ReferencePoint, SideGeometry, Sides, Unstated};
pub use joint::{ErrorFactor, JointConvention, LocationAction, MotionSide};
pub use joint_uncertainty::JointUncertainty;
pub use kind::ErrorKind;
pub use knots::{Knots, KnotsFailure};
pub use look::{BodyMesh, Look};
pub use model::{
    AxisPositions, Grid, Machine, MachineParts, MovedLine, Pose, Provenance, Tool, axis_positions, rotation_of,
};
pub use name::{AxisName, Direction, ErrorFamily, ErrorId, MAIN_AXES};
pub use operating_point::{Approach, CurveArgument, OperatingConditions, OperatingPoint, OperatingState};
pub use resolve::{
    CLASS_ANGLES, FITTED_GROUPS, error_name_in_capitals, largest, largest_stated, look, no_origin, parse_error_name,
    plausible_size, questions, resolve,
};
pub use set_up::SetUp;
pub use tolerances::{FRAME_KEYS, FrameTolerances, Tolerances};
pub use uncertainty::UncertainPart;
pub use unheld::UnheldMotion;
pub use written::machine_file;
