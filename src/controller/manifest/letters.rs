//! The controller's letters for the axes of a machine.

use super::AxisLetters;
use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use crate::machine::{Axis, AxisKind, Machine};

/// The controller's letter of every axis, in the order in which the controller counts its axes:
/// (index of the axis, letter). An axis with a name of its own gets the first free letter of its
/// kind, with a warning (W0601); if none is free, the machine is refused (E0601).
pub fn assigned_letters(
    machine: &Machine,
    letters: Option<&AxisLetters>,
    mut diagnostics: Option<&mut Diagnostics>,
) -> Option<Vec<(usize, String)>> {
    let Some(letters) = letters else {
        return Some(machine.axes().iter().map(|axis| axis.name.to_string()).enumerate().collect());
    };
    let allowed = |axis: &Axis| if axis.kind == AxisKind::Linear { &letters.linear } else { &letters.rotary };
    let own = |axis: &Axis| allowed(axis).chars().any(|c| c.to_string() == axis.name.as_str());
    let mut taken: Vec<String> = machine.axes().iter().filter(|a| own(a)).map(|a| a.name.to_string()).collect();
    let mut assigned = Vec::new();
    for (index, axis) in machine.axes().iter().enumerate() {
        if own(axis) {
            assigned.push((index, axis.name.to_string()));
            continue;
        }
        let free = allowed(axis).chars().map(|c| c.to_string()).find(|c| !taken.contains(c));
        let said = free.as_ref().map_or_else(|| no_letter(axis), |letter| another_letter(axis, letter));
        diagnostics.iter_mut().for_each(|all| all.push(said.clone()));
        let letter = free?;
        taken.push(letter.clone());
        assigned.push((index, letter));
    }
    assigned.sort_by_key(|(_, letter)| letters.order.find(letter.as_str()));
    Some(assigned)
}

fn no_letter(axis: &Axis) -> Diagnostic {
    Diagnostic::new(codes::E0601, format!("the controller has no free letter for axis `{}`", axis.name))
        .help("compile for a target without fixed axis letters, such as grid-csv")
}

fn another_letter(axis: &Axis, letter: &str) -> Diagnostic {
    Diagnostic::new(
        codes::W0601,
        format!("axis `{}` is written as `{letter}`: the controller has no such letter", axis.name),
    )
}
