//! Failures of the header and of single rows of a file of measurements.

use crate::diagnostic::shown;
use crate::syntax::sheet::MixedDecimals;
use crate::units;
use std::fmt;

/// A reason for which a header cannot be used.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum HeaderFailure {
    Repeated(String),
    /// The title, and a suggestion.
    Unknown(String, String),
    NoReadings,
    MixedReadings,
    /// The axis whose errors have no positions.
    NoPositions(String),
    WeightAndUncertainty,
    /// Uncertainties are missing for lengths, for angles.
    NoUncertainty(bool, bool),
    NoLength,
    NoOtherEnd,
    TwoOtherEnds,
    PartOfStation,
    PartOfPosition,
    /// A table of poses without a column of an axis.
    NoPoses,
    PosesWithReadings,
    /// The uncertainty of a place that is not given.
    NoPlace,
    NoStation,
    TwoApproaches,
    /// The title of a length.
    NoLengthUnit(String),
    /// The title of an error.
    NoErrorUnit(String),
    NotLength(String, String),
    /// The unit, and an error.
    NotUnitOf(String, String),
    /// The unit, and an axis.
    NotPositionUnit(String, String),
}

/// A reason for which a row cannot be used.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum RowFailure {
    /// Cells of the row, and of the header.
    Cells(usize, usize),
    EmptyCell,
    Number(units::Failure),
    Decimals(MixedDecimals),
    NoReading,
    Far(String),
    /// A cell, and the weight that it gives.
    Weight(String, f64),
    /// The quantity, and a cell.
    NotPositive(&'static str, String),
    NotApproach(String),
    /// The tool, and a suggestion.
    NoTool(String, String),
}

/// The columns of the other end of a length.
const OTHER_END: &str = "a column `station`, or `to.` columns with the positions of a second pose";

impl fmt::Display for HeaderFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Repeated(title) => {
                write!(f, "the column `{}` occurs twice, or two columns have the same content", shown(title))
            }
            Self::Unknown(title, suggestion) => write!(f, "unknown column `{}`; {suggestion}", shown(title)),
            Self::NoReadings => write!(f, "there is no column of readings"),
            Self::MixedReadings => {
                write!(f, "the header mixes kinds of readings: write each kind to a file of its own")
            }
            Self::NoPositions(axis) => {
                write!(f, "errors of `{axis}` are read at positions of `{axis}`: there is no column `{axis}`")
            }
            Self::WeightAndUncertainty => write!(f, "`weight` and `u` exclude each other: leave one out"),
            Self::NoUncertainty(true, true) => {
                write!(f, "lengths and angles are read: give `u [um]` and `u [urad]`, or neither")
            }
            Self::NoUncertainty(true, false) => write!(f, "lengths are read: give `u [um]`"),
            Self::NoUncertainty(false, _) => write!(f, "angles are read: give `u [urad]`"),
            Self::NoLength => write!(f, "`station` and `to.` columns belong to a length"),
            Self::NoOtherEnd => write!(f, "a length needs its other end: {OTHER_END}"),
            Self::TwoOtherEnds => write!(f, "a length needs its other end: {OTHER_END}, not both"),
            Self::PartOfStation => {
                write!(f, "give all three of `station.x`, `.y`, `.z` (or `ball.x`, `.y`, `.z`), or none")
            }
            Self::PartOfPosition => {
                write!(f, "give all three of `tracker.x [mm]`, `tracker.y [mm]`, `tracker.z [mm]`")
            }
            Self::PosesWithReadings => write!(f, "a table of poses has no readings"),
            Self::NoPoses => write!(f, "a table of poses has a column for each axis that moves"),
            Self::NoPlace => {
                write!(f, "`station.u` needs `station.x`, `station.y`, `station.z`; `ball.x` and `ball.u` need `ball`")
            }
            Self::NoStation => {
                let columns = "`station.x [mm]`, `station.y [mm]`, `station.z [mm]`";
                write!(f, "`dl` is the difference from the nominal distance: add columns {columns} of the station")
            }
            Self::TwoApproaches => {
                write!(f, "the direction is in `approach` and in the name of an error: leave one out")
            }
            Self::NoLengthUnit(title) => write!(f, "column `{title}` has no unit: write `{title} [um]` or `[mm]`"),
            Self::NoErrorUnit(title) => write!(f, "column `{title}` has no unit: write `{title} [um]` or `[urad]`"),
            Self::NotLength(unit, title) => write!(f, "`{}` is not a unit of length for `{title}`", shown(unit)),
            Self::NotUnitOf(unit, error) => write!(f, "`{}` is not a unit of `{error}`", shown(unit)),
            Self::NotPositionUnit(unit, axis) => write!(f, "`{}` is not a unit for positions of `{axis}`", shown(unit)),
        }
    }
}

impl fmt::Display for RowFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cells(row, header) => write!(f, "this row has {row} cells, the header has {header}"),
            Self::EmptyCell => write!(f, "a cell is empty"),
            Self::Number(failure) => failure.fmt(f),
            Self::Decimals(mixed) => mixed.fmt(f),
            Self::NoReading => write!(f, "the row has no reading"),
            Self::Far(cell) => write!(f, "`{}` is more than 1 km: compare the unit in the header", shown(cell)),
            Self::Weight(cell, weight) => {
                write!(f, "`{}`: weight {weight:e} is outside 1e-15 to 1e15", shown(cell))
            }
            Self::NotPositive(quantity, cell) => {
                write!(f, "the {quantity} `{}` is not above zero; leave the row out", shown(cell))
            }
            Self::NotApproach(cell) => {
                write!(f, "the approach `{}` is none of forward, reverse, mean (or +, -)", shown(cell))
            }
            Self::NoTool(name, suggestion) => write!(f, "the machine has no tool `{}`; {suggestion}", shown(name)),
        }
    }
}
