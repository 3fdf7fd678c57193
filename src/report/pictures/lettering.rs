//! Text and numbers in pictures: fonts, colours, anchors.

use super::point::Point;

/// Anchor of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextAnchor {
    /// It begins at the point.
    Start,
    /// It is centred on the point.
    Middle,
    /// It ends at the point.
    End,
}

/// Font of a text: size in px, weight, colour.
#[derive(Debug, Clone, Copy)]
pub struct Font {
    /// Height in px.
    pub size: f64,
    /// True for bold text.
    pub bold: bool,
    /// Any CSS colour.
    pub colour: &'static str,
}

/// Colour of lines and text.
pub const INK: &str = "#1f2933";

/// Colour of text in the background.
pub const FAINT: &str = "#5f6b76";

/// Colour of lines across a diagram.
pub const LINE: &str = "#c3cad1";

/// Colours of curves and bars: of the first, of the second, of the third kind. A page maps them to its own.
pub const FIRST: &str = "#1d5fa8";
/// Colour of the second kind.
pub const SECOND: &str = "#b8590f";
/// Colour of the third kind.
pub const THIRD: &str = "#1c7a3d";

impl Font {
    /// Plain text in ink.
    pub const fn plain(size: f64) -> Self {
        Self { size, bold: false, colour: INK }
    }

    /// Bold text in ink.
    pub const fn bold(size: f64) -> Self {
        Self { size, bold: true, colour: INK }
    }

    /// Plain text in the background.
    pub const fn faint(size: f64) -> Self {
        Self { size, bold: false, colour: FAINT }
    }
}

#[derive(Debug, Clone)]
pub(crate) struct Text {
    pub at: Point,
    pub text: String,
    pub font: Font,
    pub anchor: TextAnchor,
    pub turned: f64,
}

/// Formats a value with two decimals at most; a value that is not finite has no place in a picture and becomes 0.
pub fn number(value: f64) -> String {
    if !value.is_finite() {
        return "0".to_owned();
    }
    let text = format!("{value:.2}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}
