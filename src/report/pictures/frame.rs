//! The rectangle a diagram is drawn in, and its axes, for pictures of curves and bars.

use super::scale::{round_step, tick_text, ticks};
use super::svg::{FAINT, Font, INK, LINE, Point, Svg, TextAnchor};
use crate::units::Interval;

/// Values along one side of a frame.
#[derive(Debug, Clone, Copy)]
pub struct PlotAxis {
    min: f64,
    max: f64,
    /// Angles in degrees: their round steps divide a turn.
    turns: bool,
}

/// A rectangle in px.
#[derive(Debug, Clone, Copy)]
pub struct PlotFrame {
    /// Its left edge.
    pub left: f64,
    /// Its upper edge.
    pub top: f64,
    /// Its width.
    pub width: f64,
    /// Its height.
    pub height: f64,
}

impl PlotAxis {
    /// Axis from a smallest to a largest value; an interval of no width is widened.
    pub fn new(min: f64, max: f64) -> Self {
        Self { min, max: if max > min { max } else { min + 1.0 }, turns: false }
    }

    /// The same for angles in degrees.
    pub fn degrees(min: f64, max: f64) -> Self {
        Self { turns: true, ..Self::new(min, max) }
    }

    fn fraction(&self, value: f64) -> f64 {
        (value - self.min) / (self.max - self.min)
    }

    fn ticks(&self, length: f64, pitch: f64) -> (Vec<f64>, f64) {
        let (range, max_steps) = (self.max - self.min, ((length / pitch) as usize).clamp(1, 10));
        let round = [5.0, 10.0, 15.0, 30.0, 45.0, 90.0].into_iter().find(|step| range <= step * max_steps as f64);
        let step = round.filter(|_| self.turns && range > 20.0).unwrap_or_else(|| round_step(range, max_steps));
        (ticks(Interval::new(self.min, self.max), step), step)
    }
}

impl PlotFrame {
    /// Returns the y coordinate of a value, px.
    pub fn y(&self, axis: &PlotAxis, value: f64) -> f64 {
        self.top + self.height * (1.0 - axis.fraction(value))
    }

    /// Returns the x coordinate of a value, px.
    pub fn x(&self, axis: &PlotAxis, value: f64) -> f64 {
        self.left + self.width * axis.fraction(value)
    }

    /// Returns the point of a pair of values.
    pub fn point(&self, across: &PlotAxis, x: f64, up: &PlotAxis, y: f64) -> Point {
        Point { x: self.x(across, x), y: self.y(up, y) }
    }

    /// The axis at the lower edge.
    pub fn horizontal(&self, svg: &mut Svg, axis: &PlotAxis, name: &str) {
        let (values, step) = axis.ticks(self.width, 70.0);
        let edge = self.top + self.height;
        for value in values {
            let x = self.x(axis, value);
            svg.line((x, edge), (x, edge + 5.0), &format!(r#"stroke="{INK}""#));
            svg.text((x, edge + 19.0), &tick_text(value, step), Font::plain(12.0), TextAnchor::Middle, 0.0);
        }
        svg.text((self.left + self.width / 2.0, edge + 38.0), name, Font::plain(13.0), TextAnchor::Middle, 0.0);
    }

    /// The axis at the left edge with faint lines across, and the border.
    pub fn vertical(&self, svg: &mut Svg, axis: &PlotAxis, name: &str) {
        let (values, step) = axis.ticks(self.height, 40.0);
        for value in values {
            let y = self.y(axis, value);
            svg.line((self.left, y), (self.left + self.width, y), &format!(r#"stroke="{LINE}" stroke-width="0.7""#));
            svg.line((self.left - 5.0, y), (self.left, y), &format!(r#"stroke="{INK}""#));
            svg.text((self.left - 9.0, y + 4.0), &tick_text(value, step), Font::plain(12.0), TextAnchor::End, 0.0);
        }
        svg.rect((self.left, self.top), (self.width, self.height), &format!(r#"fill="none" stroke="{FAINT}""#));
        svg.text((self.left - 56.0, self.top + self.height / 2.0), name, Font::plain(13.0), TextAnchor::Middle, -90.0);
    }

    /// An axis at the right edge.
    pub fn right(&self, svg: &mut Svg, axis: &PlotAxis, name: &str, colour: &'static str) {
        let (values, step) = axis.ticks(self.height, 40.0);
        let (edge, font) = (self.left + self.width, Font { colour, ..Font::plain(12.0) });
        for value in values {
            let y = self.y(axis, value);
            svg.line((edge, y), (edge + 5.0, y), &format!(r#"stroke="{colour}""#));
            svg.text((edge + 9.0, y + 4.0), &tick_text(value, step), font, TextAnchor::Start, 0.0);
        }
        svg.text((edge + 48.0, self.top + self.height / 2.0), name, font, TextAnchor::Middle, -90.0);
    }
}
