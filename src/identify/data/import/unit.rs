//! Units of positions and readings, and the errors that they fit.

use super::failure::ExportFailure;
use crate::identify::data::error_name::parse_component_error;
use crate::machine::ErrorId;
use crate::units::{self, Dimension};

/// A unit of readings: factor to mm or rad, and dimension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ReadingUnit {
    pub factor: f64,
    dimension: Dimension,
}

impl ReadingUnit {
    /// True if the error can be measured in this unit. Angles may be ratios (`um/m`).
    pub fn fits(&self, error: &ErrorId) -> bool {
        match self.dimension {
            Dimension::LENGTH => !error.direction.is_rotation(),
            Dimension::ANGLE | Dimension::RATIO => error.direction.is_rotation(),
            _ => false,
        }
    }
}

pub(super) fn reading_unit(unit: &str) -> Result<ReadingUnit, ExportFailure> {
    let found = units::unit(unit).map(|(factor, dimension)| ReadingUnit { factor, dimension });
    found.map_err(|_| ExportFailure::NotUnit(unit.to_owned()))
}

/// Returns true for a unit of rotary axes, and its factor to mm or deg.
pub(super) fn position_unit(unit: &str) -> Result<(bool, f64), ExportFailure> {
    match units::unit(unit) {
        Ok((factor, Dimension::LENGTH)) => Ok((false, factor)),
        Ok((_, Dimension::ANGLE)) if unit == "deg" || unit == "°" => Ok((true, 1.0)),
        Ok((factor, Dimension::ANGLE)) => Ok((true, factor.to_degrees())),
        _ => Err(ExportFailure::NotPositionUnit(unit.to_owned())),
    }
}

pub(super) fn component_error(name: &str) -> Result<ErrorId, ExportFailure> {
    parse_component_error(name).ok_or_else(|| ExportFailure::NotComponentError(name.to_owned()))
}

pub(super) fn own_axis(error: &ErrorId, axis: &str) -> Result<(), ExportFailure> {
    let own = error.axis.to_string().eq_ignore_ascii_case(axis);
    if own { Ok(()) } else { Err(ExportFailure::ErrorOfOtherAxis(error.clone(), axis.to_owned())) }
}

/// Returns the positioning error of an axis, by its letter: EXX of X, ECC of C1.
pub(super) fn own_error(axis: &str) -> Option<ErrorId> {
    parse_component_error(&format!("E{}{axis}", axis.chars().next()?))
}
