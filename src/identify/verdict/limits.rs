//! Limits that follow what the readings show: sizes of errors that are plausible for this machine, and uncertainties of
//! its prediction that are of use.

use super::fitted::FitDiagnosis;
use crate::identify::DeviationUncertainty;
use crate::identify::data::LEVER_MM;
use crate::identify::thresholds::{MAX_UNCERTAINTY_OVER_RESIDUALS, MAX_UNCERTAINTY_SHARE, PLAUSIBLE_OVER_RMS};
use crate::machine::{Direction, largest, largest_stated};
use crate::syntax::{IdentifyEntry, PlausibleEntry, Scalar};
use crate::units::significant;

/// Returns the request with the sizes of errors that the readings show (mm); `None` if they show none beyond the usual.
pub(crate) fn plausible_request(request: &IdentifyEntry, initial_rms: f64) -> Option<IdentifyEntry> {
    let reach = PLAUSIBLE_OVER_RMS * initial_rms;
    if reach <= largest(Direction::X) {
        return None;
    }
    // To two digits, upwards.
    let up = |value: f64| significant(1.05 * value, 2);
    let length = Some(Scalar::Text(format!("{} mm", up(reach.min(largest_stated(Direction::X) / 1.1)))));
    let [usual, stated] = [largest, largest_stated].map(|of| of(Direction::A) * 1e3);
    let angle = (reach / LEVER_MM * 1e3).max(usual).min(stated / 1.1);
    let plausible = Some(PlausibleEntry { length, angle: Some(Scalar::Text(format!("{} mrad", up(angle)))) });
    Some(IdentifyEntry { plausible, ..request.clone() })
}

/// Returns the uncertainty (mm) up to which a prediction is of use.
pub(crate) fn useful(fitted: &FitDiagnosis<'_>) -> f64 {
    (MAX_UNCERTAINTY_SHARE * fitted.prediction.deviation).max(MAX_UNCERTAINTY_OVER_RESIDUALS * fitted.residuals.after)
}

pub(crate) fn holds_prediction(fitted: &FitDiagnosis<'_>) -> bool {
    match fitted.prediction.uncertainty {
        DeviationUncertainty::Known(size) => size <= useful(fitted),
        // With as many readings as unknowns nothing contradicts it.
        DeviationUncertainty::Unknown => true,
        DeviationUncertainty::Free(_) => false,
    }
}
