//! Bars of a budget: the Pareto chart of contributions, and the waterfall of the parts of the budget.

use super::frame::{PlotAxis, PlotFrame};
use super::svg::{FAINT, FIRST, Font, INK, Picture, Point, SECOND, Svg, TextAnchor, number, polyline, truncate};
use crate::units::Interval;
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

/// The place of a bar, px.
#[derive(Clone, Copy)]
struct BarPlace {
    left: f64,
    width: f64,
}

impl BarPlace {
    fn middle(self) -> f64 {
        self.left + 0.5 * self.width
    }
}

/// Returns the place of bar `i` of `count`.
fn place(i: usize, count: usize) -> BarPlace {
    let pitch = FRAME.width / count.max(1) as f64;
    let width = (pitch * 0.72).min(60.0);
    BarPlace { left: FRAME.left + pitch * (i as f64 + 0.5) - 0.5 * width, width }
}

fn begin(title: &str, subtitle: &str) -> Svg {
    let mut svg = Svg::new(WIDTH, HEIGHT);
    svg.heading(FRAME.left, title, 70, subtitle, 104);
    svg
}

/// The edges of a bar, px.
struct BarEdges {
    low: f64,
    high: f64,
}

/// Draws a bar over an interval of values with its name below.
fn bar(svg: &mut Svg, axis: &PlotAxis, place: BarPlace, values: Interval, label: &str, colour: &str) -> BarEdges {
    let (low, high) = (FRAME.y(axis, values.min), FRAME.y(axis, values.max));
    svg.rect((place.left, high), (place.width, low - high), &format!(r#"fill="{colour}""#));
    let below = FRAME.top + FRAME.height + 14.0;
    svg.text((place.middle() + 4.0, below), &truncate(label, 14), Font::plain(12.0), TextAnchor::End, -45.0);
    BarEdges { low, high }
}

/// Draws the number of a bar: above it or, `inside`, at its foot, where no curve crosses it.
fn value(svg: &mut Svg, place: BarPlace, BarEdges { low, high }: BarEdges, value: f64, inside: bool) {
    let (y, font) = if inside && low - high > 18.0 {
        (low - 6.0, Font { colour: "white", ..Font::plain(11.0) })
    } else {
        (high - 5.0, Font::plain(11.0))
    };
    svg.text((place.middle(), y), &significant(value, 3), font, TextAnchor::Middle, 0.0);
}

impl ParetoPicture {
    /// The picture.
    pub fn picture(&self) -> Picture {
        let mut svg = begin(&self.title, &self.subtitle);
        let highest = self.bars.iter().map(|b| b.value).fold(0.0, f64::max);
        let axis = PlotAxis::new(0.0, highest * 1.08);
        FRAME.vertical(&mut svg, &axis, &self.quantity);
        let fractions = PlotAxis::new(0.0, 100.0);
        let mut sum = 0.0;
        let mut line = vec![];
        for (i, b) in self.bars.iter().enumerate() {
            let place = place(i, self.bars.len());
            let edges = bar(&mut svg, &axis, place, Interval::between(0.0, b.value), &b.label, FIRST);
            value(&mut svg, place, edges, b.value, true);
            sum += b.value * b.value;
            let fraction = if self.total > 0.0 { 100.0 * sum / self.total } else { 0.0 };
            line.push(Point { x: place.middle(), y: FRAME.y(&fractions, fraction) });
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
        let axis = PlotAxis::new(0.0, highest * 1.08);
        FRAME.vertical(&mut svg, &axis, &self.quantity);
        let count = self.bars.len() + self.marks.len() + 1;
        let mut level = 0.0;
        for (i, b) in self.bars.iter().enumerate() {
            let here = place(i, count);
            let colour = if b.value < 0.0 { SECOND } else { FIRST };
            let edges = bar(&mut svg, &axis, here, Interval::between(level, level + b.value), &b.label, colour);
            value(&mut svg, here, edges, b.value, false);
            level += b.value;
            let y = FRAME.y(&axis, level);
            let dashes = format!(r#"stroke="{FAINT}" stroke-width="{}" stroke-dasharray="3 3""#, number(0.8));
            svg.line((here.left + here.width, y), (place(i + 1, count).left, y), &dashes);
        }
        for (i, (label, total)) in self.marks.iter().enumerate() {
            let at = place(self.bars.len() + 1 + i, count);
            let edges =
                bar(&mut svg, &axis, at, Interval::between(0.0, *total), label, if i == 0 { INK } else { GREY });
            value(&mut svg, at, edges, *total, false);
        }
        svg.picture(&format!("{}: {}", self.title, self.subtitle))
    }
}
