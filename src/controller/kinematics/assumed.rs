//! Places that a controller assumes of the axes of a machine. The refusal of a machine that has others names the axes
//! that differ, and what to write.

use super::transformation::Transformation;
use crate::compensation::{AssumedAxis, KinematicsMechanism, MachinePart};
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::Machine;
use crate::units::significant;
use nalgebra::Vector3;

/// Largest difference of a nominal direction or offset (mm) from what a controller assumes.
pub(super) const SAME: f64 = 1e-6;

/// True if a nominal axis is where the controller assumes it.
pub(super) fn holds(assumed: &AssumedAxis, nominal: &Transformation) -> bool {
    let Some((unit, point)) = nominal_axis(assumed.of, nominal) else { return false };
    let same = |(assumed, found): (f64, f64)| (assumed - found).abs() <= SAME;
    let turned = assumed.direction.is_none_or(|direction| (0..3).all(|k| same((direction[k], unit[k]))));
    let along = assumed.line.is_none_or(|along| {
        let cosine: f64 = (0..3).map(|k| along[k] * unit[k]).sum();
        same((1.0, cosine.abs()))
    });
    turned && along && (0..3).all(|k| assumed.offset[k].is_none_or(|offset| same((offset, point[k]))))
}

/// Returns the direction and a point of an axis; of the tool the gauge point.
fn nominal_axis(part: MachinePart, nominal: &Transformation) -> Option<(Vector3<f64>, Vector3<f64>)> {
    match part {
        MachinePart::Tool => Some((nominal.tool, Vector3::zeros())),
        part => nominal.line(part).map(|line| (line.direction, line.point)),
    }
}

/// Returns the refusal of a machine that no rules of a mechanism are for: E0751.
pub(super) fn no_rules(mechanism: &KinematicsMechanism, machine: &Machine, nominal: &Transformation) -> Diagnostic {
    let of_kind = mechanism.machines.iter().filter(|rules| rules.rotary == nominal.placement);
    let differ =
        of_kind.map(|rules| rules.assumes.iter().filter(|axis| !holds(axis, nominal)).collect::<Vec<&AssumedAxis>>());
    let Some(differ) = differ.min_by_key(Vec::len) else {
        let mut known: Vec<&str> = Vec::new();
        for words in mechanism.machines.iter().map(|rules| rules.rotary.words()) {
            if !known.contains(&words) {
                known.push(words);
            }
        }
        let message = format!("the controller has no transformation for {}", nominal.placement.words());
        return Diagnostic::new(codes::E0751, message).help(format!("this target is for {}", known.join(", or ")));
    };
    let message = "the controller's transformation assumes other directions or places of the rotary axes";
    let clauses: Vec<String> = differ.into_iter().map(|axis| difference(axis, machine, nominal)).collect();
    let help = format!("{}; else take another target (`abbe explain E0751`)", clauses.join("; "));
    Diagnostic::new(codes::E0751, message).help(help)
}

/// Returns what a controller assumes of an axis, beside what the machine file says.
fn difference(assumed: &AssumedAxis, machine: &Machine, nominal: &Transformation) -> String {
    let Some((unit, point)) = nominal_axis(assumed.of, nominal) else { return "an axis is missing".to_owned() };
    let list = |of: [f64; 3]| of.map(|x| significant(x + 0.0, 6)).join(", ");
    let name = nominal.line(assumed.of).map(|line| machine.axes()[line.axis].name.as_str());
    let name = name.map_or("the tool axis".to_owned(), |name| format!("`{name}`"));
    if let Some(direction) = assumed.direction.filter(|of| (0..3).any(|k| (of[k] - unit[k]).abs() > SAME)) {
        let is_turned_round = (0..3).all(|k| (direction[k] + unit[k]).abs() <= SAME);
        return match assumed.of {
            MachinePart::TableFirst | MachinePart::TableSecond if is_turned_round => {
                let sense = if direction.iter().sum::<f64>() < 0.0 { "direct" } else { "iso841" };
                format!("{name} turns the other way round there: if it does so on your machine, write `sense: {sense}`")
            }
            MachinePart::HeadFirst | MachinePart::HeadSecond if is_turned_round => format!(
                "{name} turns the other way round there: if it does so on your machine, write `direction: [{}]`",
                list(direction)
            ),
            _ => format!("{name} has the direction [{}] there, [{}] in the file", list(direction), list(unit.into())),
        };
    }
    if let Some(along) =
        assumed.line.filter(|of| ((0..3).map(|k| of[k] * unit[k]).sum::<f64>().abs() - 1.0).abs() > SAME)
    {
        return format!("{name} lies along [{}] there, along [{}] in the file", list(along), list(unit.into()));
    }
    let off = (0..3).filter(|k| assumed.offset[*k].is_some_and(|offset| (offset - point[*k]).abs() > SAME));
    let off: Vec<String> = off
        .map(|k| {
            let assumed = assumed.offset[k].unwrap_or_default();
            let (there, here) = (significant(assumed, 6), significant(point[k], 6));
            format!("{} is {there} mm there, {here} mm in the file", ["X", "Y", "Z"][k])
        })
        .collect();
    format!("of the place of {name} from the gauge point {}", off.join(", "))
}
