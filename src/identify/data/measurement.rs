//! Measurements: what was read at a pose, and the unknowns that belong to the instrument rather than the machine.

use crate::diagnostic::Place;
use crate::evaluate::Frame;
use crate::lower::Source;
use crate::machine::{Approach, Direction, Pose};
use nalgebra::Vector3;

/// Lever (mm) by which a rotation counts as a displacement where sizes of unlike quantities are compared.
pub(crate) const LEVER_MM: f64 = 300.0;

/// Returns the displacement (mm) that a unit (mm or rad) of an error in this direction makes.
pub(crate) fn lever(direction: Direction) -> f64 {
    if direction.is_rotation() { LEVER_MM } else { 1.0 }
}

/// One row of a measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Positions of the axes as programmed (mm, deg).
    pub pose: Pose,
    /// Index in [`crate::machine::Machine::tools`].
    pub tool: usize,
    /// From which side the axes came.
    pub approach: Approach,
    /// The reading.
    pub reading: Reading,
    /// Number of rows that it counts for.
    pub weight: f64,
    /// True if the weight is 1/u^2 of a standard uncertainty u (um): unlike quantities are then weighed by it.
    pub has_uncertainty: bool,
    /// Its run, if runs were named.
    pub run: Option<String>,
    /// Place in the file.
    pub place: Place,
}

/// A reading, actual values in mm (rad where a single error is an angle). Indices are those of
/// [`MeasurementSet::nuisances`].
#[derive(Debug, Clone, PartialEq)]
pub enum Reading {
    /// dx, dy, dz of the functional point, actual minus nominal; `None`: not measured.
    Deviation {
        /// The three components.
        values: [Option<f64>; 3],
        frame: Frame,
        /// Index of the unknown that was subtracted from each: the deviation at the first reading of the run.
        zero: [Option<usize>; 3],
    },
    /// Distance of the functional point from something else.
    Distance {
        /// The distance, less the unknown constant.
        value: f64,
        from: DistanceEnd,
        /// Index of the unknown constant, if there is one.
        zero: Option<usize>,
    },
    /// Place of the functional point as an instrument with a frame of its own sees it: a laser tracker.
    Position {
        /// The place in the workpiece frame by the best fit of the nominal points, minus the nominal one.
        value: Vector3<f64>,
        /// The point about which the instrument's frame may turn beside that fit.
        about: Vector3<f64>,
        /// First of six unknowns: where the frame of the readings is beside that fit, and by how much it is turned.
        frame: usize,
    },
    /// Deviation along a fixed direction, less what unknowns of instrument and set-up add: along a straight line a
    /// laser interferometer, along the normal of a feature a touch.
    Along {
        /// Actual minus nominal.
        value: f64,
        /// Unit vector, workpiece frame.
        direction: Vector3<f64>,
        /// Indices of the unknowns, and what a unit of each adds to the deviation.
        less: Vec<(usize, f64)>,
        /// True of a touch.
        is_touch: bool,
    },
    /// Rotation of the tool against the workpiece, or the direction of its axis, actual minus nominal, as an instrument
    /// sees it whose frame is turned and whose target sits askew. Displacements (mm) over the usual lever by the
    /// components of the skew part of the rotation (of the unit vector): they are linear in the actual orientation.
    Turn {
        values: [Option<f64>; 3],
        of: TurnKind,
        frame: Frame,
        /// Indices of the unknown rotation of the instrument's frame, about the axes of the workpiece frame.
        turned: [Option<usize>; 3],
        /// Indices of the unknown rotation of the target, about the axes of the tool.
        mounted: [Option<usize>; 3],
    },
    /// A component error itself, as a single-axis measurement gives it.
    Error {
        /// mm; of an angle the displacement that it makes over 300 mm, so that unlike errors can be summed.
        value: f64,
        source: Source,
    },
}

/// Instruments that read orientations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum TurnKind {
    /// A six-degree probe or a camera: all three rotations.
    Rotation,
    /// An electronic level: rotations about horizontal axes of the machine.
    Level,
    /// An autocollimator: rotations about two axes of the machine.
    Collimator,
    /// The direction of the tool's axis: a telescope on its mount.
    Axis,
}

impl TurnKind {
    /// Returns its name in columns and unknowns.
    pub fn label(self) -> &'static str {
        match self {
            Self::Rotation => "rotation",
            Self::Level => "level",
            Self::Collimator => "collimator",
            Self::Axis => "axis",
        }
    }
}

/// The other end of a distance.
#[derive(Debug, Clone, PartialEq)]
pub enum DistanceEnd {
    /// A point fixed to the workpiece, its place (from the workpiece origin) three unknowns from this index on.
    Station(usize),
    /// The functional point itself at another pose.
    Pose(Pose),
}

/// A tool in a run, or without one.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct ToolUse {
    /// Index in [`crate::machine::Machine::tools`].
    pub tool: usize,
    /// Its run, if runs were named.
    pub run: Option<String>,
}

/// The kinds of rows, in the words of the reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ReadingKind {
    /// dx, dy, dz.
    Deviation,
    /// The same relative to the first reading.
    Relative,
    /// Places in the instrument's frame.
    Position,
    /// Distances.
    Length,
    /// Along a line.
    Line,
    /// Touches of features.
    Touch,
    /// Component errors that are lengths.
    Error,
    /// Component errors that are angles.
    Angle,
    /// Orientations.
    Turn(TurnKind),
}

impl ReadingKind {
    /// Returns the unit in which people read it, and how many of it a mm of [`Reading`] is.
    pub fn unit(self) -> (&'static str, f64) {
        if self.is_angle() { ("urad", 1e6 / lever(Direction::A)) } else { ("um", 1e3) }
    }

    /// True of readings that are angles.
    pub fn is_angle(self) -> bool {
        matches!(self, Self::Angle | Self::Turn(_))
    }

    /// Returns its name in reports: `deviations`, `relative deviations` ...
    pub fn word(self) -> &'static str {
        match self {
            Self::Deviation => "deviations",
            Self::Relative => "relative deviations",
            Self::Position => "positions",
            Self::Length => "lengths",
            Self::Line => "lines",
            Self::Touch => "touches",
            Self::Error => "single errors",
            Self::Angle => "single angles",
            Self::Turn(TurnKind::Rotation) => "rotations",
            Self::Turn(TurnKind::Level) => "levels",
            Self::Turn(TurnKind::Collimator) => "collimator readings",
            Self::Turn(TurnKind::Axis) => "axis directions",
        }
    }
}

impl Measurement {
    /// Returns a reading of weight 1, with the first tool, from no side in particular.
    pub fn new(pose: Pose, reading: Reading, place: Place) -> Self {
        Self { pose, tool: 0, approach: Approach::Mean, reading, weight: 1.0, has_uncertainty: false, run: None, place }
    }

    /// Returns the pose, and the other one of a distance between two.
    pub fn poses(&self) -> impl Iterator<Item = &Pose> {
        let other = match &self.reading {
            Reading::Distance { from: DistanceEnd::Pose(to), .. } => Some(to),
            _ => None,
        };
        std::iter::once(&self.pose).chain(other)
    }

    /// Returns which of the (up to three) numbers of a residual were read.
    pub fn reading_mask(&self) -> [bool; 3] {
        match &self.reading {
            Reading::Deviation { values, .. } | Reading::Turn { values, .. } => values.map(|value| value.is_some()),
            Reading::Position { .. } => [true; 3],
            _ => [true, false, false],
        }
    }

    /// Returns the numbers read; 0 for the others.
    pub fn values(&self) -> Vector3<f64> {
        match &self.reading {
            Reading::Deviation { values, .. } | Reading::Turn { values, .. } => {
                Vector3::from(values.map(|value| value.unwrap_or(0.0)))
            }
            Reading::Position { value, .. } => *value,
            Reading::Distance { value, .. } | Reading::Along { value, .. } | Reading::Error { value, .. } => {
                Vector3::new(*value, 0.0, 0.0)
            }
        }
    }

    /// Returns the number of numbers read.
    pub fn readings(&self) -> usize {
        self.reading_mask().into_iter().filter(|seen| *seen).count()
    }

    /// Returns the kind of the row.
    pub fn kind(&self) -> ReadingKind {
        match &self.reading {
            Reading::Deviation { zero: [None, None, None], .. } => ReadingKind::Deviation,
            Reading::Deviation { .. } => ReadingKind::Relative,
            Reading::Position { .. } => ReadingKind::Position,
            Reading::Distance { .. } => ReadingKind::Length,
            Reading::Along { is_touch: true, .. } => ReadingKind::Touch,
            Reading::Along { .. } => ReadingKind::Line,
            Reading::Turn { of, .. } => ReadingKind::Turn(*of),
            Reading::Error { source, .. } if source.direction.is_rotation() => ReadingKind::Angle,
            Reading::Error { .. } => ReadingKind::Error,
        }
    }
}

const LETTERS: [&str; 3] = ["x", "y", "z"];

/// An unknown length or angle of an instrument or a set-up: no error of the machine, but fitted with them.
#[derive(Debug, Clone, PartialEq)]
pub struct InstrumentUnknown {
    /// `station.x`, `zero 2`, `tracker.A`: unique among the files read together.
    pub name: String,
    /// True if it is an angle.
    pub is_angle: bool,
    /// Value at the start of the fit (mm, of an angle rad).
    pub start: f64,
    /// Standard uncertainty (mm or rad) with which it is known to have this value.
    pub known: Option<f64>,
    /// Zero of a coordinate of a point, from the workpiece origin (mm).
    pub base: f64,
}

/// Measurements of all files, and the unknowns of instruments and set-ups: places of stations, dead paths, first
/// readings.
#[derive(Debug, Clone, Default)]
pub struct MeasurementSet {
    /// Row by row.
    pub rows: Vec<Measurement>,
    /// Quantities that are fitted beside the machine, and are no error of it.
    pub nuisances: Vec<InstrumentUnknown>,
}

/// Numbers of rows and unknowns.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SetExtent {
    rows: usize,
    nuisances: usize,
}

impl MeasurementSet {
    /// Adds an unknown of `mm` to begin with; gives its index.
    pub(crate) fn unknown(&mut self, name: String, start: f64) -> usize {
        self.nuisances.push(InstrumentUnknown { name, is_angle: false, start, known: None, base: 0.0 });
        self.nuisances.len() - 1
    }

    /// Adds three unknowns, `.x`, `.y` and `.z`; gives the index of the first.
    pub(crate) fn unknown_point(&mut self, name: &str, start: Vector3<f64>) -> usize {
        let first = self.nuisances.len();
        for (letter, start) in LETTERS.into_iter().zip(start.iter()) {
            self.unknown(format!("{name}.{letter}"), *start);
        }
        first
    }

    /// States that three unknowns from this index on are known to be as they start, with a standard uncertainty (mm).
    pub(crate) fn know_point(&mut self, first: usize, sigma: Option<f64>) {
        self.nuisances[first..first + 3].iter_mut().for_each(|unknown| unknown.known = sigma);
    }

    /// Adds an unknown for each component that was read, 0 to begin with; gives their indices.
    pub(crate) fn unknown_components(&mut self, name: &str, read: [bool; 3]) -> [Option<usize>; 3] {
        std::array::from_fn(|k| read[k].then(|| self.unknown(format!("{name}.{}", LETTERS[k]), 0.0)))
    }

    /// Adds six unknowns, 0 to begin with: a displacement `.x`, `.y`, `.z` and a rotation `.A`, `.B`, `.C`; gives the
    /// index of the first.
    pub(crate) fn unknown_frame(&mut self, name: &str) -> usize {
        let first = self.unknown_point(name, Vector3::zeros());
        (0..3).for_each(|k| {
            let _ = self.unknown_angle(name, k);
        });
        first
    }

    /// Adds an unknown rotation about an axis, `.A`, `.B` or `.C`, 0 to begin with; gives its index.
    pub(crate) fn unknown_angle(&mut self, name: &str, k: usize) -> usize {
        let name = format!("{name}.{}", ["A", "B", "C"][k]);
        self.nuisances.push(InstrumentUnknown { name, is_angle: true, start: 0.0, known: None, base: 0.0 });
        self.nuisances.len() - 1
    }

    /// Returns the lengths of the lists.
    pub(crate) fn extent(&self) -> SetExtent {
        SetExtent { rows: self.rows.len(), nuisances: self.nuisances.len() }
    }

    /// Cuts the lists to former lengths.
    pub(crate) fn truncate(&mut self, extent: SetExtent) {
        self.rows.truncate(extent.rows);
        self.nuisances.truncate(extent.nuisances);
    }
}
