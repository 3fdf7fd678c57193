//! Arguments that are more than numbers and words.

use abbe::text::{Reason, parse_length};

/// A length in mm that fits; `remedy` is the message for another.
pub(super) fn length(text: &str, fits: impl Fn(f64) -> bool, remedy: &str) -> Result<f64, Reason> {
    let length = parse_length(text).map_err(Reason::new)?;
    length.filter(|mm| fits(*mm)).ok_or_else(|| Reason::new(remedy))
}
