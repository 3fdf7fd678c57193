//! The controller's letters and numbers for the axes of a machine.

use super::AxisLetters;
use crate::diagnostic::{Diagnostic, Diagnostics, codes, shown};
use crate::machine::{Axis, AxisKind, ControllerAxis, Machine};

/// An axis in the controller's words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AssignedAxis {
    /// Its index in the machine.
    pub axis: usize,
    /// Its letter, or its name where the controller has no letters of its own.
    pub letter: String,
    /// Its number, from 1.
    pub number: usize,
}

/// The controller's letter and number of every axis, in the order in which it counts them. An axis has the letter that
/// the machine file or the option gives, or its own name, or the first free letter of its kind, with a warning (W0601).
/// It has the number that is stated, where the controller takes numbers from the machine, or its place in the order. If
/// there is no letter, or one for two axes, the machine is refused (E0601).
pub fn axis_letters(
    machine: &Machine,
    letters: Option<&AxisLetters>,
    mut diagnostics: Option<&mut Diagnostics>,
) -> Option<Vec<AssignedAxis>> {
    let Some(letters) = letters else {
        let plain =
            |(axis, known): (usize, &Axis)| AssignedAxis { axis, letter: known.name.to_string(), number: axis + 1 };
        return Some(machine.axes().iter().enumerate().map(plain).collect());
    };
    let mut report = |said: Diagnostic| diagnostics.iter_mut().for_each(|all| all.push(said.clone()));
    let mut assigned = match letters.stated_letters(machine) {
        Ok(stated) => stated,
        Err(refusal) => {
            report(refusal);
            return None;
        }
    };
    for (index, axis) in machine.axes().iter().enumerate() {
        if assigned[index].is_some() {
            continue;
        }
        let taken = |letter: &char| assigned.contains(&Some(*letter));
        let free = letters.of(axis).chars().find(|letter| !taken(letter));
        report(free.map_or_else(|| no_letter(axis), |letter| another_letter(axis, letter)));
        assigned[index] = Some(free?);
    }
    let mut order: Vec<(usize, char)> = assigned.into_iter().flatten().enumerate().collect();
    order.sort_by_key(|(_, letter)| letters.order.find(*letter));
    let number = |place: usize, axis: usize| letters.number_of(machine, axis).map_or(place + 1, usize::from);
    let all = order.into_iter().enumerate();
    Some(
        all.map(|(place, (axis, letter))| AssignedAxis { axis, letter: letter.into(), number: number(place, axis) })
            .collect(),
    )
}

/// The place in `letters` of the axis with a number (from 1) of the controller.
pub fn by_number(letters: &[AssignedAxis], number: usize) -> Option<&AssignedAxis> {
    letters.iter().find(|axis| axis.number == number)
}

impl AxisLetters {
    /// The letters for axes of a kind.
    fn of(&self, axis: &Axis) -> &str {
        if axis.kind == AxisKind::Linear { &self.linear } else { &self.rotary }
    }

    /// The words for an axis that the option or the machine file states.
    fn words(&self, axis: &Axis) -> ControllerAxis {
        let given = self.given.iter().find(|(name, _)| name == axis.name.as_str());
        given.map_or_else(ControllerAxis::default, |(_, words)| *words).or(axis.controller)
    }

    /// The letters that are stated, and those of axes that bear one as their name.
    fn stated_letters(&self, machine: &Machine) -> Result<Vec<Option<char>>, Diagnostic> {
        let mut assigned: Vec<Option<char>> = Vec::new();
        for axis in machine.axes() {
            let stated = self.words(axis).letter;
            if let Some(letter) = stated.filter(|letter| !self.of(axis).contains(*letter)) {
                return Err(foreign_letter(axis, letter, self.of(axis)));
            }
            let own = || self.of(axis).chars().find(|letter| axis.name.as_str() == letter.to_string());
            let letter = stated.or_else(own);
            if let Some(other) = assigned.iter().position(|known| letter.is_some() && *known == letter) {
                return Err(one_letter([&machine.axes()[other], axis], letter));
            }
            assigned.push(letter);
        }
        Ok(assigned)
    }

    /// The number that is stated for an axis, where the controller takes numbers from the machine.
    fn number_of(&self, machine: &Machine, axis: usize) -> Option<u16> {
        self.numbers.as_ref().and(self.words(&machine.axes()[axis]).number)
    }

    /// Returns the reason why numbers of axes in the controller's files would be assumptions: one that is not stated,
    /// one for two axes, one for an axis that is not there.
    pub fn refusal(&self, machine: &Machine, target: &str) -> Option<Diagnostic> {
        let unknown = self.given.iter().find(|(name, _)| machine.axis_index(name).is_none());
        if let Some((name, _)) = unknown {
            let known: Vec<&str> = machine.axes().iter().map(|axis| axis.name.as_str()).collect();
            let message = format!("--map: the chain has no axis `{}`", shown(name));
            return Some(Diagnostic::new(codes::E0712, message).help(format!("its axes are {}", known.join(", "))));
        }
        let numbers = self.numbers.as_ref()?;
        let assigned = axis_letters(machine, Some(self), None)?;
        let name = |of: &AssignedAxis| machine.axes()[of.axis].name.as_str();
        let missing = |of: &&AssignedAxis| self.number_of(machine, of.axis).is_none();
        let unstated: Vec<&str> = assigned.iter().filter(missing).map(name).collect();
        if !unstated.is_empty() && !numbers.assumed {
            let map = |of: &AssignedAxis| format!("{}={}{}", name(of), numbers.prefix, of.number);
            let all: Vec<String> = assigned.iter().map(map).collect();
            return Some(missing_letter(target, &unstated, &numbers.are).help(format!(
                "look them up in the control; if they stand in this order, write --map {}, or into the machine file \
                 `axes: {{ {}: {{ controller: {} }} }}`",
                all.join(","),
                name(&assigned[0]),
                assigned[0].number
            )));
        }
        let twice = assigned.iter().enumerate().find_map(|(i, of)| Some((by_number(&assigned[..i], of.number)?, of)));
        let (first, second) = twice?;
        let message = format!(
            "axes `{}` and `{}` have one number in the controller, {}",
            name(first),
            name(second),
            first.number
        );
        Some(Diagnostic::new(codes::E0712, message).help("correct `controller` of one of them, or --map"))
    }
}

fn missing_letter(target: &str, axes: &[&str], are: &str) -> Diagnostic {
    let message = format!(
        "files of target `{target}` name axes by their numbers in the controller ({are}), which are not stated: {}",
        axes.join(", ")
    );
    Diagnostic::new(codes::E0712, message)
}

fn no_letter(axis: &Axis) -> Diagnostic {
    Diagnostic::new(codes::E0601, format!("the controller has no free letter for axis `{}`", axis.name))
        .help("compile for a target without fixed axis letters, such as grid-csv")
}

fn foreign_letter(axis: &Axis, letter: char, known: &str) -> Diagnostic {
    let message = format!("axis `{}` cannot be `{letter}` in the controller", axis.name);
    let letters: Vec<String> = known.chars().map(String::from).collect();
    Diagnostic::new(codes::E0601, message).help(format!("its letters for axes of this kind are {}", letters.join(", ")))
}

fn one_letter(axes: [&Axis; 2], letter: Option<char>) -> Diagnostic {
    let letter = letter.map(String::from).unwrap_or_default();
    let message = format!("axes `{}` and `{}` are both `{letter}` in the controller", axes[0].name, axes[1].name);
    Diagnostic::new(codes::E0601, message)
        .help("state another letter for one of them: `controller` in its entry, or --map")
}

fn another_letter(axis: &Axis, letter: char) -> Diagnostic {
    Diagnostic::new(
        codes::W0601,
        format!("axis `{}` is written as `{letter}`: the controller has no such letter", axis.name),
    )
}
