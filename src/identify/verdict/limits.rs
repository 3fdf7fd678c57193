//! Limits that follow what the readings show: sizes of errors that are plausible for this machine, and uncertainties of
//! its prediction that are of use.

use super::fitted::Fitted;
use crate::identify::Spread;
use crate::syntax::{IdentifyEntry, PlausibleEntry, Scalar};
use crate::units::significant;

/// Errors may be this many times the root mean square of what the readings are off the machine.
const USUAL: f64 = 3.0;
/// Errors (mm) that need no word in the file.
const SMALL: f64 = 10.0;
/// Distance (mm) at which a rotation counts as displacement, and the largest rotation (mrad) that a file may state.
const ROTATED: (f64, f64) = (300.0, 500.0);
/// The same for lengths (mm).
const LARGEST: f64 = 500.0;
/// An uncertainty is of use up to this share of the largest deviation predicted ...
const USEFUL: f64 = 0.5;
/// ... or up to so many times what the fit leaves of the readings.
const RESIDUALS: f64 = 10.0;

/// The request with the sizes of errors that the readings show (mm); `None` if they show none beyond the usual.
pub(crate) fn shown(request: &IdentifyEntry, shown: f64) -> Option<IdentifyEntry> {
    let reach = USUAL * shown;
    if reach <= SMALL {
        return None;
    }
    // To two digits, upwards.
    let up = |value: f64| significant(1.05 * value, 2);
    let length = Some(Scalar::Text(format!("{} mm", up(reach.min(LARGEST / 1.1)))));
    let angle = (reach / ROTATED.0 * 1e3).max(100.0).min(ROTATED.1 / 1.1);
    let plausible = Some(PlausibleEntry { length, angle: Some(Scalar::Text(format!("{} mrad", up(angle)))) });
    Some(IdentifyEntry { plausible, ..request.clone() })
}

/// The uncertainty (mm) up to which a prediction is of use.
pub(crate) fn useful(fitted: &Fitted<'_>) -> f64 {
    (USEFUL * fitted.prediction.deviation).max(RESIDUALS * fitted.residuals.after)
}

/// True if the data hold the prediction.
pub(crate) fn held(fitted: &Fitted<'_>) -> bool {
    match fitted.prediction.spread {
        Spread::Known(size) => size <= useful(fitted),
        // With as many readings as unknowns nothing contradicts it.
        Spread::Unknown => true,
        Spread::Free(_) => false,
    }
}
