//! A machine as a machine file: self-contained, no `extends`, no tables outside. The inverse of [`super::resolve()`].

use super::{
    AlgebraChoice, Axis, AxisGeometry, AxisKind, AxisName, Branch, ComponentError, ControllerAxis, Curve, Direction,
    ErrorFamily, ErrorId, ErrorTerm, FRAME_KEYS, FrameTolerances, Generators, Geometry, Grid, JointErrors,
    JointUncertainty, MAIN_AXES, Machine, MachineParts, NamedRelation, Position, ReferencePoint, ResidualForm, Sense,
    SetUp, Tool, Travel,
};

/// Returns the text of a machine file that says what `parts` say; `provenance` are further entries of that section
/// (single lines).
pub fn machine_file(parts: &MachineParts, provenance: &[(String, String)]) -> String {
    let mut text = format!("abbe: 1\nmachine: {}\nchain: \"{}\"\naxes:\n", quote(&parts.name), parts.chain);
    parts.axes.iter().zip(&parts.errors).for_each(|(axis, errors)| text += &axis_line(axis, errors, parts));
    text += &tools(&parts.tools);
    text += &workpiece(parts);
    text += &conventions(parts);
    text += &setup(&parts.setup);
    text += &errors(parts);
    text += &tolerances(parts);
    text += &parts.class.as_ref().map_or_else(String::new, |named| named.class.written());
    text += &volume(parts);
    text += &parts.algebra.as_ref().map_or_else(String::new, algebra);
    text += "provenance:\n";
    for (key, value) in parts.provenance.entries.iter().chain(provenance) {
        text += &format!("  {}: {}\n", quote(key), quote(value));
    }
    text + &covariance(parts)
}

impl Machine {
    /// Returns the text that identifies the resolved machine with its tool: everything that results depend on, as a
    /// machine file, and the references from which its axes and its workpiece are placed anew.
    pub fn canonical(&self) -> String {
        let parts = self.to_parts();
        let Geometry { axes, workpiece } = &parts.geometry;
        let position = |Position { from, at }: &Position| {
            let from = match from {
                ReferencePoint::Bed => "bed",
                ReferencePoint::Workpiece => "workpiece",
                ReferencePoint::Axis(name) => name.as_str(),
            };
            format!("{from} {}", point(at))
        };
        let side = |(name, axis): (&AxisName, &AxisGeometry)| {
            let sides = [&axis.tool, &axis.workpiece];
            let sides = sides.map(|side| format!("{} {} {}", position(&side.origin), side.stated, side.origin_written));
            format!("# {name}: {}\n", sides.join("; "))
        };
        let references: String = axes.iter().map(side).collect();
        let tool = quote(&self.tool().name);
        format!("{}{references}# workpiece: {}\n# tool: {tool}\n", machine_file(&parts, &[]), position(workpiece))
    }
}

/// Text that YAML cannot misread: a JSON string is one.
fn quote(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// Returns the shortest digits that read back as the same number.
fn number(value: f64) -> String {
    format!("{}", value + 0.0)
}

fn point(p: &[f64; 3]) -> String {
    format!("[{}, {}, {}]", number(p[0]), number(p[1]), number(p[2]))
}

fn axis_line(axis: &Axis, errors: &JointErrors, parts: &MachineParts) -> String {
    let kind = if axis.kind == AxisKind::Linear { "linear" } else { "rotary" };
    let travel = travel(axis.travel, axis.unit());
    let sense = match (axis.branch, axis.sense) {
        (Branch::Workpiece, Sense::Direct) => ", sense: direct",
        (Branch::Workpiece, Sense::Iso841) => ", sense: iso841",
        (Branch::Tool, _) => "",
    };
    let (direction, origin) = (point(&axis.direction), point(&axis.origin));
    let other = other_side(axis, errors, parts).unwrap_or_default();
    let (name, known) = (&axis.name, controller(axis.controller));
    let home = axis.home.map_or_else(String::new, |home| format!(", home: {} {}", number(home), axis.unit()));
    let geometry = format!("direction: {direction}, origin: {origin}, travel: {travel}{sense}{home}");
    format!("  {name}: {{ kind: {kind}, {geometry}{known}{other} }}\n")
}

fn controller(axis: ControllerAxis) -> String {
    let words = axis.words();
    if words.is_empty() { String::new() } else { format!(", controller: [{}]", words.join(", ")) }
}

fn travel(travel: Travel, unit: &str) -> String {
    match travel {
        Travel::Range(min, max) => format!("[{} {unit}, {} {unit}]", number(min), number(max)),
        Travel::Continuous => "continuous".to_owned(),
    }
}

/// Returns the block of the other side, if its geometry is stated.
fn other_side(axis: &Axis, own: &JointErrors, parts: &MachineParts) -> Option<String> {
    let branch = axis.branch.opposite();
    let side = parts.geometry.axes.get(&axis.name)?.on(branch);
    if !side.stated {
        return None;
    }
    let key = if branch == Branch::Tool { "on_tool" } else { "on_workpiece" };
    let at = point(&side.origin.at);
    let origin = match &side.origin.from {
        ReferencePoint::Bed => at,
        ReferencePoint::Workpiece => format!("{{ from: workpiece, at: {at} }}"),
        ReferencePoint::Axis(name) if parts.axes.iter().any(|axis| axis.name == *name) => {
            format!("{{ from: {name}, at: {at} }}")
        }
        // The file written does not declare axes outside the chain.
        ReferencePoint::Axis(_) => return None,
    };
    let (direction, travel) = (point(&side.direction), travel(side.travel, axis.unit()));
    let errors: Vec<String> = side.errors.iter().flat_map(|errors| differing(axis, own, errors)).collect();
    let errors = if errors.is_empty() { String::new() } else { format!(", errors: {{ {} }}", errors.join(", ")) };
    Some(format!(", {key}: {{ direction: {direction}, origin: {origin}, travel: {travel}{errors} }}"))
}

/// Returns the errors of an axis that are not the same on the other side; zero where there is none.
fn differing(axis: &Axis, own: &JointErrors, other: &JointErrors) -> Vec<String> {
    let mut lines = Vec::new();
    for family in ErrorFamily::ALL {
        for direction in Direction::ALL {
            let [own, other] = [own, other].map(|errors| errors.six(family)[direction.index()].as_ref());
            if own != other {
                let id = ErrorId { axis: axis.name.clone(), family, direction };
                let value = other.map_or_else(|| amount(0.0, direction), |of| term(of, direction, Some(axis)));
                lines.push(format!("{id}: {value}"));
            }
        }
    }
    lines
}

fn tools(tools: &[Tool]) -> String {
    let body = |tool: &Tool| {
        let offset: [f64; 3] = std::array::from_fn(|i| tool.tip[i] - tool.gauge[i]);
        let upright = tool.direction == [0.0, 0.0, 1.0];
        let direction = if upright { String::new() } else { format!(", direction: {}", point(&tool.direction)) };
        format!("{{ gauge: {}, offset: {}{direction} }}\n", point(&tool.gauge), point(&offset))
    };
    match tools {
        [only] if only.name.is_empty() => format!("tool: {}", body(only)),
        _ => tools.iter().fold("tools:\n".to_owned(), |text, t| text + &format!("  {}: {}", quote(&t.name), body(t))),
    }
}

fn workpiece(parts: &MachineParts) -> String {
    let turns = ["A", "B", "C"].iter().zip(parts.workpiece_rotation).filter(|(_, degrees)| *degrees != 0.0);
    let turns: Vec<String> = turns.map(|(letter, degrees)| format!("{letter}: {} deg", number(degrees))).collect();
    let rotation = if turns.is_empty() { String::new() } else { format!(", rotation: {{ {} }}", turns.join(", ")) };
    format!("workpiece: {{ origin: {}{rotation} }}\n", point(&parts.workpiece))
}

fn conventions(parts: &MachineParts) -> String {
    let mut map = match serde_json::to_value(parts.conventions) {
        Ok(serde_json::Value::Object(map)) => map,
        _ => return String::new(),
    };
    map.remove("default_order");
    // Only a preset can name an order.
    let preset = parts.conventions.default_order.map(|order| {
        let name = if order == 1 { "hrdina-vasik-2014" } else { "holub-2015" };
        format!("preset: {name}")
    });
    let words = map.iter().map(|(key, value)| format!("{key}: {}", value.as_str().unwrap_or_default()));
    format!("conventions: {{ {} }}\n", preset.into_iter().chain(words).collect::<Vec<_>>().join(", "))
}

fn volume(parts: &MachineParts) -> String {
    let line = |(axis, grid): (&Axis, &Grid)| {
        let (min, max, step) = (number(grid.min), number(grid.max), number(grid.step));
        format!("  {}: {{ range: [{min}, {max}], step: {step} }}\n", axis.name)
    };
    let lines: String = parts.axes.iter().zip(&parts.volume).map(line).collect();
    format!("volume:\n{lines}")
}

fn setup(values: &SetUp) -> String {
    format!("setup: {}\n", setup_body(values))
}

fn setup_body(setup: &SetUp) -> String {
    format!("{{ tool: {{ {} }}, workpiece: {{ {} }} }}", amounts(&setup.tool), amounts(&setup.workpiece))
}

/// Amounts by letter, those that are not 0.
fn amounts(values: &[f64]) -> String {
    let given = values.iter().zip(Direction::ALL).filter(|(value, _)| **value != 0.0);
    given.map(|(value, d)| format!("{}: {}", d.letter(), amount(*value, d))).collect::<Vec<_>>().join(", ")
}

fn algebra(choice: &AlgebraChoice) -> String {
    let list = |words: &mut dyn Iterator<Item = String>| format!("[{}]", words.collect::<Vec<_>>().join(", "));
    let generators = match &choice.generators {
        Generators::PerError => "per-error".to_owned(),
        Generators::PerAxis => "per-axis".to_owned(),
        Generators::Single => "single".to_owned(),
        Generators::Groups(groups) => {
            let group = |(name, errors): &(String, Vec<ErrorId>)| {
                format!("{}: {}", quote(name), list(&mut errors.iter().map(ErrorId::to_string)))
            };
            format!("{{ {} }}", groups.iter().map(group).collect::<Vec<_>>().join(", "))
        }
    };
    let monomial = |factors: &Vec<(String, u8)>| {
        factors.iter().map(|(name, power)| format!("{name}^{power}")).collect::<Vec<_>>().join("*")
    };
    let relation = |r: &NamedRelation| format!("{} = {} {}", monomial(&r.left), r.factor, monomial(&r.right));
    let elements = choice.vanish.iter().map(monomial).chain(choice.relations.iter().map(relation));
    let vanish = list(&mut elements.map(|text| quote(&text)));
    format!("algebra: {{ degree: {}, generators: {generators}, vanish: {vanish} }}\n", choice.degree)
}

fn errors(parts: &MachineParts) -> String {
    let lines: String = parts
        .joints()
        .zip(&parts.errors)
        .map(|((name, axis), errors)| joint_lines(parts, name, axis, errors))
        .collect();
    if lines.is_empty() { lines } else { format!("errors:\n{lines}") }
}

/// Joint uncertainty, a line for each part.
fn covariance(parts: &MachineParts) -> String {
    let line = |part: &JointUncertainty| {
        let terms = parts.joints().flat_map(|(name, axis)| {
            let six = part.errors.get(name).into_iter().flat_map(JointErrors::iter);
            six.map(move |(family, direction, of)| {
                let id = ErrorId { axis: name.clone(), family, direction };
                format!("{id}: {}", term(of, direction, axis))
            })
        });
        let errors = format!("errors: {{ {} }}", terms.collect::<Vec<_>>().join(", "));
        let setup = if part.setup == SetUp::default() {
            String::new()
        } else {
            format!(", setup: {}", setup_body(&part.setup))
        };
        format!("  - {{ {errors}{setup} }}\n")
    };
    let form = |form: &ResidualForm| {
        let turns = parts.axes.iter().any(|of| of.name == form.axis && of.kind == AxisKind::Rotary);
        let unit = if turns { "deg" } else { "mm" };
        format!(
            "  - {{ form: {{ axis: {}{}, length: {} {unit} }} }}\n",
            quote(form.axis.as_str()),
            form_sizes(form),
            number(form.length)
        )
    };
    let joint = parts.covariance.iter().filter(|part| !part.is_empty()).map(line);
    let unheld = parts.unheld.iter().map(|motion| format!("  - {{ unheld: {{ {} }} }}\n", amounts(&motion.amounts())));
    let range = |axis: &Axis| {
        let (min, max) = parts.measured.get(&axis.name)?;
        Some(format!("{}: [{}, {}]", quote(axis.name.as_str()), number(*min), number(*max)))
    };
    let ranges: Vec<String> = parts.axes.iter().filter_map(range).collect();
    let measured = (!ranges.is_empty()).then(|| format!("  - {{ measured: {{ {} }} }}\n", ranges.join(", ")));
    let lines: String = joint.chain(parts.forms.iter().map(form)).chain(unheld).chain(measured).collect();
    if lines.is_empty() { lines } else { format!("covariance:\n{lines}") }
}

/// Returns the sizes of a form: one of all displacements and one of all rotations, or those of the errors.
fn form_sizes(form: &ResidualForm) -> String {
    let amount = |direction: Direction, size: f64| {
        if direction.is_rotation() { format!("{} urad", number(size * 1e6)) } else { format!("{} mm", number(size)) }
    };
    let [x, y, z, a, b, c] = form.sizes;
    if x == y && y == z && a == b && b == c {
        let size = if x > 0.0 { format!(", size: {}", amount(Direction::X, x)) } else { String::new() };
        let rotation = if a > 0.0 { format!(", rotation: {}", amount(Direction::A, a)) } else { String::new() };
        return size + &rotation;
    }
    let one = |direction: &Direction| {
        let (axis, family, direction) = (form.axis.clone(), ErrorFamily::Component, *direction);
        let size = form.scatter(direction);
        (size > 0.0).then(|| format!("{}: {}", ErrorId { axis, family, direction }, amount(direction, size)))
    };
    format!(", errors: {{ {} }}", Direction::ALL.iter().filter_map(one).collect::<Vec<_>>().join(", "))
}

/// Bounds along and across axes of the chain, and squareness.
fn tolerances(parts: &MachineParts) -> String {
    let four = |four: &FrameTolerances| {
        let given = FRAME_KEYS.iter().zip(four).enumerate().filter_map(|(k, (key, value))| {
            let direction = if k < 2 { Direction::X } else { Direction::A };
            Some(format!("{key}: {}", amount((*value)?, direction)))
        });
        given.collect::<Vec<_>>()
    };
    let joints = parts.axes.iter().map(|axis| &axis.name).chain(parts.chain.spindle());
    let of_joint = |name: &AxisName| {
        let [location, component] = parts.tolerances.joints.get(name)?;
        let mut all = four(component);
        if location.iter().any(Option::is_some) {
            all.push(format!("location: {{ {} }}", four(location).join(", ")));
        }
        Some(format!("  {name}: {{ {} }}\n", all.join(", ")))
    };
    let there = |axis: usize| parts.axes.iter().any(|a| a.name.main() == Some(axis));
    let pairs = parts.tolerances.squareness.iter().filter(|(pair, _)| pair.iter().all(|axis| there(*axis)));
    let pair = |([a, b], value): (&[usize; 2], &f64)| {
        format!("  {}-{}: {}\n", MAIN_AXES[*a], MAIN_AXES[*b], amount(*value, Direction::A))
    };
    let lines: String = joints.filter_map(of_joint).chain(pairs.map(pair)).collect();
    if lines.is_empty() { lines } else { format!("tolerances:\n{lines}") }
}

/// Location errors, then component errors; a spindle has no positions.
fn joint_lines(parts: &MachineParts, name: &AxisName, axis: Option<&Axis>, errors: &JointErrors) -> String {
    let line = |(family, direction, of): (ErrorFamily, Direction, &ErrorTerm)| {
        let id = ErrorId { axis: name.clone(), family, direction };
        let term = term(of, direction, axis);
        match parts.uncertainty.get(&id) {
            Some(half) => format!("  {id}: {}\n", with_uncertainty(&term, &round(*half, direction))),
            None => format!("  {id}: {term}\n"),
        }
    };
    errors.iter().map(line).collect()
}

/// Returns a term with its uncertainty beside it, in its mapping.
fn with_uncertainty(term: &str, uncertainty: &str) -> String {
    match term.strip_suffix(" }") {
        Some(open) => format!("{open}, uncertainty: {uncertainty} }}"),
        None => format!("{{ value: {term}, uncertainty: {uncertainty} }}"),
    }
}

fn term(term: &ErrorTerm, direction: Direction, axis: Option<&Axis>) -> String {
    match term {
        ErrorTerm::Constant(value) => amount(*value, direction),
        ErrorTerm::Tolerance(value) => format!("{{ tolerance: {} }}", amount(*value, direction)),
        ErrorTerm::Component(ComponentError::Single(one)) => curve(one, direction, axis),
        ErrorTerm::Component(ComponentError::Bidirectional { forward, reverse }) => {
            let [forward, reverse] = [forward, reverse].map(|one| curve(one, direction, axis));
            format!("{{ forward: {forward}, reverse: {reverse} }}")
        }
    }
}

fn curve(curve: &Curve, direction: Direction, axis: Option<&Axis>) -> String {
    let kind = axis.map_or(AxisKind::Linear, |axis| axis.kind);
    let unit = kind.unit();
    match curve {
        Curve::Polynomial(c) => {
            let terms: Vec<String> = c.iter().enumerate().map(|(k, c)| coefficient(*c, direction, kind, k)).collect();
            format!("{{ polynomial: [{}] }}", terms.join(", "))
        }
        Curve::Harmonics(orders) => {
            let pair = |(k, (c, s)): (usize, &(f64, f64))| {
                format!("{k}: [{}, {}]", amount(*c, direction), amount(*s, direction))
            };
            format!("{{ harmonics: {{ {} }} }}", orders.iter().enumerate().map(pair).collect::<Vec<_>>().join(", "))
        }
        Curve::BSpline(spline) => {
            let breaks: Vec<String> =
                spline.breaks().positions().iter().map(|q| format!("{} {unit}", number(*q))).collect();
            let coefficients: Vec<String> = spline.coefficients().iter().map(|c| amount(*c, direction)).collect();
            let (degree, breaks, coefficients) = (spline.degree(), breaks.join(", "), coefficients.join(", "));
            format!("{{ bspline: {{ degree: {degree}, knots: [{breaks}], coefficients: [{coefficients}] }} }}")
        }
        Curve::Linear(knots) | Curve::Cubic(knots, _) => {
            let pairs = knots.positions().iter().zip(knots.values());
            let points: Vec<String> =
                pairs.map(|(q, v)| format!("[{} {unit}, {}]", number(*q), amount(*v, direction))).collect();
            let cubic = if matches!(curve, Curve::Cubic(..)) { "cubic" } else { "linear" };
            // A curve that stops short of the travel does so on purpose.
            let is_short = |axis: &Axis| {
                let ((min, max), domain) = (axis.travel.interval(), curve.domain());
                axis.travel != Travel::Continuous && domain.is_some_and(|(first, last)| first > min || last < max)
            };
            let beyond = if axis.is_some_and(is_short) { ", beyond: hold" } else { "" };
            format!("{{ points: [{}], interpolation: {cubic}{beyond} }}", points.join(", "))
        }
    }
}

/// Returns an uncertainty with its unit, to twelve digits.
fn round(value: f64, direction: Direction) -> String {
    let (factor, unit) = direction.micro();
    format!("{} {unit}", crate::units::significant(value * factor, 12))
}

fn amount(value: f64, direction: Direction) -> String {
    if direction.is_rotation() {
        format!("{} urad", number(value * 1e6))
    } else {
        format!("{} um", number(value * 1e3))
    }
}

/// Returns a coefficient of the position to a power, in um/m^k, urad/m^k, or per degree.
fn coefficient(value: f64, direction: Direction, kind: AxisKind, k: usize) -> String {
    if k == 0 {
        return amount(value, direction);
    }
    let (per, argument) = if kind == AxisKind::Linear { (1e3, "m") } else { (1.0, "deg") };
    let value = (0..k).fold(value, |v, _| v * per);
    let exponent = if k == 1 { String::new() } else { format!("^{k}") };
    format!("{}/{argument}{exponent}", amount(value, direction))
}
