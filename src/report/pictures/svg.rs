//! A small writer of SVG: numbers short and never `-0`, text escaped, no outside resources, the same
//! bytes for the same picture. A finished [`Picture`] can be had as PNG too, its text as outlines.

use super::lettering::Text;
pub use super::lettering::{FAINT, FIRST, Font, INK, LINE, SECOND, THIRD, TextAnchor, number};
use super::png::{self, PictureFailure};
pub use super::point::Point;

/// A picture in the making; coordinates in px, y downwards.
#[derive(Debug, Clone)]
pub struct Svg {
    width: f64,
    height: f64,
    body: Vec<Piece>,
}

/// A piece of the body: text is kept apart, for it has two written forms.
#[derive(Debug, Clone)]
enum Piece {
    Markup(String),
    Text(Text),
}

impl Svg {
    /// An empty picture on white ground.
    pub fn new(width: f64, height: f64) -> Self {
        Self { width, height, body: Vec::new() }
    }

    /// Adds an element whose attributes are ours (nothing of the user's may be in them).
    pub fn element(&mut self, name: &str, attributes: &str) {
        self.markup(format!("<{name} {attributes}/>\n"));
    }

    fn markup(&mut self, text: String) {
        match self.body.last_mut() {
            Some(Piece::Markup(body)) => body.push_str(&text),
            _ => self.body.push(Piece::Markup(text)),
        }
    }

    /// Puts the drawing of `draw` into a group with these attributes (ours, like those of [`Self::element`]).
    pub fn group(&mut self, attributes: &str, draw: impl FnOnce(&mut Self)) {
        self.markup(format!("<g {attributes}>\n"));
        draw(self);
        self.markup("</g>\n".to_owned());
    }

    /// Puts another picture here, enlarged by `times`.
    pub fn place(&mut self, corner: impl Into<Point>, times: f64, other: Self) {
        let corner = corner.into();
        let transform = format!(r#"transform="translate({} {}) scale({times})""#, number(corner.x), number(corner.y));
        self.group(&transform, |svg| {
            for piece in other.body {
                match piece {
                    Piece::Markup(text) => svg.markup(text),
                    text @ Piece::Text(_) => svg.body.push(text),
                }
            }
        });
    }

    /// Width and height, px.
    pub fn size(&self) -> (f64, f64) {
        (self.width, self.height)
    }

    /// A straight line.
    pub fn line(&mut self, from: impl Into<Point>, to: impl Into<Point>, style: &str) {
        let (from, to) = (from.into(), to.into());
        let (x1, y1, x2, y2) = (number(from.x), number(from.y), number(to.x), number(to.y));
        self.element("line", &format!(r#"x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" {style}"#));
    }

    /// An upright rectangle from its upper left corner.
    pub fn rect(&mut self, corner: impl Into<Point>, size: impl Into<Point>, style: &str) {
        let (corner, size) = (corner.into(), size.into());
        let (x, y, w, h) = (number(corner.x), number(corner.y), number(size.x), number(size.y));
        self.element("rect", &format!(r#"x="{x}" y="{y}" width="{w}" height="{h}" {style}"#));
    }

    /// A circle.
    pub fn circle(&mut self, centre: impl Into<Point>, radius: f64, style: &str) {
        let Point { x, y } = centre.into();
        self.element("circle", &format!(r#"cx="{}" cy="{}" r="{}" {style}"#, number(x), number(y), number(radius)));
    }

    /// A path.
    pub fn path(&mut self, data: &str, style: &str) {
        self.element("path", &format!(r#"d="{data}" {style}"#));
    }

    /// A line with a filled head at its end; shorter than a head, the head alone.
    pub fn arrow(&mut self, from: Point, to: Point, width: f64, colour: &str) {
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        let length = dx.hypot(dy);
        if length < 0.5 {
            return;
        }
        let head = (width * 4.5).min(length);
        let (ux, uy) = (dx / length, dy / length);
        let neck = Point { x: to.x - ux * head, y: to.y - uy * head };
        self.line(from, neck, &format!(r#"stroke="{colour}" stroke-width="{}""#, number(width)));
        let half = head * 0.38;
        let side = |half: f64| Point { x: neck.x - uy * half, y: neck.y + ux * half };
        let points = [to, side(half), side(-half)];
        self.path(&polygon(&points), &format!(r#"fill="{colour}""#));
    }

    /// A line of text; `turned` by that many degrees about its point. Escaped here.
    pub fn text(&mut self, at: impl Into<Point>, text: &str, font: Font, anchor: TextAnchor, turned: f64) {
        self.body.push(Piece::Text(Text { at: at.into(), text: text.to_owned(), font, anchor, turned }));
    }

    /// Draws the two lines at the top, each cut to a number of characters.
    pub fn heading(&mut self, left: f64, title: &str, title_room: usize, subtitle: &str, subtitle_room: usize) {
        self.text((left, 32.0), &truncate(title, title_room), Font::bold(18.0), TextAnchor::Start, 0.0);
        self.text((left, 54.0), &truncate(subtitle, subtitle_room), Font::faint(13.0), TextAnchor::Start, 0.0);
    }

    /// Returns the finished picture. `title` is the text for screen readers.
    pub fn picture(self, title: &str) -> Picture {
        Picture { drawing: self, title: title.to_owned() }
    }

    /// The file, its texts written by `write`.
    fn file(&self, title: &str, write: impl Fn(&Text) -> String) -> String {
        let body: String = self
            .body
            .iter()
            .map(|piece| match piece {
                Piece::Markup(text) => text.clone(),
                Piece::Text(text) => write(text),
            })
            .collect();
        format!(
            concat!(
                r#"<svg xmlns="http://www.w3.org/2000/svg" width="{w}" height="{h}" viewBox="0 0 {w} {h}" "#,
                r#"font-family="'DejaVu Sans', Verdana, Helvetica, Arial, sans-serif" role="img">"#,
                "\n<title>{title}</title>\n",
                r#"<rect x="0" y="0" width="{w}" height="{h}" fill="white"/>"#,
                "\n{body}</svg>\n"
            ),
            w = number(self.width),
            h = number(self.height),
            title = escape(title),
            body = body,
        )
    }
}

fn text_element(text: &Text) -> String {
    let (x, y) = (number(text.at.x), number(text.at.y));
    let anchor = match text.anchor {
        TextAnchor::Start => "",
        TextAnchor::Middle => r#" text-anchor="middle""#,
        TextAnchor::End => r#" text-anchor="end""#,
    };
    let weight = if text.font.bold { r#" font-weight="bold""# } else { "" };
    let turn = if text.turned == 0.0 {
        String::new()
    } else {
        format!(r#" transform="rotate({} {x} {y})""#, number(text.turned))
    };
    let (size, colour, words) = (number(text.font.size), text.font.colour, escape(&text.text));
    format!("<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" fill=\"{colour}\"{weight}{anchor}{turn}>{words}</text>\n")
}

/// A finished picture.
#[derive(Debug, Clone)]
pub struct Picture {
    drawing: Svg,
    title: String,
}

impl Picture {
    /// Returns the bytes of an SVG file.
    pub fn svg(&self) -> String {
        self.drawing.file(&self.title, text_element)
    }

    /// Returns a PNG file, two pixels for a px; fails if the picture cannot be rasterised, and in a build without the
    /// feature `png`.
    pub fn png(&self) -> Result<Vec<u8>, PictureFailure> {
        png::pixels(|write_text| self.drawing.file(&self.title, write_text))
    }
}

/// Data of a closed path.
pub fn polygon(points: &[Point]) -> String {
    let mut data = polyline(points);
    data.push('Z');
    data
}

/// Data of an open path.
pub fn polyline(points: &[Point]) -> String {
    let step = |(i, p): (usize, &Point)| format!("{}{} {}", if i == 0 { "M" } else { "L" }, number(p.x), number(p.y));
    points.iter().enumerate().map(step).collect()
}

/// Text as XML takes it, in elements and in quoted attributes.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            // XML 1.0 has no place for these.
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// Lines of at most `longest` characters, broken at blanks; a longer word is cut.
pub fn wrap(text: &str, longest: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let word = truncate(word, longest);
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= longest => {
                line.push(' ');
                line.push_str(&word);
            }
            _ => lines.push(word),
        }
    }
    lines
}

/// Returns at most `longest` characters, cut with an ellipsis.
pub fn truncate(text: &str, longest: usize) -> String {
    if text.chars().count() <= longest {
        return text.to_owned();
    }
    text.chars().take(longest.saturating_sub(1)).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_text_is_harmless() {
        assert_eq!([-0.001, 1.5, 100.0, f64::NAN].map(number), ["0", "1.5", "100", "0"]);
        assert_eq!(escape("</script>&\"'\u{1}"), "&lt;/script&gt;&amp;&quot;&#39;\u{fffd}");
        assert_eq!(wrap("a bc def", 4), ["a bc", "def"]);
        assert_eq!(truncate("abcdef", 4), "abc…");
    }
}
