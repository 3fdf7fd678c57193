//! The long text of a diagnostic's code, of an error's name, of a class of machines, of a controller, of a word.

use super::targets::{TargetSummary, target};
use crate::diagnostic::{CODES, Code, Diagnostic, codes, info, nearest};
use crate::machine::{CLASS_NAMES, Direction, ErrorId, classes, error_name_in_capitals, parse_error_name};
use serde::Serialize;

/// An explanation.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, schemars::JsonSchema)]
pub struct Explanation {
    /// The code, error name, class, controller or word as it is written.
    pub topic: String,
    /// The explanation, Markdown.
    pub text: String,
}

impl Explanation {
    fn of_code(code: &Code) -> Self {
        let text = format!("{}: {}\n\n{}", code.id, code.title, code.explanation.trim());
        Self { topic: code.id.to_owned(), text }
    }

    fn of_target(target: TargetSummary) -> Self {
        let text = target.text();
        Self { topic: target.target, text }
    }
}

/// Explains a code such as E0203, an error such as EC0Y, a class such as production, a controller such as linuxcnc, or
/// a word such as gauge.
/// Fails for other words.
pub fn explain(topic: &str) -> Result<Explanation, Diagnostic> {
    let code = info(topic).map(Explanation::of_code);
    code.or_else(|| class(topic))
        .or_else(|| target(topic).ok().map(Explanation::of_target))
        .or_else(|| error_name(topic))
        .or_else(|| word(topic))
        .ok_or_else(|| unknown(topic))
}

/// Says what is near an unknown word, or which words there are.
fn unknown(topic: &str) -> Diagnostic {
    let message = format!("`{}` is no code, error name, class, target or word", topic.escape_debug());
    let headings: Vec<String> = entries().map(|(heading, _)| heading.to_lowercase()).collect();
    let words = headings.iter().flat_map(|heading| parts(heading));
    let known = CODES.iter().map(|code| code.id).chain(words).chain(CLASS_NAMES);
    let near = error_name_in_capitals(topic).or_else(|| nearest(topic, known).map(str::to_owned));
    let help = match near {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!(
            "codes as messages print them, E0101 and on; errors EXX .. ECC, EC0Y and the like; classes {}; targets as \
             `abbe targets` lists them; words: {}",
            CLASS_NAMES.join(", "),
            headings.join("; ")
        ),
    };
    Diagnostic::new(codes::E0818, message).help(help)
}

/// Headings and texts of the glossary.
fn entries() -> impl Iterator<Item = (&'static str, &'static str)> {
    include_str!("../../docs/words.md").split("\n## ").skip(1).filter_map(|entry| entry.split_once("\n\n"))
}

/// The words of a heading by which it is found.
fn parts(heading: &str) -> impl Iterator<Item = &str> {
    heading.split([' ', ',', '(', ')']).filter(|word| !matches!(*word, "" | "and" | "error" | "point"))
}

/// An entry of the glossary, by its heading or a word of it.
fn word(what: &str) -> Option<Explanation> {
    let asked = what.to_lowercase();
    let is_asked = |heading: &str| {
        let heading = heading.to_lowercase();
        heading == asked || parts(&heading).any(|word| word == asked)
    };
    let (heading, text) = entries().find(|(heading, _)| is_asked(heading))?;
    Some(Explanation { topic: heading.to_owned(), text: format!("{heading}\n\n{}", text.trim_end()) })
}

/// The numbers of a class, as a machine file has them.
fn class(what: &str) -> Option<Explanation> {
    let class = classes().remove(what)?;
    let text = format!(
        "{what}: tolerances typical of a class of machines; no standard, no measured population.\nEach is a bound, \
         plus or minus, before compensation. `abbe budget --class {what}` takes them where the machine\nfile has \
         none, and so does `class: {what}` in the file; or, to change them, this:\n\n{}\nA number left out is taken \
         from another class with `like: {what}`.\n",
        class.written()
    );
    Some(Explanation { topic: what.to_owned(), text })
}

fn error_name(what: &str) -> Option<Explanation> {
    let id = parse_error_name(what)?;
    Some(Explanation { topic: id.to_string(), text: describe(&id) })
}

fn describe(id: &ErrorId) -> String {
    let motion = if id.direction.is_rotation() { "rotation about" } else { "displacement along" };
    let letter = ['X', 'Y', 'Z'][id.direction.index() % 3];
    let mut text = if id.is_location() {
        format!("{id}: location error of axis {}: {motion} {letter} of its axis of motion, a constant.\n", id.axis)
    } else {
        format!(
            "{id}: component error of axis {}: {motion} {letter} while {} moves, a function of its position.\n",
            id.axis, id.axis
        )
    };
    text.push_str(
        "Sign: tool relative to workpiece, actual minus nominal, in the directions of the machine frame (ISO 841).\n",
    );
    if let Some(sentence) = squareness(id).or_else(|| rotary(id)) {
        text.push_str(sentence);
        text.push('\n');
    }
    text.push_str(&format!("Unit: {}.\n", if id.direction.is_rotation() { "urad, arcsec or um/m" } else { "um" }));
    text
}

/// Returns a sentence that fixes the sign of a squareness by an example, without a sign convention.
fn squareness(id: &ErrorId) -> Option<&'static str> {
    match (id.is_location(), id.direction, id.axis.as_str()) {
        (true, Direction::C, "Y") => Some(
            "Squareness of Y to X: positive when the angle between +X and +Y is above 90 degrees. +10 urad at Y = \
             500 mm moves the tool by -5 um in X.",
        ),
        (true, Direction::B, "Z") => Some(
            "Squareness of Z to X: positive when the angle between +X and +Z is below 90 degrees. +10 urad at Z = \
             300 mm moves the tool by +3 um in X.",
        ),
        (true, Direction::A, "Z") => Some(
            "Squareness of Z to Y: positive when the angle between +Y and +Z is above 90 degrees. +10 urad at Z = \
             300 mm moves the tool by -3 um in Y.",
        ),
        _ => None,
    }
}

/// The effect of a location error of a rotary axis or spindle, with a number.
fn rotary(id: &ErrorId) -> Option<&'static str> {
    if !id.is_location() {
        return None;
    }
    Some(match (id.axis.as_str(), id.direction) {
        ("A" | "B" | "C", Direction::X | Direction::Y | Direction::Z) => {
            "The axis line stands that far in + of the machine direction, in a table and in a head alike; nothing \
             moves at position 0. EX0C = +10 um of a C' table moves the tool by +20 um in X of the workpiece frame \
             at C = 180 deg (-20 um in X of the machine frame)."
        }
        ("A" | "B" | "C", _) => {
            "The axis line is turned by that angle, right-handed, about the machine direction through the axis's \
             origin; nothing moves at position 0. EA0C = +10 urad of a C' table moves the tool by -4 um in Z at C = \
             180 deg, 200 mm from the axis in Y of the machine."
        }
        ("S", Direction::A | Direction::B) => {
            "The spindle is tilted about the gauge point. EA0S = +10 urad moves the tip of a tool of 100 mm by +1 um \
             in Y, EB0S = +10 urad by -1 um in X."
        }
        _ => return None,
    })
}
