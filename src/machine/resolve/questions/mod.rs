//! Geometry that is allowed and seldom meant: `check` asks about it.

mod asked;
mod curves;

use super::doubles::is_fitted_location;
use super::sides::no_origin;
use crate::diagnostic::Diagnostic;
use crate::machine::{Axis, AxisKind, AxisName, Branch, ErrorId, ErrorTerm, Machine, Sense, Travel};
use crate::syntax::{Document, Keys, PositionEntry, Scalar, TravelEntry, keys};
use crate::units::{self, Dimension, significant};
use asked::{TINY, WIDE_LOCATION, angle, ask};
use curves::curve_questions;
use nalgebra::Vector3;

/// A translation of a location error from which on it is a position that belongs elsewhere, mm.
const POSITION: f64 = 1.0;
/// A bound of an angle from which on it is as a rule in another unit, rad: 400 arcsec.
const WIDE_ANGLE: f64 = 2e-3;
/// A displacement of the gauge point by a variant from which on it is another spindle, mm.
const OTHER_SPINDLE: f64 = 50.0;
/// A travel of a linear axis above which it is as a rule in another unit, mm: the longest gantries have 60 m.
const LONGEST: f64 = 1e5;
/// The same of a rotary axis, deg: ten turns.
const MOST_TURNED: f64 = 3600.0;
/// A travel is in radians if its ends are so near (deg) to multiples of five degrees: two decimals of a radian.
const NEAR: f64 = 0.3;
/// A length of a machine that is shorter than this, mm, is as a rule one in metres.
const METRES: f64 = 3.0;
/// A coordinate from which on it is no offset that was measured, mm.
const OFFSET: f64 = 0.05;
/// Height above the workpiece origin, in parts of the way of the tip, from which on the tip never comes near it.
const ABOVE: f64 = 0.5;
/// A distance that a tip may miss the workpiece by, mm: rounding of drawings.
const MISSED: f64 = 1.0;

/// Returns what to ask about the geometry of a machine that a document was resolved to, with the upward direction that
/// the document states.
pub fn questions(document: &Document, machine: &Machine, up: Option<[f64; 3]>) -> Vec<Diagnostic> {
    let mut found = absent(document, machine);
    found.extend(origins(document, machine));
    found.extend(machine.axes().iter().filter_map(|axis| radians(document, axis)));
    found.extend(machine.axes().iter().filter_map(|axis| far_travel(document, axis)));
    found.extend(machine.axes().iter().filter_map(|axis| other_letter(document, axis)));
    found.extend(metres(document, machine));
    found.extend(bare_beside_inches(document, machine));
    let is_stated = moves(machine) && document.workpiece.as_ref().is_some_and(|workpiece| workpiece.origin.is_some());
    found.extend(
        misplaced(machine, up)
            .filter(|_| is_stated)
            .map(|(message, help)| ask(document, &keys(["workpiece"]), message, help)),
    );
    found.extend(far_lines(document, machine));
    found.extend(squareness_twice(document, machine));
    found.extend(positions(document, machine));
    found.extend(bounds(document, machine));
    found.extend(curve_questions(document, machine));
    found.extend(document.moved_gauges.iter().filter_map(|(at, base)| moved_gauge(document, at, base)));
    found
}

/// True if linear axes take the tool about the workpiece: neither a robot nor an example of a joint or two.
fn moves(machine: &Machine) -> bool {
    machine.axes().iter().filter(|axis| axis.kind == AxisKind::Linear).count() >= 2
}

/// Asks about sections that are not there.
fn absent(document: &Document, machine: &Machine) -> Vec<Diagnostic> {
    let at = keys(["machine"]);
    let mut found = Vec::new();
    if document.tool.is_none() && document.tools.is_empty() {
        let help = "write `tool: { gauge: [250, 225, 0], length: 120 mm }`: angles act by the arm to the tip";
        found.push(ask(document, &at, "no `tool`: gauge point and tip lie at machine zero".to_owned(), help));
    }
    let is_bare = document.tool.as_ref().is_some_and(|tool| tool.length.is_none() && tool.offset.is_none());
    if is_bare && moves(machine) && machine.tool().tip == machine.tool().gauge {
        let help = "write its `length: 120 mm`, from the gauge point to the tip; `length: 0 mm` is a probe at the nose";
        found.push(ask(
            document,
            &keys(["tool"]),
            "the tool has no length: its tip is the gauge point".to_owned(),
            help,
        ));
    }
    let turns = machine.axes().iter().any(|axis| axis.kind == AxisKind::Rotary);
    if turns && moves(machine) && document.workpiece.as_ref().is_none_or(|workpiece| workpiece.origin.is_none()) {
        let help = "write `workpiece: { origin: [250, 225, -380] }`; `[0, 0, 0]` keeps machine zero";
        found.push(ask(document, &at, "no `workpiece`: its origin lies at machine zero".to_owned(), help));
    }
    found
}

/// Asks for origins of rotary axes, and of all axes of a machine that is only bounded: verbs that judge it bound its
/// angles by a class.
fn origins(document: &Document, machine: &Machine) -> Vec<Diagnostic> {
    let is_bound = |term: &ErrorTerm| matches!(term, ErrorTerm::Tolerance(_));
    let any = machine.errors().next().is_some() || machine.tolerances().count() > 0;
    let only_bounded = any && machine.errors().all(|(_, term)| is_bound(term));
    let said = machine.without_origin_in_file();
    let asked = machine.without_origin(|_| true).into_iter().filter(|index| !said.contains(index));
    let one = |index: usize| {
        let axis = &machine.axes()[index];
        let why = match axis.kind {
            AxisKind::Rotary => "has a line",
            AxisKind::Linear if only_bounded => "has no bounds of its angles, for which verbs take those of a class,",
            AxisKind::Linear => return None,
        };
        let place = document.places.key(&keys(["axes", axis.name.as_str()]));
        Some(no_origin(machine, index, why).at(place, ""))
    };
    asked.filter_map(one).collect()
}

/// Asks about a travel of a rotary axis whose ends are angles in radians.
fn radians(document: &Document, axis: &Axis) -> Option<Diagnostic> {
    let Travel::Range(min, max) = axis.travel else { return None };
    let is_angle = |end: f64| {
        let (degrees, halves) = (end.to_degrees(), 2.0 * end);
        let off = |x: f64, step: f64| (x - step * libm::round(x / step)).abs();
        end.abs() <= 6.3 && off(degrees, 5.0) <= NEAR && off(halves, 1.0) > 1e-3
    };
    let mut ends = [min, max].into_iter().filter(|end| *end != 0.0);
    if axis.kind != AxisKind::Rotary || !ends.all(is_angle) {
        return None;
    }
    let [from, to] = [min, max].map(|end| significant(libm::round(end.to_degrees()), 4));
    let message = format!("axis `{}` travels from {min} to {max} deg: are these radians?", axis.name);
    let help = format!("write degrees, such as `travel: [{from} deg, {to} deg]`");
    Some(ask(document, &keys(["axes", axis.name.as_str()]), message, help))
}

/// Asks about a travel longer than those of machines.
fn far_travel(document: &Document, axis: &Axis) -> Option<Diagnostic> {
    let Travel::Range(min, max) = axis.travel else { return None };
    let (most, unit) = match axis.kind {
        AxisKind::Linear => (LONGEST, "mm"),
        AxisKind::Rotary => (MOST_TURNED, "deg"),
    };
    if max - min <= most {
        return None;
    }
    let message =
        format!("axis `{}` travels from {} to {} {unit}", axis.name, significant(min, 6), significant(max, 6));
    let help = "compare the units of both ends; an axis that turns without end is `travel: continuous`";
    Some(ask(document, &keys(["axes", axis.name.as_str()]), message, help))
}

/// Asks about a rotary axis whose letter is that of another direction, along which it turns.
fn other_letter(document: &Document, axis: &Axis) -> Option<Diagnostic> {
    let own = ["A", "B", "C"].iter().position(|letter| *letter == axis.name.as_str())?;
    let along = (0..3).find(|k| axis.direction[*k].abs() > 1.0 - 1e-9)?;
    if axis.kind != AxisKind::Rotary || along == own {
        return None;
    }
    let (name, direction, letter) = (&axis.name, ["X", "Y", "Z"][along], ["A", "B", "C"][along]);
    let message = format!("axis `{name}` turns about {direction}: by ISO 841 such an axis is `{letter}`");
    let help = format!(
        "names of errors and words of controls follow the letter: call it `{letter}`, or leave `direction` out"
    );
    Some(ask(document, &keys(["axes", axis.name.as_str()]), message, help))
}

/// Asks about lengths of the machine that are of the size of metres: travels, points and the tool.
fn metres(document: &Document, machine: &Machine) -> Vec<Diagnostic> {
    let linear = || machine.axes().iter().filter(|axis| axis.kind == AxisKind::Linear);
    let span = |axis: &Axis| axis.travel.interval().1 - axis.travel.interval().0;
    let help = "a number without a unit is in mm; write `0.5 m`, or millimetres";
    let mut found = Vec::new();
    let mut question =
        |at: &Keys, what: String| found.push(ask(document, at, format!("{what}: are these metres?"), help));
    for axis in linear().filter(|axis| (OFFSET..METRES).contains(&span(axis))) {
        let (min, max) = axis.travel.interval();
        question(&keys(["axes", axis.name.as_str()]), format!("axis `{}` travels from {min} to {max} mm", axis.name));
    }
    if !linear().any(|axis| span(axis) > 10.0 * METRES) {
        return found;
    }
    let in_metres = |point: [f64; 3]| {
        let stated: Vec<f64> = point.into_iter().map(f64::abs).filter(|x| *x > 0.0).collect();
        stated.len() > 1 && stated.iter().all(|x| (OFFSET..METRES).contains(x))
    };
    let tool = machine.tool();
    let origins = machine.axes().iter().map(|axis| (keys(["axes", axis.name.as_str(), "origin"]), axis.origin));
    let points = [(keys(["workpiece", "origin"]), machine.workpiece()), (keys(["tool", "gauge"]), tool.gauge)];
    for (at, point) in points.into_iter().chain(origins).filter(|(_, point)| in_metres(*point)) {
        question(&at, format!("`{}` is [{}] mm", at.join("."), point.map(|x| significant(x, 6)).join(", ")));
    }
    let length = libm::sqrt((0..3).map(|i| (tool.tip[i] - tool.gauge[i]) * (tool.tip[i] - tool.gauge[i])).sum());
    if (OFFSET..METRES).contains(&length) {
        question(&keys(["tool"]), format!("the tip is {} mm from the gauge point", significant(length, 4)));
    }
    found
}

/// Returns the numbers of a position, machine coordinates or from a named point.
fn point(position: &Option<PositionEntry>) -> Option<&[Scalar]> {
    match position.as_ref()? {
        PositionEntry::Point(point) => Some(point),
        PositionEntry::Relative(relative) => relative.at.as_deref(),
    }
}

/// Asks about bare numbers, which are mm, of a file whose travels, or errors, are in inches.
fn bare_beside_inches(document: &Document, machine: &Machine) -> Option<Diagnostic> {
    let what = match (document.is_in_inches(), document.has_errors_in_inches()) {
        (true, _) => "travels",
        (false, true) => "errors",
        (false, false) => return None,
    };
    let entry = |axis: &Axis| document.axes.get(axis.name.as_str())?.as_ref();
    let linear = machine.axes().iter().filter(|axis| axis.kind == AxisKind::Linear);
    let ends = linear.filter_map(|axis| match entry(axis)?.travel.as_ref()? {
        TravelEntry::Range(ends) => Some((keys(["axes", axis.name.as_str(), "travel"]), &ends[..])),
        TravelEntry::Word(_) => None,
    });
    let origin = |axis: &Axis| Some((keys(["axes", axis.name.as_str(), "origin"]), point(&entry(axis)?.origin)?));
    let origins = machine.axes().iter().filter_map(origin);
    let workpiece =
        document.workpiece.as_ref().and_then(|of| Some((keys(["workpiece", "origin"]), point(&of.origin)?)));
    let tool = document.tool.iter().flat_map(|tool| {
        let length = tool.length.as_ref().map(std::slice::from_ref);
        let points = [("gauge", tool.gauge.as_deref()), ("offset", tool.offset.as_deref()), ("length", length)];
        points.into_iter().filter_map(|(key, list)| Some((keys(["tool", key]), list?)))
    });
    let is_bare = |scalar: &Scalar| match scalar {
        Scalar::Number(value) => *value != 0.0,
        Scalar::Text(text) => units::number(text).is_ok_and(|value| value != 0.0),
    };
    let mut bare = ends.chain(origins).chain(workpiece).chain(tool).filter(|(_, list)| list.iter().any(is_bare));
    let (at, list) = bare.next()?;
    let number = list.iter().find(|scalar| is_bare(scalar))?;
    let message =
        format!("`{}` has {number} without a unit, which is mm; {what} of this file are in inches", at.join("."));
    Some(ask(document, &at, message, "write the unit behind each number, `15 in` or `15 mm`"))
}

/// Returns what to ask of a tip that never comes to the workpiece, whatever the linear axes do.
fn misplaced(machine: &Machine, up: Option<[f64; 3]>) -> Option<(String, &'static str)> {
    let zero = |axis: &&Axis| axis.kind == AxisKind::Rotary && !axis.travel.contains(0.0);
    let (tip, origin, tool) = (machine.tool().tip, machine.workpiece(), machine.tool().direction);
    if machine.axes().iter().find(zero).is_some() {
        return None;
    }
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
    // The place of the tip relative to the workpiece in a direction, and how far the linear axes take it.
    let reach = |along: [f64; 3]| {
        let at = dot(tip, along) - dot(origin, along);
        machine.axes().iter().filter(|axis| axis.kind == AxisKind::Linear).fold((at, at), |(low, high), axis| {
            let backwards = axis.branch == Branch::Workpiece && axis.sense == Sense::Direct;
            let by = dot(axis.direction, along) * if backwards { -1.0 } else { 1.0 };
            let ((min, max), ends) = (axis.travel.interval(), |q: f64| q * by);
            (low + ends(min).min(ends(max)), high + ends(min).max(ends(max)))
        })
    };
    let point = |p: [f64; 3]| p.map(|x| significant(x, 6)).join(", ");
    let places = format!("tip [{}], workpiece origin [{}] at the zero pose", point(tip), point(origin));
    let help = "both are in machine coordinates at the zero pose: check `gauge`, `length`, `workpiece` and travels; a \
                part whose Z is not that of the machine has a `rotation`, a spindle that lies an `up: [0, 1, 0]`";
    let (low, high) = reach(tool);
    if high < low + MISSED {
        return None;
    }
    // A part stands on its table, which need not be across the tool.
    let of_part = || machine.workpiece_rotation().map_or([0.0, 0.0, 1.0], |turn| turn.column(2).into_owned().into());
    let (up, upwards) = up.map_or_else(|| (of_part(), "Z of the part"), |up| (up, "`up`"));
    for (high, along) in [(high, "the tool axis"), (reach(up).1, upwards)] {
        if high < -MISSED {
            let by = significant(-high, 4);
            return Some((format!("the tip stays {by} mm below the workpiece origin along {along}: {places}"), help));
        }
    }
    if low > ABOVE * (high - low) {
        let by = significant(low, 4);
        return Some((format!("the tip stays {by} mm above the workpiece origin along the tool axis: {places}"), help));
    }
    let across = (0..3).map(|k| std::array::from_fn(|i| f64::from(u8::from(i == k))));
    let is_across = |along: [f64; 3]| dot(along, tool).abs() < 1e-6 && dot(along, up).abs() < 1e-6;
    let across = across.zip(["X", "Y", "Z"]).filter(|(along, _)| is_across(*along));
    let missed = across.map(|(along, letter)| (reach(along), letter));
    let missed = missed.map(|((low, high), letter)| (low.max(-high), letter)).find(|(by, _)| *by > MISSED);
    let (by, letter) = missed?;
    let by = significant(by, 4);
    Some((format!("the tip stays {by} mm beside the workpiece origin along {letter}: {places}"), help))
}

/// Asks about lines of rotary axes that are farther from the part, or from the spindle, than any linear axis travels.
fn far_lines(document: &Document, machine: &Machine) -> Vec<Diagnostic> {
    let spans = machine.axes().iter().filter(|axis| axis.kind == AxisKind::Linear).map(|axis| {
        let (min, max) = axis.travel.interval();
        max - min
    });
    let longest = spans.fold(0.0, f64::max);
    let is_stated = document.workpiece.as_ref().is_some_and(|workpiece| workpiece.origin.is_some());
    if !moves(machine) || longest <= 0.0 {
        return Vec::new();
    }
    let written = |axis: &Axis| document.axes.get(axis.name.as_str()).and_then(Option::as_ref)?.origin.as_ref();
    let one = |axis: &Axis| {
        written(axis)?;
        let (from, what) = match axis.branch {
            Branch::Workpiece if is_stated => (machine.workpiece(), "the workpiece origin"),
            Branch::Workpiece => return None,
            Branch::Tool => (machine.tool().gauge, "the gauge point"),
        };
        let to = Vector3::from(from) - Vector3::from(axis.origin);
        let along = Vector3::from(axis.direction).normalize();
        let off = (to - along * along.dot(&to)).norm();
        if off <= longest {
            return None;
        }
        let (off, longest) = (significant(off, 4), significant(longest, 4));
        let message = format!(
            "the line of `{}` is {off} mm from {what} at the zero pose; no linear axis travels more than {longest} mm",
            axis.name
        );
        let help = "compare the signs of `origin` with those of the other points: all are in machine coordinates";
        Some(ask(document, &keys(["axes", axis.name.as_str(), "origin"]), message, help))
    };
    machine.axes().iter().filter(|axis| axis.kind == AxisKind::Rotary).filter_map(one).collect()
}

/// Asks about the squareness of two linear axes that is given twice, once at each: the difference acts.
fn squareness_twice(document: &Document, machine: &Machine) -> Option<Diagnostic> {
    let linear = |name: &AxisName| machine.axes().iter().find(|of| of.name == *name && of.kind == AxisKind::Linear);
    let turned = machine.errors().filter_map(|(error, term)| {
        let ErrorTerm::Constant(value) = term else { return None };
        let across = linear(&error.axis)?.direction[error.direction.index().checked_sub(3)?].abs() < 1e-6;
        (across && *value != 0.0 && !is_fitted_location(document, &error)).then_some(error)
    });
    let all: Vec<ErrorId> = turned.collect();
    let twin = |(i, second): (usize, &ErrorId)| {
        let along = linear(&second.axis)?.direction;
        let is_oblique = |of: &Axis| (0..3).map(|k| of.direction[k] * along[k]).sum::<f64>().abs() < 0.5;
        let is_twin = |of: &&ErrorId| of.direction == second.direction && linear(&of.axis).is_some_and(is_oblique);
        Some((all[..i].iter().find(is_twin)?.clone(), second.clone()))
    };
    let (first, second) = all.iter().enumerate().find_map(twin)?;
    let message = format!(
        "`{first}` and `{second}` turn `{}` and `{}` against one another: their difference is the squareness",
        first.axis, second.axis
    );
    let help = format!("give it once: `{}-{}: 12 urad`, or one of the two", first.axis, second.axis);
    Some(ask(document, &keys(["errors", &second.to_string()]), message, help))
}

/// Asks about errors of the size of positions: locations, and measured curves.
fn positions<'a>(document: &'a Document, machine: &'a Machine) -> impl Iterator<Item = Diagnostic> + 'a {
    machine.errors().filter_map(move |(error, term)| {
        if error.direction.is_rotation() {
            return wide_location(document, &error, term);
        }
        let (value, is_location) = match term {
            ErrorTerm::Constant(value) => (*value, true),
            ErrorTerm::Component(component) => {
                let knots = component.curves().filter_map(|curve| curve.knots());
                (knots.flat_map(|knots| &knots.values).fold(0.0_f64, |largest, x| largest.max(x.abs())), false)
            }
            ErrorTerm::Tolerance(_) => return None,
        };
        // What a fit found is no slip of a hand.
        if value.abs() < POSITION || is_fitted_location(document, &error) {
            return None;
        }
        let (value, axis) = (significant(value, 4), &error.axis);
        let (message, help) = if is_location {
            (
                format!("`{error}` is {value} mm: is it the place where axis `{axis}` stands by design?"),
                format!("such a place is its `origin`; `{error}` is how far it is off, micrometres on a machine"),
            )
        } else {
            (
                format!("`{error}` reaches {value} mm: are its values in um?"),
                format!("write the unit of the readings in the header, `{error} [um]`, or correct the values"),
            )
        };
        Some(ask(document, &keys(["errors", &error.to_string()]), message, help))
    })
}

/// Asks about a location error that one sees by eye.
fn wide_location(document: &Document, error: &ErrorId, term: &ErrorTerm) -> Option<Diagnostic> {
    let ErrorTerm::Constant(value) = term else { return None };
    if value.abs() < WIDE_LOCATION || is_fitted_location(document, error) {
        return None;
    }
    let help = "microradians and arcseconds are usual: compare the unit; an axis that is oblique by design has a \
                `direction`";
    let message = format!("`{error}` is {}: is that meant?", angle(*value, 1e3, "mrad"));
    Some(ask(document, &keys(["errors", &error.to_string()]), message, help))
}

/// Asks about bounds of the size of positions, of angles that one sees by eye, and of what no instrument reads.
fn bounds(document: &Document, machine: &Machine) -> Vec<Diagnostic> {
    let of_errors = machine.errors().filter_map(|(error, term)| match term {
        ErrorTerm::Tolerance(value) => Some((error.to_string(), *value, error.direction.is_rotation())),
        _ => None,
    });
    let is_tiny = |value: f64, turns: bool| value > 0.0 && value < TINY[usize::from(turns)];
    let wide = |(_, value, turns): &(String, f64, bool)| {
        *value >= if *turns { WIDE_ANGLE } else { POSITION } || is_tiny(*value, *turns)
    };
    let ask_of = |(name, value, turns): (String, f64, bool)| {
        let at: Vec<String> = std::iter::once("tolerances").chain(name.split_whitespace()).map(str::to_owned).collect();
        let (size, help) = match (turns, is_tiny(value, turns)) {
            (true, true) => (angle(value, 1e6, "urad"), "urad or arcsec"),
            (true, false) => (angle(value, 1e3, "mrad"), "urad or arcsec"),
            (false, true) => (format!("{} um", significant(value * 1e3, 3)), "um"),
            (false, false) => (format!("{} mm", significant(value, 3)), "um"),
        };
        let help = format!("bounds of such errors are {help} as a rule: compare the unit with that of the data sheet");
        ask(document, &at, format!("`{name}` is bounded by {size}: is that meant?"), help)
    };
    of_errors.chain(machine.tolerances().list()).filter(wide).map(ask_of).collect()
}

/// Asks about a gauge point that a variant moves far from that of its base.
fn moved_gauge(document: &Document, at: &Keys, base: &[Scalar; 3]) -> Option<Diagnostic> {
    let written = match at.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["tool", _] => document.tool.as_ref()?,
        [_, name, _] => document.tools.get(name)?.as_ref()?,
        _ => return None,
    };
    let mm = |scalar: &Scalar| match scalar {
        Scalar::Number(mm) => Some(*mm),
        Scalar::Text(text) => units::quantity(text).ok().filter(|q| q.dimension == Dimension::LENGTH).map(|q| q.value),
    };
    let pairs = written.gauge.as_ref()?.iter().zip(base);
    let squares = pairs.map(|(a, b)| mm(a).zip(mm(b)).map(|(a, b)| (a - b) * (a - b))).sum::<Option<f64>>()?;
    let by = libm::sqrt(squares);
    if by < OTHER_SPINDLE {
        return None;
    }
    let message = format!("the variant moves the gauge point of its base by {} mm", significant(by, 4));
    let help = "another tool in the same spindle has another `length`, and the gauge point of the base";
    Some(ask(document, at, message, help))
}
