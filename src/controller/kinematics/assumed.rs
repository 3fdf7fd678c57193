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

/// The difference of a nominal axis from what a controller assumes of it.
enum Difference {
    /// The machine has no such axis.
    Missing,
    /// Direction assumed, and that of the machine.
    Direction([f64; 3], [f64; 3]),
    /// The same in either sense.
    Line([f64; 3], [f64; 3]),
    /// Components of the place, from 0: assumed, and that of the machine, mm.
    Place(Vec<(usize, f64, f64)>),
}

/// True if a nominal axis is where the controller assumes it.
pub(super) fn holds(assumed: &AssumedAxis, nominal: &Transformation) -> bool {
    difference(assumed, nominal).is_none()
}

fn difference(assumed: &AssumedAxis, nominal: &Transformation) -> Option<Difference> {
    let Some((unit, point)) = nominal_axis(assumed.of, nominal) else { return Some(Difference::Missing) };
    let differs = |assumed: f64, found: f64| (assumed - found).abs() > SAME;
    if let Some(direction) = assumed.direction.filter(|of| (0..3).any(|k| differs(of[k], unit[k]))) {
        return Some(Difference::Direction(direction, unit.into()));
    }
    let cosine = |of: &[f64; 3]| (0..3).map(|k| of[k] * unit[k]).sum::<f64>();
    if let Some(line) = assumed.line.filter(|of| differs(1.0, cosine(of).abs())) {
        return Some(Difference::Line(line, unit.into()));
    }
    let components = (0..3).filter_map(|k| Some((k, assumed.offset[k]?, point[k])));
    let off: Vec<_> = components.filter(|(_, assumed, found)| differs(*assumed, *found)).collect();
    (!off.is_empty()).then_some(Difference::Place(off))
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
    let differ = of_kind.map(|rules| {
        let found = rules.assumes.iter().filter_map(|axis| Some((axis.of, difference(axis, nominal)?)));
        found.collect::<Vec<_>>()
    });
    let Some(differ) = differ.min_by_key(Vec::len) else {
        let mut known: Vec<&str> = Vec::new();
        for words in mechanism.machines.iter().map(|rules| rules.rotary.words()) {
            if !known.contains(&words) {
                known.push(words);
            }
        }
        let message = format!("the controller has no transformation for {}", nominal.placement.words());
        return Diagnostic::new(codes::E0751, message)
            .help(format!("this target is for {}; `abbe targets MACHINE` lists others", known.join(", or ")));
    };
    let message = "the controller's transformation assumes other directions or places of the rotary axes";
    let clauses: Vec<String> = differ
        .into_iter()
        .map(|(part, difference)| {
            let axis = nominal.line(part).map(|line| machine.axes()[line.axis].name.as_str());
            difference.words(part, &axis.map_or("the tool axis".to_owned(), |axis| format!("`{axis}`")))
        })
        .collect();
    let help = format!("{}; else take another target (`abbe targets MACHINE`)", clauses.join("; "));
    Diagnostic::new(codes::E0751, message).help(help)
}

impl Difference {
    /// Returns what a controller assumes of an axis of this name, beside what the machine file says.
    fn words(self, part: MachinePart, name: &str) -> String {
        let list = |of: [f64; 3]| of.map(|x| significant(x + 0.0, 6)).join(", ");
        match self {
            Self::Missing => "an axis is missing".to_owned(),
            Self::Direction(there, here) => {
                let is_turned_round = (0..3).all(|k| (there[k] + here[k]).abs() <= SAME);
                let remedy = match part {
                    MachinePart::TableFirst | MachinePart::TableSecond if is_turned_round => {
                        format!("sense: {}", if there.iter().sum::<f64>() < 0.0 { "direct" } else { "iso841" })
                    }
                    MachinePart::HeadFirst | MachinePart::HeadSecond if is_turned_round => {
                        format!("direction: [{}]", list(there))
                    }
                    _ => {
                        return format!(
                            "{name} has the direction [{}] there, [{}] in the file",
                            list(there),
                            list(here)
                        );
                    }
                };
                format!("{name} turns the other way round there: if it does so on your machine, write `{remedy}`")
            }
            Self::Line(there, here) => {
                format!("{name} lies along [{}] there, along [{}] in the file", list(there), list(here))
            }
            Self::Place(off) => {
                let component = |(k, there, here): (usize, f64, f64)| {
                    let [there, here] = [there, here].map(|mm| significant(mm, 6));
                    format!("{} is {there} mm there, {here} mm in the file", ["X", "Y", "Z"][k])
                };
                let off: Vec<String> = off.into_iter().map(component).collect();
                format!("of the place of {name} from the gauge point {}", off.join(", "))
            }
        }
    }
}
