//! A machine file from answers: the questions of `abbe init` and of the page, and the commented file that they make.

use crate::units::{number, significant};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The key of the question whose answer names files.
pub const FILES: &str = "files";

/// Height of the table above the lowest place of the tip, as a fraction of the travel of Z.
const TABLE: f64 = 0.05;
/// The same where a rotary axis swings the table.
const SWUNG_TABLE: f64 = 0.35;
/// The line of a swinging axis above its table, as a fraction of the travel of Z.
const CRADLE: f64 = 0.075;
/// Height of the pivot of a head above the gauge point, mm.
const PIVOT_MM: f64 = 200.0;

/// A question about a machine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MachineQuestion {
    /// Name of the answer.
    pub key: String,
    /// The question, with its unit.
    pub asked: String,
    /// The answer that is proposed; empty if none is.
    pub default: String,
    /// The form of an answer.
    pub wanted: String,
    /// The answers to choose from; empty for free text.
    pub choices: Vec<AnswerChoice>,
    /// True if the answer, or without one the proposal, is understood.
    pub is_understood: bool,
}

/// An answer to choose.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AnswerChoice {
    /// The answer.
    pub answer: String,
    /// One line; empty if the answer says all.
    pub title: String,
    /// Lines of text; empty without a picture.
    pub picture: &'static str,
}

/// The questions that answers lead to, and the file that they make.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MachineDialogue {
    /// The questions, in the order in which they are asked.
    pub questions: Vec<MachineQuestion>,
    /// The machine file, if all answers and proposals are understood.
    pub file: Option<String>,
}

/// Returns the questions that answers by key lead to; an empty answer is the proposal.
pub(crate) fn dialogue(answers: &BTreeMap<String, String>, classes: &[&str]) -> MachineDialogue {
    let mut asking = Asking { answers, classes, questions: Vec::new() };
    let file = asking.machine().map(|answers| answers.machine_file());
    MachineDialogue { questions: asking.questions, file }
}

/// Questions that are being asked.
struct Asking<'a> {
    answers: &'a BTreeMap<String, String>,
    classes: &'a [&'a str],
    questions: Vec<MachineQuestion>,
}

impl Asking<'_> {
    /// Asks, and returns what is read from the answer.
    fn ask<T>(
        &mut self,
        [key, asked, default, wanted]: [&str; 4],
        choices: Vec<AnswerChoice>,
        read: impl Fn(&str) -> Option<T>,
    ) -> Option<T> {
        let answer = self.answers.get(key).map(|answer| answer.trim()).filter(|answer| !answer.is_empty());
        let found = read(answer.unwrap_or(default));
        let [key, asked, default, wanted] = [key, asked, default, wanted].map(str::to_owned);
        self.questions.push(MachineQuestion { key, asked, default, wanted, choices, is_understood: found.is_some() });
        found
    }

    fn machine(&mut self) -> Option<MachineAnswers> {
        let of = |(kind, number): (&MachineChoice, usize)| AnswerChoice {
            answer: number.to_string(),
            title: format!("{}: {}", kind.title, kind.chain),
            picture: kind.picture,
        };
        let kinds = MACHINE_CHOICES.iter().zip(1..).map(of).collect();
        let wanted = format!("a number from 1 to {}", MACHINE_CHOICES.len());
        let named = |answer: &str| MACHINE_CHOICES.get(answer.parse::<usize>().ok()?.checked_sub(1)?).copied();
        let choice = self.ask(["kind", "Which kind", "4", &wanted], kinds, named)?;
        let travels: Vec<_> = choice.axes.iter().map(|(axis, usual)| self.travel(axis, *usual)).collect();
        let length =
            ["tool", "Tool: from the nose of the spindle to the tip, mm", "120", "a length in mm, such as 120"];
        let tool_length_mm = self.ask(length, Vec::new(), |answer| within(answer, 1e4));
        let errors = self.errors(choice);
        Some(MachineAnswers {
            choice,
            travels: travels.into_iter().collect::<Option<_>>()?,
            tool_length_mm: tool_length_mm?,
            errors: errors?,
        })
    }

    fn travel(&mut self, axis: &str, usual: Option<[f64; 2]>) -> Option<Option<[f64; 2]>> {
        let default = usual.map_or("continuous".to_owned(), |[from, to]| format!("{from} {to}"));
        let is_rotary = "ABC".contains(axis);
        let unit = if is_rotary { "deg, two ends or `continuous`" } else { "mm, two ends" };
        let asked = format!("Travel of {axis}, {unit}");
        let wanted = "two numbers, the lower end first, such as `0 500`";
        self.ask([&format!("travel {axis}"), &asked, &default, wanted], Vec::new(), |answer| travel(answer, is_rotary))
    }

    fn errors(&mut self, choice: MachineChoice) -> Option<KnownErrors> {
        let known = [
            "nothing yet: bounds typical of a class of machines",
            "a data sheet: accuracy of the axes",
            "measured tables, as CSV files",
            "nothing: invented values, to try the program",
        ];
        let of = |(title, number): (&str, usize)| AnswerChoice {
            answer: number.to_string(),
            title: title.to_owned(),
            picture: "",
        };
        let known = known.into_iter().zip(1..).map(of).collect();
        let asked = ["known", "What is known of its errors", "1", "a number from 1 to 4"];
        let number = |answer: &str| answer.parse::<usize>().ok().filter(|number| (1..=4).contains(number));
        match self.ask(asked, known, number)? {
            1 => self.class().map(KnownErrors::Class),
            2 => {
                let figures: Vec<_> = choice.axes.iter().map(|(axis, _)| self.accuracy(axis)).collect();
                let (class, figures) = (self.class()?, figures.into_iter().collect::<Option<Vec<_>>>()?);
                Some(KnownErrors::DataSheet(figures.into_iter().flatten().collect(), class))
            }
            3 => {
                let asked = [FILES, "Files, with blanks between", "", "names of files that are there"];
                let names = |answer: &str| answer.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
                let names = self.ask(asked, Vec::new(), |answer| Some(names(answer)).filter(|names| !names.is_empty()));
                names.map(KnownErrors::Measured)
            }
            _ => Some(KnownErrors::Example),
        }
    }

    fn class(&mut self) -> Option<String> {
        let classes = self.classes;
        let of = |name: &&str| AnswerChoice { answer: (*name).to_owned(), title: String::new(), picture: "" };
        let known = |answer: &str| classes.contains(&answer).then(|| answer.to_owned());
        let asked = ["class", "Class", "production", "one of these classes"];
        self.ask(asked, classes.iter().map(of).collect(), known)
    }

    /// Returns the accuracy of an axis by name, if the sheet has one.
    fn accuracy(&mut self, axis: &str) -> Option<Option<(String, String)>> {
        let unit = if "ABC".contains(axis) { "arcsec" } else { "um" };
        let asked = format!("Accuracy A (ISO 230-2) of {axis}, {unit}; 0 if the sheet has none");
        let wanted = format!("the whole band, in {unit}, such as 8");
        let question = [&format!("accuracy {axis}"), &asked, "0", &wanted];
        let band = self.ask(question, Vec::new(), |answer| within(answer, 1e5))?;
        Some((band > 0.0).then(|| (axis.to_owned(), format!("{band} {unit}"))))
    }
}

/// Reads a number from 0 to a maximum.
fn within(answer: &str, max: f64) -> Option<f64> {
    number(answer).ok().filter(|value| (0.0..=max).contains(value))
}

/// Reads the ends of a travel, the lower one first, or none for an axis without end.
fn travel(answer: &str, may_be_endless: bool) -> Option<Option<[f64; 2]>> {
    if may_be_endless && answer == "continuous" {
        return Some(None);
    }
    let separates = |c: char| c.is_whitespace() || matches!(c, ',' | ';' | '[' | ']');
    let words = answer.split(separates).filter(|word| !word.is_empty());
    let ends = words.map(|word| number(word).ok()).collect::<Option<Vec<f64>>>()?;
    let is_travel = |ends: &[f64; 2]| ends[0] < ends[1] && ends.iter().all(|end| end.abs() <= 1e5);
    <[f64; 2]>::try_from(ends).ok().filter(is_travel).map(Some)
}

/// A kind of machine that the dialogue offers.
#[derive(Debug, Clone, Copy)]
struct MachineChoice {
    /// One line.
    title: &'static str,
    /// The walk from the workpiece to the tool.
    chain: &'static str,
    /// Three lines of text.
    picture: &'static str,
    /// Axes with their usual travel, mm and deg; none for an axis without end.
    axes: &'static [(&'static str, Option<[f64; 2]>)],
}

const LINEAR: [(&str, Option<[f64; 2]>); 3] =
    [("X", Some([0.0, 500.0])), ("Y", Some([0.0, 400.0])), ("Z", Some([-400.0, 0.0]))];
const TILT: Option<[f64; 2]> = Some([-120.0, 30.0]);

/// The kinds of machines that the dialogue offers.
const MACHINE_CHOICES: [MachineChoice; 6] = [
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
enum KnownErrors {
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
struct MachineAnswers {
    /// The kind.
    choice: MachineChoice,
    /// Ends of the travel of each axis of the kind, mm and deg; none for an axis without end.
    travels: Vec<Option<[f64; 2]>>,
    /// Distance of the tip from the gauge point, mm.
    tool_length_mm: f64,
    /// Errors.
    errors: KnownErrors,
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
    fn machine_file(&self) -> String {
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
