//! One question, and the sizes that several of them share.

use crate::diagnostic::{Diagnostic, codes};
use crate::syntax::{Document, Keys};

/// A rotation of a location error from which on it is as a rule in another unit, rad: 1000 arcsec.
pub(super) const WIDE_LOCATION: f64 = 5e-3;
/// A displacement (mm) and a rotation (rad) below which a bound, or all values of a table, are as a rule in a larger
/// unit: no instrument of a workshop reads that.
pub(super) const TINY: [f64; 2] = [1e-4, 5e-8];

/// Returns a question about what stands at a place of the file.
pub(super) fn ask(document: &Document, at: &Keys, message: String, help: impl Into<String>) -> Diagnostic {
    Diagnostic::new(codes::W0413, message).at(document.places.key(at), "").help(help)
}
