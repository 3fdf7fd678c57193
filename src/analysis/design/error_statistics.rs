//! Deviations by each error alone over a volume, to first order.

use crate::analysis::reference::{PartReference, ReferencePoint, tip_at};
use crate::evaluate::{Deviation, Field, Poses, Summary};
use crate::lower::{JointError, NominalJoints, Quantity};
use crate::machine::{ErrorId, ErrorTerm, OperatingPoint, Pose};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Statistics of the deviations by one error alone.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorStatistics {
    /// The error.
    pub error: ErrorId,
    /// Position deviation of the functional point over the poses, um.
    pub position: Summary,
    /// Rotation of the tool over the poses, urad.
    pub rotation: Summary,
    /// At one pose: the part of its deviation along the deviation of all errors together, um. The sum over
    /// the errors is (to first order) that deviation's length.
    pub along: f64,
}

/// Returns every error with a value, largest 95 % position deviation first; equal ones in the machine's order. `worst`
/// is the operating point of [`ErrorStatistics::along`]; its conditions are those of all poses. What the set-up of a
/// part takes out of the field is taken out of every effect.
pub fn error_statistics(
    field: &dyn Field,
    poses: &Poses,
    worst: &OperatingPoint<'_>,
    reference: Option<&PartReference>,
) -> Vec<ErrorStatistics> {
    let machine = field.machine();
    let tip = |pose: &[f64]| reference.map_or_else(Vector3::zeros, |_| tip_at(machine, pose));
    let visit = |pose: Pose| Visit { joints: NominalJoints::at(machine, &pose), tip: tip(&pose), pose };
    // What hangs on the geometry alone is computed once a pose, for all errors.
    let visits: Vec<Visit> = (0..poses.len()).into_par_iter().map(|i| visit(poses.get(i))).collect();
    let points = reference.map_or(&[][..], PartReference::points);
    let points: Vec<Visit> = points.par_iter().map(|point: &ReferencePoint| visit(point.pose.clone())).collect();
    let at_worst = visit(worst.axes.to_vec());
    let all = field.deviation(worst).position.try_normalize(0.0).unwrap_or_default();
    let valued: Vec<(ErrorId, &ErrorTerm)> =
        machine.errors().filter(|(_, term)| !matches!(term, ErrorTerm::Tolerance(_))).collect();
    let source = |(id, term): &(ErrorId, &ErrorTerm)| {
        let error = JointError::new(machine, id);
        let value = |pose: &[f64]| term.value(&error.argument(&worst.conditions.at_pose(pose)));
        let effect = |visit: &Visit, quantity| error.effect(&visit.joints, quantity) * value(&visit.pose);
        let motion = reference.map(|of| of.motion(points.iter().map(|point| effect(point, Quantity::Position))));
        let left = |visit: &Visit| {
            let [position, rotation] = [Quantity::Position, Quantity::Rotation].map(|of| effect(visit, of));
            let whole = Deviation { position, rotation };
            motion.map_or(whole, |motion| motion.removed_from(&whole, &visit.tip))
        };
        let all_left: Vec<Deviation> = visits.iter().map(left).collect();
        let summary = |of: fn(&Deviation) -> Vector3<f64>, unit: f64| {
            Summary::of(&all_left.iter().map(|deviation| of(deviation) * unit).collect::<Vec<_>>())
        };
        ErrorStatistics {
            error: id.clone(),
            position: summary(|of| of.position, 1e3),
            rotation: summary(|of| of.rotation, 1e6),
            along: left(&at_worst).position.dot(&all) * 1e3,
        }
    };
    let mut sources: Vec<ErrorStatistics> = valued.par_iter().map(source).collect();
    sources.sort_by(|a, b| b.position.p95.total_cmp(&a.position.p95));
    sources
}

/// A pose (mm, deg) with the joints there, and the place of the functional point on the part, mm.
struct Visit {
    joints: NominalJoints,
    tip: Vector3<f64>,
    pose: Pose,
}
