//! The sections `tolerances` and `class`: bounds of errors, of axes, of squareness, and of everything else.

use super::axes::AxisDraft;
use super::context::{Context, dotted_path};
use super::found_errors::{Errors, NEGATIVE, behind_both_signs, bounded};
use super::joint_names::JointNames;
use crate::diagnostic::{Diagnostic, codes, did_you_mean, shown};
use crate::machine::{
    AxisKind, AxisName, Branch, CLASS_NAMES, ClassNumbers, Direction, ErrorFamily, ErrorId, ErrorKind, ErrorTerm,
    FRAME_KEYS, Frames, MAIN_AXES, Machine, NamedClass, Tolerances, classes,
};
use crate::syntax::{BoundEntry, FigureEntry, FrameEntry, Keys, below, keys};
use crate::units::significant;

/// Words of data sheets that bound a positioning error: one that says how wide the band is, and those that widen it.
/// The bound is half of their sum. docs/guide-data-sheets.md derives it.
const WORDS: [(&str, &[&str]); 7] =
    [("A", &[]), ("E", &["R"]), ("M", &["B", "R"]), ("P", &[]), ("Tp", &[]), ("Pa", &["U", "Ps"]), ("width", &[])];

/// An axis is oblique to a letter if the cosine of the angle between them is within these.
const OBLIQUE: std::ops::Range<f64> = 1e-3..1.0 - 1e-6;

/// An error, a bound along or across an axis, or a squareness, as the words of data sheets see it.
struct FigureOf<'a> {
    /// Its name in messages.
    name: &'a str,
    direction: Direction,
    /// True for a constant: a location error.
    constant: bool,
    /// True for an error of positioning, of which all words are said.
    positioning: bool,
}

/// The meaning of a name under `tolerances`.
pub enum Named {
    /// An error such as EXX.
    Error,
    /// An axis or the spindle.
    Joint(AxisName),
    /// Squareness, `X-Y`.
    Pair,
}

/// Meaning of a name; names that are none of these are taken for errors.
pub fn meaning(name: &str, known: &JointNames<'_>) -> Named {
    let joint = AxisName::new(name).filter(|axis| known.axis(axis).is_some() || known.spindle == Some(axis));
    match joint {
        Some(axis) => Named::Joint(axis),
        None if name.contains('-') => Named::Pair,
        None => Named::Error,
    }
}

/// Returns the bound of an error by its letter.
pub fn letter(
    context: &mut Context,
    error: &ErrorId,
    entry: &BoundEntry,
    known: &JointNames<'_>,
    at: &Keys,
) -> Option<ErrorTerm> {
    if !error.is_location() && known.axis(&error.axis).is_none() {
        let help = "a spindle does not move here; it has location errors such as `EA0S`";
        context.at_key(codes::E0408, at, format!("`{error}` is a component error of the spindle"), help);
        return None;
    }
    let figure = entry.figure();
    if !entry.is_figure() || !figure.is_one() {
        let help = format!("write one bound, `{error}: 8 um`, or words of a data sheet, `{error}: {{ A: 8 um }}`");
        context.at_key(codes::E0416, at, format!("`{}` is not the bound of an error", dotted_path(at)), help);
        return None;
    }
    warn_oblique(context, error, known, &figure, at);
    let of = FigureOf {
        name: &error.to_string(),
        direction: error.direction,
        constant: error.is_location(),
        positioning: known.axis(&error.axis).is_some_and(|axis| positions(error, axis)),
    };
    let here = if figure.value.is_some() { context.value_of(at) } else { at.clone() };
    half_width(context, &figure, &of, &here).map(ErrorTerm::Tolerance)
}

/// Returns a bound: its value, or half of the sum of the widths.
fn half_width(context: &mut Context, figure: &FigureEntry, of: &FigureOf<'_>, at: &Keys) -> Option<f64> {
    if let Some(value) = &figure.value {
        return bounded(context, value, of.direction, at);
    }
    let listed: Vec<&str> = figure.words.iter().map(|(word, _)| *word).collect();
    let fits = |(lead, more): &&(&str, &[&str])| {
        listed.contains(lead) && listed.iter().all(|word| word == lead || more.contains(word))
    };
    let (name, words) = (of.name, listed.join("`, `"));
    let message = if of.constant {
        format!("`{name}` is a constant, and `{words}` a width over a travel")
    } else if !of.positioning && listed != ["width"] {
        format!("`{words}` is said of positioning, which `{name}` is not")
    } else if !WORDS.iter().any(|row| fits(&row)) {
        match listed.iter().find(|word| WORDS.iter().any(|(lead, _)| lead == *word)) {
            Some(lead) if listed.len() > 1 => {
                format!("`{words}` do not go together for `{name}`: `{lead}` with what it takes beside it is enough")
            }
            _ => format!("`{words}` alone bounds no error"),
        }
    } else {
        let width = |(word, figure): &(&str, crate::syntax::Scalar)| {
            let size = bounded(context, figure, of.direction, &below(at, word))?;
            Some(if behind_both_signs(figure).is_some() { 2.0 * size } else { size })
        };
        let widths: Vec<Option<f64>> = figure.words.iter().map(width).collect();
        return widths.into_iter().sum::<Option<f64>>().map(|sum| 0.5 * sum);
    };
    let help = "positioning: A; E with or without R; M with or without B and R; P; Tp; Pa with or without U and Ps; \
                any component error and squareness: width; location errors: one value; `+-4 um` is a width of 8 um";
    context.at_key(codes::E0416, at, message, help);
    None
}

/// Warns of a bound by a letter that is neither along its axis nor across it: it is a box in machine coordinates, and
/// takes the place of what a class says of the axis.
pub fn warn_oblique(context: &mut Context, error: &ErrorId, known: &JointNames<'_>, figure: &FigureEntry, at: &Keys) {
    let Some((axis, u)) = known.axis(&error.axis).and_then(|axis| Some((axis, axis.on(axis.side).direction?))) else {
        return;
    };
    let along = u[error.direction.index() % 3].abs();
    if !OBLIQUE.contains(&along) {
        return;
    }
    let own = along > 0.5 && !error.is_location();
    let key = FRAME_KEYS[2 * usize::from(error.direction.is_rotation()) + usize::from(!own)];
    let entry = format!("{{ {key}: {figure} }}");
    let entry = if error.is_location() { format!("{{ location: {entry} }}") } else { entry };
    let motion = if axis.kind == Some(AxisKind::Rotary) { "turns about" } else { "moves along" };
    let direction = u.map(|x| significant(x, 4)).join(", ");
    let message = format!("`{error}` is neither along nor across axis `{}`, which {motion} [{direction}]", axis.name);
    let help = format!("for a bound of the axis itself write under `tolerances`: `{}: {entry}`", axis.name);
    context.at_key(codes::W0407, at, message, help);
}

/// True for the error of positioning of an axis: along a linear, about a rotary one.
fn positions(error: &ErrorId, axis: &AxisDraft) -> bool {
    let (Some(kind), Some(u)) = (axis.kind, axis.on(axis.side).direction) else { return true };
    let own = u[error.direction.index() % 3].abs() > 0.5;
    own && error.direction.is_rotation() == (kind == AxisKind::Rotary)
}

/// Bounds along and across axes, and of squareness.
pub fn frames(context: &mut Context, known: &JointNames<'_>, errors: &Errors) -> Tolerances {
    let mut all = Tolerances::default();
    for (name, entry) in &context.document.tolerances {
        let (at, Some(entry)) = (keys(["tolerances", name]), entry) else { continue };
        match meaning(name, known) {
            Named::Error => {}
            Named::Joint(axis) => joint(context, &axis, entry, known, &at, errors, &mut all),
            Named::Pair => pair(context, name, entry, &at, errors, &mut all),
        }
    }
    warn_doubled(context, &all);
    all
}

fn joint(
    context: &mut Context,
    axis: &AxisName,
    entry: &BoundEntry,
    known: &JointNames<'_>,
    at: &Keys,
    errors: &Errors,
    all: &mut Tolerances,
) {
    let figure = entry.figure();
    if figure != FigureEntry::default() {
        let help = match known.axis(axis).and_then(|axis| axis.kind).filter(|_| figure.value.is_none()) {
            Some(kind) => format!("write `{axis}: {{ {}: {figure} }}`", positioning_key(kind)),
            None => format!("write `{axis}: {{ along: 2 um, across: 3 um, about_across: 10 urad }}`"),
        };
        let message = format!("`{}` does not say which errors of axis `{axis}` it bounds", dotted_path(at));
        context.at_key(codes::E0416, at, message, help);
        return;
    }
    let location = entry.location.clone().unwrap_or_default();
    let component = entry.frame();
    if known.axis(axis).is_none() && component != FrameEntry::default() {
        let help = format!("a spindle does not move here: `{axis}: {{ location: {{ about_across: 40 urad }} }}`");
        context.at_key(codes::E0408, at, format!("`{axis}` is a spindle, which has no component errors"), help);
        return;
    }
    let mut both = [[None; 4]; 2];
    for ((family, entry), four) in ErrorFamily::ALL.into_iter().zip([&location, &component]).zip(&mut both) {
        let base = if family == ErrorFamily::Location { below(at, "location") } else { at.clone() };
        for (slot, (key, value)) in FRAME_KEYS.into_iter().zip(entry.four()).enumerate() {
            let Some(value) = value else { continue };
            let here = below(&base, key);
            let kind = known.axis(axis).and_then(|axis| axis.kind);
            if context.document.places.is_marred(&here) {
                continue;
            }
            if !value.is_one() {
                let help = format!("write `{key}: 8 um`, or words of a data sheet, `{key}: {{ A: 8 um }}`");
                context.at_key(codes::E0416, &here, format!("`{}` is not one bound", dotted_path(&here)), help);
                continue;
            }
            let letters = if slot < 2 { SHIFTS } else { TURNS };
            // The letter along an axis is none of the directions across it.
            let along = own_letter(known, axis).filter(|_| slot % 2 == 1 && family == ErrorFamily::Component);
            let letters: Vec<Direction> =
                letters.iter().copied().filter(|letter| Some(letter.index() % 3) != along).collect();
            if by_letter(context, axis, family, &letters, &here, errors) {
                continue;
            }
            let of = FigureOf {
                name: &dotted_path(&here),
                direction: if slot < 2 { Direction::X } else { Direction::A },
                constant: family == ErrorFamily::Location,
                positioning: kind.is_some_and(|kind| positioning_key(kind) == key),
            };
            four[slot] = half_width(context, value, &of, &here);
        }
    }
    let _ = all.joints.insert(axis.clone(), both);
}

/// Returns the letter, 0 to 2, along which an axis lies on both sides of the bed.
fn own_letter(known: &JointNames<'_>, axis: &AxisName) -> Option<usize> {
    let draft = known.axis(axis)?;
    let on = |branch: Branch| draft.on(branch).direction?.iter().position(|u| u.abs() > 1.0 - 1e-9);
    let [tool, workpiece] = Branch::BOTH.map(on);
    tool.filter(|_| tool == workpiece)
}

/// The key of the error of positioning of an axis.
fn positioning_key(kind: AxisKind) -> &'static str {
    if kind == AxisKind::Linear { FRAME_KEYS[0] } else { FRAME_KEYS[2] }
}

fn pair(context: &mut Context, name: &str, entry: &BoundEntry, at: &Keys, errors: &Errors, all: &mut Tolerances) {
    let mut two: Vec<usize> =
        name.split('-').filter_map(|axis| MAIN_AXES.iter().position(|l| *l == axis.trim())).collect();
    two.sort_unstable();
    two.dedup();
    let figure = entry.figure();
    let only = entry.is_figure() && figure.is_one();
    let ([first, second], true, 2) = (&two[..], only, name.split('-').count()) else {
        let help = "write the squareness of two of the linear axes X, Y, Z: `X-Y: 0.02/500`; of others, `W: { \
                    location: { about_across: 40 urad } }`";
        context.at_key(codes::E0416, at, format!("`{}` is not the bound of a squareness", dotted_path(at)), help);
        return;
    };
    let here = if figure.value.is_some() { context.value_of(at) } else { at.clone() };
    let carrying = AxisName::new(MAIN_AXES[*second]);
    let pair = [*first, *second];
    // A squareness is a turn about the third of X, Y, Z.
    let about = [Direction::ALL[6 - first - second]];
    if carrying.as_ref().is_some_and(|axis| by_letter(context, axis, ErrorFamily::Location, &about, &here, errors)) {
        return;
    }
    let valued = carrying
        .as_ref()
        .and_then(|axis| errors.joints.get(axis)?.six(ErrorFamily::Location)[about[0].index()].as_ref());
    if let (Some(axis), Some(_)) = (&carrying, valued) {
        let error = ErrorId { axis: axis.clone(), family: ErrorFamily::Location, direction: about[0] };
        let message = format!("`{}` bounds `{error}`, which has a value: the value acts alone", dotted_path(at));
        context.at_key(codes::W0411, at, message, "keep one of them");
    }
    let of = FigureOf { name, direction: Direction::A, constant: false, positioning: false };
    if let Some(value) = half_width(context, &figure, &of, &here)
        && all.squareness.insert(pair, value).is_some()
    {
        let [first, second] = pair.map(|axis| MAIN_AXES[axis]);
        let message = format!("the squareness of {first} and {second} is given twice, here as `{}`", dotted_path(at));
        context.at_key(codes::E0407, at, message, "remove one of the two");
    }
}

const SHIFTS: &[Direction] = &[Direction::X, Direction::Y, Direction::Z];
const TURNS: &[Direction] = &[Direction::A, Direction::B, Direction::C];

/// Refuses a bound along or across an axis beside one by letter in one of these directions.
fn by_letter(
    context: &mut Context,
    axis: &AxisName,
    family: ErrorFamily,
    slots: &[Direction],
    at: &Keys,
    errors: &Errors,
) -> bool {
    let sides = [errors.joints.get(axis), errors.other_side.get(axis).map(|(_, errors)| errors)];
    let is_bound = |direction: &&Direction| {
        let terms = sides.iter().flatten().map(|errors| &errors.six(family)[direction.index()]);
        terms.into_iter().any(|term| matches!(term, Some(ErrorTerm::Tolerance(_))))
    };
    let Some(direction) = slots.iter().find(is_bound) else { return false };
    let error = ErrorId { axis: axis.clone(), family, direction: *direction };
    let message = format!("`{}` bounds what `{error}` bounds by its letter", dotted_path(at));
    let place = context.document.places.key(at);
    let first = errors.places.get(&error).cloned().flatten();
    let refusal = Diagnostic::new(codes::E0407, message).at(place, "").at(first, "by letter here");
    context.diagnostics.push(refusal.help("write all three directions by letter, or all along and across the axis"));
    true
}

/// Refuses squareness beside rotations across the axis that has it.
fn warn_doubled(context: &mut Context, all: &Tolerances) {
    for pair in all.squareness.keys() {
        let letters = pair.map(|axis| MAIN_AXES[axis]);
        let Some(axis) = AxisName::new(letters[1]) else { continue };
        if all.of(&axis, ErrorFamily::Location, true, false).is_some() {
            let at = keys(["tolerances", letters[1], "location", "about_across"]);
            let message = format!("`{}` bounds the squareness {}-{} too", dotted_path(&at), letters[0], letters[1]);
            context.at_key(codes::E0407, &at, message, "keep one of them");
        }
    }
}

/// Refuses squareness of axes that have none: parallel ones.
pub fn squareness(context: &mut Context, machine: &Machine) {
    let frames = Frames::of(machine);
    for [first, second] in machine.tolerances().squareness.keys() {
        let [Some(_), Some(joint)] = [first, second].map(|axis| machine.axis_index(MAIN_AXES[*axis])) else { continue };
        let rotation = Direction::ALL[3 + (3 - first - second)];
        if frames.joint(joint).squareness_to(ErrorFamily::Location, rotation) != Some(*first) {
            let name = format!("{}-{}", MAIN_AXES[*first], MAIN_AXES[*second]);
            let at = keys(["tolerances", &name]);
            let message = format!("`{}` is the squareness of axes that do not span a plane", dotted_path(&at));
            context.at_key(codes::E0416, &at, message, "give the directions of both axes, or remove the bound");
        }
    }
}

/// Returns the class of the file.
pub fn class(context: &mut Context) -> Option<NamedClass> {
    let entry = context.document.class.as_ref()?;
    let at = keys(["class"]);
    let known = classes();
    let base = match &entry.like {
        None => None,
        Some(name) => match known.get(name) {
            Some(class) => Some(class.clone()),
            None => {
                let message = format!("there is no class of machines `{}`", shown(name));
                context.at_value(codes::E0417, &at, message, did_you_mean(name, &CLASS_NAMES));
                return None;
            }
        },
    };
    let mut numbers = ClassNumbers::default();
    for (kind, slot) in ErrorKind::ALL.into_iter().zip(&mut numbers.all) {
        let Some(scalar) = entry.number(kind.section(), kind.name()) else { continue };
        let here = keys(["class", kind.section(), kind.name()]);
        let value =
            context.coefficient(scalar, kind.direction(), AxisKind::Linear, kind.grows_with_travel().into(), &here)?;
        if value < 0.0 {
            context.at_value(codes::E0411, &here, "a negative tolerance", NEGATIVE);
            return None;
        }
        *slot = Some(value);
    }
    if let Some(shortest) = entry.linear.as_ref().and_then(|linear| linear.shortest.as_ref()) {
        numbers.shortest_mm = Some(context.length(shortest, &keys(["class", "linear", "shortest"]))?);
    }
    if numbers == ClassNumbers::default() && entry.source.is_none() {
        return base.zip(entry.like.clone()).map(|(class, name)| NamedClass { name, class });
    }
    let name = entry.like.as_ref().map_or_else(|| "of the file".to_owned(), |name| format!("of the file, like {name}"));
    match numbers.over(base, entry.source.clone().unwrap_or_else(|| "machine file".to_owned())) {
        Ok(class) => Some(NamedClass { name, class }),
        Err(missing) => {
            let message =
                format!("the class has no `{}.{}`, and is not `like` another", missing.section(), missing.name());
            let help = "write all numbers of linear axes, and all of rotary ones or none; or `like: production`";
            context.at_key(codes::E0417, &at, message, help);
            None
        }
    }
}
