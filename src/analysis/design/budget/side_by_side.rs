//! Budgets side by side: the effect of each tolerance on the 95 % value of each of several machines.

use super::bounds::{Bound, Role};
use super::totals::{Budget, ToleranceEffect};
use crate::machine::{Direction, ErrorId};
use std::collections::BTreeMap;

/// One bounded error in one machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BudgetPart {
    /// Its bound (mm, rad).
    pub tolerance: f64,
    /// Its effect on the 95 % value of the drawn machines' position (um): the effects of a machine add up to that
    /// value.
    pub of_p95: ToleranceEffect,
    /// Deviation by it alone at its bound, root mean square over the poses (um).
    pub average: f64,
}

/// One bounded error in several machines.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundedError {
    /// Its name, in the first machine that bounds it.
    pub error: String,
    /// Its direction, which decides the unit: mm or rad.
    pub direction: Direction,
    /// In each machine; `None` where it is not bounded.
    pub parts: Vec<Option<BudgetPart>>,
}

impl BoundedError {
    /// Returns the largest effect of all machines, um.
    pub fn largest(&self) -> f64 {
        self.parts.iter().flatten().map(|part| part.of_p95.effect.abs()).fold(0.0, f64::max)
    }

    /// Returns its effect on a machine's 95 % value minus that on the first machine's, um; without a bound it is 0.
    /// Over all errors these differences add up to that of the 95 % values.
    pub fn minus_first(&self, machine: usize) -> f64 {
        let effect = |i: usize| self.parts.get(i).copied().flatten().map_or(0.0, |part| part.of_p95.effect);
        effect(machine) - effect(0)
    }
}

/// The name of an error, and its part in every machine.
type NamedParts = (String, Vec<Option<BudgetPart>>);

/// Returns every error that is bounded in any of the machines, matched along and across their axes; largest first, then
/// by name.
pub fn side_by_side(budgets: &[(&[Bound], &Budget)]) -> Vec<BoundedError> {
    let mut by_error: BTreeMap<(&ErrorId, bool), NamedParts> = BTreeMap::new();
    for (machine, (bounds, budget)) in budgets.iter().enumerate() {
        let average: BTreeMap<usize, f64> = budget.average.iter().map(|c| (c.bound, c.um)).collect();
        for (i, bound) in bounds.iter().enumerate() {
            let (_, parts) = by_error
                .entry((&bound.error, bound.role == Role::Letter))
                .or_insert_with(|| (bound.to_string(), vec![None; budgets.len()]));
            let average = average.get(&i).copied().unwrap_or(0.0);
            parts[machine] =
                Some(BudgetPart { tolerance: bound.tolerance, of_p95: budget.position.tighten[i], average });
        }
    }
    let one = |((id, _), (error, parts)): ((&ErrorId, bool), NamedParts)| BoundedError {
        direction: id.direction,
        error,
        parts,
    };
    let mut list: Vec<BoundedError> = by_error.into_iter().map(one).collect();
    list.sort_by(|a, b| b.largest().total_cmp(&a.largest()));
    list
}
