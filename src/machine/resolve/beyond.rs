//! The course of curves beyond their points, as noted until all are read.

use crate::diagnostic::Place;
use crate::machine::{AxisKind, ErrorId};

/// The course of a curve beyond its points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Beyond {
    /// The last value holds.
    Hold,
    /// The last slope goes on.
    Slope,
    /// The curve is refused.
    Refuse,
}

impl Beyond {
    /// Its words in a file.
    pub const WORDS: [&'static str; 3] = ["hold", "slope", "refuse"];
}

/// A curve that goes on beyond its points.
#[derive(Debug, Clone, PartialEq)]
pub struct ShortCurve {
    pub error: ErrorId,
    pub kind: AxisKind,
    /// First and last point (mm, deg).
    pub measured: (f64, f64),
    pub travel: (f64, f64),
    pub beyond: Beyond,
    /// True if the file says so.
    pub is_stated: bool,
    pub place: Option<Place>,
    pub travel_place: Option<Place>,
}
