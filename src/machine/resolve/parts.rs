//! Names, tools, workpiece, set-up, provenance.

use super::axes::direction;
use super::context::{Context, dotted_path};
use super::positions::{PositionDraft, position};
use crate::diagnostic::{Diagnostic, codes, did_you_mean, is_layout, shown};
use crate::machine::{AxisKind, Direction, Machine, Provenance, SetUp, Tool};
use crate::syntax::{Keys, Scalar, SetUpEntry, ToolEntry, below, keys};
use indexmap::IndexMap;

/// Longest name of a machine, in characters.
const NAME: usize = 120;
/// Longest entry of `provenance`, in characters.
const NOTE: usize = 500;

/// Letters of a rotation: about X, Y and Z.
const ROTATION: [&str; 3] = ["A", "B", "C"];

/// The language's version; a file without it is taken for the only version there is.
pub fn version(context: &mut Context) {
    let at = keys(["abbe"]);
    match &context.document.abbe {
        Some(Scalar::Number(n)) if *n == 1.0 => {}
        Some(Scalar::Text(text)) if text == "1" => {}
        Some(other) => {
            let message = format!("this is version `{}` of the machine language", shown(&other.to_string()));
            context.at_value(codes::E0211, &at, message, "this program knows version 1: `abbe: 1`");
        }
        None if context.document.places.is_marred(&at) => {}
        None => context.at_key(
            codes::W0201,
            &at,
            "the file does not name its version of the language",
            "put `abbe: 1` at the top",
        ),
    }
}

/// Returns the machine's name.
pub fn name(context: &mut Context) -> Option<String> {
    let document = context.document;
    let at = keys(["machine"]);
    match &document.machine {
        Some(name) => single_line(context, name, NAME, &at).then(|| name.clone()),
        None => {
            if !document.places.is_marred(&at) {
                context.at_key(
                    codes::E0203,
                    &Keys::new(),
                    "the machine has no name",
                    "add `machine: Trunnion five-axis centre`",
                );
            }
            None
        }
    }
}

/// Text that reaches titles, file headers and controllers' comments.
fn single_line(context: &mut Context, text: &str, limit: usize, at: &Keys) -> bool {
    let bad = |c: char| c.is_control() || is_layout(c);
    let what = dotted_path(at);
    let (message, help) = if text.trim().is_empty() {
        (format!("`{what}` is empty"), "give it a name")
    } else if text.contains(bad) {
        (format!("`{what}` has a line break or control character in it"), "keep it on one line of plain text")
    } else if text.chars().count() > limit {
        (format!("`{what}` has {} characters; the limit is {limit}", text.chars().count()), "shorten it")
    } else {
        return true;
    };
    context.at_value(codes::E0212, at, message, help);
    false
}

/// At least one tool.
pub fn tools(context: &mut Context) -> Option<Vec<Tool>> {
    let document = context.document;
    if document.tool.is_some() && !document.tools.is_empty() {
        let places = &document.places;
        let refusal = Diagnostic::new(codes::E0209, "`tool` and `tools` exclude each other")
            .at(places.key(&keys(["tools"])), "")
            .at(places.key(&keys(["tool"])), "also given here")
            .help("move the tool into `tools` and give it a name");
        context.diagnostics.push(refusal);
        return None;
    }
    if document.tools.is_empty() {
        let entry = document.tool.clone().unwrap_or_default();
        return Some(vec![tool(context, String::new(), &entry, &keys(["tool"]))?]);
    }
    let named = document.tools.iter().map(|(name, entry)| {
        let at = keys(["tools", name]);
        let tame = tame(context, name, &at);
        let tool = tool(context, name.clone(), entry.as_ref()?, &at)?;
        tame.then_some(tool)
    });
    named.collect::<Vec<_>>().into_iter().collect()
}

/// Tool names reach command lines and file names.
fn tame(context: &mut Context, name: &str, at: &Keys) -> bool {
    let tame = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.');
    let fits = name.starts_with(|c: char| c.is_ascii_alphanumeric()) && name.chars().all(tame) && name.len() <= 32;
    let fits = fits && !name.contains("..");
    if !fits {
        let help = "letters, digits, `_`, `-` and single dots, 32 at most, a letter or digit first";
        context.at_key(codes::E0212, at, format!("`{}` is not the name of a tool", shown(name)), help);
    }
    fits
}

fn tool(context: &mut Context, name: String, entry: &ToolEntry, at: &Keys) -> Option<Tool> {
    let gauge = match &entry.gauge {
        Some(list) => context.vector(list, &below(at, "gauge")),
        None => Some([0.0; 3]),
    };
    let direction = match &entry.direction {
        Some(list) => direction(context, "the tool", list, &below(at, "direction")),
        None => Some([0.0, 0.0, 1.0]),
    };
    let offset = match (&entry.length, &entry.offset) {
        (Some(_), Some(_)) => {
            let help =
                "keep one: `length` goes from the gauge point against the tool axis, `offset` is [x, y, z] from it";
            context.at_key(
                codes::E0209,
                &below(at, "offset"),
                "`length` and `offset` of a tool exclude each other",
                help,
            );
            None
        }
        (Some(length), None) => {
            length_below(context, length, &below(at, "length")).zip(direction).map(|(l, axis)| axis.map(|x| -l * x))
        }
        (None, Some(list)) => context.vector(list, &below(at, "offset")),
        (None, None) => Some([0.0; 3]),
    };
    let (gauge, offset, direction) = (gauge?, offset?, direction?);
    Some(Tool { name, gauge, tip: std::array::from_fn(|i| gauge[i] + offset[i]), direction })
}

/// Rotary axes from which on a machine is a robot, whose flange seldom points along Z of the machine.
const ROBOT: usize = 4;

/// Warns of tools of a robot whose direction is not written.
pub fn warn_direction(context: &mut Context, machine: &Machine) {
    if machine.axes().iter().filter(|axis| axis.kind == AxisKind::Rotary).count() < ROBOT {
        return;
    }
    let document = context.document;
    let single = document.tool.iter().map(|tool| (keys(["tool"]), tool));
    let named = document.tools.iter().filter_map(|(name, tool)| Some((keys(["tools", name]), tool.as_ref()?)));
    let silent: Vec<Keys> =
        single.chain(named).filter(|(_, tool)| tool.direction.is_none()).map(|(at, _)| at).collect();
    for at in silent {
        let message = format!(
            "`{}` of a robot has no `direction`: its axis is Z of the machine at the zero pose",
            dotted_path(&at)
        );
        let help = "write where the tool axis points at the zero pose, from the tip to the gauge point, such as \
                    `direction: [0, 1, 0]`; `[0, 0, 1]` keeps Z";
        context.at_key(codes::W0409, &at, message, help);
    }
}

fn length_below(context: &mut Context, scalar: &Scalar, at: &Keys) -> Option<f64> {
    let length = context.length(scalar, at)?;
    if length < 0.0 {
        context.at_value(
            codes::E0213,
            at,
            format!("a tool length of {length} mm"),
            "the length is counted from the gauge point towards the tip",
        );
        return None;
    }
    Some(length)
}

/// Returns the workpiece origin, if one is given.
pub fn workpiece(context: &mut Context) -> Option<PositionDraft> {
    let written = context.document.workpiece.as_ref().and_then(|w| w.origin.as_ref())?;
    position(context, written, &keys(["workpiece", "origin"]))
}

/// Returns the angles (deg) of the workpiece's rotation about X, Y and Z.
pub fn workpiece_rotation(context: &mut Context) -> [f64; 3] {
    let document = context.document;
    let written = document.workpiece.as_ref().map(|workpiece| &workpiece.rotation);
    written.map_or([0.0; 3], |written| rotation(context, written, &keys(["workpiece", "rotation"])))
}

/// Returns the angles (deg) of a rotation about X, Y and Z that is written at a place.
pub fn rotation(context: &mut Context, written: &IndexMap<String, Scalar>, section: &Keys) -> [f64; 3] {
    let mut angles = [0.0; 3];
    for (letter, scalar) in written {
        let at = below(section, letter);
        match ROTATION.iter().position(|known| known == letter) {
            Some(i) => angles[i] = context.position(scalar, AxisKind::Rotary, &at).unwrap_or(0.0),
            None => {
                let message = format!("unknown key `{}` in `{}`", shown(letter), dotted_path(section));
                context.at_key(codes::E0201, &at, message, did_you_mean(letter, &ROTATION));
            }
        }
    }
    angles
}

/// Set-up errors.
pub fn setup(context: &mut Context) -> SetUp {
    let document = context.document;
    document.setup.as_ref().map_or_else(SetUp::default, |entry| setup_at(context, entry, &keys(["setup"])))
}

/// Set-up errors written in a section.
pub fn setup_at(context: &mut Context, entry: &SetUpEntry, section: &Keys) -> SetUp {
    let tool = amounts(context, &entry.tool, &["X", "Y", "Z"], &below(section, "tool"));
    let workpiece = amounts(context, &entry.workpiece, &SIX, &below(section, "workpiece"));
    SetUp { tool, workpiece }
}

/// Letters of displacements (mm) and rotations (rad).
pub const SIX: [&str; 6] = ["X", "Y", "Z", "A", "B", "C"];

/// Returns amounts written by letter in a section, mm and rad; 0 where there is none.
pub fn amounts<const N: usize>(
    context: &mut Context,
    written: &IndexMap<String, Scalar>,
    letters: &[&str; N],
    section: &Keys,
) -> [f64; N] {
    let mut amounts = [0.0; N];
    for (letter, scalar) in written {
        let at = below(section, letter);
        let Some(i) = letters.iter().position(|l| l == letter) else {
            let message = format!("unknown key `{}` in `{}`", shown(letter), dotted_path(section));
            context.at_key(codes::E0201, &at, message, did_you_mean(letter, letters));
            continue;
        };
        let direction = Direction::ALL[i];
        let Some(value) = context.error_value(scalar, direction, &at) else { continue };
        context.plausible(value, direction, &at);
        amounts[i] = value;
    }
    amounts
}

/// Returns the origin of the numbers, also beside single error terms.
pub fn provenance(context: &mut Context) -> Provenance {
    let document = context.document;
    for (name, term) in &document.errors {
        for (key, value) in term.iter().filter_map(|t| t.provenance.as_ref()).flatten() {
            single_line(context, &value.to_string(), NOTE, &keys(["errors", name, "provenance", key]));
        }
    }
    let mut entries = Vec::new();
    for (key, value) in &document.provenance {
        let at = keys(["provenance", key]);
        if single_line(context, &value.to_string(), NOTE, &at) && single_line(context, key, NAME, &at) {
            entries.push((key.clone(), value.to_string()));
        }
    }
    Provenance { entries }
}
