//! The values of characteristics, as results have them.

use crate::analysis::budget::{Percentile, Proportion};
use crate::analysis::zone::{CharacteristicKind, ZoneFit};
use schemars::JsonSchema;
use serde::Serialize;

/// A characteristic of a feature (ISO 1101) with its tolerance.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CharacteristicResult {
    /// Name of the feature.
    pub feature: String,
    /// The characteristic.
    pub kind: CharacteristicKind,
    /// Name of the datum feature.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub datum: Option<String>,
    /// The fit by which it is judged.
    pub fit: ZoneFit,
    /// Its largest value, um.
    pub tolerance_um: Option<f64>,
    /// Number of its points that are reached.
    pub poses: usize,
    /// Number of its points, and those of its datum, that are not.
    pub unreached: usize,
    /// The reason why the points in reach do not carry it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lacks: Option<String>,
    /// Its value by the errors that have values, um.
    pub value_um: Option<f64>,
    /// Width of the narrowest zone, um; none where nothing is fitted.
    pub minimum_zone_um: Option<f64>,
    /// Width of the zone about the least-squares feature, um; none where nothing is fitted.
    pub least_squares_um: Option<f64>,
    /// Interval of the value by the uncertainty of the errors, 95 %, um.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval_um: Option<[f64; 2]>,
    /// True if the value is within the tolerance; none where it is, but points are out of reach.
    pub holds: Option<bool>,
    /// The values of machines drawn between the bounds of errors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drawn: Option<DrawnCharacteristic>,
    /// The parts of errors in the value, or in the 95 % value of the machines drawn, largest first.
    pub errors: Vec<CharacteristicPart>,
}

/// A characteristic over machines drawn between the bounds of errors.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DrawnCharacteristic {
    /// Number of machines drawn.
    pub samples: usize,
    /// Median, um.
    pub median_um: f64,
    /// The value that 95 % of the machines do not exceed, um, with its 95 % confidence interval.
    pub p95_um: Percentile,
    /// The fraction of the machines that hold the tolerance at the points in reach, with its 95 % interval (Wilson):
    /// while points are out of reach, an upper limit.
    pub holds: Option<Proportion>,
}

/// The part of an error in a characteristic.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CharacteristicPart {
    /// Name of the error; `values` for all errors with values beside bounds.
    pub error: String,
    /// Its part, um, first order; the parts of all errors sum up to the value.
    pub um: f64,
    /// The same as a fraction of the value.
    pub share: f64,
}
