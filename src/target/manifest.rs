//! The manifest of a target (`target.yaml`): what the controller can hold and what it does with it.

use super::kinematics::{KinematicsMechanism, layout_fits};
use crate::compensation::{Capability, Increment, LatticeCapability, OwnAxisCapability, Spacing};
use serde::Deserialize;

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
    #[serde(with = "serde_yaml::with::singleton_map")]
    pub mechanism: Mechanism,
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
    /// `measured`, `documented`, `own format` or `memory`.
    pub level: String,
    /// The source.
    pub source: String,
}

/// What the stored number means. The only meaning so far; the key is there so that a manifest says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stored {
    /// It is added to the command.
    Correction,
}

/// The mechanism.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mechanism {
    /// One table per axis.
    OwnAxis(OwnAxisMechanism),
    /// A lattice.
    Lattice(LatticeMechanism),
    /// The controller's kinematics are replaced.
    Kinematics(KinematicsMechanism),
}

/// One table per axis.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OwnAxisMechanism {
    max_points: usize,
    spacing: Spacing,
    bidirectional: bool,
    continuous: (f64, f64),
    stored: Stored,
    increment: Increment,
}

/// A lattice.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LatticeMechanism {
    max_nodes: usize,
    corrects_rotary: bool,
    stored: Stored,
    increment: Increment,
}

/// At which position the controller looks its tables up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Lookup {
    /// At the commanded position.
    Command,
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
    /// Constant arrays of C: the numbers of a full kinematics model.
    CArrays,
    /// Lines `setp COMPONENT.NAME VALUE`.
    HalConstants,
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
    /// How to read it back; absent for files without tables.
    #[serde(default)]
    pub layout: Option<Layout>,
}

impl Manifest {
    /// What the mechanism can hold.
    pub fn capability(&self) -> Capability {
        match &self.mechanism {
            Mechanism::OwnAxis(m) => Capability::OwnAxis(OwnAxisCapability {
                max_points: m.max_points,
                spacing: m.spacing,
                bidirectional: m.bidirectional,
                continuous: m.continuous,
                increment: m.increment,
            }),
            Mechanism::Lattice(m) => Capability::Lattice(LatticeCapability {
                max_nodes: m.max_nodes,
                corrects_rotary: m.corrects_rotary,
                increment: m.increment,
            }),
            Mechanism::Kinematics(_) => Capability::Kinematics,
        }
    }

    /// Least increments of the stored numbers.
    pub fn increment(&self) -> Increment {
        match &self.mechanism {
            Mechanism::OwnAxis(m) => m.increment,
            Mechanism::Lattice(m) => m.increment,
            Mechanism::Kinematics(m) => m.increment,
        }
    }

    /// What the stored number means.
    pub fn stored(&self) -> Stored {
        match &self.mechanism {
            Mechanism::OwnAxis(m) => m.stored,
            Mechanism::Lattice(m) => m.stored,
            Mechanism::Kinematics(_) => Stored::Correction,
        }
    }

    /// Does it rest on memory alone?
    pub fn unverified(&self) -> bool {
        [&self.certainty.syntax, &self.certainty.sign].into_iter().any(|c| c.level == "memory")
    }

    /// What makes a manifest impossible to work with, in words.
    pub fn fault(&self) -> Option<String> {
        let increment = self.increment();
        let decimals = increment.position_decimals.max(increment.correction_decimals);
        if decimals > MOST_DECIMALS {
            return Some(format!("{decimals} decimals are more than the {MOST_DECIMALS} that a double has to give"));
        }
        match &self.mechanism {
            Mechanism::OwnAxis(m) if !(2..=MOST_POINTS).contains(&m.max_points) => {
                Some(format!("max_points: a table has from 2 to {MOST_POINTS} points"))
            }
            Mechanism::OwnAxis(m)
                if !(m.continuous.1 > m.continuous.0 && m.continuous.1 - m.continuous.0 <= 36_000.0) =>
            {
                Some("continuous: write [from, to] in deg, rising, at most a hundred turns".to_owned())
            }
            Mechanism::Lattice(m) if !(2..=MOST_NODES).contains(&m.max_nodes) => {
                Some(format!("max_nodes: a lattice has from 2 to {MOST_NODES} nodes"))
            }
            Mechanism::OwnAxis(m) => {
                self.files.iter().filter_map(|f| f.layout.as_ref()).find_map(|l| l.fault(m.bidirectional))
            }
            Mechanism::Lattice(_) => None,
            Mechanism::Kinematics(m) => m.fault().or_else(|| self.unfit_files(m)),
        }
    }
}

impl Manifest {
    /// A kinematics module is one set of files, and one of them is read back.
    fn unfit_files(&self, mechanism: &KinematicsMechanism) -> Option<String> {
        let layouts: Vec<&Layout> = self.files.iter().filter_map(|file| file.layout.as_ref()).collect();
        let one = matches!(layouts[..], [layout] if layout_fits(mechanism.carries, layout));
        let once = self.files.iter().all(|file| file.per == Per::Machine);
        (!one || !once).then(|| {
            "files: all `per: machine`, and one of them with the layout c_arrays (full_model) or hal_constants"
                .to_owned()
        })
    }
}

/// Digits behind the point that still mean something at 1000 mm.
const MOST_DECIMALS: u8 = 12;

/// More points than any controller's table.
const MOST_POINTS: usize = 100_000;

/// A lattice of so many nodes of six axes is half a gigabyte of text.
const MOST_NODES: usize = 5_000_000;

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
