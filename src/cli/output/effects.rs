//! What `eval` says besides deviations: `--sensitivity` with `--interactions`, and `--inverse`.

use super::session::Session;
use super::view::table;
use crate::analysis::interactions;
use crate::analysis::{Effect, Interactions, Inverse};
use crate::cli::Exit;
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::random_poses;
use crate::lower::{WeilLift, values};
use crate::machine::{Approach, AxisKind, Machine, Pose};
use crate::units::significant;
use serde_json::{Value, json};

/// Besides the poses asked for, the bound is taken over so many of the volume.
const BOUND_POSES: usize = 64;

/// Sensitivities at poses, and what order 1 neglects.
pub(crate) struct Effects {
    at: Vec<Interactions>,
    interacting: bool,
    /// mm and rad; `None` without `--interactions`.
    neglected: Option<(f64, f64)>,
}

impl Effects {
    pub(crate) fn new(
        session: &mut Session,
        machine: &Machine,
        poses: &[Pose],
        approach: Approach,
        interacting: bool,
    ) -> Result<Self, Exit> {
        let calculation =
            interactions(machine, 1 + u8::from(interacting)).or_else(|refusal| session.refuse(refusal))?;
        let at: Vec<Interactions> = poses.iter().map(|pose| calculation.at(pose, approach)).collect();
        let bound = || {
            let volume = random_poses(machine, BOUND_POSES, 1)
                .into_iter()
                .map(|pose| calculation.at(&pose, approach).neglected());
            let worst = |a: (f64, f64), b: (f64, f64)| (a.0.max(b.0), a.1.max(b.1));
            volume.chain(at.iter().map(Interactions::neglected)).fold((0.0, 0.0), worst)
        };
        let neglected = interacting.then(bound);
        Ok(Self { at, interacting, neglected })
    }

    /// `order 1 is good to 3 nm on this machine`.
    pub(crate) fn sentence(&self) -> Option<String> {
        self.neglected.map(|(position, rotation)| {
            format!(
                "order 1 is good to {} nm and {} nrad on this machine (all interactions of second degree with one sign, \
                 at the worst of these poses and {BOUND_POSES} of its volume)",
                significant(position * 1e6, 2),
                significant(rotation * 1e9, 2)
            )
        })
    }

    pub(crate) fn text(&self) -> String {
        let mut text = String::new();
        for (number, at) in self.at.iter().enumerate() {
            text.push_str(&format!("Pose {}: what 1 um or 1 urad of an error does\n", number + 1));
            text.push_str(&format!("{}\n", first_table(&at.first)));
            if self.interacting {
                text.push_str(&format!(
                    "Interactions that do most, with the errors as they are\n{}\n",
                    second_table(&at.second)
                ));
            }
        }
        self.sentence().map_or(text.clone(), |sentence| format!("{text}{sentence}\n"))
    }

    /// The sensitivities of one pose.
    pub(crate) fn json(&self, pose: usize) -> Vec<(&'static str, Value)> {
        let at = &self.at[pose];
        let list = |effects: &[Effect]| effects.iter().map(effect_json).collect::<Vec<_>>();
        let mut fields = vec![("sensitivity", json!(list(&at.first)))];
        if self.interacting {
            fields.push(("interactions", json!(list(&at.second))));
            let (position, rotation) = at.neglected();
            fields.push(("order_1_neglects", json!({"position_mm": position, "rotation_rad": rotation})));
        }
        fields
    }
}

fn effect_json(effect: &Effect) -> Value {
    let row = |v: &nalgebra::Vector3<f64>| [v.x + 0.0, v.y + 0.0, v.z + 0.0];
    json!({
        "error": effect.errors.join("*"), "deviation": row(&effect.deviation), "rotation": row(&effect.rotation),
        "value": effect.value,
    })
}

fn first_table(effects: &[Effect]) -> comfy_table::Table {
    let mut table = table(&["error", "dx um", "dy um", "dz um", "wx urad", "wy urad", "wz urad"]);
    for effect in effects {
        // mm per rad are nm per urad: 1e-3 um.
        let angle = effect.rotation != nalgebra::Vector3::zeros();
        let scale = if angle { 1e-3 } else { 1.0 };
        let cells = effect.deviation.iter().map(|x| significant(x * scale + 0.0, 5));
        let cells = cells.chain(effect.rotation.iter().map(|x| significant(*x + 0.0, 5)));
        let _ = table.add_row(std::iter::once(effect.errors.join("*")).chain(cells).collect::<Vec<_>>());
    }
    table
}

/// How many interactions a person reads.
const SHOWN: usize = 12;

fn second_table(effects: &[Effect]) -> comfy_table::Table {
    let mut table = table(&["errors", "dx nm", "dy nm", "dz nm"]);
    let size = |e: &Effect| e.deviation.norm() * e.value.abs();
    let mut order: Vec<&Effect> = effects.iter().filter(|e| size(e) > 0.0).collect();
    order.sort_by(|a, b| size(b).total_cmp(&size(a)));
    for effect in order.into_iter().take(SHOWN) {
        let cells = effect.deviation.iter().map(|x| significant(x * effect.value * 1e6 + 0.0, 4));
        let _ = table.add_row(std::iter::once(effect.errors.join(" * ")).chain(cells).collect::<Vec<_>>());
    }
    table
}

/// Displacements of the axes that undo the errors, over an algebra: mm and deg, by axis.
pub(crate) fn inverse(
    session: &mut Session,
    machine: &Machine,
    pose: &Pose,
    lift: &WeilLift,
    approach: Approach,
) -> Result<Vec<(String, f64)>, Exit> {
    let errors = values(machine, pose, approach);
    let problem = Inverse::new(machine, pose, &errors);
    let solution = problem.solve(lift, lift.basis().order());
    let Ok(by) = solution else {
        return session.refuse(
            Diagnostic::new(codes::E0524, "the axes cannot be solved for at this pose: a division by an element whose real part is zero")
                .help("`--inverse` needs three linear axes that are independent, with or without two rotary ones, at a pose that is not singular"),
        );
    };
    let displacement = |(axis, by): (&usize, &crate::algebra::Weil)| {
        let axis = &machine.axes()[*axis];
        let sum = crate::algebra::difference(by, 0.0);
        (axis.name.to_string(), if axis.kind == AxisKind::Rotary { sum.to_degrees() } else { sum })
    };
    Ok(problem.moved().iter().zip(&by).map(displacement).collect())
}
