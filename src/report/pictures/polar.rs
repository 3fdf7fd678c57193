//! Polar diagrams of deviations that are exaggerated about a nominal circle: of a ball bar or an axis of rotation about
//! the least-squares centre, of round features with the least-squares circle, one exaggeration for all panels.

use super::scale::round_step;
use super::svg::{FIRST, Font, INK, LINE, Picture, Point, SECOND, Svg, TextAnchor, polygon, polyline, wrap};
use crate::analysis::instrument::BallBar;
use crate::machine::sin_cos_degrees;
use crate::units::significant;

/// One diagram.
#[derive(Debug, Clone)]
pub struct DialPanel {
    /// Names of the directions to the right and upwards.
    pub directions: [String; 2],
    /// Angle (deg) and deviation, a curve for each way.
    pub curves: Vec<Vec<(f64, f64)>>,
    /// Stretches of the curves to point out.
    pub marks: Vec<DialMark>,
    /// True if the curves go all the way round.
    pub closed: bool,
    /// The line below it.
    pub title: String,
    /// The line below that.
    pub line: String,
}

/// A stretch of the curves after a place, in the sense of each.
#[derive(Debug, Clone, PartialEq)]
pub struct DialMark {
    /// The place, deg.
    pub angle: f64,
    /// Angles travelled from there to its beginning and its end, deg.
    pub travelled: [f64; 2],
    /// Its name.
    pub label: String,
}

impl DialMark {
    /// Points of the curve of one way that are within the stretch, in the order of the path.
    fn of(&self, curve: &[(f64, f64)], sign: f64) -> Vec<(f64, f64)> {
        let travelled = |angle: f64| {
            let path = (sign * (angle - self.angle)).rem_euclid(360.0);
            if path > 180.0 { path - 360.0 } else { path }
        };
        let [from, to] = self.travelled;
        let mut points: Vec<(f64, f64)> =
            curve.iter().copied().filter(|(angle, _)| (from..=to).contains(&travelled(*angle))).collect();
        points.sort_by(|a, b| travelled(a.0).total_cmp(&travelled(b.0)));
        points
    }
}

impl DialPanel {
    /// Returns the diagram of a ball bar.
    pub fn of(circle: &BallBar) -> Self {
        let curve = |way: &Vec<f64>| circle.angle_deg.iter().copied().zip(way.iter().copied()).collect();
        Self {
            directions: circle.plane.directions().map(|i| ["+X", "+Y", "+Z"][i].to_owned()),
            curves: circle.centred_um.iter().map(curve).collect(),
            marks: Vec::new(),
            closed: true,
            title: format!("{}: G(b) {} µm", circle.plane.name(), significant(circle.bidirectional_um, 3)),
            line: format!(
                "G {} and {} µm, squareness {} µrad",
                significant(circle.circular_deviation_um.counter_clockwise, 3),
                significant(circle.circular_deviation_um.clockwise, 3),
                significant(circle.squareness_urad, 3)
            ),
        }
    }
}

/// Diagrams side by side.
#[derive(Debug, Clone, Copy)]
pub struct PolarPicture<'a> {
    title: &'a str,
    subtitle: &'a str,
    panels: &'a [DialPanel],
    ways: &'a [(&'a str, Stroke)],
    /// The meaning of outwards.
    outwards: &'a str,
    /// True if the text for screen readers has the lines below the diagrams.
    is_told: bool,
}

const PANEL: f64 = 290.0;
const LEFT: f64 = 24.0;
const TOP: f64 = 84.0;
/// Radius of the nominal circle, px.
const NOMINAL: f64 = 96.0;
/// Rings on either side of it.
const RINGS: i32 = 2;
/// Diagrams beside each other, and the height of a row of them with its lines, px.
const ACROSS: usize = 4;
const ROW: f64 = PANEL + 52.0;
/// Distance from ring to ring, px.
const PITCH: f64 = 19.0;
const SENSES: [(&str, Stroke); 2] = [
    ("counter-clockwise", Stroke { colour: FIRST, dashes: "" }),
    ("clockwise", Stroke { colour: SECOND, dashes: "5 3" }),
];
const PROFILE: [(&str, Stroke); 2] = [
    ("deviation along the normal", Stroke { colour: FIRST, dashes: "" }),
    ("least-squares circle", Stroke { colour: SECOND, dashes: "5 3" }),
];
const MEAN_TURN: [(&str, Stroke); 1] = [("synchronous", Stroke { colour: FIRST, dashes: "" })];

#[derive(Debug, Clone, Copy)]
pub(crate) struct Stroke {
    pub colour: &'static str,
    /// Lengths of dashes and gaps; empty for none.
    pub dashes: &'static str,
}

impl Stroke {
    /// Attributes of a line of this width.
    pub(crate) fn style(&self, width: f64) -> String {
        let dashes =
            if self.dashes.is_empty() { String::new() } else { format!(r#" stroke-dasharray="{}""#, self.dashes) };
        format!(r#"fill="none" stroke="{}" stroke-width="{width}"{dashes}"#, self.colour)
    }

    /// A sample of the line with its name; returns where the next one may begin.
    pub(crate) fn key(&self, svg: &mut Svg, x: f64, y: f64, name: &str) -> f64 {
        svg.line((x, y - 4.0), (x + 26.0, y - 4.0), &self.style(1.8));
        svg.text((x + 32.0, y), name, Font::plain(12.0), TextAnchor::Start, 0.0);
        x + 60.0 + 7.0 * name.chars().count() as f64
    }
}

/// The rings of a diagram about a centre, and the value of one of them (um).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dial {
    centre: Point,
    ring: f64,
}

impl Dial {
    /// The height and width it takes, px.
    pub(crate) const SIZE: f64 = PANEL;

    /// A dial for values up to `largest` (um).
    pub(crate) fn new(centre: Point, largest: f64) -> Self {
        // Below a picometre there is nothing but rounding to draw.
        Self { centre, ring: round_step(largest.max(1e-6), RINGS as usize) }
    }

    /// Radius of the outermost ring, with some air, px.
    fn outer() -> f64 {
        NOMINAL + PITCH * f64::from(RINGS) + 6.0
    }

    /// Rings and cross, with names of the directions to the right and upwards.
    pub(crate) fn rings(&self, svg: &mut Svg, right: &str, up: &str) {
        let (centre, outer) = (self.centre, Self::outer());
        for k in -RINGS..=RINGS {
            let colour = if k == 0 { INK } else { LINE };
            svg.circle(centre, NOMINAL + PITCH * f64::from(k), &format!(r#"fill="none" stroke="{colour}""#));
        }
        let faint = format!(r#"stroke="{LINE}""#);
        svg.line((centre.x - outer, centre.y), (centre.x + outer, centre.y), &faint);
        svg.line((centre.x, centre.y - outer), (centre.x, centre.y + outer), &faint);
        svg.text((centre.x + outer, centre.y - 5.0), right, Font::bold(12.0), TextAnchor::End, 0.0);
        svg.text((centre.x + 6.0, centre.y - outer + 4.0), up, Font::bold(12.0), TextAnchor::Start, 0.0);
    }

    /// Values (um) over angles (deg).
    pub(crate) fn curve(&self, svg: &mut Svg, values: impl Iterator<Item = (f64, f64)>, closed: bool, stroke: Stroke) {
        let points: Vec<Point> = values.map(|(angle, value)| self.point(angle, value)).collect();
        let path = if closed { polygon(&points) } else { polyline(&points) };
        svg.path(&path, &stroke.style(1.5));
    }

    fn point(&self, angle: f64, value: f64) -> Point {
        self.at(angle, NOMINAL + PITCH * value / self.ring)
    }

    fn at(&self, angle: f64, radius: f64) -> Point {
        let (sine, cosine) = sin_cos_degrees(angle);
        Point { x: self.centre.x + radius * cosine, y: self.centre.y - radius * sine }
    }

    /// Lays a wide line over a stretch of a curve.
    fn highlight(&self, svg: &mut Svg, stretch: &[(f64, f64)], stroke: Stroke) {
        let points: Vec<Point> = stretch.iter().map(|(angle, value)| self.point(*angle, *value)).collect();
        if points.len() > 1 {
            let wide = Stroke { dashes: "", ..stroke };
            svg.path(&polyline(&points), &format!(r#"{} stroke-opacity="0.35""#, wide.style(7.0)));
        }
    }

    /// Writes the name of a mark within the rings.
    fn label(&self, svg: &mut Svg, mark: &DialMark) {
        let Point { x, y } = self.at(mark.angle, NOMINAL - PITCH * f64::from(RINGS) - 14.0);
        svg.text((x, y - 3.0), &mark.label, Font::bold(11.0), TextAnchor::Middle, 0.0);
    }

    /// Draws the text below it, in bold and faint.
    fn below(&self, svg: &mut Svg, title: &str, line: &str) {
        let y = self.centre.y + Self::outer() + 22.0;
        svg.text((self.centre.x, y), title, Font::bold(13.0), TextAnchor::Middle, 0.0);
        svg.text((self.centre.x, y + 18.0), line, Font::faint(12.0), TextAnchor::Middle, 0.0);
    }

    pub(crate) fn ring_words(&self) -> String {
        format!("{} µm", significant(self.ring, 4))
    }
}

/// Returns the largest value of diagrams, um.
fn largest(panels: &[DialPanel]) -> f64 {
    let all = panels.iter().flat_map(|panel| panel.curves.iter().flatten());
    all.fold(0.0_f64, |max, (_, x)| max.max(x.abs()))
}

impl<'a> PolarPicture<'a> {
    /// Returns diagrams of circles, counter-clockwise and clockwise.
    pub fn senses(title: &'a str, subtitle: &'a str, panels: &'a [DialPanel]) -> Self {
        let outwards =
            " of radial deviation; the dark circle is the nominal radius. Outwards: the machine is too far out.";
        Self { title, subtitle, panels, ways: &SENSES, outwards, is_told: false }
    }

    /// Returns diagrams of the mean turn of an axis of rotation.
    pub fn mean_turn(title: &'a str, subtitle: &'a str, panels: &'a [DialPanel]) -> Self {
        let outwards = ", of a tilt as many µrad; the dark circle is zero, outwards is plus.";
        Self { title, subtitle, panels, ways: &MEAN_TURN, outwards, is_told: false }
    }

    /// Returns diagrams of round features, each with its least-squares circle.
    pub fn profiles(title: &'a str, subtitle: &'a str, panels: &'a [DialPanel]) -> Self {
        let outwards = " of deviation along the normal; the dark circle is the nominal surface. Outwards: away from \
                        the axis. N\u{d7}: deviations are drawn N times as large as the radius.";
        Self { title, subtitle, panels, ways: &PROFILE, outwards, is_told: true }
    }

    /// Returns how many times deviations are drawn as large as a radius (mm) of one of the diagrams.
    pub fn magnification(panels: &[DialPanel], radius_mm: f64) -> f64 {
        let ring_mm = Dial::new(Point { x: 0.0, y: 0.0 }, largest(panels)).ring * 1e-3;
        (PITCH / ring_mm) / (NOMINAL / radius_mm)
    }

    /// The picture.
    pub fn picture(&self) -> Picture {
        let width = 2.0 * LEFT + PANEL * self.panels.len().clamp(2, ACROSS) as f64;
        let below = TOP + ROW * self.panels.len().div_ceil(ACROSS) as f64 + 6.0;
        let mut svg = Svg::new(width, below + 42.0);
        svg.heading(LEFT, self.title, 60, self.subtitle, (width / 7.5) as usize);
        let largest = largest(self.panels);
        let dial = |i: usize| {
            let (column, row) = ((i % ACROSS) as f64, (i / ACROSS) as f64);
            let centre = Point { x: LEFT + PANEL * (column + 0.5), y: TOP + PANEL * 0.5 + ROW * row };
            Dial::new(centre, largest)
        };
        self.panels.iter().enumerate().for_each(|(i, panel)| self.draw(&mut svg, panel, dial(i)));
        let _ = self.ways.iter().fold(LEFT, |x, (name, stroke)| stroke.key(&mut svg, x, below, name));
        let note = format!("One ring is {}{}", dial(0).ring_words(), self.outwards);
        for (i, line) in wrap(&note, (width / 6.4) as usize).iter().enumerate() {
            svg.text((LEFT, below + 22.0 + 16.0 * i as f64), line, Font::faint(12.0), TextAnchor::Start, 0.0);
        }
        let below = |panel: &DialPanel| format!("; {}, {}", panel.title, panel.line);
        let told = self.panels.iter().filter(|_| self.is_told).map(below).collect::<String>();
        svg.picture(&format!("{}: {}{told}", self.title, self.subtitle))
    }

    fn draw(&self, svg: &mut Svg, panel: &DialPanel, dial: Dial) {
        let [right, up] = &panel.directions;
        dial.rings(svg, right, up);
        for (curve, (_, stroke)) in panel.curves.iter().zip(self.ways) {
            dial.curve(svg, curve.iter().copied(), panel.closed, *stroke);
        }
        for mark in &panel.marks {
            for ((curve, (_, stroke)), sign) in panel.curves.iter().zip(self.ways).zip([1.0, -1.0]) {
                dial.highlight(svg, &mark.of(curve, sign), *stroke);
            }
            dial.label(svg, mark);
        }
        dial.below(svg, &panel.title, &panel.line);
    }
}
