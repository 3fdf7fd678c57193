//! Runs of a single-axis measurement: every reading, and for each direction the mean with its band of 2 s. Readings
//! over time as lines.

use super::frame::{PlotAxis, PlotFrame};
use super::polar::Stroke;
use super::readings::{LEFT, MARGIN, TOP, begin};
use super::svg::{FIRST, Font, INK, Picture, Point, SECOND, Svg, THIRD, TextAnchor, polyline};

/// Readings of one direction of approach.
#[derive(Debug, Clone, Default)]
pub struct RunCurves {
    /// Position, mean, and 2 s if that is known.
    pub means: Vec<(f64, f64, Option<f64>)>,
    /// Position and value of every reading.
    pub readings: Vec<(f64, f64)>,
}

/// The runs of one error.
#[derive(Debug, Clone)]
pub struct RunPanel {
    /// Name and figures.
    pub title: String,
    /// Unit of the values, as it is printed.
    pub unit: &'static str,
    /// Forward, reverse, and of a direction that is not known.
    pub ways: [RunCurves; 3],
}

/// Errors of one axis, one below the other.
#[derive(Debug, Clone, Copy)]
pub struct RunPicture<'a> {
    /// The first line.
    pub title: &'a str,
    /// The second line.
    pub subtitle: &'a str,
    /// Name of the axis of positions, with its unit.
    pub position: &'a str,
    /// The errors.
    pub panels: &'a [RunPanel],
}

const HEIGHT: f64 = 230.0;
const STEP: f64 = HEIGHT + 96.0;
const WAYS: [(&str, Stroke); 3] = [
    ("forward, mean and 2 s", Stroke { colour: FIRST, dashes: "" }),
    ("reverse, mean and 2 s", Stroke { colour: SECOND, dashes: "7 3" }),
    ("direction not known", Stroke { colour: INK, dashes: "2 3" }),
];

impl RunPicture<'_> {
    /// The picture.
    pub fn picture(&self) -> Picture {
        let height = TOP + STEP * self.panels.len() as f64 + 24.0;
        let mut svg = begin(self.title, self.subtitle, height);
        for (i, panel) in self.panels.iter().enumerate() {
            let top = TOP + 16.0 + STEP * i as f64;
            panel.draw(&mut svg, PlotFrame { left: LEFT + MARGIN, top, width: 800.0, height: HEIGHT }, self.position);
        }
        let there = |k: usize| self.panels.iter().any(|panel| !panel.ways[k].means.is_empty());
        let keys = (0..WAYS.len()).filter(|k| there(*k));
        let _ = keys.fold(LEFT + MARGIN, |x, k| WAYS[k].1.key(&mut svg, x, height - 16.0, WAYS[k].0));
        svg.picture(&format!("{}: {}", self.title, self.subtitle))
    }
}

impl RunPanel {
    fn draw(&self, svg: &mut Svg, frame: PlotFrame, position: &str) {
        let edges = |(_, mean, band): &(f64, f64, Option<f64>)| {
            let band = band.unwrap_or(0.0);
            [mean - band, mean + band]
        };
        let means = || self.ways.iter().flat_map(|way| &way.means);
        let read = self.ways.iter().flat_map(|way| &way.readings).map(|(_, value)| *value);
        let (across, up) =
            (scale(means().map(|(at, _, _)| *at), 0.02), scale(means().flat_map(edges).chain(read), 0.06));
        svg.text((frame.left, frame.top - 12.0), &self.title, Font::bold(13.0), TextAnchor::Start, 0.0);
        frame.vertical(svg, &up, self.unit);
        frame.horizontal(svg, &across, position);
        for (way, (_, stroke)) in self.ways.iter().zip(WAYS) {
            let at = |x: f64, y: f64| frame.point(&across, x, &up, y);
            for (x, y) in &way.readings {
                svg.circle(at(*x, *y), 1.6, &format!(r#"fill="{}" fill-opacity="0.55""#, stroke.colour));
            }
            let line = |of: &dyn Fn(f64, f64) -> f64| -> Vec<Point> {
                way.means.iter().map(|(x, mean, band)| at(*x, of(*mean, band.unwrap_or(0.0)))).collect()
            };
            svg.path(&polyline(&line(&|mean, _| mean)), &stroke.style(1.8));
            if way.means.iter().any(|(_, _, band)| band.is_some()) {
                svg.path(&polyline(&line(&|mean, band| mean + band)), &stroke.style(0.7));
                svg.path(&polyline(&line(&|mean, band| mean - band)), &stroke.style(0.7));
            }
        }
    }
}

/// Lines of one unit.
#[derive(Debug, Clone, PartialEq)]
pub struct LinePanel {
    /// The unit, as it is printed.
    pub unit: &'static str,
    /// Names and points.
    pub curves: Vec<(String, Vec<(f64, f64)>)>,
}

/// Panels of lines over one axis, one below the other.
#[derive(Debug, Clone, Copy)]
pub struct LinePicture<'a> {
    /// The first line.
    pub title: &'a str,
    /// The second line.
    pub subtitle: &'a str,
    /// Name of the axis to the right.
    pub across: &'a str,
    /// The panels.
    pub panels: &'a [LinePanel],
}

/// Strokes of lines, in turn.
const STROKES: [Stroke; 6] = [
    Stroke { colour: FIRST, dashes: "" },
    Stroke { colour: SECOND, dashes: "" },
    Stroke { colour: THIRD, dashes: "" },
    Stroke { colour: FIRST, dashes: "6 3" },
    Stroke { colour: SECOND, dashes: "6 3" },
    Stroke { colour: THIRD, dashes: "6 3" },
];

impl LinePicture<'_> {
    /// The picture.
    pub fn picture(&self) -> Picture {
        let height = TOP + STEP * self.panels.len() as f64;
        let mut svg = begin(self.title, self.subtitle, height);
        let points = || self.panels.iter().flat_map(|panel| panel.curves.iter().flat_map(|(_, points)| points));
        let across = scale(points().map(|(x, _)| *x), 0.0);
        for (i, panel) in self.panels.iter().enumerate() {
            let top = TOP + 16.0 + STEP * i as f64;
            let frame = PlotFrame { left: LEFT + MARGIN, top, width: 800.0, height: HEIGHT };
            let up = scale(panel.curves.iter().flat_map(|(_, points)| points).map(|(_, y)| *y), 0.06);
            frame.vertical(&mut svg, &up, panel.unit);
            frame.horizontal(&mut svg, &across, self.across);
            let mut key = frame.left;
            for ((name, points), stroke) in panel.curves.iter().zip(STROKES.iter().cycle()) {
                let line: Vec<Point> = points.iter().map(|(x, y)| frame.point(&across, *x, &up, *y)).collect();
                svg.path(&polyline(&line), &stroke.style(1.6));
                key = stroke.key(&mut svg, key, top - 8.0, name);
            }
        }
        svg.picture(&format!("{}: {}", self.title, self.subtitle))
    }
}

fn scale(values: impl Iterator<Item = f64>, air: f64) -> PlotAxis {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let air = air * (high - low).max(1e-6);
    if high >= low { PlotAxis::new(low - air, high + air) } else { PlotAxis::new(0.0, 1.0) }
}
