//! Content of a certificate.

use super::figures::{Figures, RaisedFigure};
use super::sign_test::Strongest;
use super::single_error::SingleErrorResidual;
use super::zero_shift::ZeroShift;
use crate::controller::kinematics::SignTrials;
use crate::machine::Approach;

/// A certificate: the deviations that a set of files leaves, over the volume and error by error.
#[derive(Debug, Clone)]
pub struct Certificate {
    /// The number of poses.
    pub poses: usize,
    /// The direction of approach that is worse after compensation.
    pub approach: Approach,
    /// Figures without the files.
    pub uncompensated: Figures,
    /// Figures with the files.
    pub compensated: Figures,
    /// Every error alone.
    pub errors: Vec<SingleErrorResidual>,
    /// The number of poses that the figures of single errors rest on.
    pub single_error_poses: usize,
    /// The motions that are added at home, or with all axes at 0 where the file states no home, approached forward and
    /// in reverse (mm, deg).
    pub at_reference: [Vec<f64>; 2],
    /// The effect of a new reference position, where tables must vanish at it.
    pub shifted: Option<ZeroShift>,
    /// Figures with straight lines between points, where the control has them as an option; else they step.
    pub straight: Option<Figures>,
    /// Figures that are larger with the files than without them.
    pub raised: Vec<RaisedFigure>,
    /// Figures of kinematic parameters by tool and by what a block programs; none of other mechanisms.
    pub programming: Vec<ProgrammingFigures>,
    /// The entry by which the sign is best tested; none if nothing is corrected.
    pub strongest: Option<Strongest>,
    /// Sign tests of kinematic parameters; none of other mechanisms.
    pub sign_trials: Option<SignTrials>,
}

/// The way in which blocks program the direction of the tool.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub enum ToolDirection {
    /// By a vector.
    #[serde(rename = "vector")]
    Vector,
    /// By the positions of the rotary axes.
    #[serde(rename = "rotary axes")]
    RotaryAxes,
}

/// Figures of a controller's transformation for one way to program the tool and one tool.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct ProgrammingFigures {
    /// The way in which blocks program the direction of the tool.
    pub tool_direction: ToolDirection,
    /// Name of the tool in the machine file, empty for the only one.
    pub tool: String,
    /// Length by which the tool is longer than that of the machine file, mm.
    pub longer_mm: f64,
    /// Figures without the parameters.
    pub uncompensated: Figures,
    /// Figures with them.
    pub compensated: Figures,
    /// The number of poses at a pole, where the controller keeps an axis.
    pub at_poles: usize,
    /// Figures with them without those poses; `None` if there are none, or no others.
    pub away_from_poles: Option<Figures>,
}
