//! Failures of the header and of single rows of an export.

use crate::diagnostic::shown;
use crate::machine::ErrorId;
use crate::units;

/// A reason for which a header cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(super) enum ExportFailure {
    #[error("`{}` is not a component error", shown(.0))]
    NotComponentError(String),
    #[error("`{}` is not a unit", shown(.0))]
    NotUnit(String),
    #[error("`{}` is not a unit of positions", shown(.0))]
    NotPositionUnit(String),
    /// Unit and error.
    #[error("`{}` is not a unit of `{}`", shown(.0), .1)]
    NotUnitOf(String, ErrorId),
    /// The error, and the axis that moved.
    #[error("`{}` is an error of axis {}, but axis {} moved: correct `--error` or `--axis`", .0, .0.axis, shown(.1))]
    ErrorOfOtherAxis(ErrorId, String),
    /// `--continuous` with this axis.
    #[error("axis {} is linear: `--continuous` applies to rotary axes", shown(.0))]
    LinearAxis(String),
    #[error("there is no position column")]
    NoPositions,
    /// No column of readings, of the error that is asked for.
    #[error(
        "there is no column of readings{}",
        .0.as_ref().map_or_else(String::new, |error| format!(" of `{}`", shown(error)))
    )]
    NoReadings(Option<String>),
    /// The title of a column of means, without any of runs.
    #[error(
        "the table has means over the runs (`{}`) and no runs, which show outliers, drift and repeatability: export \
         the runs, or take each mean as a run with `--columns FILE`, an entry `{{ error: EXX, unit: um, direction: \
         forward }}` for each",
        shown(.0)
    )]
    Means(String),
    #[error("the file does not say which axis moved: give `--axis X`")]
    NoAxis,
    #[error("the column `axis` names `{}` and `{}`: select one with `--axis`", shown(.0), shown(.1))]
    TwoAxes(String, String),
    /// The axis that the file notes, and the one that was asked for.
    #[error("the file says that axis `{}` moved, and not `{}`", shown(.0), shown(.1))]
    AxisNoted(String, String),
    /// The title of the runs; `None` for positions that were reached.
    #[error(
        "the file does not say which error {} measure: give `--error EXX`",
        .0.as_ref().map_or_else(|| "these runs".to_owned(), |title| format!("the runs (`{}`)", shown(title)))
    )]
    NoError(Option<String>),
    /// The title of the readings.
    #[error(
        "the column `{}` has no unit: write it into the title, or give the unit that the instrument was set to with \
         `--unit`",
        shown(.0)
    )]
    NoUnit(String),
    /// The title of a column between runs.
    #[error(
        "the column `{}` stands between runs and is not understood: delete it, or map the columns with \
         `--columns FILE`",
        shown(.0)
    )]
    UnknownBetween(String),
    /// The title of the second column of a run.
    #[error("`{}` is the second column of its run and direction; number the runs apart", shown(.0))]
    RunTwice(String),
    /// Titles of channels without a mounting.
    #[error(
        "{0} are channels of an instrument: give the direction of the beam and the instrument's vertical with \
         `--beam +X --vertical +Z`, or one error with `--error`"
    )]
    Channels(String),
    /// The axis along the beam, and the axis that moved.
    #[error("the beam is along {}, but axis {} moved", .0, shown(.1))]
    BeamAcross(String, String),
    /// A title that `--flip` names and the table does not have.
    #[error("`--flip {}` names no channel of this table", shown(.0))]
    NoFlipped(String),
    /// A title that the mapping names and the table does not have.
    #[error("the table has no column `{}`, which the mapping names", shown(.0))]
    NoMapped(String),
    /// A title with its unit, and the unit that the mapping has instead.
    #[error("the column `{}` is in `{}`; the mapping says `{}`", shown(.0), shown(.1), shown(.2))]
    OtherUnit(String, String, String),
}

/// A reason for which a row is left out.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(super) enum SampleFailure {
    /// Cells of the row, and of the header.
    #[error("{0} cells under {1} columns")]
    Cells(usize, usize),
    /// Cells of the last row, and the fewest of a row above.
    #[error("{0} cells in the last row, {1} or more in each above: is the file cut off?")]
    Cut(usize, usize),
    #[error("marked `{}`", shown(.0))]
    Excluded(String),
    #[error("no position")]
    NoPosition,
    #[error(transparent)]
    Number(#[from] units::Failure),
    /// A position (mm or deg).
    #[error("the position {0} exceeds 1000000 mm or deg")]
    Far(f64),
    #[error("a row of axis {}", shown(.0))]
    OtherAxis(String),
    #[error("a reading of {0}")]
    OtherError(ErrorId),
    #[error("`{}` is not a direction", shown(.0))]
    NotDirection(String),
    /// A reading, and its unit.
    #[error("a reading of {0} {1} is no error of a machine")]
    TooLarge(f64, &'static str),
    #[error("the reading has no unit")]
    NoUnit,
    #[error("not a unit of `{0}`")]
    NotUnitOf(ErrorId),
    #[error("the row has no reading")]
    NoReading,
    #[error(transparent)]
    Error(#[from] ExportFailure),
}
