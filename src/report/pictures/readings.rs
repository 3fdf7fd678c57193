//! Diagrams of instruments' readings along a path: an R-test over the turn of a rotary axis, a laser along the
//! diagonals there and back. All panels of a picture have one scale.

use super::frame::{PlotAxis, PlotFrame};
use super::polar::{Dial, Stroke};
use super::svg::{FIRST, Font, Picture, Point, SECOND, Svg, THIRD, TextAnchor, polyline};
use crate::analysis::instrument::{Diagonal, RTest};
use crate::units::significant;

/// R-tests of several axes, one below the other.
#[derive(Debug, Clone, Copy)]
pub struct RTestPicture<'a> {
    /// The first line.
    pub title: &'a str,
    /// The second line.
    pub subtitle: &'a str,
    /// The tests.
    pub tests: &'a [RTest],
}

/// The diagonals of a volume, side by side.
#[derive(Debug, Clone, Copy)]
pub struct DiagonalPicture<'a> {
    /// The first line.
    pub title: &'a str,
    /// The second line.
    pub subtitle: &'a str,
    /// The diagonals.
    pub diagonals: &'a [Diagonal],
}

pub(super) const LEFT: f64 = 24.0;
pub(super) const TOP: f64 = 92.0;
const WIDTH: f64 = 920.0;
/// Width beside a frame for its axis.
pub(super) const MARGIN: f64 = 66.0;
const COMPONENTS: [(&str, Stroke); 3] = [
    ("dx", Stroke { colour: FIRST, dashes: "" }),
    ("dy", Stroke { colour: SECOND, dashes: "7 3" }),
    ("dz", Stroke { colour: THIRD, dashes: "2 3" }),
];
const WAYS: [(&str, Stroke); 2] =
    [("there", Stroke { colour: FIRST, dashes: "" }), ("back", Stroke { colour: SECOND, dashes: "7 3" })];

pub(super) fn begin(title: &str, subtitle: &str, height: f64) -> Svg {
    let mut svg = Svg::new(WIDTH, height);
    svg.heading(LEFT, title, 70, subtitle, 120);
    svg
}

/// An axis with zero and all values in it; differences below a picometre are rounding.
fn scale(values: impl Iterator<Item = f64>) -> PlotAxis {
    let (min, max) = values.fold((0.0_f64, 0.0_f64), |(min, max), x| (min.min(x), max.max(x)));
    let air = 0.06 * (max - min).max(1e-6);
    PlotAxis::new(min - air, max + air)
}

/// Points of a curve, joined; dots too if there are few of them.
fn curve(svg: &mut Svg, points: &[Point], stroke: Stroke) {
    svg.path(&polyline(points), &stroke.style(1.7));
    if points.len() <= 40 {
        points.iter().for_each(|point| svg.circle(*point, 2.1, &format!(r#"fill="{}""#, stroke.colour)));
    }
}

/// Stretches without a gap, as index ranges: between them are positions that could not be read.
fn stretches(positions: &[f64]) -> Vec<std::ops::Range<usize>> {
    let step = |i: usize| (positions[i] - positions[i - 1]).abs();
    let least = (1..positions.len()).map(step).fold(f64::INFINITY, f64::min);
    let mut starts: Vec<usize> = vec![0];
    starts.extend((1..positions.len()).filter(|i| step(*i) > 1.5 * least));
    let ends = starts.iter().skip(1).copied().chain([positions.len()]);
    starts.iter().zip(ends).map(|(start, end)| *start..end).collect()
}

impl RTestPicture<'_> {
    /// The picture: on the left the components over the position, on the right about a circle.
    pub fn picture(&self) -> Picture {
        const ROW: f64 = Dial::SIZE + 44.0;
        let height = TOP + ROW * self.tests.len() as f64 + 40.0;
        let mut svg = begin(self.title, self.subtitle, height);
        let all = || self.tests.iter().flat_map(|test| &test.readings).flat_map(|reading| reading.reading_um);
        let (axis, largest) = (scale(all()), all().fold(0.0_f64, |max, x| max.max(x.abs())));
        for (i, test) in self.tests.iter().enumerate() {
            let top = TOP + ROW * i as f64;
            let frame = PlotFrame { left: LEFT + MARGIN, top: top + 16.0, width: 470.0, height: Dial::SIZE - 70.0 };
            let dial = Dial::new(Point { x: LEFT + 730.0, y: top + 0.5 * Dial::SIZE - 12.0 }, largest);
            row(&mut svg, test, frame, &axis, dial);
        }
        let below = height - 34.0;
        let end = COMPONENTS.iter().fold(LEFT + MARGIN, |x, (name, stroke)| stroke.key(&mut svg, x, below, name));
        let note = format!(
            "One ring is {}; the dark circle is zero, outwards is plus.",
            Dial::new(Point { x: 0.0, y: 0.0 }, largest).ring_words()
        );
        svg.text((end + 20.0, below), &note, Font::faint(12.0), TextAnchor::Start, 0.0);
        svg.picture(&format!("{}: {}", self.title, self.subtitle))
    }
}

fn row(svg: &mut Svg, test: &RTest, frame: PlotFrame, axis: &PlotAxis, dial: Dial) {
    let name = &test.axis;
    let positions: Vec<f64> = test.readings.iter().map(|reading| reading.position_deg).collect();
    let ends = (positions.first().copied().unwrap_or(0.0), positions.last().copied().unwrap_or(0.0));
    let across = PlotAxis::degrees(ends.0.min(ends.1), ends.0.max(ends.1));
    let ranges = test.range_um.map(|um| significant(um, 3)).join(", ");
    let title = format!("{name}: ranges {ranges} µm");
    svg.text((frame.left, frame.top - 12.0), &title, Font::bold(13.0), TextAnchor::Start, 0.0);
    frame.vertical(svg, axis, "µm");
    let first = name.split('+').next().unwrap_or(name);
    frame.horizontal(svg, &across, &format!("{first} in degrees"));
    dial.rings(svg, &format!("{first} 0°"), "90°");
    for (k, (_, stroke)) in COMPONENTS.iter().enumerate() {
        for stretch in stretches(&positions) {
            let values = || stretch.clone().map(|i| (positions[i], test.readings[i].reading_um[k]));
            let points: Vec<Point> = values().map(|(q, d)| frame.point(&across, q, axis, d)).collect();
            curve(svg, &points, *stroke);
            dial.curve(svg, values(), false, *stroke);
        }
    }
}

impl DiagonalPicture<'_> {
    /// The picture: the displacement over the travel along each diagonal.
    pub fn picture(&self) -> Picture {
        const PANEL: (f64, f64) = (360.0, 190.0);
        const STEP: (f64, f64) = (444.0, 286.0);
        let rows = self.diagonals.len().div_ceil(2) as f64;
        let height = TOP + STEP.1 * rows + 30.0;
        let mut svg = begin(self.title, self.subtitle, height);
        let axis = scale(self.diagonals.iter().flat_map(|d| d.there_um.iter().chain(&d.back_um)).copied());
        for (i, d) in self.diagonals.iter().enumerate() {
            let (column, line) = ((i % 2) as f64, (i / 2) as f64);
            let (left, top) = (LEFT + MARGIN + STEP.0 * column, TOP + 14.0 + STEP.1 * line);
            let frame = PlotFrame { left, top, width: PANEL.0, height: PANEL.1 };
            panel(&mut svg, d, frame, &axis);
        }
        let below = height - 18.0;
        let end = WAYS.iter().fold(LEFT + MARGIN, |x, (name, stroke)| stroke.key(&mut svg, x, below, name));
        let note =
            "Actual minus nominal travel along the diagonal. p: the axis rises, n: it falls, in the order X, Y, Z.";
        svg.text((end + 20.0, below), note, Font::faint(12.0), TextAnchor::Start, 0.0);
        svg.picture(&format!("{}: {}", self.title, self.subtitle))
    }
}

fn panel(svg: &mut Svg, d: &Diagonal, frame: PlotFrame, axis: &PlotAxis) {
    let across = PlotAxis::new(0.0, d.way_mm.last().copied().unwrap_or(1.0));
    let (e, b) = (significant(d.e_d_um, 3), significant(d.b_d_um, 3));
    let title = format!("{}: E_d {e} µm, B_d {b} µm", d.name);
    svg.text((frame.left, frame.top - 10.0), &title, Font::bold(13.0), TextAnchor::Start, 0.0);
    frame.vertical(svg, axis, "µm");
    frame.horizontal(svg, &across, "travel along the diagonal in mm");
    for (way, (_, stroke)) in [&d.there_um, &d.back_um].into_iter().zip(WAYS) {
        let points: Vec<Point> = d.way_mm.iter().zip(way).map(|(x, y)| frame.point(&across, *x, axis, *y)).collect();
        curve(svg, &points, stroke);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_read_is_not_joined() {
        assert_eq!(stretches(&[0.0, 10.0, 20.0, 340.0, 350.0, 360.0]), [0..3, 3..6]);
        assert_eq!(stretches(&[30.0, 20.0, 10.0]), vec![0..3]);
        assert_eq!(stretches(&[5.0]), vec![0..1]);
    }
}
