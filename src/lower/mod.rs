//! Lowering: a machine at a pose becomes matrices over an algebra, in one documented order.
//!
//! 1. [`values`] looks the errors of every joint up at the pose (mm, rad).
//! 2. [`ErrorLift`] turns each number into an element: itself over the reals, `value * i` over D_n.
//! 3. [`joint()`] builds the matrix G of one joint from them, as the conventions say.
//! 4. [`Chain`] multiplies the joints on the walk from the workpiece to the tool.
//!
//! [`sensitivities`] are derivatives at the nominal machine, [`position_jacobian`] at the actual errors.

mod chain;
mod generators;
mod joint;
mod sensitivity;
mod source;
mod tangent;

pub use chain::{Chain, NominalPose, positions};
pub use generators::{Declared, Given, WeilLift, given, presence};
pub use joint::{JointElements, Position, error_motion, invert_if, joint};
pub use sensitivity::{Sensitivity, sensitivities, sensitivities_to};
pub use source::{ErrorLift, ErrorSite, ErrorValues, Exact, OrderN, Source, values};
pub use tangent::{PositionJacobian, actual_point, point, position_jacobian};
