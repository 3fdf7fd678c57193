//! What to fit, in words: groups (`location`, `tool`, `workpiece`, `spindle`, `linear`) and error names, component
//! errors with a basis (`EXX:poly3`, `ECC:fourier2`, `EYX:spline8`).

use super::parameter::{Basis, Parameter, Term};
use crate::diagnostic::{Diagnostic, did_you_mean, shown};
use crate::lower::{Place, Source};
use crate::machine::{
    Approach, AxisKind, ComponentError, Curve, Direction, ErrorId, ErrorTerm, Knots, Machine, Travel, parse_error_name,
};
use crate::syntax::IdentifyEntry;

/// Groups by name.
const GROUPS: [&str; 5] = ["location", "tool", "workpiece", "spindle", "linear"];

type Refused = Box<Diagnostic>;

/// The parameters that `request` asks for, in its order, each once.
pub fn parameters(machine: &Machine, request: &IdentifyEntry) -> Result<Vec<Parameter>, Refused> {
    let mut list: Vec<Parameter> = Vec::new();
    for word in &request.fit {
        for parameter in of_word(machine, word.trim(), request)? {
            add(&mut list, parameter)?;
        }
    }
    for word in &request.fixed {
        let fixed = fixed(machine, word.trim(), &list)?;
        list.retain(|parameter| !fixed.contains(&parameter.name));
    }
    if list.is_empty() {
        let help =
            "name errors or groups: `--fit location,tool`, or `identify: { fit: [location] }` in the machine file";
        return Err(Box::new(Diagnostic::new("E0502", "there is nothing to fit").help(help)));
    }
    Ok(list)
}

/// The same parameter from two words counts once; two forms of curve may not move the same error.
fn add(list: &mut Vec<Parameter>, parameter: Parameter) -> Result<(), Refused> {
    if list.iter().any(|known| known.name == parameter.name) {
        return Ok(());
    }
    let moves = |t: &Term| parameter.terms.iter().any(|own| own.source == t.source);
    let clash = |known: &&Parameter| known.terms.iter().any(moves) && kind(known) != kind(&parameter);
    if let Some(known) = list.iter().find(clash) {
        let message = format!("`{}` and `{}` fit the same error curve in two forms", known.name, parameter.name);
        return Err(refusal(message, "fit every error once, in one form"));
    }
    list.push(parameter);
    Ok(())
}

/// Which form of curve a parameter belongs to.
fn kind(parameter: &Parameter) -> u8 {
    match parameter.terms.first().map(|t| &t.basis) {
        _ if parameter.name.ends_with(":slope") => 4,
        Some(Basis::Power(_)) => 1,
        Some(Basis::Cosine(_) | Basis::Sine(_)) => 2,
        Some(Basis::Spline(_)) => 3,
        _ => 0,
    }
}

fn refusal(message: String, help: impl Into<String>) -> Refused {
    Box::new(Diagnostic::new("E0502", message).help(help))
}

/// Names of the parameters that a word of `fixed` takes out.
fn fixed(machine: &Machine, word: &str, list: &[Parameter]) -> Result<Vec<String>, Refused> {
    if GROUPS.contains(&word) {
        return Ok(of_word(machine, word, &IdentifyEntry::default())?.into_iter().map(|p| p.name).collect());
    }
    if list.iter().any(|p| p.name == word) {
        return Ok(vec![word.to_owned()]);
    }
    let error = error(machine, word)?;
    let moved = |p: &&Parameter| p.terms.first().is_some_and(|t| t.source == source(machine, &error));
    Ok(list.iter().filter(moved).map(|p| p.name.clone()).collect())
}

fn of_word(machine: &Machine, word: &str, request: &IdentifyEntry) -> Result<Vec<Parameter>, Refused> {
    match word {
        "location" => Ok(machine.axes().iter().enumerate().flat_map(|(i, _)| six(machine, i)).collect()),
        "spindle" if machine.spindle_errors().is_none() => {
            Err(refusal("this chain has no spindle".to_owned(), "write `(S)` before `t` in the chain"))
        }
        "spindle" => Ok(six(machine, machine.axes().len()).collect()),
        "tool" => Ok(setup(machine, Place::Tool, "tool", &machine.setup().tool)),
        "workpiece" => Ok(setup(machine, Place::Workpiece, "workpiece", &machine.setup().workpiece)),
        "linear" => Ok(linear(machine)),
        _ => single(machine, word, request),
    }
}

/// The six location errors of a joint.
fn six(machine: &Machine, joint: usize) -> impl Iterator<Item = Parameter> + '_ {
    let name = match machine.axes().get(joint) {
        Some(axis) => Some(&axis.name),
        None => machine.chain().spindle(),
    };
    name.into_iter().flat_map(move |axis| {
        let one = move |direction| {
            let error = ErrorId { axis: axis.clone(), location: true, direction };
            location(machine, &error)
        };
        Direction::ALL.into_iter().map(one)
    })
}

fn location(machine: &Machine, error: &ErrorId) -> Parameter {
    let term = |id: &ErrorId| machine.errors().find(|(known, _)| known == id).map(|(_, term)| term.clone());
    let start = term(error).map_or(0.0, |term| term.value(0.0, Approach::Mean));
    Parameter::single(machine, error.to_string(), source(machine, error), Basis::Constant, start)
}

fn setup(machine: &Machine, place: Place, word: &str, starts: &[f64]) -> Vec<Parameter> {
    let one = |(start, direction): (&f64, Direction)| {
        let source = Source { place, direction };
        Parameter::single(machine, format!("{word}.{}", direction.letter()), source, Basis::Constant, *start)
    };
    starts.iter().zip(Direction::ALL).map(one).collect()
}

/// Where an error sits. Its axis is one of the chain's, or the spindle.
fn source(machine: &Machine, error: &ErrorId) -> Source {
    let joint = machine.axis_index(error.axis.as_str()).unwrap_or(machine.axes().len());
    let place = if error.location { Place::Location(joint) } else { Place::Component(joint) };
    Source { place, direction: error.direction }
}

fn error(machine: &Machine, word: &str) -> Result<ErrorId, Refused> {
    let Some(error) = parse_error_name(word) else {
        let message = format!("`{}` is neither an error nor a group", shown(word));
        let help = format!("errors such as `EC0Y` or `EXX:poly3`, or a group; {}", did_you_mean(word, &GROUPS));
        return Err(refusal(message, help));
    };
    let spindle = machine.chain().spindle().is_some_and(|name| *name == error.axis);
    if machine.axis_index(error.axis.as_str()).is_none() && !(spindle && error.location) {
        let message = format!("`{error}`: the chain has no axis `{}` that could have it", error.axis);
        let known: Vec<&str> = machine.axes().iter().map(|axis| axis.name.as_str()).collect();
        return Err(refusal(message, format!("its axes are {}", known.join(", "))));
    }
    Ok(error)
}

/// One error, with the basis that stands behind it, in `identify.basis`, or usual for the axis.
fn single(machine: &Machine, word: &str, request: &IdentifyEntry) -> Result<Vec<Parameter>, Refused> {
    let (name, form) = word.split_once(':').map_or((word, None), |(name, form)| (name.trim(), Some(form.trim())));
    let error = error(machine, name)?;
    let listed = request.basis.iter().find(|(key, _)| parse_error_name(key).as_ref() == Some(&error));
    let form = form.or(listed.map(|(_, form)| form.as_str()));
    if error.location {
        return match form {
            None => Ok(vec![location(machine, &error)]),
            Some(_) => Err(refusal(format!("`{error}` is a constant: it has no basis"), format!("write `{error}`"))),
        };
    }
    let axis = machine.axis_index(error.axis.as_str()).unwrap_or_default();
    let usual = if machine.axes()[axis].kind == AxisKind::Linear { "poly3" } else { "fourier2" };
    let form = form.unwrap_or(usual);
    let cut = form.find(|c: char| c.is_ascii_digit()).unwrap_or(form.len());
    let (family, order) = (&form[..cut], form[cut..].parse::<u8>().ok().filter(|n| (1..=50).contains(n)));
    match (family, order) {
        ("poly", Some(order)) => polynomial(machine, &error, axis, order),
        ("fourier", Some(order)) => fourier(machine, &error, axis, order),
        ("spline", Some(knots)) => spline(machine, &error, axis, knots),
        _ => {
            let message = format!("`{}` is not a basis", shown(form));
            Err(refusal(message, "write poly3 (powers 0 to 3), fourier2 (orders 0 to 2) or spline8 (8 knots)"))
        }
    }
}

/// The curve that the file gives for an error, if it has one direction.
fn given<'a>(machine: &'a Machine, error: &ErrorId) -> Option<&'a Curve> {
    machine.errors().find(|(known, _)| known == error).and_then(|(_, term)| match term {
        ErrorTerm::Component(ComponentError::Single(curve)) => Some(curve),
        _ => None,
    })
}

fn polynomial(machine: &Machine, error: &ErrorId, axis: usize, order: u8) -> Result<Vec<Parameter>, Refused> {
    if machine.is_continuous(axis) {
        let help = format!("use `{error}:fourier{order}`");
        return Err(refusal(format!("`{error}`: a polynomial on an axis without ends is not periodic"), help));
    }
    let known = match given(machine, error) {
        Some(Curve::Polynomial(known)) => known.clone(),
        _ => Vec::new(),
    };
    let one = |k: u8| {
        let start = known.get(usize::from(k)).copied().unwrap_or(0.0);
        Parameter::single(machine, format!("{error}:x^{k}"), source(machine, error), Basis::Power(k), start)
    };
    Ok((0..=order.min(20)).map(one).collect())
}

fn fourier(machine: &Machine, error: &ErrorId, axis: usize, order: u8) -> Result<Vec<Parameter>, Refused> {
    if machine.axes()[axis].kind == AxisKind::Linear {
        let message = format!("`{error}`: harmonics are of one turn, axis `{}` is linear", error.axis);
        return Err(refusal(message, "use poly or spline"));
    }
    let known = match given(machine, error) {
        Some(Curve::Harmonics(known)) => known.clone(),
        _ => Vec::new(),
    };
    let at = |k: u8| known.get(usize::from(k)).copied().unwrap_or_default();
    let one = |k: u8| {
        let name = |word: &str| format!("{error}:{word}{k}");
        let cosine = Parameter::single(machine, name("cos"), source(machine, error), Basis::Cosine(k), at(k).0);
        let sine = Parameter::single(machine, name("sin"), source(machine, error), Basis::Sine(k), at(k).1);
        if k == 0 { vec![cosine] } else { vec![cosine, sine] }
    };
    Ok((0..=order).flat_map(one).collect())
}

/// Even knots over the travel; periodic, with as many knots to the turn, on an axis without ends.
fn spline(machine: &Machine, error: &ErrorId, axis: usize, knots: u8) -> Result<Vec<Parameter>, Refused> {
    let travel = machine.axes()[axis].travel;
    let (min, max) = travel.interval();
    let turn = travel == Travel::Continuous;
    let count = usize::from(knots.max(2));
    let intervals = if turn { count } else { count - 1 };
    let position = |i: usize| if i == intervals { max } else { min + (max - min) * i as f64 / intervals as f64 };
    let one = |k: usize| {
        let value = |i: usize| f64::from(u8::from(i == k || (turn && k == 0 && i == intervals)));
        let points: Vec<(f64, f64)> = (0..=intervals).map(|i| (position(i), value(i))).collect();
        let failed = || refusal(format!("`{error}`: the travel has no room for {count} knots"), "take fewer knots");
        let curve = Curve::cubic(Knots::new(&points, turn.then_some(360.0)).map_err(|_| failed())?);
        let at = crate::units::significant(position(k), 6);
        let name = format!("{error}:{at}{}", machine.axes()[axis].unit());
        let start = given(machine, error).map_or(0.0, |known| known.value(position(k)));
        Ok(Parameter::single(machine, name, source(machine, error), Basis::Spline(curve), start))
    };
    (0..count).map(one).collect()
}

/// The 2015 paper's parametrisation of every linear axis: positioning and the three angles grow with the
/// position, and straightness is the integral of the angles (the Abbe principle): `(e x u) q^2 / 2`.
fn linear(machine: &Machine) -> Vec<Parameter> {
    let slides = machine.axes().iter().enumerate().filter(|(_, axis)| axis.kind == AxisKind::Linear);
    slides.flat_map(|(i, axis)| slopes(machine, i, axis.direction)).collect()
}

fn slopes(machine: &Machine, axis: usize, u: [f64; 3]) -> Vec<Parameter> {
    let name = &machine.axes()[axis].name;
    let at = |direction| Source { place: Place::Component(axis), direction };
    let term =
        |k: usize, power, factor: f64| Term { source: at(Direction::ALL[k]), basis: Basis::Power(power), factor };
    let parameter = |main: Direction, terms: Vec<Term>| {
        let error = ErrorId { axis: name.clone(), location: false, direction: main };
        let terms = terms.into_iter().filter(|t| t.factor != 0.0).collect();
        Parameter::of_terms(machine, format!("{error}:slope"), at(main), 1, terms, 0.0)
    };
    let own = (0..3).fold(0, |most, k| if u[k].abs() > u[most].abs() { k } else { most });
    let along = parameter(Direction::ALL[own], (0..3).map(|k| term(k, 1, u[k])).collect());
    let angle = |k: usize| {
        let (next, last) = ((k + 1) % 3, (k + 2) % 3);
        // The unit vector k times u: its component `next` is -u[last], its component `last` is u[next].
        let terms = vec![term(3 + k, 1, 1.0), term(next, 2, -u[last] / 2.0), term(last, 2, u[next] / 2.0)];
        parameter(Direction::ALL[3 + k], terms)
    };
    std::iter::once(along).chain((0..3).map(angle)).collect()
}
