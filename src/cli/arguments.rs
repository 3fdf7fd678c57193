//! Arguments that are more than numbers and words.

use abbe::text::parse_length;

/// Reason why a text is not a valid argument.
#[derive(Debug)]
pub(super) struct Unfit(pub String);

impl std::fmt::Display for Unfit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Unfit {}

/// Parses a length in mm. Fails with `remedy` as the message if `fits` refuses it.
pub(super) fn length(text: &str, fits: impl Fn(f64) -> bool, remedy: &str) -> Result<f64, Unfit> {
    let length = parse_length(text).map_err(|failure| Unfit(failure.to_string()))?;
    length.filter(|mm| fits(*mm)).ok_or_else(|| Unfit(remedy.to_owned()))
}
