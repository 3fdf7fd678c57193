//! Effects beside deviations: of errors one by one and two by two, and motions of the axes that undo the errors.

use crate::algebra::difference;
use crate::analysis::{Interactions, Inverse, ProductEffect, interactions};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::random_poses;
use crate::job::poses::AxisPositions;
use crate::lower::{WeilLift, into_part, values};
use crate::machine::{AxisKind, Machine, OperatingConditions, OperatingPoint, Pose};
use crate::run::{Call, Refused};
use nalgebra::Vector3;

/// Poses of the volume over which the bound is taken, besides those asked for.
pub(crate) const BOUND_POSES: usize = 64;

/// Maximum number of effects that are held.
pub(crate) const MAX_EFFECTS: usize = 250_000;

/// Effect of an error, or of a pair of errors, at a pose; workpiece frame.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct ErrorEffect {
    /// Name of the error; of a pair `A*B`.
    pub error: String,
    /// Displacement of the functional point when each error is 1 mm or 1 rad, mm.
    pub deviation: [f64; 3],
    /// Rotation of the tool, rad.
    pub rotation: [f64; 3],
    /// Product of the values of the errors at the pose, mm and rad.
    pub value: f64,
}

/// A pose at which the tool is parallel to a rotary axis: the position alone is solved for.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct InversePole {
    /// The rotary axis that is free: it does not turn the tool axis.
    pub free: String,
    /// Unit vector across the tool axis, workpiece frame, into which no axis turns it.
    pub unreachable: [f64; 3],
}

/// Bound of the terms that order 1 neglects: all interactions of second degree with one sign.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Neglected {
    /// Displacement of the functional point, mm.
    pub position_mm: f64,
    /// Rotation of the tool, rad.
    pub rotation_rad: f64,
}

impl Neglected {
    fn of(interactions: &Interactions) -> Self {
        let (position_mm, rotation_rad) = interactions.neglected_bound();
        Self { position_mm, rotation_rad }
    }

    fn max(self, other: Self) -> Self {
        let (position_mm, rotation_rad) =
            (self.position_mm.max(other.position_mm), self.rotation_rad.max(other.rotation_rad));
        Self { position_mm, rotation_rad }
    }
}

pub(crate) struct Effects {
    pub sensitivity: Vec<ErrorEffect>,
    pub interactions: Option<Vec<ErrorEffect>>,
    pub neglected: Option<Neglected>,
}

/// Returns the effects at each pose, and the bound of the terms that order 1 neglects over them and over the volume.
pub(crate) fn effects(
    call: &mut Call,
    machine: &Machine,
    poses: &[Pose],
    conditions: OperatingConditions,
    interacting: bool,
) -> Result<(Vec<Effects>, Option<Neglected>), Refused> {
    let calculation = interactions(machine, 1 + u8::from(interacting)).or_else(|refusal| call.refuse(refusal))?;
    let each = poses.first().map_or(0, |pose| {
        let one = calculation.at(&conditions.at_pose(pose));
        one.first.len() + one.second.len()
    });
    if each.saturating_mul(poses.len()) > MAX_EFFECTS {
        return call.usage(format!(
            "{} poses with {each} effects of errors each are too many: at most {MAX_EFFECTS} effects, so ask at fewer \
             poses, or without `--interactions`",
            poses.len()
        ));
    }
    let at: Vec<Interactions> = poses.iter().map(|pose| calculation.at(&conditions.at_pose(pose))).collect();
    let bound = || {
        let volume = random_poses(machine, BOUND_POSES, 1).into_iter();
        let volume = volume.map(|pose| Neglected::of(&calculation.at(&conditions.at_pose(&pose))));
        let none = Neglected { position_mm: 0.0, rotation_rad: 0.0 };
        volume.chain(at.iter().map(Neglected::of)).fold(none, Neglected::max)
    };
    let neglected = interacting.then(bound);
    let one = |at: &Interactions| Effects {
        sensitivity: list(&at.first),
        interactions: interacting.then(|| list(&at.second)),
        neglected: interacting.then(|| Neglected::of(at)),
    };
    Ok((at.iter().map(one).collect(), neglected))
}

fn list(effects: &[ProductEffect]) -> Vec<ErrorEffect> {
    let row = |v: &Vector3<f64>| [v.x + 0.0, v.y + 0.0, v.z + 0.0];
    let one = |effect: &ProductEffect| ErrorEffect {
        error: effect.errors.join("*"),
        deviation: row(&effect.deviation),
        rotation: row(&effect.rotation),
        value: effect.value,
    };
    effects.iter().map(one).collect()
}

/// Returns by how much the axes move to undo the errors, over an algebra: mm and deg, by axis.
pub(crate) fn inverse(
    call: &mut Call,
    machine: &Machine,
    at: &OperatingPoint<'_>,
    lift: &WeilLift,
) -> Result<(AxisPositions, Option<InversePole>), Refused> {
    let errors = values(machine, at);
    let problem = Inverse::new(machine, at.axes, &errors);
    let pole = problem.pole();
    // At a pole these stay where they are.
    let still: Vec<usize> = if pole.is_some() { problem.moving_axes()[3..].to_vec() } else { Vec::new() };
    let problem = if pole.is_some() { problem.of_position() } else { problem };
    let Ok(by) = problem.solve(lift, lift.basis().order()) else {
        let count = |kind: AxisKind| machine.axes().iter().filter(|axis| axis.kind == kind).count();
        let message = match count(AxisKind::Linear) {
            3 => "the linear axes cannot hold the point at this pose: they are not independent".to_owned(),
            linear => {
                let axes = if linear == 1 { "axis" } else { "axes" };
                format!("three conditions hold the point, and the machine has {linear} linear {axes} for them")
            }
        };
        let help = "`--inverse` needs three linear axes that are independent; two rotary ones besides hold the \
                    direction of the tool";
        return call.refuse(Diagnostic::new(codes::E0524, message).help(help));
    };
    let displacement = |(axis, by): (&usize, &crate::algebra::Weil)| {
        let axis = &machine.axes()[*axis];
        let sum = difference(by, 0.0);
        (axis.name.to_string(), if axis.kind == AxisKind::Rotary { sum.to_degrees() } else { sum } + 0.0)
    };
    let pole = pole.map(|pole| InversePole {
        free: machine.axes()[pole.free].name.to_string(),
        unreachable: into_part(machine, pole.unreachable).map(|x| x + 0.0).into(),
    });
    let still = still.iter().map(|axis| (machine.axes()[*axis].name.to_string(), 0.0));
    Ok((problem.moving_axes().iter().zip(&by).map(displacement).chain(still).collect(), pole))
}
