//! Lowering: a machine at a pose becomes matrices over an algebra, in one documented order.
//!
//! 1. [`values`] looks the errors of every joint up at the operating point (mm, rad).
//! 2. [`ErrorLift`] turns each number into an element: itself over the reals, `value * i` over D_n.
//! 3. [`joint()`] builds the matrix G of one joint from them, by the conventions.
//! 4. [`Chain`] multiplies the joints on the walk from the workpiece to the tool.
//!
//! First-order effects have two kernels: [`twists`] at the nominal machine, with the [`sensitivities`] they yield, and
//! [`position_jacobian`] and [`direction_jacobian`], the derivatives over any algebra at the actual errors.

mod chain;
mod generators;
mod joint;
mod source;
mod tangent;
mod twist;

pub use chain::{Chain, NominalPose, into_part, positions};
pub use generators::{DeclaredAlgebra, NamedSource, WeilLift, named_sources, unit_values};
pub use joint::{JointElements, JointFactor, JointPosition, error_motion, invert_if, joint, joint_factors};
pub use source::{AxisErrorValues, ErrorLift, ErrorSite, ErrorValues, Exact, OrderN, Source, values};
pub use tangent::{PositionJacobian, direction_jacobian, point, position_jacobian};
pub use twist::{
    JointError, NominalJoints, Quantity, Sensitivity, SideWeights, Twist, TwistMap, sensitivities, sensitivities_to,
    twists,
};
