//! Machines made of bytes, with numbers from a dictionary: valid more often than text, and close to every limit.

use abbe::controller::NAMES;
use abbe::options::{CompensationOptions, Fit, Goal};
use abbe::{CompileOptions, MemoryFiles};
use std::fmt::Write as _;

/// A machine with what it is compiled for.
pub struct Generated {
    /// The text of its file.
    pub text: String,
    /// The tables that it names.
    pub files: MemoryFiles,
    /// Target and options.
    pub options: CompileOptions,
}

/// Positions of knots, ends of travels, coordinates: mm or deg.
const POSITIONS: [&str; 32] = [
    "0",
    "1",
    "-1",
    "100",
    "500",
    "-400",
    "90",
    "180",
    "359.9999999999999",
    "360",
    "-180",
    "0.001",
    "0.0005",
    "1e-6",
    "1e-9",
    "1e-10",
    "1e-320",
    "-0",
    "1e6",
    "-1e6",
    "1000001",
    "1e20",
    "-1e20",
    "1e308",
    "12345.678901234567",
    "0.1",
    "33.333333333333336",
    "250",
    "7",
    "2e5",
    "-1e-9",
    "720",
];

/// Errors, in um or urad.
const ERRORS: [&str; 20] = [
    "0",
    "1",
    "-1",
    "10",
    "-25",
    "0.001",
    "1e-9",
    "1e-300",
    "1e3",
    "-1e4",
    "1e5",
    "9.99e5",
    "1e7",
    "1e308",
    "-0",
    "3.0000000000000004",
    "0.5",
    "300",
    "-300",
    "50",
];

/// Lengths of travels between knots.
const GAPS: [&str; 12] = ["50", "100", "25", "1", "1e-3", "1e-7", "1e-12", "1e-320", "90", "30", "0.1", "333"];

/// Chains with the names of their axes.
const CHAINS: [(&str, &str); 12] = [
    ("w b X t", "X"),
    ("w X' b Y Z t", "XYZ"),
    ("w b X Y Z t", "XYZ"),
    ("w Y' X' b Z t", "YXZ"),
    ("w C' b X Z t", "CXZ"),
    ("w C' A' Y' b X Z t", "CAYXZ"),
    ("w X' b Y Z C A t", "XYZCA"),
    ("w C' b X Y Z B t", "CXYZB"),
    ("w X' Z' b t", "XZ"),
    ("w b X Y Z (S) t", "XYZ"),
    ("w C' B' X' b Y Z W t", "CBXYZW"),
    ("w b A B C t", "ABC"),
];

const CONVENTIONS: [&str; 9] = [
    "location: carried_body",
    "linear: before",
    "rotary: rotating",
    "workpiece_axes: direct",
    "errors_are: body",
    "location_order: real",
    "joints: linearised",
    "preset: holub-2015",
    "preset: bui-kimm",
];

/// Choices by bytes; at their end the first of every list.
struct Dice<'a>(&'a [u8]);

impl Dice<'_> {
    fn byte(&mut self) -> usize {
        let (first, rest) = self.0.split_first().unwrap_or((&0, &[]));
        self.0 = rest;
        usize::from(*first)
    }

    fn below(&mut self, count: usize) -> usize {
        self.byte() % count.max(1)
    }

    fn pick<'l, T>(&mut self, list: &'l [T]) -> &'l T {
        &list[self.below(list.len())]
    }

    /// True once in `times`, by a byte that is not 0.
    fn once_in(&mut self, times: usize) -> bool {
        self.byte() % times == 1 % times
    }
}

/// An axis of a generated machine.
struct Axis {
    name: char,
    rotary: bool,
    /// Ends of the travel; none for a continuous axis.
    travel: Option<[&'static str; 2]>,
}

impl Axis {
    fn unit(&self) -> &'static str {
        if self.rotary { "deg" } else { "mm" }
    }

    fn knots(&self, dice: &mut Dice) -> Vec<String> {
        let [first, last] = self.travel.unwrap_or(["0", "360"]);
        let mut knots = vec![first.to_owned()];
        let mut at: f64 = first.parse().unwrap_or(0.0);
        for _ in 0..dice.below(6) {
            at += dice.pick(&GAPS).parse::<f64>().unwrap_or(1.0);
            knots.push(format!("{at:e}"));
        }
        if !dice.once_in(8) {
            knots.retain(|knot| knot.parse::<f64>().ok() < last.parse().ok());
            knots.push(last.to_owned());
        }
        knots
    }
}

/// Makes a machine.
pub fn generated(bytes: &[u8]) -> Generated {
    let mut dice = Dice(bytes);
    let options = options(&mut dice);
    let (chain, names) = *dice.pick(&CHAINS);
    let axes: Vec<Axis> = names.chars().map(|name| axis(&mut dice, name)).collect();
    let mut text = format!("abbe: 1\nmachine: generated\nchain: \"{chain}\"\naxes:\n");
    axes.iter().for_each(|axis| text += &axis_line(&mut dice, axis));
    text += &geometry(&mut dice);
    let mut files = MemoryFiles::new();
    text += "errors:\n  EXX: 0 um\n";
    for k in 0..dice.below(9) {
        let axis = &axes[dice.below(axes.len())];
        if let Some(table) = error(&mut dice, &mut text, axis, k) {
            files = files.with(format!("t{k}.csv"), table);
        }
    }
    Generated { text: text.replace("  EXX: 0 um\n", ""), files, options }
}

fn options(dice: &mut Dice) -> CompileOptions {
    let mut options = super::oracles::compile_options(NAMES[dice.below(NAMES.len())]);
    let choice = dice.byte();
    options.compensation = CompensationOptions {
        correct: [None, Some(Goal::Pose), Some(Goal::Position), None][choice % 4],
        fit: [None, Some(Fit::Axis), Some(Fit::FunctionalPoint), None][choice / 4 % 4],
        without: if choice / 16 % 4 == 1 { vec!["product".to_owned()] } else { Vec::new() },
        ..CompensationOptions::default()
    };
    options
}

fn axis(dice: &mut Dice, name: char) -> Axis {
    let rotary = "ABC".contains(name);
    let (low, high) = *dice.pick(&[("0", "500"), ("0", "100"), ("-400", "0"), ("-90", "90"), ("0", "360")]);
    let travel = match dice.below(8) {
        0 if rotary => None,
        1 => Some([*dice.pick(&POSITIONS), *dice.pick(&POSITIONS)]),
        2 => Some([low, *dice.pick(&POSITIONS)]),
        _ => Some([low, high]),
    };
    Axis { name, rotary, travel }
}

fn axis_line(dice: &mut Dice, axis: &Axis) -> String {
    let unit = axis.unit();
    let travel = axis.travel.map_or("continuous".to_owned(), |[low, high]| format!("[{low} {unit}, {high} {unit}]"));
    let mut line = format!("  {}: {{ travel: {travel}, origin: {}", axis.name, vector(dice));
    if dice.once_in(8) {
        let _ = write!(line, ", direction: {}", vector(dice));
    }
    line + " }\n"
}

fn vector(dice: &mut Dice) -> String {
    format!("[{}, {}, {}]", dice.pick(&POSITIONS), dice.pick(&POSITIONS), dice.pick(&POSITIONS))
}

fn geometry(dice: &mut Dice) -> String {
    let mut text = format!("tool: {{ gauge: {}, length: {} mm }}\n", vector(dice), dice.pick(&POSITIONS));
    if dice.once_in(3) {
        let _ = writeln!(
            text,
            "workpiece: {{ origin: {}, rotation: {{ A: {} deg }} }}",
            vector(dice),
            dice.pick(&POSITIONS)
        );
    }
    if dice.once_in(2) {
        let _ = writeln!(text, "conventions: {{ {} }}", dice.pick(&CONVENTIONS));
    }
    if dice.once_in(3) {
        let _ = writeln!(text, "volume: {{ step: {} mm }}", dice.pick(&POSITIONS));
    }
    text
}

/// Writes an error; returns the table that it names.
fn error(dice: &mut Dice, text: &mut String, axis: &Axis, number: usize) -> Option<String> {
    let direction = *dice.pick(&['X', 'Y', 'Z', 'A', 'B', 'C']);
    let rotation = "ABC".contains(direction);
    let (unit, name) = (if rotation { "urad" } else { "um" }, format!("E{direction}{}", axis.name));
    if dice.once_in(5) {
        let _ = writeln!(text, "  E{direction}0{}: {} {unit}", axis.name, dice.pick(&ERRORS));
        return None;
    }
    if dice.once_in(8) {
        let _ = writeln!(text, "  {name}: {{ tolerance: {} {unit} }}", dice.pick(&ERRORS));
        return None;
    }
    if dice.once_in(4) {
        let table = table(dice, axis, &name, unit);
        let cubic = if dice.once_in(2) { ", interpolation: cubic" } else { "" };
        let _ = writeln!(text, "  {name}: {{ table: t{number}.csv{cubic} }}");
        return Some(table);
    }
    let form = if dice.once_in(4) {
        format!("{{ forward: {}, reverse: {} }}", curve(dice, axis, unit), curve(dice, axis, unit))
    } else {
        curve(dice, axis, unit)
    };
    let _ = writeln!(text, "  {name}: {form}");
    None
}

fn table(dice: &mut Dice, axis: &Axis, name: &str, unit: &str) -> String {
    let mut table = format!("{} [{}],{name} [{unit}]\n", axis.name, axis.unit());
    let knots = axis.knots(dice);
    let closing = *dice.pick(&ERRORS);
    for (k, knot) in knots.iter().enumerate() {
        let ends = axis.travel.is_none() && (k == 0 || k + 1 == knots.len());
        let value = if ends { closing } else { dice.pick(&ERRORS) };
        let _ = writeln!(table, "{knot},{value}");
    }
    table
}

fn curve(dice: &mut Dice, axis: &Axis, unit: &str) -> String {
    let (axis_unit, knots) = (axis.unit(), axis.knots(dice));
    match dice.below(8) {
        0 => {
            let slope = if axis.rotary { "deg" } else { "m" };
            let [a, b, c] = [(); 3].map(|()| *dice.pick(&ERRORS));
            format!("{{ polynomial: [{a} {unit}, {b} {unit}/{slope}, {c} {unit}/{slope}^2] }}")
        }
        1 => {
            let order = *dice.pick(&["1", "2", "7", "40"]);
            let [a, b] = [(); 2].map(|()| *dice.pick(&ERRORS));
            format!("{{ harmonics: {{ {order}: [{a} {unit}, {b} {unit}] }} }}")
        }
        2 => {
            let list = knots.iter().map(|knot| format!("{knot} {axis_unit}")).collect::<Vec<_>>().join(", ");
            let count = knots.len() + if axis.travel.is_some() { 2 } else { 0 };
            let values = (0..count).map(|_| format!("{} {unit}", dice.pick(&ERRORS))).collect::<Vec<_>>().join(", ");
            format!("{{ bspline: {{ knots: [{list}], coefficients: [{values}] }} }}")
        }
        kind => {
            let closing = *dice.pick(&ERRORS);
            let last = knots.len() - 1;
            let point = |(k, knot): (usize, &String)| {
                let ends = axis.travel.is_none() && (k == 0 || k == last);
                format!("[{knot} {axis_unit}, {} {unit}]", if ends { closing } else { dice.pick(&ERRORS) })
            };
            let points = knots.iter().enumerate().map(point).collect::<Vec<_>>().join(", ");
            let interpolation = if kind == 3 { ", interpolation: cubic" } else { "" };
            format!("{{ points: [{points}]{interpolation} }}")
        }
    }
}
