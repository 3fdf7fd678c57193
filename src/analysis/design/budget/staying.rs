//! Errors with values in a budget: those that no bound stands for act in every machine drawn, as they are.

use super::bounds::Bound;
use crate::analysis::reference::{PartReference, RigidMotion, tip_at};
use crate::evaluate::{Bare, Deviation, Field, Order, error_by_error};
use crate::machine::{ErrorId, ErrorTerm, Machine, OperatingConditions, OperatingPoint};

/// The errors that act as they are in every machine drawn.
#[derive(Clone, Copy, Default)]
pub enum ActingErrors<'a> {
    /// None: only bounds count.
    #[default]
    None,
    /// Those of the machine that have a value and no bound.
    OfMachine,
    /// Those of a field, without what the set-up of the part takes out.
    OfField(&'a dyn Field),
}

impl std::fmt::Debug for ActingErrors<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::None => "None",
            Self::OfMachine => "OfMachine",
            Self::OfField(_) => "OfField",
        })
    }
}

/// The errors of a machine that stay, to first order, and what the set-up of the part takes out of their deviations.
#[derive(Debug, Clone)]
pub struct StayingErrors<'a> {
    machine: &'a Machine,
    bounds: &'a [Bound],
    motion: Option<RigidMotion>,
}

impl<'a> StayingErrors<'a> {
    /// Returns the errors of a machine that stay beside bounds; `None` if none does.
    pub fn new(machine: &'a Machine, bounds: &'a [Bound], reference: Option<&PartReference>) -> Option<Self> {
        let setup = machine.setup();
        let is_set_up = setup.tool.iter().chain(&setup.workpiece).any(|x| *x != 0.0);
        if !is_set_up && count_staying(machine, bounds) == 0 {
            return None;
        }
        let mut staying = Self { machine, bounds, motion: None };
        staying.motion = reference.map(|of| of.motion_of(&staying, Order::Degree(1), OperatingConditions::default()));
        Some(staying)
    }
}

impl Field for StayingErrors<'_> {
    fn machine(&self) -> &Machine {
        self.machine
    }

    fn deviation(&self, at: &OperatingPoint<'_>) -> Deviation {
        let Self { machine, bounds, motion } = self;
        let mut whole = Bare { machine, order: Order::Degree(1) }.deviation(at);
        for (_, effect) in error_by_error(machine, at).into_iter().filter(|(error, _)| is_bounded(bounds, error)) {
            whole.position -= effect.position;
            whole.rotation -= effect.rotation;
        }
        motion.map_or(whole, |motion| motion.removed_from(&whole, &tip_at(machine, at.axes)))
    }
}

/// Returns the number of errors of a machine with a value that no bound stands for.
pub fn count_staying(machine: &Machine, bounds: &[Bound]) -> usize {
    let valued = machine.errors().filter(|(_, term)| !matches!(term, ErrorTerm::Tolerance(_)));
    valued.filter(|(error, _)| !is_bounded(bounds, error)).count()
}

/// True if a bound stands for an error: if a bounded direction of its joint has a part along its letter.
fn is_bounded(bounds: &[Bound], error: &ErrorId) -> bool {
    let covers = |bound: &Bound| {
        let part = bound.letters()[error.direction.index()].abs();
        bound.error.axis == error.axis && bound.error.family == error.family && part > 1e-9
    };
    bounds.iter().any(covers)
}
