//! Values, diagnostics and quantities as text.

pub use super::check::annotations;
pub use crate::controller::micro;
pub use crate::diagnostic::{Reason, Rendering, did_you_mean, render, shown, summary as counts};
pub use crate::evaluate::UnknownOrder;
pub use crate::job::poses::axes_text;
pub use crate::report::cell;
pub use crate::standards::NOT_VERIFIED;
pub use crate::units::{
    Failure as UnknownQuantity, angle, by_uncertainty, counted, ends, fold, fold_beside, length, number, significant,
    with_interval, with_sigma, within,
};

/// Parses a length with its unit, such as `2 um`, mm.
///
/// Fails for a text that is no quantity; returns none for a quantity that is no length.
pub fn parse_length(text: &str) -> Result<Option<f64>, UnknownQuantity> {
    crate::units::quantity(text).map(|quantity| quantity.as_length())
}
