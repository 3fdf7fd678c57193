//! Text as outlines, for PNG: no font has to be installed, and the picture is the same everywhere.
//!
//! The outlines are those of DejaVu Sans (`LICENSE`), the font that the SVG pictures name first; written by
//! `generate.py`. Bold is drawn with a stroke. A character that is not there becomes the replacement mark.

use super::lettering::{Text, TextAnchor, number};
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// Units of the outlines for the height of the font.
const EM: f64 = 2048.0;

/// Width of the stroke that makes a letter bold, units.
const BOLD: u32 = 90;

/// Advance and outline (SVG path data, y upwards), in units.
type Glyph = (f64, &'static str);

fn glyphs() -> &'static BTreeMap<char, Glyph> {
    static GLYPHS: OnceLock<BTreeMap<char, Glyph>> = OnceLock::new();
    GLYPHS.get_or_init(|| include_str!("glyphs.txt").lines().filter_map(parse_glyph).collect())
}

fn parse_glyph(line: &'static str) -> Option<(char, Glyph)> {
    let mut parts = line.splitn(3, ' ');
    let character = char::from_u32(u32::from_str_radix(parts.next()?, 16).ok()?)?;
    Some((character, (parts.next()?.parse().ok()?, parts.next().unwrap_or(""))))
}

fn glyph(character: char) -> Glyph {
    let all = glyphs();
    all.get(&character).or_else(|| all.get(&'\u{fffd}')).copied().unwrap_or((0.0, ""))
}

/// A line of text as a group of paths.
pub fn path_elements(text: &Text) -> String {
    let scale = text.font.size / EM;
    let width: f64 = text.text.chars().map(|c| glyph(c).0).sum();
    let start = match text.anchor {
        TextAnchor::Start => 0.0,
        TextAnchor::Middle => -0.5 * width,
        TextAnchor::End => -width,
    };
    let (x, y, colour) = (number(text.at.x), number(text.at.y), text.font.colour);
    let stroke = if text.font.bold { format!(r#" stroke="{colour}" stroke-width="{BOLD}""#) } else { String::new() };
    let turn = if text.turned == 0.0 { String::new() } else { format!(" rotate({})", number(text.turned)) };
    let mut out =
        format!(r#"<g fill="{colour}"{stroke} transform="translate({x} {y}){turn} scale({scale} -{scale})">"#);
    let mut pen = start;
    for character in text.text.chars() {
        let (advance, outline) = glyph(character);
        if !outline.is_empty() {
            out.push_str(&format!(r#"<path transform="translate({})" d="{outline}"/>"#, number(pen)));
        }
        pen += advance;
    }
    out.push_str("</g>\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_our_pictures_say_has_an_outline() {
        assert!(glyphs().len() > 400);
        for character in "AZaz09 .,-−+±×µ°′″·|()[]=:;/%'…→\u{a0}\u{202f}äßéøŁΔμЖ".chars() {
            assert!(glyphs().contains_key(&character), "{character:?}");
        }
        assert_eq!(glyph('\u{4e2d}'), glyph('\u{fffd}'));
        assert_eq!(glyph('1').0, 1303.0);
    }
}
