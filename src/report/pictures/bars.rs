//! Bars of a budget: the Pareto chart of contributions, and the waterfall of the parts of the budget.

use super::frame::{Axis, PlotFrame};
use super::svg::{Anchor, FAINT, FIRST, Font, INK, Picture, SECOND, Svg, fitted, number, polyline};
use crate::units::significant;

/// A labelled value.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// Its name.
    pub label: String,
    /// Its height.
    pub value: f64,
}

/// Contributions, largest first, and how they add up as root of the sum of squares.
#[derive(Debug, Clone)]
pub struct ParetoPicture {
    /// The first line.
    pub title: String,
    /// The second line.
    pub subtitle: String,
    /// Quantity of the values, with its unit.
    pub quantity: String,
    /// Largest first.
    pub bars: Vec<Bar>,
    /// Sum of the squares of all, also of those that are not drawn.
    pub total: f64,
}

/// Parts one on top of the other up to their sum, and totals beside them.
#[derive(Debug, Clone)]
pub struct WaterfallPicture {
    /// The first line.
    pub title: String,
    /// The second line.
    pub subtitle: String,
    /// Quantity of the values, with its unit.
    pub quantity: String,
    /// Bars in the order they are stacked.
    pub bars: Vec<Bar>,
    /// Totals, in the order of the picture.
    pub marks: Vec<(String, f64)>,
}

const WIDTH: f64 = 880.0;
const HEIGHT: f64 = 460.0;
const FRAME: PlotFrame = PlotFrame { left: 78.0, top: 84.0, width: 740.0, height: 270.0 };
const GREY: &str = "#8a94a0";

/// Returns the start of column `i` of `count`, and the width of its bar.
fn column(i: usize, count: usize) -> (f64, f64) {
    let pitch = FRAME.width / count.max(1) as f64;
    let width = (pitch * 0.72).min(60.0);
    (FRAME.left + pitch * (i as f64 + 0.5) - 0.5 * width, width)
}

fn begin(title: &str, subtitle: &str) -> Svg {
    let mut svg = Svg::new(WIDTH, HEIGHT);
    svg.heading(FRAME.left, (title, 70), (subtitle, 104));
    svg
}

/// A bar from one value to another with its name below; returns its lower and upper edge.
fn bar(svg: &mut Svg, axis: &Axis, place: (f64, f64), (from, to): (f64, f64), label: &str, colour: &str) -> (f64, f64) {
    let (x, width) = place;
    let (low, high) = (FRAME.y(axis, from.min(to)), FRAME.y(axis, from.max(to)));
    svg.rect((x, high), (width, low - high), &format!(r#"fill="{colour}""#));
    let middle = x + 0.5 * width;
    let below = FRAME.top + FRAME.height + 14.0;
    svg.text((middle + 4.0, below), &fitted(label, 14), Font::plain(12.0), Anchor::End, -45.0);
    (low, high)
}

/// Draws the number of a bar: above it or, `inside`, at its foot, where no curve crosses it.
fn value(svg: &mut Svg, place: (f64, f64), (low, high): (f64, f64), value: f64, inside: bool) {
    let middle = place.0 + 0.5 * place.1;
    let (y, font) = if inside && low - high > 18.0 {
        (low - 6.0, Font { colour: "white", ..Font::plain(11.0) })
    } else {
        (high - 5.0, Font::plain(11.0))
    };
    svg.text((middle, y), &significant(value, 3), font, Anchor::Middle, 0.0);
}

impl ParetoPicture {
    /// The picture.
    pub fn picture(&self) -> Picture {
        let mut svg = begin(&self.title, &self.subtitle);
        let highest = self.bars.iter().map(|b| b.value).fold(0.0, f64::max);
        let axis = Axis::new(0.0, highest * 1.08);
        FRAME.vertical(&mut svg, &axis, &self.quantity);
        let fractions = Axis::new(0.0, 100.0);
        let mut sum = 0.0;
        let mut line = vec![];
        for (i, b) in self.bars.iter().enumerate() {
            let place = column(i, self.bars.len());
            let edges = bar(&mut svg, &axis, place, (0.0, b.value), &b.label, FIRST);
            value(&mut svg, place, edges, b.value, true);
            sum += b.value * b.value;
            let fraction = if self.total > 0.0 { 100.0 * sum / self.total } else { 0.0 };
            line.push((place.0 + 0.5 * place.1, FRAME.y(&fractions, fraction)));
        }
        svg.path(&polyline(&line), &format!(r#"fill="none" stroke="{SECOND}" stroke-width="1.6""#));
        line.iter().for_each(|at| svg.circle(*at, 2.6, &format!(r#"fill="{SECOND}""#)));
        FRAME.right(&mut svg, &fractions, "fraction of the sum of squares in %", SECOND);
        svg.picture(&format!("{}: {}", self.title, self.subtitle))
    }
}

impl WaterfallPicture {
    /// The picture.
    pub fn picture(&self) -> Picture {
        let mut svg = begin(&self.title, &self.subtitle);
        let sum: f64 = self.bars.iter().map(|b| b.value).sum();
        let highest = self.marks.iter().map(|m| m.1).fold(sum, f64::max);
        let axis = Axis::new(0.0, highest * 1.08);
        FRAME.vertical(&mut svg, &axis, &self.quantity);
        let count = self.bars.len() + self.marks.len() + 1;
        let mut level = 0.0;
        for (i, b) in self.bars.iter().enumerate() {
            let (x, width) = column(i, count);
            let colour = if b.value < 0.0 { SECOND } else { FIRST };
            let edges = bar(&mut svg, &axis, (x, width), (level, level + b.value), &b.label, colour);
            value(&mut svg, (x, width), edges, b.value, false);
            level += b.value;
            let y = FRAME.y(&axis, level);
            let dashes = format!(r#"stroke="{FAINT}" stroke-width="{}" stroke-dasharray="3 3""#, number(0.8));
            svg.line((x + width, y), (column(i + 1, count).0, y), &dashes);
        }
        for (i, (label, total)) in self.marks.iter().enumerate() {
            let at = column(self.bars.len() + 1 + i, count);
            let edges = bar(&mut svg, &axis, at, (0.0, *total), label, if i == 0 { INK } else { GREY });
            value(&mut svg, at, edges, *total, false);
        }
        svg.picture(&format!("{}: {}", self.title, self.subtitle))
    }
}
