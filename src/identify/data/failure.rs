//! Failures of the header and of single rows of a file of measurements.

use crate::diagnostic::shown;
use crate::identify::thresholds::MAX_TURN_RAD;
use crate::syntax::sheet::MixedDecimals;
use crate::units;

/// A reason for which a header cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(super) enum HeaderFailure {
    #[error("the column `{}` occurs twice, or two columns have the same content", shown(.0))]
    Repeated(String),
    /// The title, and a suggestion.
    #[error("unknown column `{}`; {}", shown(.0), .1)]
    Unknown(String, String),
    #[error("there is no column of readings")]
    NoReadings,
    #[error("the header mixes kinds of readings: write each kind to a file of its own")]
    MixedReadings,
    /// The axis whose errors have no positions.
    #[error("errors of `{0}` are read at positions of `{0}`: there is no column `{0}`")]
    NoPositions(String),
    #[error("`weight` and `u` exclude each other: leave one out")]
    WeightAndUncertainty,
    /// Uncertainties are missing for lengths, for angles.
    #[error("{}", no_uncertainty(*.0, *.1))]
    NoUncertainty(bool, bool),
    #[error("`station` and `to.` columns belong to a length")]
    NoLength,
    #[error("a length needs its other end: {OTHER_END}")]
    NoOtherEnd,
    #[error("a length needs its other end: {OTHER_END}, not both")]
    TwoOtherEnds,
    #[error("give all three of `station.x`, `.y`, `.z` (or `ball.x`, `.y`, `.z`), or none")]
    PartOfStation,
    #[error("give all three of `tracker.x [mm]`, `tracker.y [mm]`, `tracker.z [mm]`")]
    PartOfPosition,
    #[error(
        "a touch needs `feature` or `ball`, and all three of `n.x`, `n.y`, `n.z`, the direction from it to the probe"
    )]
    PartOfTouch,
    /// A table of poses without a column of an axis.
    #[error("a table of poses has a column for each axis that moves")]
    NoPoses,
    #[error("a table of poses has no readings")]
    PosesWithReadings,
    /// The uncertainty of a place that is not given.
    #[error("`station.u` needs `station.x`, `station.y`, `station.z`; `ball.x` and `ball.u` need `ball`")]
    NoPlace,
    #[error(
        "`dl` is the difference from the nominal distance: add columns `station.x [mm]`, `station.y [mm]`, \
         `station.z [mm]` of the station"
    )]
    NoStation,
    #[error("the direction is in `approach` and in the name of an error: leave one out")]
    TwoApproaches,
    /// The title of a length.
    #[error("column `{0}` has no unit: write `{0} [um]` or `[mm]`")]
    NoLengthUnit(String),
    /// The title of a rotation.
    #[error("column `{0}` has no unit of angle: write `{0} [urad]`, `[arcsec]` or, of a slope, `[um/m]`")]
    NoAngleUnit(String),
    #[error("a level and an autocollimator read rotations about two axes: leave one of `.a`, `.b`, `.c` out")]
    ThirdRotation,
    /// The title of an error.
    #[error("column `{0}` has no unit: write `{0} [um]` or `[urad]`")]
    NoErrorUnit(String),
    #[error("`{}` is not a unit of length for `{}`", shown(.0), .1)]
    NotLength(String, String),
    /// The unit, and an error.
    #[error("`{}` is not a unit of `{}`", shown(.0), .1)]
    NotUnitOf(String, String),
    /// The unit, and an axis.
    #[error("`{}` is not a unit for positions of `{}`", shown(.0), .1)]
    NotPositionUnit(String, String),
}

/// A reason for which a row cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(super) enum RowFailure {
    /// Cells of the row, and of the header.
    #[error("this row has {0} cells, the header has {1}")]
    Cells(usize, usize),
    #[error("a cell is empty")]
    EmptyCell,
    #[error(transparent)]
    Number(units::Failure),
    #[error(transparent)]
    Decimals(MixedDecimals),
    #[error("the direction `n` of this touch has no length")]
    NoNormal,
    #[error("the row has no reading")]
    NoReading,
    #[error("`{}` is a reading, and a plan asks for what is not measured yet: leave the cell empty", shown(.0))]
    ReadingInPlan(String),
    #[error("`{}` is more than 1 km: compare the unit in the header", shown(.0))]
    Far(String),
    #[error(
        "`{}` is more than {MAX_TURN_RAD} rad: rotations are the small difference of the actual orientation from the \
         nominal one; compare the unit in the header",
        shown(.0)
    )]
    LargeRotation(String),
    /// A cell, and the weight that it gives.
    #[error("`{}`: weight {:e} is outside 1e-15 to 1e15", shown(.0), .1)]
    Weight(String, f64),
    /// The quantity, and a cell.
    #[error("the {} `{}` is not above zero; leave the row out", .0, shown(.1))]
    NotPositive(&'static str, String),
    #[error("the approach `{}` is none of forward, reverse, mean (or +, -)", shown(.0))]
    NotApproach(String),
    /// The tool, and a suggestion.
    #[error("the machine has no tool `{}`; {}", shown(.0), .1)]
    NoTool(String, String),
}

/// The columns of the other end of a length.
const OTHER_END: &str = "a column `station`, or `to.` columns with the positions of a second pose";

fn no_uncertainty(lengths: bool, angles: bool) -> &'static str {
    match (lengths, angles) {
        (true, true) => "lengths and angles are read: give `u [um]` and `u [urad]`, or neither",
        (true, false) => "lengths are read: give `u [um]`",
        (false, _) => "angles are read: give `u [urad]`",
    }
}
