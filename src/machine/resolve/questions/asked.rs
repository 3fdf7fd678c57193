//! One question, and the sizes that several of them share.

use crate::diagnostic::{Diagnostic, codes};
use crate::syntax::{Document, Keys};
use crate::units::significant;

/// A rotation of a location error from which on it is as a rule in another unit, rad: 1000 arcsec.
pub(super) const WIDE_LOCATION: f64 = 5e-3;
/// A displacement (mm) and a rotation (rad) below which a bound, or all values of a table, are as a rule in a larger
/// unit: no instrument of a workshop reads that.
pub(super) const TINY: [f64; 2] = [1e-4, 5e-8];

/// Returns a question about what stands at a place of the file.
pub(super) fn ask(document: &Document, at: &Keys, message: String, help: impl Into<String>) -> Diagnostic {
    Diagnostic::new(codes::W0413, message).at(document.places.key(at), "").help(help)
}

/// Returns an angle (rad) in a unit and in arcseconds: `31.4 mrad, 6480 arcsec`.
pub(super) fn angle(value: f64, per_rad: f64, unit: &str) -> String {
    let [of, arcsec] = [value * per_rad, value.to_degrees() * 3600.0].map(|x| significant(x, 3));
    format!("{of} {unit}, {arcsec} arcsec")
}
