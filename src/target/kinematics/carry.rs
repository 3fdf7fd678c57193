//! What of a machine a kinematics module can carry, and which machines it can be for.

use super::constants::{Centres, LinearMap};
use super::data::{Model, WORLD};
use super::{Carries, KinematicsMechanism};
use crate::diagnostic::Diagnostic;
use crate::machine::{AxisKind, Machine};
use crate::target::{Target, assigned_letters};

/// The numbers of a module.
#[derive(Debug, Clone, PartialEq)]
pub enum Carried {
    /// The chain with every error.
    FullModel(Model),
    /// X, Y, Z to their joints.
    LinearMap(LinearMap),
    /// Lines of a tilting table.
    RotaryCentres(Centres),
}

impl Carried {
    /// Takes from a machine what the target's module carries. Refusals: E0601, E0750, E0751.
    pub fn of(machine: &Machine, target: &Target, orientation: bool) -> Result<Self, Diagnostic> {
        let Some(mechanism) = target.manifest.kinematics() else {
            return Err(Diagnostic::new("E0703", "this target does not replace the kinematics"));
        };
        let letters = letters(machine, target)?;
        let carried = match mechanism.carries {
            Carries::FullModel => Self::FullModel(full_model(machine, &letters, mechanism, orientation)?),
            Carries::LinearMap => Self::LinearMap(LinearMap::fitted(machine, &letters)?),
            Carries::RotaryCentres => Self::RotaryCentres(Centres::fitted(machine, &letters)?),
        };
        Ok(carried.quantised(mechanism))
    }

    /// Is the direction of the tool corrected? A full model says so itself, the others cannot.
    pub fn orientation(&self) -> bool {
        matches!(self, Self::FullModel(model) if model.orientation)
    }

    /// As the files can hold it.
    fn quantised(self, mechanism: &KinematicsMechanism) -> Self {
        let decimals = mechanism.increment.correction_decimals;
        match self {
            Self::FullModel(model) => Self::FullModel(model),
            Self::LinearMap(map) => Self::LinearMap(map.rounded(decimals)),
            Self::RotaryCentres(centres) => Self::RotaryCentres(centres.rounded(decimals)),
        }
    }
}

/// For each axis of the walk its coordinate in [`WORLD`] and its joint.
fn letters(machine: &Machine, target: &Target) -> Result<Vec<(usize, usize)>, Diagnostic> {
    let assigned = assigned_letters(machine, target.manifest.axis_letters.as_ref(), None).ok_or_else(|| {
        Diagnostic::new("E0601", "the controller has not letters enough for the axes of this machine")
            .help("this target knows the letters X Y Z, U V W and A B C")
    })?;
    let mut found = vec![None; machine.axes().len()];
    for (joint, (axis, letter)) in assigned.iter().enumerate() {
        found[*axis] = WORLD.find(letter.as_str()).map(|coordinate| (coordinate, joint));
    }
    found.into_iter().collect::<Option<Vec<_>>>().ok_or_else(|| {
        Diagnostic::new("E0750", "an axis has a letter that is no coordinate of the world")
            .help("the target's `axis_letters` must be among X Y Z A B C U V W")
    })
}

/// The tip is held by the linear axes X, Y and Z.
fn full_model(
    machine: &Machine,
    letters: &[(usize, usize)],
    mechanism: &KinematicsMechanism,
    orientation: bool,
) -> Result<Model, Diagnostic> {
    let model = Model::of(machine, letters, mechanism.damping, orientation);
    let linear = machine.axes().iter().zip(letters);
    let main = linear.filter(|(axis, (letter, _))| axis.kind == AxisKind::Linear && *letter < 3).count();
    let refused = |why: &str| Diagnostic::new("E0750", format!("{why}: this kinematics module cannot hold the tip"));
    if main < 3 {
        return Err(refused("the machine has not the three linear axes X, Y and Z")
            .help("the tip is brought to its place by X, Y and Z; robots and lathes without Y need another target"));
    }
    if model.command(&model.setting(), &[0.0; 9]).is_none() {
        return Err(refused("with all axes at 0 the linear axes X, Y and Z do not span the room")
            .help("check the directions of X, Y and Z"));
    }
    Ok(model)
}
