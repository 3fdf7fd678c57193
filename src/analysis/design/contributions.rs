//! Machines side by side, error by error: the deviation by each error alone on the same work.

use crate::analysis::reference::{ErrorEffects, PartReference};
use crate::evaluate::quantile_95;
use crate::machine::{ErrorId, ErrorTerm, Machine, OperatingConditions, Pose};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// One error in several machines.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorContribution {
    /// The error.
    pub error: ErrorId,
    /// The 95 % position deviation over the poses with only this error, first order, um; `None` in a
    /// machine that has no value for it.
    pub um: Vec<Option<f64>>,
}

impl ErrorContribution {
    /// Returns the largest of all machines, um.
    pub fn largest(&self) -> f64 {
        self.um.iter().flatten().copied().fold(0.0, f64::max)
    }

    /// Returns its deviation in a machine minus that in the first, um; without a value it is 0.
    pub fn minus_first(&self, machine: usize) -> f64 {
        let um = |i: usize| self.um.get(i).copied().flatten().unwrap_or(0.0);
        um(machine) - um(0)
    }
}

/// Returns every error of any of the machines, each machine at its own poses (mm, deg) of the same work, without what
/// the set-up of the part takes out of each; largest first, then by name. With minimum zones there is none.
pub fn contributions(
    machines: &[(&Machine, Vec<Pose>)],
    conditions: OperatingConditions,
    references: &[Option<&PartReference>],
) -> Vec<ErrorContribution> {
    let mut by_error: BTreeMap<ErrorId, Vec<Option<f64>>> = BTreeMap::new();
    for (index, ((machine, poses), reference)) in machines.iter().zip(references).enumerate() {
        let Some(effects) = ErrorEffects::new(machine, conditions, *reference) else { continue };
        for (error, um) in deviation_alone(machine, poses, &effects) {
            let slots = by_error.entry(error).or_insert_with(|| vec![None; machines.len()]);
            slots[index] = Some(um);
        }
    }
    let mut list: Vec<ErrorContribution> =
        by_error.into_iter().map(|(error, um)| ErrorContribution { error, um }).collect();
    list.sort_by(|a, b| b.largest().total_cmp(&a.largest()));
    list
}

/// Returns the errors of one machine that have a value, with their 95 % deviation, um.
fn deviation_alone(machine: &Machine, poses: &[Pose], effects: &ErrorEffects<'_>) -> Vec<(ErrorId, f64)> {
    let lengths = |pose: &Pose| -> Vec<f64> { effects.at(pose).into_iter().map(|(_, d)| d.position.norm()).collect() };
    let rows: Vec<Vec<f64>> = poses.par_iter().map(lengths).collect();
    let errors = machine.errors().enumerate().filter(|(_, (_, term))| !matches!(term, ErrorTerm::Tolerance(_)));
    let one = |(i, (error, _)): (usize, (ErrorId, &ErrorTerm))| {
        let mut column: Vec<f64> = rows.iter().map(|row| row[i]).collect();
        (error, quantile_95(&mut column) * 1e3)
    };
    errors.map(one).collect()
}
