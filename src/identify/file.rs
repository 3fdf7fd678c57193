//! A fitted machine as a machine file: self-contained, no `extends`, no tables outside.

use super::parameter::{Basis, Parameter};
use crate::lower::{Place, Source};
use crate::machine::{
    Approach, Axis, AxisKind, Branch, ComponentError, Curve, Direction, ErrorId, ErrorTerm, Machine, Sense, Travel,
};
use std::collections::BTreeMap;

/// The text of a machine file that says what `machine` says, the fitted parameters with their new values;
/// `provenance` are further entries of that section (single lines).
pub fn fitted_file(
    machine: &Machine,
    parameters: &[Parameter],
    theta: &[f64],
    provenance: &[(String, String)],
) -> String {
    let fitted = Fitted::new(machine, parameters, theta);
    let mut text = format!("abbe: 1\nmachine: {}\nchain: \"{}\"\naxes:\n", quoted(machine.name()), machine.chain());
    machine.axes().iter().for_each(|axis| text += &axis_line(axis));
    text += &tools(machine);
    text += &format!("workpiece: {{ origin: {} }}\n", point(&machine.workpiece()));
    text += &conventions(machine);
    text += &fitted.setup();
    text += &fitted.errors();
    text += &volume(machine);
    text += "provenance:\n";
    for (key, value) in machine.provenance().entries.iter().chain(provenance) {
        text += &format!("  {}: {}\n", quoted(key), quoted(value));
    }
    text
}

/// Text that YAML cannot misread: a JSON string is one.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// The shortest digits that read back as the same number.
fn number(value: f64) -> String {
    format!("{}", value + 0.0)
}

fn point(p: &[f64; 3]) -> String {
    format!("[{}, {}, {}]", number(p[0]), number(p[1]), number(p[2]))
}

fn axis_line(axis: &Axis) -> String {
    let kind = if axis.kind == AxisKind::Linear { "linear" } else { "rotary" };
    let unit = axis.unit();
    let travel = match axis.travel {
        Travel::Range(min, max) => format!("[{} {unit}, {} {unit}]", number(min), number(max)),
        Travel::Continuous => "continuous".to_owned(),
    };
    let sense = match (axis.branch, axis.sense) {
        (Branch::Workpiece, Sense::Direct) => ", sense: direct",
        (Branch::Workpiece, Sense::Iso841) => ", sense: iso841",
        (Branch::Tool, _) => "",
    };
    let (direction, origin) = (point(&axis.direction), point(&axis.origin));
    format!("  {}: {{ kind: {kind}, direction: {direction}, origin: {origin}, travel: {travel}{sense} }}\n", axis.name)
}

/// The tool in use first: it is the default of the new file.
fn tools(machine: &Machine) -> String {
    let body = |tool: &crate::machine::Tool| {
        let offset: [f64; 3] = std::array::from_fn(|i| tool.tip[i] - tool.gauge[i]);
        format!("{{ gauge: {}, offset: {} }}\n", point(&tool.gauge), point(&offset))
    };
    if machine.tool().name.is_empty() {
        return format!("tool: {}", body(machine.tool()));
    }
    let others = machine.tools().iter().filter(|tool| tool.name != machine.tool().name);
    let lines = std::iter::once(machine.tool()).chain(others).map(|t| format!("  {}: {}", quoted(&t.name), body(t)));
    format!("tools:\n{}", lines.collect::<String>())
}

fn conventions(machine: &Machine) -> String {
    let mut map = match serde_json::to_value(machine.conventions()) {
        Ok(serde_json::Value::Object(map)) => map,
        _ => return String::new(),
    };
    map.remove("default_order");
    // Only a preset can name an order.
    let preset = machine.conventions().default_order.map(|_| "preset: hrdina-vasik-2014".to_owned());
    let words = map.iter().map(|(key, value)| format!("{key}: {}", value.as_str().unwrap_or_default()));
    format!("conventions: {{ {} }}\n", preset.into_iter().chain(words).collect::<Vec<_>>().join(", "))
}

fn volume(machine: &Machine) -> String {
    let line = |(axis, grid): (&Axis, &crate::machine::Grid)| {
        let (min, max, step) = (number(grid.min), number(grid.max), number(grid.step));
        format!("  {}: {{ range: [{min}, {max}], step: {step} }}\n", axis.name)
    };
    let lines: String = machine.axes().iter().zip(machine.volume()).map(line).collect();
    format!("volume:\n{lines}")
}

/// The fitted curves, source by source.
struct Fitted<'a> {
    machine: &'a Machine,
    curves: BTreeMap<(u8, usize, usize), Directed>,
}

/// Curves of mean, forward and reverse approach, as far as they were fitted.
type Directed = [Option<Curve>; 3];

/// Where an approach stands in [`Directed`].
fn way(approach: Approach) -> usize {
    match approach {
        Approach::Mean => 0,
        Approach::Forward => 1,
        Approach::Reverse => 2,
    }
}

/// A sortable key: set-up of tool and workpiece, location and component errors by joint and direction.
fn key(source: Source) -> (u8, usize, usize) {
    let direction = source.direction.index();
    match source.place {
        Place::Tool => (0, 0, direction % 3),
        Place::Workpiece => (1, 0, direction),
        Place::Location(joint) => (2, joint, direction),
        Place::Component(axis) => (3, axis, direction),
    }
}

impl<'a> Fitted<'a> {
    fn new(machine: &'a Machine, parameters: &[Parameter], theta: &[f64]) -> Self {
        let mut curves: BTreeMap<(u8, usize, usize), Directed> = BTreeMap::new();
        for (parameter, value) in parameters.iter().zip(theta) {
            for term in &parameter.terms {
                let amount = value * term.factor;
                let sum = &mut curves.entry(key(term.source)).or_default()[way(term.approach)];
                *sum = Some(join(sum.take(), &term.basis, amount));
            }
        }
        Self { machine, curves }
    }

    /// The fitted constant of a source, if it was fitted.
    fn constant(&self, source: Source) -> Option<f64> {
        self.curves.get(&key(source)).and_then(|[mean, ..]| mean.as_ref()).map(|curve| curve.value(0.0))
    }

    fn setup(&self) -> String {
        let part = |place: Place, values: &[f64]| {
            let each = values.iter().zip(Direction::ALL).filter_map(|(value, direction)| {
                let value = self.constant(Source { place, direction }).unwrap_or(*value);
                (value != 0.0).then(|| format!("{}: {}", direction.letter(), amount(value, direction)))
            });
            each.collect::<Vec<_>>().join(", ")
        };
        let setup = self.machine.setup();
        let (tool, workpiece) = (part(Place::Tool, &setup.tool), part(Place::Workpiece, &setup.workpiece));
        format!("setup: {{ tool: {{ {tool} }}, workpiece: {{ {workpiece} }} }}\n")
    }

    fn errors(&self) -> String {
        let known: BTreeMap<ErrorId, &ErrorTerm> = self.machine.errors().collect();
        let axes = self.machine.axes().iter().map(|axis| &axis.name);
        let mut lines = String::new();
        for (joint, name) in axes.chain(self.machine.chain().spindle()).enumerate() {
            for (location, direction) in [true, false].into_iter().flat_map(|l| Direction::ALL.map(|d| (l, d))) {
                let id = ErrorId { axis: name.clone(), location, direction };
                let place = if location { Place::Location(joint) } else { Place::Component(joint) };
                let source = Source { place, direction };
                let fitted = self.curves.get(&key(source));
                let constant = if location { self.constant(source) } else { None };
                let written = match (fitted, known.get(&id)) {
                    (Some(_), None) if constant == Some(0.0) => None,
                    (Some(_), _) if location => Some(amount(constant.unwrap_or(0.0), direction)),
                    (Some(fitted), term) => Some(self.fitted(fitted, term.copied(), joint, direction)),
                    (None, Some(term)) => Some(self.term(term, joint, direction)),
                    (None, None) => None,
                };
                lines += &written.map_or_else(String::new, |text| format!("  {id}: {text}\n"));
            }
        }
        if lines.is_empty() { lines } else { format!("errors:\n{lines}") }
    }

    /// A fitted component error. A direction that was not fitted keeps what the file says.
    fn fitted(&self, curves: &Directed, known: Option<&ErrorTerm>, joint: usize, direction: Direction) -> String {
        let kept = match known {
            Some(ErrorTerm::Component(ComponentError::Single(curve))) => [Some(curve), Some(curve)],
            Some(ErrorTerm::Component(ComponentError::Bidirectional { forward, reverse })) => {
                [Some(forward), Some(reverse)]
            }
            _ => [None, None],
        };
        let text = |curve: Option<&Curve>| {
            let none = Curve::Polynomial(vec![0.0]);
            self.curve(curve.unwrap_or(&none), joint, direction)
        };
        let [mean, forward, reverse] = curves;
        match mean {
            Some(mean) => text(Some(mean)),
            None => {
                let [forward, reverse] = [text(forward.as_ref().or(kept[0])), text(reverse.as_ref().or(kept[1]))];
                format!("{{ forward: {forward}, reverse: {reverse} }}")
            }
        }
    }

    fn term(&self, term: &ErrorTerm, joint: usize, direction: Direction) -> String {
        match term {
            ErrorTerm::Constant(value) => amount(*value, direction),
            ErrorTerm::Tolerance(value) => format!("{{ tolerance: {} }}", amount(*value, direction)),
            ErrorTerm::Component(ComponentError::Single(curve)) => self.curve(curve, joint, direction),
            ErrorTerm::Component(ComponentError::Bidirectional { forward, reverse }) => {
                let [forward, reverse] = [forward, reverse].map(|curve| self.curve(curve, joint, direction));
                format!("{{ forward: {forward}, reverse: {reverse} }}")
            }
        }
    }

    fn curve(&self, curve: &Curve, axis: usize, direction: Direction) -> String {
        let axis = &self.machine.axes()[axis];
        match curve {
            Curve::Polynomial(c) => {
                let terms: Vec<String> =
                    c.iter().enumerate().map(|(k, c)| coefficient(*c, direction, axis, k)).collect();
                format!("{{ polynomial: [{}] }}", terms.join(", "))
            }
            Curve::Harmonics(orders) => {
                let pair = |(k, (c, s)): (usize, &(f64, f64))| {
                    format!("{k}: [{}, {}]", amount(*c, direction), amount(*s, direction))
                };
                format!("{{ harmonics: {{ {} }} }}", orders.iter().enumerate().map(pair).collect::<Vec<_>>().join(", "))
            }
            Curve::Linear(knots) | Curve::Cubic(knots, _) => {
                let unit = axis.unit();
                let pairs = knots.positions().iter().zip(knots.values());
                let points: Vec<String> =
                    pairs.map(|(q, v)| format!("[{} {unit}, {}]", number(*q), amount(*v, direction))).collect();
                let cubic = if matches!(curve, Curve::Cubic(..)) { "cubic" } else { "linear" };
                format!("{{ points: [{}], interpolation: {cubic} }}", points.join(", "))
            }
        }
    }
}

/// A curve and `amount` of a basis function.
fn join(known: Option<Curve>, basis: &Basis, amount: f64) -> Curve {
    match basis {
        Basis::Constant => power(known, 0, amount),
        Basis::Power(k) => power(known, usize::from(*k), amount),
        Basis::Cosine(k) => harmonic(known, usize::from(*k), (amount, 0.0)),
        Basis::Sine(k) => harmonic(known, usize::from(*k), (0.0, amount)),
        Basis::Spline(curve) => spline(known, curve, amount),
    }
}

fn power(known: Option<Curve>, k: usize, amount: f64) -> Curve {
    let mut c = if let Some(Curve::Polynomial(c)) = known { c } else { Vec::new() };
    c.resize(c.len().max(k + 1), 0.0);
    c[k] += amount;
    Curve::Polynomial(c)
}

fn harmonic(known: Option<Curve>, k: usize, (cosine, sine): (f64, f64)) -> Curve {
    let mut orders = if let Some(Curve::Harmonics(orders)) = known { orders } else { Vec::new() };
    orders.resize(orders.len().max(k + 1), (0.0, 0.0));
    orders[k] = (orders[k].0 + cosine, orders[k].1 + sine);
    Curve::Harmonics(orders)
}

/// Splines through the same knots add up knot by knot.
fn spline(known: Option<Curve>, one: &Curve, amount: f64) -> Curve {
    let Some(knots) = one.knots() else { return one.clone() };
    let before = known.as_ref().and_then(Curve::knots);
    let value = |i: usize| before.map_or(0.0, |k| k.values()[i]) + amount * knots.values()[i];
    let points: Vec<(f64, f64)> = knots.positions().iter().enumerate().map(|(i, q)| (*q, value(i))).collect();
    let smooth = matches!(one, Curve::Cubic(..));
    let through = |knots| if smooth { Curve::cubic(knots) } else { Curve::Linear(knots) };
    crate::machine::Knots::new(&points, knots.period()).map_or_else(|_| one.clone(), through)
}

/// A value with its unit.
fn amount(value: f64, direction: Direction) -> String {
    if direction.is_rotation() {
        format!("{} urad", number(value * 1e6))
    } else {
        format!("{} um", number(value * 1e3))
    }
}

/// A coefficient of the position to a power, in um/m^k, urad/m^k, or per degree.
fn coefficient(value: f64, direction: Direction, axis: &Axis, k: usize) -> String {
    if k == 0 {
        return amount(value, direction);
    }
    let (per, argument) = if axis.kind == AxisKind::Linear { (1e3, "m") } else { (1.0, "deg") };
    let value = (0..k).fold(value, |v, _| v * per);
    let exponent = if k == 1 { String::new() } else { format!("^{k}") };
    format!("{}/{argument}{exponent}", amount(value, direction))
}
