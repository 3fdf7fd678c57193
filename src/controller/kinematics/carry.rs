//! The content of a kinematics module, and the machines that it fits.

use super::constants::LinearMap;
use super::data::{ModuleModel, WORLD};
use super::parameters::Parameters;
use super::topology;
use crate::compensation::{KinematicsMechanism, ModuleContent};
use crate::controller::manifest::{ControllerTarget, axis_letters};
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::Machine;

/// The numbers of a module.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub enum KinematicsModule {
    /// The chain with every error.
    FullModel(ModuleModel),
    /// X, Y, Z to their joints.
    LinearMap(LinearMap),
    /// Parameters of the controller's own transformation.
    KinematicParameters(Parameters),
}

impl KinematicsModule {
    /// Takes the module's errors from a machine. Refusals: E0601, E0750, E0751, E0752.
    pub fn of(machine: &Machine, target: &ControllerTarget, orientation: bool) -> Result<Self, Diagnostic> {
        let Some(mechanism) = target.manifest.kinematics() else {
            return Err(Diagnostic::new(codes::E0703, "this target does not replace the kinematics"));
        };
        let carried = match mechanism.carries {
            ModuleContent::FullModel => Self::FullModel(ModuleModel::of(machine, mechanism.damping, orientation)?),
            ModuleContent::LinearMap => Self::LinearMap(LinearMap::fit(machine, &letters(machine, target)?)?),
            ModuleContent::KinematicParameters => {
                Self::KinematicParameters(Parameters::of(machine, mechanism, orientation)?)
            }
        };
        Ok(carried.quantise(mechanism))
    }

    /// The same with the machine's tool, which a full model has from the controller (G43) and not from its files.
    #[must_use]
    pub fn with_tool_of(self, machine: &Machine) -> Self {
        match self {
            Self::FullModel(model) => Self::FullModel(ModuleModel { tool: super::data::tool(machine), ..model }),
            other => other,
        }
    }

    /// The same for the position alone.
    #[must_use]
    pub fn without_orientation(self) -> Self {
        match self {
            Self::FullModel(model) => Self::FullModel(ModuleModel { orientation: false, ..model }),
            Self::KinematicParameters(parameters) => Self::KinematicParameters(parameters.with_programming(false)),
            other => other,
        }
    }

    /// True if the direction of the tool is corrected: by a full model, or by a transformation that is given it.
    pub fn orientation(&self) -> bool {
        match self {
            Self::FullModel(model) => model.orientation,
            Self::KinematicParameters(parameters) => parameters.vectors,
            Self::LinearMap(_) => false,
        }
    }

    /// Kinematic parameters for a machine that was measured with other parameters in force.
    #[must_use]
    pub fn on_top_of(self, installed: Vec<f64>) -> Self {
        match self {
            Self::KinematicParameters(parameters) => Self::KinematicParameters(parameters.on_top_of(installed)),
            other => other,
        }
    }

    /// Returns the module that takes this one back: parameters as they were before, or the model of the machine without
    /// errors. Refusals: those of [`Self::of`].
    pub fn restored(&self, machine: &Machine, target: &ControllerTarget) -> Result<Self, Diagnostic> {
        match self {
            Self::KinematicParameters(parameters) => Ok(Self::KinematicParameters(parameters.restored())),
            _ => Ok(Self::of(&machine.filtered(|_| false), target, self.orientation())?.with_tool_of(machine)),
        }
    }

    /// The parameters of a controller's own transformation, if the module is that.
    pub fn parameters(&self) -> Option<&Parameters> {
        match self {
            Self::KinematicParameters(parameters) => Some(parameters),
            Self::FullModel(_) | Self::LinearMap(_) => None,
        }
    }

    /// Returns the warnings for a programmer: W0601, W0760, W0761.
    pub fn warnings(&self, machine: &Machine) -> Vec<Diagnostic> {
        match self {
            Self::FullModel(model) => topology::warnings(machine, model),
            Self::LinearMap(_) | Self::KinematicParameters(_) => Vec::new(),
        }
    }

    /// Rounds the numbers to those that the files can hold.
    fn quantise(self, mechanism: &KinematicsMechanism) -> Self {
        let decimals = mechanism.increment.correction_decimals;
        match self {
            Self::FullModel(model) => Self::FullModel(model),
            Self::LinearMap(map) => Self::LinearMap(map.round(decimals)),
            Self::KinematicParameters(parameters) => Self::KinematicParameters(parameters),
        }
    }
}

/// Returns for each axis of the walk its coordinate in [`WORLD`] and its joint.
fn letters(machine: &Machine, target: &ControllerTarget) -> Result<Vec<(usize, usize)>, Diagnostic> {
    let assigned = axis_letters(machine, target.manifest.axis_letters.as_ref(), None).ok_or_else(|| {
        Diagnostic::new(codes::E0601, "the controller has not letters enough for the axes of this machine")
            .help("this target knows the letters X Y Z, U V W and A B C")
    })?;
    let mut found = vec![None; machine.axes().len()];
    for (joint, known) in assigned.iter().enumerate() {
        found[known.axis] = WORLD.find(known.letter.as_str()).map(|coordinate| (coordinate, joint));
    }
    found.into_iter().collect::<Option<Vec<_>>>().ok_or_else(|| {
        Diagnostic::new(codes::E0750, "an axis has a letter that is no coordinate of the world")
            .help("the target's `axis_letters` must be among X Y Z A B C U V W")
    })
}
