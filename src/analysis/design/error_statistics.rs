//! Deviations by each error alone over a volume, to first order.

use crate::evaluate::{Deviation, Field, Poses, Summary, error_by_error};
use crate::machine::{Approach, ErrorId, ErrorTerm, Machine};
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
/// is the pose (mm, deg) of [`ErrorStatistics::along`].
pub fn error_statistics(field: &dyn Field, poses: &Poses, worst: &[f64], approach: Approach) -> Vec<ErrorStatistics> {
    let machine = field.machine();
    let rows: Vec<Vec<Deviation>> = (0..poses.len())
        .into_par_iter()
        .map(|i| error_by_error(machine, &poses.get(i), approach).into_iter().map(|(_, d)| d).collect())
        .collect();
    let all = field.deviation(worst, approach).position.try_normalize(0.0).unwrap_or_default();
    let at_worst = error_by_error(machine, worst, approach);
    let column = |k: usize, pick: fn(&Deviation) -> Vector3<f64>| -> Summary {
        Summary::of(&rows.iter().map(|row| pick(&row[k])).collect::<Vec<_>>())
    };
    let source = |k: usize| ErrorStatistics {
        error: at_worst[k].0.clone(),
        position: column(k, |d| d.position * 1e3),
        rotation: column(k, |d| d.rotation * 1e6),
        along: at_worst[k].1.position.dot(&all) * 1e3,
    };
    let mut sources: Vec<ErrorStatistics> = known(machine).into_iter().map(source).collect();
    sources.sort_by(|a, b| b.position.p95.total_cmp(&a.position.p95));
    sources
}

/// Returns the indices in [`Machine::errors`] of those that have a value: tolerances have none.
fn known(machine: &Machine) -> Vec<usize> {
    let valued = |(_, (_, term)): &(usize, (ErrorId, &ErrorTerm))| !matches!(term, ErrorTerm::Tolerance(_));
    machine.errors().enumerate().filter(valued).map(|(k, _)| k).collect()
}
