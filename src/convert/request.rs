//! A conversion to make, and what it asks of the errors.

use crate::diagnostic::{Diagnostic, codes};
use crate::machine::{Axis, AxisName, Conventions, Location};

/// Differences that count as zero: a femtometre, and the same over a metre.
pub(super) const TINY: [f64; 2] = [1e-12, 1e-15];

/// Difference (mm) that is rounding: of positions of some metres, in matrices multiplied and taken apart again.
pub const ROUNDING: f64 = 1e-9;

/// A conversion to make.
#[derive(Debug, Clone)]
pub struct ConversionRequest {
    /// The new conventions.
    pub conventions: Conventions,
    /// `axis_only`: the axis from whose actual line location errors count, instead of the machine frame.
    pub datum: Option<AxisName>,
    /// Allowed difference of the machines (mm; rotations: this over a metre). Above [`ROUNDING`], tables may get more
    /// points.
    pub within_mm: f64,
}

/// The refusal of a tolerance that would have to become part of other errors.
pub(super) fn tolerance_refusal(what: &str) -> Diagnostic {
    let message = format!("`{what}` is only bounded by a tolerance, and would become part of several other errors");
    let help = "give it a value, leave it out, or keep the convention that it would have to change";
    Diagnostic::new(codes::E0527, message).help(help)
}

/// True if the error motion changes its side of the nominal motion.
pub(super) fn changes_side(axis: &Axis, old: &Conventions, new: &Conventions) -> bool {
    axis.convention(old).component.side != axis.convention(new).component.side
}

/// True if location errors must be regrouped.
pub(super) fn regroups(old: &Conventions, request: &ConversionRequest) -> bool {
    old.location != request.conventions.location
        || request.datum.is_some()
        || (old.location == Location::CarriedBody && old.errors_are != request.conventions.errors_are)
}
