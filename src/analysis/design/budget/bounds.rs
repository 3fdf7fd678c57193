//! The bounds of errors.

use super::class::Class;
use crate::analysis::closed_form::LocationSet;
use crate::machine::{AxisKind, Direction, ErrorFamily, ErrorId, ErrorTerm, Machine};

/// An error of which only a bound is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Bound {
    /// The error.
    pub error: ErrorId,
    /// Bound of its magnitude (mm, rad).
    pub tolerance: f64,
    /// True if the bound is that of the class, false if the machine file gives it.
    pub of_class: bool,
}

/// Returns the bounds in the machine file, in the order of [`Machine::errors`]; with a class, also its bounds for the
/// component errors of every axis and for the minimal set of location errors, where the file has no bound of its own.
/// Bounds of zero are left out.
pub fn bounds(machine: &Machine, class: Option<&Class>) -> Vec<Bound> {
    let own = |error: &ErrorId| {
        let found = machine.errors().find(|(id, _)| id == error)?;
        if let ErrorTerm::Tolerance(tolerance) = found.1 { Some(*tolerance) } else { None }
    };
    let location = class.map_or_else(Vec::new, |_| LocationSet::of(machine).members);
    let names = machine.axes().iter().map(|axis| &axis.name).chain(machine.chain().spindle());
    let mut bounds = Vec::new();
    for (index, name) in names.enumerate() {
        let axis = machine.axes().get(index);
        for family in ErrorFamily::ALL {
            for direction in Direction::ALL {
                let error = ErrorId { axis: name.clone(), family, direction };
                let wanted = match family {
                    ErrorFamily::Location => location.iter().any(|(id, _)| *id == error),
                    ErrorFamily::Component => axis.is_some(),
                };
                let of_class = class.filter(|_| wanted).and_then(|class| class.tolerance(axis, &error));
                match (own(&error), of_class) {
                    (Some(tolerance), _) => bounds.push(Bound { error, tolerance, of_class: false }),
                    (None, Some(tolerance)) => bounds.push(Bound { error, tolerance, of_class: true }),
                    (None, None) => {}
                }
            }
        }
    }
    bounds.retain(|bound| bound.tolerance > 0.0);
    bounds
}

/// Returns the number of errors of a machine that have a value; a budget leaves them out.
pub fn known(machine: &Machine) -> usize {
    machine.errors().filter(|(_, term)| !matches!(term, ErrorTerm::Tolerance(_))).count()
}

/// True if the machine has rotary axes and the class has no values for them.
pub fn lacks_rotary(machine: &Machine, class: &Class) -> bool {
    !class.knows_rotary() && machine.axes().iter().any(|axis| axis.kind == AxisKind::Rotary)
}
