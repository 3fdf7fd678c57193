//! The manifest of a target (`target.yaml`): what the controller can hold and what it does with it.

use crate::compensation::{Holds, Increment, KinematicsMechanism, Mechanisms, Spacing, Stored, TableRules};
use crate::controller::kinematics::layout_fits;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A target's manifest.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Its name: the folder's.
    pub target: String,
    /// One line.
    pub title: String,
    /// What it can correct.
    pub expresses: String,
    /// What it cannot.
    pub cannot: Vec<String>,
    /// How sure its facts are.
    pub certainty: CertaintyOf,
    /// A dry test of the sign at the machine.
    pub sign_test: String,
    /// What its tables can hold.
    pub mechanism: Mechanisms,
    /// What it does with them.
    pub controller: Controller,
    /// Letters the controller has for axes, if it has only these.
    #[serde(default)]
    pub axis_letters: Option<AxisLetters>,
    /// The files.
    pub files: Vec<FileSpec>,
}

/// How sure syntax and sign are.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CertaintyOf {
    /// Of the syntax.
    pub syntax: Certainty,
    /// Of the sign.
    pub sign: Certainty,
}

/// How sure a fact is, and from where.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Certainty {
    /// How sure.
    pub level: Level,
    /// The source.
    pub source: String,
}

/// How sure a fact is.
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
    /// Follows from what is documented, or seen in other programs' files; the documentation does not say it.
    #[serde(rename = "inferred")]
    Inferred,
    /// From memory alone.
    #[serde(rename = "memory")]
    Memory,
}

impl Level {
    /// As the manifest writes it.
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
pub enum Lookup {
    /// At the commanded position.
    Command,
    /// At the position that the tables before have corrected; the axes are corrected from the last to the first.
    Corrected,
    /// Tables over one axis at the commanded position, those over several at what the former have made of it.
    LinesThenPlanes,
}

/// Between points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// Straight lines; multilinear on a lattice.
    Linear,
}

/// Outside the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OutsideTable {
    /// The value at the end.
    Hold,
    /// The straight line of the outermost cell goes on.
    Extrapolate,
    /// Nothing is added.
    Nothing,
    /// The table begins again.
    RollOver,
}

/// With which numbers the controller works.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Arithmetic {
    /// Doubles throughout.
    Float64,
    /// Trims and slopes are kept as single precision, positions as doubles (LinuxCNC).
    Float32TrimAndSlope,
}

/// What the controller does with its tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Controller {
    /// Where it looks up.
    pub lookup: Lookup,
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
    /// For linear axes.
    pub linear: String,
    /// For rotary axes.
    pub rotary: String,
    /// The order in which the controller counts them.
    pub order: String,
}

/// For what a file is written.
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

/// How a file is read back.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "format", rename_all = "snake_case", deny_unknown_fields)]
pub enum Layout {
    /// Lines of numbers between blanks, nothing else.
    Columns {
        /// What the columns are.
        columns: Vec<Column>,
    },
    /// CSV: a column per axis, then a column `d` + axis per corrected axis, units in the header.
    CsvLattice,
    /// The same as JSON.
    JsonLattice,
    /// Lines of known patterns.
    Lines {
        /// What a comment begins with.
        #[serde(default)]
        comment: Option<String>,
        /// The patterns, tried in this order.
        lines: Vec<LineSpec>,
    },
    /// Blocks of columns under a line of names: arguments (axes) and errors by their ISO names.
    ErrorColumns,
    /// Columns under a line of names: a position, and a column for every corrected axis.
    AxisColumns {
        /// Name of the position's column.
        position: String,
        /// Name of the column that is added approaching with falling position.
        reversal: String,
        /// What stands around them.
        frame: Frame,
    },
    /// Constant arrays of C: the numbers of a full kinematics model.
    CArrays,
    /// Lines `setp COMPONENT.NAME VALUE`.
    HalConstants,
}

/// The lines around columns.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frame {
    /// What a comment begins with.
    pub comment: String,
    /// The first line: one of these patterns.
    pub begin: Vec<String>,
    /// The last line; nothing stands behind it.
    pub end: String,
}

/// A line of a file: text with fields in angle brackets.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LineSpec {
    /// The pattern, such as `$AN_CEC[<table>,<index>]=<value>`.
    pub line: String,
    /// Only on the line with this number, from 1.
    #[serde(default)]
    pub at: Option<usize>,
    /// Must such a line be there?
    #[serde(default)]
    pub required: bool,
    /// Does a block begin or end with it?
    #[serde(default)]
    pub block: Option<Edge>,
    /// What it says besides.
    #[serde(default)]
    pub set: BTreeMap<String, String>,
}

/// An end of a block of lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Edge {
    /// Its first line.
    Begin,
    /// Its last line.
    End,
}

/// A column of a table of one axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Column {
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
    #[serde(default)]
    pub of: Option<String>,
    /// How to read it back; absent for files without tables.
    #[serde(default)]
    pub layout: Option<Layout>,
    /// How it says which file belongs to which axis, if it does.
    #[serde(default)]
    pub index: Option<Index>,
}

/// How a file says which file belongs to which axis.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "form", rename_all = "snake_case", deny_unknown_fields)]
pub enum Index {
    /// Sections of an INI: `[PREFIXn]`, n the number of the axis from 0, then `KEY = FILE`.
    Sections {
        /// What stands before the number.
        prefix: String,
        /// Of the line that names the file.
        key: String,
        /// What else the section must say for the file to be read as it is read here.
        #[serde(default)]
        with: BTreeMap<String, String>,
    },
    /// A line of words, then letters of axes; below it a file, or `-`, under each letter.
    Columns {
        /// The words before the letters.
        header: String,
    },
}

impl Manifest {
    /// Does it rest on memory alone?
    pub fn unverified(&self) -> bool {
        [&self.certainty.syntax, &self.certainty.sign].into_iter().any(|c| c.level == Level::Memory)
    }

    /// A line for the head of a file.
    pub fn caution(&self) -> String {
        let (syntax, sign) = (self.certainty.syntax.level.word(), self.certainty.sign.level.word());
        let test = if self.unverified() { "NOT VERIFIED, from memory: " } else { "" };
        format!("{test}syntax {syntax}, sign {sign}; test the sign first")
    }

    /// Do the tables hold for one tool only?
    pub fn tool_dependent(&self) -> bool {
        self.mechanism.iter().any(|(name, rules)| match name {
            "error_curves" => false,
            "own_axis" => rules.fit == crate::compensation::Fit::FunctionalPoint,
            _ => true,
        })
    }

    /// What makes a manifest impossible to work with, in words.
    pub fn fault(&self) -> Option<String> {
        let tables = self.mechanism.iter().count();
        match &self.mechanism.kinematics {
            Some(kinematics) if tables == self.reversal().iter().count() => {
                return decimals_fault(kinematics.increment)
                    .or_else(|| kinematics.fault())
                    .or_else(|| self.unfit_files(kinematics))
                    .or_else(|| self.table_fault());
            }
            Some(_) => {
                return Some(
                    "mechanism: kinematics stand alone, or beside own_axis tables that are bidirectional and hold the reversal".to_owned(),
                );
            }
            None if self.mechanism.iter().any(|(_, rules)| rules.holds == Holds::Reversal) => {
                return Some("holds: reversal is for own_axis tables beside kinematics".to_owned());
            }
            None if tables == 0 => return Some("mechanism: there is none".to_owned()),
            None => {}
        }
        self.table_fault()
    }

    /// Own-axis tables beside kinematics.
    pub fn reversal(&self) -> Option<&TableRules> {
        let rules = self.mechanism.own_axis.as_ref()?;
        (self.mechanism.kinematics.is_some() && rules.holds == Holds::Reversal && rules.bidirectional).then_some(rules)
    }

    fn table_fault(&self) -> Option<String> {
        if self.mechanism.plane.is_some() && self.mechanism.product.is_some() {
            return Some("mechanism: planes or products, not both".to_owned());
        }
        let layouts = || self.files.iter().filter_map(|f| f.layout.as_ref());
        let columns = || {
            let rules = self.mechanism.own_axis.as_ref()?;
            layouts().find_map(|l| l.fault(rules.bidirectional))
        };
        self.mechanism.iter().find_map(|(name, rules)| fault(name, rules)).or_else(columns)
    }
}

fn decimals_fault(increment: Increment) -> Option<String> {
    let decimals = increment.position_decimals.max(increment.correction_decimals);
    (decimals > MAX_DECIMALS)
        .then(|| format!("{decimals} decimals are more than the {MAX_DECIMALS} that a double has to give"))
}

fn can_be_magnified(mechanism: &str, rules: &TableRules) -> bool {
    mechanism == "lattice" && rules.stored != Stored::Command && (1..=1000).contains(&rules.magnification)
}

fn fault(name: &str, rules: &TableRules) -> Option<String> {
    let increment = rules.increment;
    let scales = [increment.position_scale, increment.correction_scale].map(|s| [s.mm, s.deg]).concat();
    let points = rules.max_points.min(rules.max_points_per_axis);
    let most = if name == "lattice" { MAX_NODES } else { MAX_POINTS };
    if let Some(fault) = decimals_fault(increment) {
        Some(fault)
    } else if !scales.iter().all(|s| (1e-9..=1e9).contains(s)) {
        Some("increment: a scale is stored units in one mm or deg, from 1e-9 to 1e9".to_owned())
    } else if points < 2 || rules.max_points > most {
        Some(format!("{name}: max_points: a table has from 2 to {most} points"))
    } else if !(rules.continuous.1 > rules.continuous.0 && rules.continuous.1 - rules.continuous.0 <= 36_000.0) {
        Some("continuous: write [from, to] in deg, rising, at most a hundred turns".to_owned())
    } else if matches!(rules.spacing, Spacing::PowerOfTwo(unit) if !(1e-6..=1e3).contains(&unit)) {
        Some("power_of_two: the length that the power multiplies, from 1e-6 to 1000".to_owned())
    } else if rules.incremental && increment.correction_decimals > 0 {
        Some(
            "incremental: differences are whole numbers of the correction_scale's unit, correction_decimals: 0"
                .to_owned(),
        )
    } else if rules.magnification != 1 && !can_be_magnified(name, rules) {
        Some("magnification: of a lattice of corrections or errors, from 1 to 1000".to_owned())
    } else {
        None
    }
}

impl Manifest {
    /// A kinematics module is one set of files, and one of them is read back; tables beside it have files of their own.
    fn unfit_files(&self, mechanism: &KinematicsMechanism) -> Option<String> {
        let module = || self.files.iter().filter(|file| !file.is_of_tables());
        let layouts: Vec<&Layout> = module().filter_map(|file| file.layout.as_ref()).collect();
        let one = matches!(layouts[..], [layout] if layout_fits(mechanism.carries, layout));
        let once = module().all(|file| file.per == Per::Machine);
        let tables = self.files.iter().filter(|file| file.is_of_tables());
        let read =
            tables.clone().all(|file| matches!(file.layout, Some(Layout::Columns { .. } | Layout::Lines { .. })));
        let known = tables.clone().count() == 0 || self.reversal().is_some();
        (!one || !once || !read || !known).then(|| {
            "files: all `per: machine`, and one of them with the layout c_arrays (full_model) or hal_constants; besides, `of: own_axis` with a layout of tables"
                .to_owned()
        })
    }
}

impl FileSpec {
    /// Does it hold the tables of a mechanism only? Beside a kinematics module all tables have such files.
    pub fn is_of_tables(&self) -> bool {
        self.of.is_some()
    }
}

/// Digits behind the point that still mean something at 1000 mm.
const MAX_DECIMALS: u8 = 12;

/// More points than any controller's table.
const MAX_POINTS: usize = 100_000;

/// A lattice of so many nodes of six axes is half a gigabyte of text.
const MAX_NODES: usize = 5_000_000;

impl Layout {
    fn fault(&self, bidirectional: bool) -> Option<String> {
        let Self::Columns { columns } = self else { return None };
        let count = |column| columns.iter().filter(|c| **c == column).count();
        let (position, forward, reverse) = (count(Column::Position), count(Column::Forward), count(Column::Reverse));
        let fits = position == 1 && forward == 1 && reverse == usize::from(bidirectional);
        (!fits)
            .then(|| "columns: position, forward, and reverse if the mechanism is bidirectional, each once".to_owned())
    }
}
