//! Writes a random machine in the machine language, and its tables beside it.

use std::fmt::Write;

use super::curves::{Curve, Error, Points};
use super::machines::{Extra, Sample};
use super::program::Folder;
use super::rigid::Axis;

const DIRECTIONS: [char; 6] = ['X', 'Y', 'Z', 'A', 'B', 'C'];

/// Writes `machine.yaml` and its tables into a folder, and returns the text.
pub fn write(sample: &Sample, folder: &Folder) -> String {
    let rigid = &sample.rigid;
    let mut text = format!("abbe: 1\nmachine: random\n{}\n{}", chain(sample), conventions(sample));
    text += "axes:\n";
    for (axis, extra) in rigid.walk.iter().zip(&sample.axes) {
        // The order in which the readers of these tests count.
        let place = |name: &str| "XYZABCUVW".find(name).unwrap_or(usize::MAX);
        let before =
            rigid.walk.iter().filter(|other| (place(&other.name), &other.name) < (place(&axis.name), &axis.name));
        writeln!(text, "  {}: {{ controller: {}, {}", axis.name, before.count() + 1, axis_line(axis, extra)).unwrap();
    }
    let [x, y, length] = rigid.offset;
    let tip =
        if x == 0.0 && y == 0.0 { format!("length: {} mm", -length) } else { format!("offset: {:?}", rigid.offset) };
    writeln!(text, "tool: {{ gauge: {:?}, {tip} }}", rigid.gauge).unwrap();
    let [a, b, c] = rigid.workpiece_rotation;
    let turned = format!(", rotation: {{ A: {a} deg, B: {b}, C: {} rad }}", c.to_radians());
    let turned = if [a, b, c] == [0.0; 3] { String::new() } else { turned };
    writeln!(text, "workpiece: {{ origin: {:?}{turned} }}", rigid.workpiece_origin).unwrap();
    let (tool, workpiece) = (constants(&rigid.tool_setup, 1), constants(&rigid.workpiece_setup, 2));
    writeln!(text, "setup: {{ tool: {{ {tool} }}, workpiece: {{ {workpiece} }} }}").unwrap();
    text += &errors(sample, folder);
    folder.write("machine.yaml", &text);
    text
}

fn chain(sample: &Sample) -> String {
    let (workpiece, tool): (Vec<_>, Vec<_>) = sample.rigid.walk.iter().partition(|axis| axis.workpiece);
    let names = |side: &[&Axis], prime: &str| side.iter().map(|a| format!("{}{prime} ", a.name)).collect::<String>();
    if sample.branches {
        let outwards: Vec<_> = workpiece.iter().rev().map(|a| a.name.as_str()).collect();
        let tool: Vec<_> = tool.iter().map(|a| a.name.as_str()).collect();
        return format!("branches: {{ workpiece: [{}], tool: [{}] }}", outwards.join(", "), tool.join(", "));
    }
    let spindle = if sample.rigid.spindle.is_some() { "(S) " } else { "" };
    format!("chain: \"w {}b {}{spindle}t\"", names(&workpiece, "'"), names(&tool, ""))
}

fn conventions(sample: &Sample) -> String {
    let c = sample.rigid.conventions;
    let keys = [
        ("location", c.carried_body, "carried_body"),
        ("linear", c.before, "before"),
        ("rotary", c.rotating, "rotating"),
        ("workpiece_axes", c.direct, "direct"),
        ("errors_are", c.body, "body"),
        ("location_order", c.real, "real"),
        ("joints", c.linearised, "linearised"),
    ];
    // Defaults are omitted, so that they are tested too.
    let changed: Vec<_> = keys.iter().filter(|k| k.1).map(|(key, _, value)| format!("{key}: {value}")).collect();
    if changed.is_empty() { String::new() } else { format!("conventions: {{ {} }}\n", changed.join(", ")) }
}

fn axis_line(axis: &Axis, extra: &Extra) -> String {
    let unit = if axis.rotary { "deg" } else { "mm" };
    let mut line = match extra.travel {
        Some([low, high]) => format!("travel: [{low} {unit}, {high} {unit}]"),
        None => "travel: continuous".into(),
    };
    if axis.name.starts_with('J') {
        line += if axis.rotary { ", kind: rotary" } else { ", kind: linear" };
    }
    let letter = "XYZUVWABC".find(&axis.name);
    let default = letter.is_some_and(|i| (0..3).all(|k| axis.direction[k] == f64::from(u8::from(k == i % 3))));
    if !default {
        write!(line, ", direction: {:?}", axis.direction).unwrap();
    }
    if let Some(direct) = axis.direct {
        write!(line, ", sense: {}", if direct { "direct" } else { "iso841" }).unwrap();
    }
    write!(line, ", origin: {:?} }}", axis.origin).unwrap();
    line
}

/// `X: 1 um, A: 2 urad` of those that are not zero.
fn constants(values: &[f64], salt: usize) -> String {
    let used = values.iter().enumerate().filter(|(_, v)| **v != 0.0);
    let written: Vec<_> = used.map(|(k, v)| format!("{}: {}", DIRECTIONS[k], Unit::of(k, salt).quantity(*v))).collect();
    written.join(", ")
}

fn errors(sample: &Sample, folder: &Folder) -> String {
    let mut lines = String::new();
    let located = sample.rigid.walk.iter().map(|axis| (axis.name.as_str(), axis.location));
    let spindle = sample.rigid.spindle.map(|location| ("S", location));
    for (salt, (name, location)) in located.chain(spindle).enumerate() {
        for (k, value) in location.iter().enumerate().filter(|(_, v)| **v != 0.0) {
            writeln!(lines, "  E{}0{name}: {}", DIRECTIONS[k], Unit::of(k, salt).quantity(*value)).unwrap();
        }
    }
    for (salt, (axis, extra)) in sample.rigid.walk.iter().zip(&sample.axes).enumerate() {
        for (k, error) in extra.errors.iter().enumerate() {
            let Some(error) = error else { continue };
            let writer =
                Writer { axis, name: format!("E{}{}", DIRECTIONS[k], axis.name), unit: Unit::of(k, salt), folder };
            writeln!(lines, "  {}: {}", writer.name, writer.error(error)).unwrap();
        }
    }
    if lines.is_empty() { lines } else { format!("errors:\n{lines}") }
}

/// A unit and its size in mm or rad.
#[derive(Clone, Copy)]
struct Unit(&'static str, f64);

impl Unit {
    /// One of the units for a component; every spelling gets its turn.
    fn of(component: usize, salt: usize) -> Self {
        let degree = std::f64::consts::PI / 180.0;
        let translations = [Self("um", 1e-3), Self("mm", 1.0), Self("nm", 1e-6)];
        let rotations = [Self("urad", 1e-6), Self("mrad", 1e-3), Self("arcsec", degree / 3600.0), Self("rad", 1.0)];
        if component < 3 { translations[(component + salt) % 3] } else { rotations[(component + salt) % 4] }
    }

    fn quantity(self, value: f64) -> String {
        format!("{} {}", value / self.1, self.0)
    }
}

/// Writes the error of one name.
struct Writer<'a> {
    axis: &'a Axis,
    name: String,
    unit: Unit,
    folder: &'a Folder,
}

impl Writer<'_> {
    fn error(&self, error: &Error) -> String {
        match &error.reverse {
            None => self.curve(&error.forward, ""),
            Some(reverse) => {
                format!(
                    "{{ forward: {}, reverse: {} }}",
                    self.curve(&error.forward, "-up"),
                    self.curve(reverse, "-down")
                )
            }
        }
    }

    fn curve(&self, curve: &Curve, suffix: &str) -> String {
        match curve {
            Curve::Constant(value) => self.unit.quantity(*value),
            Curve::Polynomial(c) => {
                let terms: Vec<_> = c.iter().enumerate().map(|(k, c)| self.coefficient(k, *c)).collect();
                format!("{{ polynomial: [{}] }}", terms.join(", "))
            }
            Curve::Harmonics(terms) => {
                let term = |(k, c, s): &(u32, f64, f64)| {
                    format!("{k}: [{}, {}]", self.unit.quantity(*c), self.unit.quantity(*s))
                };
                format!("{{ harmonics: {{ {} }} }}", terms.iter().map(term).collect::<Vec<_>>().join(", "))
            }
            Curve::Points(points) => self.points(points, suffix),
        }
    }

    /// Linear axes count in metres, rotary ones in degrees.
    fn coefficient(&self, power: usize, value: f64) -> String {
        let (argument, per) = if self.axis.rotary { ("deg", 1.0) } else { ("m", 1000.0_f64) };
        let value = value * per.powi(power as i32) / self.unit.1;
        match power {
            0 => format!("{value} {}", self.unit.0),
            1 => format!("{value} {}/{argument}", self.unit.0),
            _ => format!("{value} {}/{argument}^{power}", self.unit.0),
        }
    }

    fn points(&self, points: &Points, suffix: &str) -> String {
        let argument = if self.axis.rotary { "deg" } else { "mm" };
        let pairs = points.at.iter().zip(&points.values);
        let interpolation = if points.cubic { ", interpolation: cubic" } else { "" };
        if points.file {
            let file = format!("{}{suffix}.csv", self.name);
            let rows: String = pairs.map(|(x, v)| format!("{x},{}\n", v / self.unit.1)).collect();
            let header = format!("{} [{argument}],{} [{}]\n", self.axis.name, self.name, self.unit.0);
            self.folder.write(&file, &(header + &rows));
            return format!("{{ table: {file}{interpolation} }}");
        }
        let pairs: Vec<_> = pairs.map(|(x, v)| format!("[{x} {argument}, {}]", self.unit.quantity(*v))).collect();
        format!("{{ points: [{}]{interpolation} }}", pairs.join(", "))
    }
}
