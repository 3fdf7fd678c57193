//! A single value as written: a bare number or text such as `12 um`.

use crate::units;
use std::fmt;

/// A number without, or a text with, a unit.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(untagged)]
pub enum Scalar {
    /// A bare number; may be infinite or NaN.
    Number(f64),
    /// Anything else.
    Text(String),
}

impl fmt::Display for Scalar {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Text(text) => f.write_str(text),
        }
    }
}

impl Scalar {
    /// True if it is written in inches.
    pub fn is_in_inches(&self) -> bool {
        match self {
            Self::Text(text) => {
                let word = text.trim_end().rsplit(|c: char| !c.is_alphabetic()).next();
                let inch = units::unit("in").ok();
                word.and_then(|word| units::unit(word).ok()).is_some_and(|unit| Some(unit) == inch)
            }
            Self::Number(_) => false,
        }
    }
}
