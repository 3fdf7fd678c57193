//! Intervals of the headline figures by the uncertainty that a machine file states of its errors.

use super::reference::{PartReference, RigidMotion, tip_at};
use super::{Bands, Comparison, UncertainDeviations, band_places, bands, part_models, uncertain_parts};
use crate::evaluate::{CompiledModel, Field, Frame, Poses, Statistics, frame_rotation};
use crate::machine::{Machine, OperatingConditions, Pose};
use nalgebra::Vector3;
use rayon::prelude::*;
use serde::Serialize;

/// Expanded uncertainty (k = 2) of the deviation at a pose, component by component, to first order.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, schemars::JsonSchema)]
pub struct PoseUncertainty {
    /// Uncertainty of the position of the functional point, mm.
    pub deviation: [f64; 3],
    /// Uncertainty of the orientation of the tool, rad.
    pub rotation: [f64; 3],
}

impl PoseUncertainty {
    /// Returns the uncertainty at poses (mm, deg) in a frame, without what a reference takes out. `None` where the
    /// machine states none, and with a minimum zone.
    pub(crate) fn at(
        machine: &Machine,
        poses: &[Pose],
        conditions: OperatingConditions,
        frame: Frame,
        reference: Option<&PartReference>,
    ) -> Option<Vec<Self>> {
        let parts = machine.uncertain_parts();
        if parts.is_empty() || !is_linear(&[reference]) {
            return None;
        }
        let models = part_models(machine, &parts, conditions);
        let motion = |model: &CompiledModel| {
            reference.map(|of| of.motion(of.points().iter().map(|point| model.deviation(&point.pose).position)))
        };
        let motions: Vec<Option<RigidMotion>> = models.par_iter().map(motion).collect();
        let one = |pose: &Pose| {
            let tip = tip_at(machine, pose);
            let turned = frame_rotation(machine, pose, frame);
            let mut squares = [Vector3::zeros(); 2];
            for (model, motion) in models.iter().zip(&motions) {
                let whole = model.deviation(pose);
                let unturned = motion.map_or(whole, |motion| motion.removed_from(&whole, &tip));
                let effect = turned.map_or(unturned, |rotation| unturned.rotated(&rotation));
                squares[0] += effect.position.component_mul(&effect.position);
                squares[1] += effect.rotation.component_mul(&effect.rotation);
            }
            let [deviation, rotation] = squares.map(|sum| sum.map(|x| 2.0 * x.sqrt()).into());
            Self { deviation, rotation }
        };
        Some(poses.par_iter().map(one).collect())
    }
}

/// Intervals of the statistics of a machine beside another. Machines share the uncertainty that both files state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ComparedBands {
    /// Those of the machine.
    #[serde(flatten)]
    pub own: Bands,
    /// Those of its statistics minus the first machine's.
    pub minus_first: Bands,
    /// True if the 95 % position deviation differs from the first machine's by more than the uncertainty.
    pub told_apart: bool,
}

/// True if no reference is a minimum zone, whose motion does not follow single parts of an uncertainty.
fn is_linear(references: &[Option<&PartReference>]) -> bool {
    references.iter().flatten().all(|of| of.is_linear())
}

/// Returns the intervals of the figures of a field over poses, of which `whole` are the statistics and `besides` the
/// indices of poses not to be left out; a reference that the field is without is taken out of each part too. `None`
/// where the machine states no uncertainty, and with a minimum zone.
pub(crate) fn field_bands(
    field: &dyn Field,
    poses: &Poses,
    whole: Statistics,
    besides: &[usize],
    conditions: OperatingConditions,
    seed: u64,
    reference: Option<&PartReference>,
) -> Option<Bands> {
    let machine = field.machine();
    let parts = uncertain_parts([machine]);
    if parts.is_empty() || !is_linear(&[reference]) {
        return None;
    }
    let places: Vec<Pose> = band_places(poses.len(), besides).into_iter().map(|i| poses.get(i)).collect();
    let values = places.par_iter().map(|pose| field.deviation(&conditions.at_pose(pose))).collect();
    let deviations = UncertainDeviations::of(machine, &parts, &places, values, whole, conditions, reference);
    bands(&UncertainDeviations::with_principal_parts(vec![deviations]), seed).0.pop()
}

/// Returns the intervals of all machines; `None` where no file states an uncertainty, and with minimum zones.
pub(crate) fn compared_bands(
    sides: &[(&Machine, Vec<Pose>)],
    comparison: &Comparison,
    conditions: OperatingConditions,
    seed: u64,
    references: &[Option<&PartReference>],
) -> Option<Vec<ComparedBands>> {
    let parts = uncertain_parts(sides.iter().map(|(machine, _)| *machine));
    if parts.is_empty() || !is_linear(references) {
        return None;
    }
    let places = band_places(comparison.common.len(), &[]);
    let of = |i: usize| {
        let side = &comparison.machines[i];
        let (poses, values): (Vec<Pose>, Vec<_>) = places.iter().map(|place| side.reached[*place].clone()).unzip();
        UncertainDeviations::of(sides[i].0, &parts, &poses, values, side.statistics, conditions, references[i])
    };
    let machines = UncertainDeviations::with_principal_parts((0..sides.len()).map(of).collect());
    let (own, differences) = bands(&machines, seed);
    let both = own.into_iter().zip(differences).map(|(own, minus_first)| {
        let [low, high] = minus_first.position_um.p95;
        ComparedBands { own, minus_first, told_apart: low > 0.0 || high < 0.0 }
    });
    Some(both.collect())
}
