//! Limits that follow what the readings show: sizes of errors that are plausible for this machine, and uncertainties of
//! its prediction that are of use.

use super::fitted::FitDiagnosis;
use crate::identify::DeviationUncertainty;
use crate::identify::data::LEVER_MM;
use crate::identify::thresholds::{
    MAX_PLAUSIBLE_MM, MAX_PLAUSIBLE_MRAD, MAX_UNCERTAINTY_OVER_RESIDUALS, MAX_UNCERTAINTY_SHARE, MAX_USUAL_MM,
    PLAUSIBLE_OVER_RMS,
};
use crate::syntax::{IdentifyEntry, PlausibleEntry, Scalar};
use crate::units::significant;

/// Returns the request with the sizes of errors that the readings show (mm); `None` if they show none beyond the usual.
pub(crate) fn plausible_request(request: &IdentifyEntry, shown: f64) -> Option<IdentifyEntry> {
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
pub(crate) fn useful(fitted: &FitDiagnosis<'_>) -> f64 {
    (MAX_UNCERTAINTY_SHARE * fitted.prediction.deviation).max(MAX_UNCERTAINTY_OVER_RESIDUALS * fitted.residuals.after)
}

/// True if the data hold the prediction.
pub(crate) fn holds_prediction(fitted: &FitDiagnosis<'_>) -> bool {
    match fitted.prediction.uncertainty {
        DeviationUncertainty::Known(size) => size <= useful(fitted),
        // With as many readings as unknowns nothing contradicts it.
        DeviationUncertainty::Unknown => true,
        DeviationUncertainty::Free(_) => false,
    }
}
