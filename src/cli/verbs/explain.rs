//! `abbe explain`: the long text of a diagnostic's code, of an error's name, of a target.

use super::targets;
use crate::cli::output::session::Session;
use crate::cli::{Format, Outcome};
use crate::controller::ControllerTarget;
use crate::diagnostic::{CODES, Code, info};
use crate::machine::{Direction, ErrorFamily, ErrorId, parse_error_name};
use serde_json::json;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// A code such as E0203, an error such as EC0Y, or a target such as linuxcnc.
    what: String,
}

pub(crate) fn run(session: &mut Session, args: &Args) -> Outcome {
    let Some((topic, text)) = explanation(&args.what) else {
        let codes: Vec<&str> = CODES.iter().map(|code| code.id).collect();
        return session.usage(&format!(
            "`{}` is no code, error name or target.\nCodes: {}\nErrors: EXX .. ECC, EC0Y and the like. Targets: `abbe targets`.",
            args.what.escape_debug(),
            codes.join(" ")
        ));
    };
    match session.format() {
        Format::Json => session.print_json(json!({"topic": topic, "text": text})),
        Format::Text | Format::Csv => session.print(&text),
    }
    Ok(())
}

fn explanation(what: &str) -> Option<(String, String)> {
    let code =
        |code: &Code| (code.id.to_owned(), format!("{}: {}\n\n{}", code.id, code.title, code.explanation.trim()));
    let target = |target: ControllerTarget| (target.manifest.target.clone(), targets::describe(&target));
    info(what).map(code).or_else(|| ControllerTarget::embedded(what).map(target)).or_else(|| error_name(what))
}

fn error_name(what: &str) -> Option<(String, String)> {
    let id = parse_error_name(what)?;
    Some((id.to_string(), describe(&id)))
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

/// The sentence that says the sign of a squareness without a sign.
fn squareness(id: &ErrorId) -> Option<&'static str> {
    match (id.family, id.direction, id.axis.as_str()) {
        (ErrorFamily::Location, Direction::C, "Y") => Some(
            "Squareness of Y to X: positive when the angle between +X and +Y is above 90 degrees. +10 urad at Y = 500 mm moves the tool by -5 um in X.",
        ),
        (ErrorFamily::Location, Direction::B, "Z") => Some(
            "Squareness of Z to X: positive when the angle between +X and +Z is below 90 degrees. +10 urad at Z = 300 mm moves the tool by +3 um in X.",
        ),
        (ErrorFamily::Location, Direction::A, "Z") => Some(
            "Squareness of Z to Y: positive when the angle between +Y and +Z is above 90 degrees. +10 urad at Z = 300 mm moves the tool by -3 um in Y.",
        ),
        _ => None,
    }
}

/// What a location error of a rotary axis or spindle moves, with a number.
fn rotary(id: &ErrorId) -> Option<&'static str> {
    if !id.is_location() {
        return None;
    }
    Some(match (id.axis.as_str(), id.direction) {
        ("A" | "B" | "C", Direction::X | Direction::Y | Direction::Z) => {
            "The axis line stands that far in + of the machine direction, in a table and in a head alike; nothing moves at position 0. EX0C = +10 um of a C' table moves the tool by +20 um in X of the workpiece frame at C = 180 deg (-20 um in X of the machine frame)."
        }
        ("A" | "B" | "C", _) => {
            "The axis line is turned by that angle, right-handed, about the machine direction through the axis's origin; nothing moves at position 0. EA0C = +10 urad of a C' table moves the tool by -4 um in Z at C = 180 deg, 200 mm from the axis in Y of the machine."
        }
        ("S", Direction::A | Direction::B) => {
            "The spindle is tilted about the gauge point. EA0S = +10 urad moves the tip of a tool of 100 mm by +1 um in Y, EB0S = +10 urad by -1 um in X."
        }
        _ => return None,
    })
}
