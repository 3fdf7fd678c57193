//! Failures of the header and of single rows of an export.

use crate::diagnostic::shown;
use crate::machine::ErrorId;
use crate::units;
use std::fmt;

/// A reason for which a header cannot be used.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ExportFailure {
    NotComponentError(String),
    NotUnit(String),
    NotPositionUnit(String),
    /// Unit and error.
    NotUnitOf(String, ErrorId),
    /// The error, and the axis that moved.
    ErrorOfOtherAxis(ErrorId, String),
    /// `--continuous` with this axis.
    LinearAxis(String),
    NoPositions,
    /// No column of readings, of the error that is asked for.
    NoReadings(Option<String>),
    NoAxis,
    TwoAxes(String, String),
    /// The title of the runs; `None` for positions that were reached.
    NoError(Option<String>),
    /// The title of the readings.
    NoUnit(String),
    /// The title of a column between runs.
    UnknownBetween(String),
    /// The title of the second column of a run.
    RunTwice(String),
    /// Titles of channels without a mounting.
    Channels(String),
    /// The axis along the beam, and the axis that moved.
    BeamAcross(String, String),
    /// A title that `--flip` names and the table does not have.
    NoFlipped(String),
    /// A title that the mapping names and the table does not have.
    NoMapped(String),
    /// A title with its unit, and the unit that the mapping has instead.
    OtherUnit(String, String, String),
}

/// A reason for which a row is left out.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum SampleFailure {
    /// Cells of the row, and of the header.
    Cells(usize, usize),
    Excluded(String),
    NoPosition,
    Number(units::Failure),
    /// A position (mm or deg).
    Far(f64),
    OtherAxis(String),
    OtherError(ErrorId),
    NotDirection(String),
    /// A reading, and its unit.
    TooLarge(f64, &'static str),
    NoUnit,
    NotUnitOf(ErrorId),
    NoReading,
    Error(ExportFailure),
}

impl fmt::Display for ExportFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotComponentError(name) => write!(f, "`{}` is not a component error", shown(name)),
            Self::NotUnit(unit) => write!(f, "`{}` is not a unit", shown(unit)),
            Self::NotPositionUnit(unit) => write!(f, "`{}` is not a unit of positions", shown(unit)),
            Self::NotUnitOf(unit, error) => write!(f, "`{}` is not a unit of `{error}`", shown(unit)),
            Self::ErrorOfOtherAxis(error, axis) => write!(f, "`{error}` is no error of axis {}", shown(axis)),
            Self::LinearAxis(axis) => {
                write!(f, "axis {} is linear: `--continuous` applies to rotary axes", shown(axis))
            }
            Self::NoPositions => write!(f, "there is no position column"),
            Self::NoReadings(None) => write!(f, "there is no column of readings"),
            Self::NoReadings(Some(error)) => write!(f, "there is no column of readings of `{}`", shown(error)),
            Self::NoAxis => write!(f, "the file does not say which axis moved: give `--axis X`"),
            Self::TwoAxes(one, other) => {
                let (one, other) = (shown(one), shown(other));
                write!(f, "the column `axis` names `{one}` and `{other}`: select one with `--axis`")
            }
            Self::NoError(None) => {
                write!(f, "the file does not say which error these runs measure: give `--error EXX`")
            }
            Self::NoError(Some(title)) => {
                let title = shown(title);
                write!(f, "the file does not say which error the runs (`{title}`) measure: give `--error EXX`")
            }
            Self::NoUnit(title) => {
                write!(
                    f,
                    "the column `{}` has no unit: write it into the title, or give the unit that the instrument was \
                     set to with `--unit`",
                    shown(title)
                )
            }
            Self::RunTwice(title) => {
                let title = shown(title);
                write!(f, "`{title}` is the second column of its run and direction; number the runs apart")
            }
            Self::UnknownBetween(title) => write!(
                f,
                "the column `{}` stands between runs and is not understood: delete it, or map the columns with \
                 `--columns FILE`",
                shown(title)
            ),
            Self::Channels(titles) => write!(
                f,
                "{titles} are channels of an instrument: give the direction of the beam and the instrument's vertical \
                 with `--beam +X --vertical +Z`, or one error with `--error`"
            ),
            Self::BeamAcross(beam, axis) => {
                write!(f, "the beam is along {beam}, but axis {} moved", shown(axis))
            }
            Self::NoFlipped(title) => write!(f, "`--flip {}` names no channel of this table", shown(title)),
            Self::NoMapped(title) => write!(f, "the table has no column `{}`, which the mapping names", shown(title)),
            Self::OtherUnit(title, own, mapped) => {
                let (title, own, mapped) = (shown(title), shown(own), shown(mapped));
                write!(f, "the column `{title}` is in `{own}`; the mapping says `{mapped}`")
            }
        }
    }
}

impl fmt::Display for SampleFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cells(row, header) => write!(f, "{row} cells under {header} columns"),
            Self::Excluded(mark) => write!(f, "marked `{}`", shown(mark)),
            Self::NoPosition => write!(f, "no position"),
            Self::Number(failure) => failure.fmt(f),
            Self::Far(position) => write!(f, "the position {position} exceeds 1000000 mm or deg"),
            Self::OtherAxis(axis) => write!(f, "a row of axis {}", shown(axis)),
            Self::OtherError(error) => write!(f, "a reading of {error}"),
            Self::NotDirection(text) => write!(f, "`{}` is not a direction", shown(text)),
            Self::TooLarge(value, unit) => write!(f, "a reading of {value} {unit} is no error of a machine"),
            Self::NoUnit => write!(f, "the reading has no unit"),
            Self::NotUnitOf(error) => write!(f, "not a unit of `{error}`"),
            Self::NoReading => write!(f, "the row has no reading"),
            Self::Error(failure) => failure.fmt(f),
        }
    }
}

impl From<units::Failure> for SampleFailure {
    fn from(failure: units::Failure) -> Self {
        Self::Number(failure)
    }
}

impl From<ExportFailure> for SampleFailure {
    fn from(failure: ExportFailure) -> Self {
        Self::Error(failure)
    }
}
