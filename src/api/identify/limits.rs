//! Limits that follow what the readings show: sizes of errors that are plausible for this machine, and uncertainties of
//! its prediction that are of use.

use super::Fitted;
use crate::identify::DeviationUncertainty;
use crate::syntax::{IdentifyEntry, PlausibleEntry, Scalar};
use crate::units::significant;

/// Plausible size of an error over the RMS of the readings before the fit, as for the prior of the fit.
const PLAUSIBLE_OVER_RMS: f64 = 3.0;
/// Size (mm) of errors that need no entry in the file.
const MAX_USUAL_MM: f64 = 10.0;
/// Distance (mm) at which a rotation counts as displacement.
const LEVER_MM: f64 = 300.0;
/// Largest length (mm) and angle (mrad) that a file may state as plausible.
const MAX_PLAUSIBLE_MM: f64 = 500.0;
const MAX_PLAUSIBLE_MRAD: f64 = 500.0;
/// Uncertainty over the largest deviation predicted up to which a prediction is of use ...
const MAX_UNCERTAINTY_SHARE: f64 = 0.5;
/// ... or over the RMS of the residuals.
const MAX_UNCERTAINTY_OVER_RESIDUALS: f64 = 10.0;

/// Returns the request with the sizes of errors that the readings show (mm); `None` if they show none beyond the usual.
pub(super) fn plausible_request(request: &IdentifyEntry, shown: f64) -> Option<IdentifyEntry> {
    let reach = PLAUSIBLE_OVER_RMS * shown;
    if reach <= MAX_USUAL_MM {
        return None;
    }
    // To two digits, upwards.
    let up = |value: f64| significant(1.05 * value, 2);
    let length = Some(Scalar::Text(format!("{} mm", up(reach.min(MAX_PLAUSIBLE_MM / 1.1)))));
    let angle = (reach / LEVER_MM * 1e3).max(100.0).min(MAX_PLAUSIBLE_MRAD / 1.1);
    let plausible = Some(PlausibleEntry { length, angle: Some(Scalar::Text(format!("{} mrad", up(angle)))) });
    Some(IdentifyEntry { plausible, ..request.clone() })
}

/// Returns the uncertainty (mm) up to which a prediction is of use.
pub(super) fn useful(fitted: &Fitted<'_>) -> f64 {
    (MAX_UNCERTAINTY_SHARE * fitted.prediction.deviation).max(MAX_UNCERTAINTY_OVER_RESIDUALS * fitted.residuals.after)
}

/// True if the data hold the prediction.
pub(super) fn holds_prediction(fitted: &Fitted<'_>) -> bool {
    match fitted.prediction.uncertainty {
        DeviationUncertainty::Known(size) => size <= useful(fitted),
        // With as many readings as unknowns nothing contradicts it.
        DeviationUncertainty::Unknown => true,
        DeviationUncertainty::Free(_) => false,
    }
}
