//! Deviations by each error alone over a volume, to first order.

use crate::evaluate::{Field, Poses, Summary};
use crate::lower::{JointError, NominalJoints, Quantity};
use crate::machine::{ErrorId, ErrorTerm, OperatingPoint, Pose};
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
/// is the operating point of [`ErrorStatistics::along`]; its conditions are those of all poses.
pub fn error_statistics(field: &dyn Field, poses: &Poses, worst: &OperatingPoint<'_>) -> Vec<ErrorStatistics> {
    let machine = field.machine();
    let visit = |pose: Pose| (NominalJoints::at(machine, &pose), pose);
    // What hangs on the geometry alone is computed once a pose, for all errors.
    let visits: Vec<Visit> = (0..poses.len()).into_par_iter().map(|i| visit(poses.get(i))).collect();
    let joints = NominalJoints::at(machine, worst.axes);
    let at = |pose| worst.conditions.at_pose(pose);
    let all = field.deviation(worst).position.try_normalize(0.0).unwrap_or_default();
    let valued: Vec<(ErrorId, &ErrorTerm)> =
        machine.errors().filter(|(_, term)| !matches!(term, ErrorTerm::Tolerance(_))).collect();
    let source = |(id, term): &(ErrorId, &ErrorTerm)| {
        let error = JointError::new(machine, id);
        let value = |pose| term.value(&error.argument(&at(pose)));
        let values: Vec<f64> = visits.iter().map(|(_, pose)| value(pose)).collect();
        let summary = |quantity, unit: f64| {
            let effect = |((joints, _), value): (&Visit, &f64)| error.effect(joints, quantity) * *value * unit;
            Summary::of(&visits.iter().zip(&values).map(effect).collect::<Vec<_>>())
        };
        let along = error.effect(&joints, Quantity::Position) * value(worst.axes);
        ErrorStatistics {
            error: id.clone(),
            position: summary(Quantity::Position, 1e3),
            rotation: summary(Quantity::Rotation, 1e6),
            along: along.dot(&all) * 1e3,
        }
    };
    let mut sources: Vec<ErrorStatistics> = valued.par_iter().map(source).collect();
    sources.sort_by(|a, b| b.position.p95.total_cmp(&a.position.p95));
    sources
}

/// A pose (mm, deg) with the joints there.
type Visit = (NominalJoints, Pose);
