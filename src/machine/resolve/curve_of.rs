//! The error, axis and sign of a curve whose form is read.

use super::axes::AxisDraft;
use crate::machine::{AxisKind, ErrorId, Travel};

/// A curve in the making: of which error, on which axis, with which sign.
pub struct CurveOf<'a> {
    pub error: &'a ErrorId,
    pub axis: &'a AxisDraft,
    pub kind: AxisKind,
    pub negated: bool,
}

impl CurveOf<'_> {
    /// Returns -1 of an error that is given in the opposite direction, else 1.
    pub fn sign(&self) -> f64 {
        if self.negated { -1.0 } else { 1.0 }
    }

    /// True if its axis has no ends.
    pub fn continuous(&self) -> bool {
        self.axis.travel == Some(Travel::Continuous)
    }
}
