//! The manifest of a target (`target.yaml`): mechanisms of the controller, and its use of them.

use super::forms::{ArchiveForm, Index, LineSpec, TextFrame};
use crate::compensation::{KinematicsMechanism, Mechanisms, OwnAxisContent, TableRules};
use crate::machine::ControllerAxis;
use serde::Deserialize;

/// A target's manifest.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Its name: the folder's.
    pub target: String,
    /// One line.
    pub title: String,
    /// The errors that it can correct, in words.
    pub expresses: String,
    /// The errors that it cannot correct, in words.
    pub cannot: Vec<String>,
    /// The certainty of its facts.
    pub certainty: CertaintyOf,
    /// A dry test of the sign at the machine.
    pub sign_test: String,
    /// The words of the control for sign tests of kinematic parameters; stated by every target of these.
    pub trial: Option<TrialWords>,
    /// The mechanisms of its compensation.
    pub mechanism: Mechanisms,
    /// The arithmetic of its look-up.
    pub controller: Controller,
    /// Letters the controller has for axes, if it has only these.
    pub axis_letters: Option<AxisLetters>,
    /// True if the controller reads ASCII only: the machine's name is written in it.
    #[serde(default)]
    pub ascii: bool,
    /// The files.
    pub files: Vec<FileSpec>,
}

/// The words of a control for sign tests of kinematic parameters.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrialWords {
    /// Action by which changed numbers come into force, in the imperative.
    pub activate: String,
    /// The state in which the block runs.
    pub with: String,
    /// The display on which positions of the axes are read.
    pub read: String,
}

/// The certainty of syntax and sign.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CertaintyOf {
    /// The certainty of the syntax.
    pub syntax: Certainty,
    /// The certainty of the sign.
    pub sign: Certainty,
    /// The frame in which numbers stand, with its certainty; stated by every target of kinematic parameters.
    pub frame: Option<Certainty>,
}

/// The certainty of a fact, and its source.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Certainty {
    /// The level.
    pub level: Level,
    /// The source.
    pub source: String,
}

/// A level of certainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Level {
    /// Seen on the running controller.
    #[serde(rename = "measured")]
    Measured,
    /// Stated by the maker's documentation, or by the source code.
    #[serde(rename = "documented")]
    Documented,
    /// The format is ours.
    #[serde(rename = "own format")]
    OwnFormat,
    /// Follows from documented facts, or seen in other programs' files; not stated in the documentation.
    #[serde(rename = "inferred")]
    Inferred,
    /// Written from memory alone.
    #[serde(rename = "memory")]
    Memory,
}

impl Level {
    /// Returns the word in the manifest.
    pub fn word(self) -> &'static str {
        match self {
            Self::Measured => "measured",
            Self::Documented => "documented",
            Self::OwnFormat => "own format",
            Self::Inferred => "inferred",
            Self::Memory => "memory",
        }
    }
}

/// At which position the controller looks its tables up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LookupPosition {
    /// At the commanded position.
    Command,
    /// At the position that the tables before have corrected; the axes are corrected from the last to the first.
    Corrected,
    /// Tables over one axis at the commanded position, those over several at the position corrected by the former.
    LinesThenPlanes,
}

/// Between points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// Straight lines; multilinear on a lattice.
    Linear,
    /// A step somewhere in the section between two points of a table over one axis.
    Step,
    /// The one or the other, by an option of the control.
    StepOrLinear,
}

/// Outside the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OutsideTable {
    /// The value at the end.
    Hold,
    /// The straight line of the outermost cell goes on.
    Extrapolate,
    /// No correction is added.
    Nothing,
    /// The table begins again.
    RollOver,
}

/// The numbers with which the controller computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Arithmetic {
    /// Doubles throughout.
    Float64,
    /// Trims and slopes are kept as single precision, positions as doubles (LinuxCNC).
    Float32TrimAndSlope,
}

/// The arithmetic of the controller's look-up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Controller {
    /// The position at which it looks up.
    pub lookup: LookupPosition,
    /// Between points.
    pub interpolation: Interpolation,
    /// Outside.
    pub outside: OutsideTable,
    /// Its numbers.
    pub arithmetic: Arithmetic,
}

/// The axis letters a controller has.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisLetters {
    /// Unit or name for linear axes.
    pub linear: String,
    /// Unit or name for rotary axes.
    pub rotary: String,
    /// The order in which the controller counts them.
    pub order: String,
    /// Numbers of axes, where the builder of the machine sets them; without the key they follow from `order`.
    pub numbers: Option<AxisNumbers>,
    /// Letters and numbers of axes by name, from the options of a run.
    #[serde(skip)]
    pub given: Vec<(String, ControllerAxis)>,
}

/// Numbers that the controller's files use for axes.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisNumbers {
    /// The things that are counted, and the place where the control states their numbers.
    pub are: String,
    /// Word before a number in the controller's files, such as `AX`.
    #[serde(default)]
    pub prefix: String,
    /// True if a number that is not stated is the place in `order`.
    #[serde(default)]
    pub assumed: bool,
}

/// The parts of a set that have a file of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Per {
    /// Once.
    Machine,
    /// Once for every axis.
    Axis,
    /// Once for every axis that some table is looked up with.
    Input,
    /// Once for every axis that some table corrects.
    Output,
}

/// The layout by which a file is read back.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "format", rename_all = "snake_case", deny_unknown_fields)]
pub enum FileLayout {
    /// Lines of numbers between blanks, nothing else.
    Columns { columns: Vec<TableColumn> },
    /// CSV: a column per axis, then a column `d` + axis per corrected axis, units in the header.
    CsvLattice,
    /// The same as JSON.
    JsonLattice,
    /// Lines of known patterns.
    Lines {
        /// The mark that begins a comment.
        comment: Option<String>,
        /// The patterns, tried in this order.
        lines: Vec<LineSpec>,
        /// The forms of the control's own archive.
        archive: Option<Box<ArchiveForm>>,
    },
    /// Blocks of columns under a line of names: arguments (axes) and errors by their ISO names.
    ErrorColumns,
    /// Columns under a line of names: a position, and a column for every corrected axis.
    AxisColumns {
        /// Name of the position's column.
        position: String,
        /// Name of the column that is added approaching with falling position.
        reversal: String,
        /// The lines around the columns.
        frame: TextFrame,
    },
    /// Constant arrays of C: the numbers of a full kinematics model.
    CArrays,
    /// Lines `setp COMPONENT.NAME VALUE`.
    HalConstants,
    /// Kinematic parameters, one a line.
    Parameters {
        /// The mark that begins a comment.
        comment: String,
        /// The pattern of a parameter, with `<name>` and `<value>`.
        line: String,
        /// Patterns of lines that say what the parameters mean: they stand as they are written for the machine.
        #[serde(default)]
        structure: Vec<String>,
        /// Patterns of the other lines.
        #[serde(default)]
        others: Vec<String>,
        /// Patterns of lines that may be left out, and stand as they are written for the machine otherwise.
        #[serde(default)]
        optional: Vec<String>,
        /// Patterns of lines with a name that the builder of the machine gives, each there once.
        #[serde(default)]
        builder: Vec<String>,
        /// Lines at which the controller stops reading.
        #[serde(default)]
        end: Vec<String>,
        /// The line with which the file begins and ends.
        frame: Option<String>,
        /// The forms of the control's own archive.
        archive: Option<Box<ArchiveForm>>,
    },
}

/// A column of a table of one axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TableColumn {
    /// Position.
    Position,
    /// Correction approaching with rising position.
    Forward,
    /// Correction approaching with falling position.
    Reverse,
}

/// A file of the target.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileSpec {
    /// Name, itself a template.
    pub path: String,
    /// The template's file in the target's folder.
    pub template: String,
    /// Once, or for every axis.
    pub per: Per,
    /// The mechanism whose tables it holds, if not all; without such tables it is not written.
    pub of: Option<String>,
    /// The layout by which it is read back; absent for files without tables.
    pub layout: Option<FileLayout>,
    /// The form in which it puts files in force, if it does.
    pub index: Option<Index>,
    /// True if it is code: the lines that the template writes for the machine, comments aside.
    #[serde(default)]
    pub code: bool,
}

impl Manifest {
    /// True if it rests on memory alone.
    pub fn rests_on_memory(&self) -> bool {
        let mut stated = [&self.certainty.syntax, &self.certainty.sign].into_iter().chain(&self.certainty.frame);
        stated.any(|c| c.level == Level::Memory)
    }

    /// A line for the head of a file.
    pub fn caution(&self) -> String {
        let (syntax, sign) = (self.certainty.syntax.level.word(), self.certainty.sign.level.word());
        let test = if self.rests_on_memory() { "NOT VERIFIED, from memory: " } else { "" };
        format!("{test}syntax {syntax}, sign {sign}; test the sign first")
    }

    /// True if the tables hold for one tool only.
    pub fn tool_dependent(&self) -> bool {
        self.mechanism.iter().any(|(name, rules)| match name {
            "error_curves" => false,
            "own_axis" => rules.fit == crate::compensation::Fit::FunctionalPoint,
            _ => true,
        })
    }

    /// The mechanism, if it replaces the kinematics.
    pub fn kinematics(&self) -> Option<&KinematicsMechanism> {
        self.mechanism.kinematics.as_ref()
    }

    /// Own-axis tables beside kinematics.
    pub fn reversal(&self) -> Option<&TableRules> {
        let own = self.mechanism.own_axis.as_ref().filter(|own| own.holds == OwnAxisContent::Reversal)?;
        (self.mechanism.kinematics.is_some() && own.table.directions.is_bidirectional()).then_some(&own.table)
    }
}

impl FileSpec {
    /// True if it holds the tables of one mechanism only. Beside a kinematics module all tables have such files.
    pub fn is_of_tables(&self) -> bool {
        self.of.is_some()
    }
}
