//! A machine file from answers: the questions of `abbe init`, and the commented file that they make.

use crate::units::significant;
use std::fmt::Write as _;

/// Height of the table above the lowest place of the tip, as a fraction of the travel of Z.
const TABLE: f64 = 0.05;
/// The same where a rotary axis swings the table.
const SWUNG_TABLE: f64 = 0.35;
/// The line of a swinging axis above its table, as a fraction of the travel of Z.
const CRADLE: f64 = 0.075;
/// Height of the pivot of a head above the gauge point, mm.
const PIVOT_MM: f64 = 200.0;

/// A kind of machine that the dialogue offers.
#[derive(Debug, Clone, Copy)]
pub struct MachineChoice {
    /// One line.
    pub title: &'static str,
    /// The walk from the workpiece to the tool.
    pub chain: &'static str,
    /// Three lines of text.
    pub picture: &'static str,
    /// Axes with their usual travel, mm and deg; none for an axis without end.
    pub axes: &'static [(&'static str, Option<[f64; 2]>)],
}

const LINEAR: [(&str, Option<[f64; 2]>); 3] =
    [("X", Some([0.0, 500.0])), ("Y", Some([0.0, 400.0])), ("Z", Some([-400.0, 0.0]))];
const TILT: Option<[f64; 2]> = Some([-120.0, 30.0]);

/// The kinds of machines that the dialogue offers.
pub const MACHINE_CHOICES: [MachineChoice; 6] = [
    MachineChoice {
        title: "Three axes, a table that moves in X and Y",
        chain: "w X' Y' b Z t",
        picture: "          | Z\n          V\n     [========] X, Y",
        axes: &LINEAR,
    },
    MachineChoice {
        title: "Three axes, a portal or router above a table that stands",
        chain: "w b X Y Z t",
        picture: "     +---[ ]---+ X, Y\n     |    V Z  |\n     [=========]",
        axes: &LINEAR,
    },
    MachineChoice {
        title: "Four axes, a rotary table about X",
        chain: "w A' X' Y' b Z t",
        picture: "          | Z\n          V\n     [](=====)[] X, Y; A",
        axes: &[LINEAR[0], LINEAR[1], LINEAR[2], ("A", None)],
    },
    MachineChoice {
        title: "Five axes, a trunnion: A swings the rotary table C",
        chain: "w C' A' Y' b X Z t",
        picture: "          | X, Z\n          V\n     []\\_(==)_/[] Y; A, C",
        axes: &[LINEAR[0], LINEAR[1], LINEAR[2], ("A", TILT), ("C", None)],
    },
    MachineChoice {
        title: "Five axes, a swivelling head B and a rotary table C",
        chain: "w C' Y' b X Z B t",
        picture: "        (B) X, Z\n          \\\n     [==(==)==] Y; C",
        axes: &[LINEAR[0], LINEAR[1], LINEAR[2], ("B", Some([-120.0, 120.0])), ("C", None)],
    },
    MachineChoice {
        title: "Five axes, a fork head with C and A",
        chain: "w b X Y Z C A t",
        picture: "     +--(C)(A)--+ X, Y, Z\n     |     \\    |\n     [==========]",
        axes: &[LINEAR[0], LINEAR[1], LINEAR[2], ("C", Some([-360.0, 360.0])), ("A", Some([-110.0, 110.0]))],
    },
];

/// Knowledge of the errors of a machine.
#[derive(Debug, Clone)]
pub enum KnownErrors {
    /// Nothing: bounds typical of a class of machines.
    Class(String),
    /// Accuracy A of ISO 230-2 of axes by name, with its unit, and a class for the rest.
    DataSheet(Vec<(String, String)>, String),
    /// Tables of measured errors, by file.
    Measured(Vec<String>),
    /// Invented values.
    Example,
}

/// Answers to the questions.
#[derive(Debug, Clone)]
pub struct MachineAnswers {
    /// The kind.
    pub choice: MachineChoice,
    /// Ends of the travel of each axis of the kind, mm and deg; none for an axis without end.
    pub travels: Vec<Option<[f64; 2]>>,
    /// Distance of the tip from the gauge point, mm.
    pub tool_length_mm: f64,
    /// Errors.
    pub errors: KnownErrors,
}

impl MachineAnswers {
    /// Returns the ends of the travel of a linear axis, mm.
    fn travel_mm(&self, axis: &str) -> [f64; 2] {
        let mut travels = self.choice.axes.iter().zip(&self.travels);
        travels.find(|((name, _), _)| *name == axis).and_then(|(_, travel)| *travel).unwrap_or_default()
    }

    /// Returns the workpiece origin, with the lines of A, B and C, assumed from the travels, mm.
    fn places_mm(&self) -> [[f64; 3]; 4] {
        let [x, y] = ["X", "Y"].map(|axis| self.travel_mm(axis).iter().sum::<f64>() / 2.0);
        let [low, high] = self.travel_mm("Z");
        let is_on_table = |axis: &str| self.choice.chain.contains(&format!("{axis}'"));
        let height = |fraction: f64| low - self.tool_length_mm + fraction * (high - low);
        let table = height(if is_on_table("A") { SWUNG_TABLE } else { TABLE });
        let swung = if is_on_table("C") { height(SWUNG_TABLE + CRADLE) } else { table };
        let pivot = [0.0, 0.0, PIVOT_MM];
        [
            [x, y, table],
            if is_on_table("A") { [x, y, swung] } else { pivot },
            pivot,
            if is_on_table("C") { [x, y, table] } else { pivot },
        ]
    }

    /// Returns the machine file.
    pub fn machine_file(&self) -> String {
        let point = |at: [f64; 3]| format!("[{}]", at.map(|x| significant(x, 6)).join(", "));
        let [workpiece, a, b, c] = self.places_mm();
        let mut text = format!(
            "# yaml-language-server: $schema=./abbe.schema.json\n# Written by `abbe init` from answers. Positions in \
             mm and deg; every error value needs its unit.\nabbe: 1\nmachine: \"{}\"\n\n\
             # The walk from the workpiece (w) \
             over the bed (b) to the tool (t); a prime marks what carries the workpiece.\nchain: \"{}\"\n\n# `origin` \
             of a rotary axis: a point of its line, with all axes at 0. ASSUMED from the travels: measure it.\n# \
             `origin` of a linear axis: the point about which its angular errors turn.\naxes:\n",
            self.choice.title, self.choice.chain
        );
        for ((name, _), travel) in self.choice.axes.iter().zip(&self.travels) {
            let (unit, origin) = match *name {
                "A" => ("deg", a),
                "B" => ("deg", b),
                "C" => ("deg", c),
                _ => ("mm", [0.0; 3]),
            };
            let travel = match travel.map(|ends| ends.map(|end| significant(end, 8))) {
                Some([from, to]) => format!("[{from} {unit}, {to} {unit}]"),
                None => "continuous".to_owned(),
            };
            let _ = writeln!(text, "  {name}: {{ travel: {travel}, origin: {} }}", point(origin));
        }
        let length = significant(self.tool_length_mm, 6);
        let _ = write!(
            text,
            "\n# The gauge point (nose of the spindle) with all axes at 0; the tip is `length` below it.\ntool: {{ \
             gauge: [0, 0, 0], length: {length} mm }}\n# The origin of the workpiece with all axes at 0. ASSUMED from \
             the travels.\nworkpiece: {{ origin: {} }}\n\n{}\nprovenance: {{ source: abbe init }}\n",
            point(workpiece),
            self.error_sections()
        );
        text
    }

    fn error_sections(&self) -> String {
        let class = |name: &str| {
            format!(
                "# Bounds of all that is not given below, typical of a class (`abbe explain {name}`).\nclass: {name}\n"
            )
        };
        match &self.errors {
            KnownErrors::Class(name) => class(name),
            KnownErrors::DataSheet(figures, name) => {
                let line = |(axis, figure): &(String, String)| format!("  E{axis}{axis}: {{ A: {figure} }}\n");
                let lines: String = figures.iter().map(line).collect();
                let lines = if lines.is_empty() { lines } else { format!("tolerances:\n{lines}") };
                format!("{}# Accuracy A of ISO 230-2, as the data sheet has it.\n{lines}", class(name))
            }
            KnownErrors::Measured(files) => {
                let names: Vec<String> = files.iter().map(|file| format!("\"{file}\"")).collect();
                format!(
                    "# Tables of measured errors: a CSV with the header `X [mm], EXX [um], EYX [um], ...`\nmeasured: \
                     [{}]\n",
                    names.join(", ")
                )
            }
            KnownErrors::Example => self.example_errors(),
        }
    }

    fn example_errors(&self) -> String {
        let mut text = String::from(
            "# Invented. Deviations, actual minus nominal, of the tool relative to the workpiece.\nerrors:\n  \
             EC0Y: 12 urad   # angle X-Y 12 urad above 90 deg\n  EB0Z: -8 urad\n  EA0Z: 5 urad\n  \
             EXX: { polynomial: [0 um, 6 um/m] }\n  EBX: { polynomial: [0 urad, 15 urad/m] }\n",
        );
        for (axis, _) in self.choice.axes {
            let across = match *axis {
                "A" => "YZBC",
                "B" => "XZAC",
                "C" => "XYAB",
                _ => "",
            };
            for (letter, value) in across.chars().zip(["6 um", "-9 um", "11 urad", "-7 urad"]) {
                let _ = writeln!(text, "  E{letter}0{axis}: {value}");
            }
        }
        text
    }
}
