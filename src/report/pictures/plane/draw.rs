//! The drawing of a plane: colours and arrows or a deformed grid, frame, notes.

use super::bands::ColourBands;
use super::picture::{LEFT, MARGIN, PlanePicture, PlaneQuantity, PlaneStyle, TOP};
use crate::analysis::{Plane, PlaneNodes};
use crate::evaluate::{Frame, Order};
use crate::machine::Approach;
use crate::report::pictures::scale::{round_step, tick_text, ticks};
use crate::report::pictures::svg::{Font, INK, Picture, Point, Svg, TextAnchor, polygon, truncate, wrap};
use crate::report::text::DrawSettings;
use crate::units::significant;

const WIDTH: f64 = 880.0;
/// Smallest height of the colour bar.
const BAR: f64 = 150.0;
/// Arrows along the longer side, about.
const ARROWS: f64 = 13.0;

impl PlanePicture<'_> {
    /// The picture as an SVG file.
    pub fn svg(&self) -> String {
        self.picture().svg()
    }

    /// The picture.
    pub fn picture(&self) -> Picture {
        self.draw().picture(&format!("{}: {}", self.title(), self.subtitle()))
    }

    pub(super) fn draw(&self) -> Svg {
        let values = self.values(self.plane);
        let mut scaled = self.values(self.reference());
        scaled.extend(self.like.map(|_| 0.0));
        let bands = ColourBands::new(&scaled, self.shown);
        let scale = self.scale();
        let exaggeration = self.exaggeration(scale);
        let notes: Vec<String> = self.notes(&values, exaggeration).iter().flat_map(|note| wrap(note, 106)).collect();
        let area = self.area(scale);
        let min_height = if self.drawn == PlaneStyle::Colours { BAR } else { 0.0 };
        let below = TOP + (area.1 + 2.0 * self.margin()).max(min_height) + 66.0;
        let mut svg = Svg::new(WIDTH, below + 18.5 * notes.len() as f64 + 8.0);
        svg.text((LEFT, 32.0), &truncate(&self.title(), 70), Font::bold(18.0), TextAnchor::Start, 0.0);
        svg.text((LEFT, 54.0), &truncate(&self.subtitle(), 100), Font::faint(14.0), TextAnchor::Start, 0.0);
        match self.drawn {
            PlaneStyle::Colours => {
                self.fill(&mut svg, &values, &bands, scale);
                svg.group(r#"class="on-colour""#, |svg| self.arrows(svg, scale));
                bands.bar(&mut svg, Point { x: LEFT + area.0 + 34.0, y: TOP }, area.1.max(BAR), &self.quantity());
            }
            PlaneStyle::Grid => self.draw_deformed(&mut svg, scale, exaggeration),
        }
        self.frame(&mut svg, scale);
        for (i, note) in notes.iter().enumerate() {
            svg.text((LEFT, below + 18.5 * i as f64), note, Font::plain(13.5), TextAnchor::Start, 0.0);
        }
        svg
    }

    /// Returns the shown quantity in um, node by node.
    fn values(&self, plane: &Plane) -> Vec<f64> {
        let value = |d: &crate::evaluate::Deviation| match self.shown {
            PlaneQuantity::Length => d.position.norm(),
            PlaneQuantity::Component(k) => d.position[k.min(2)],
        };
        match &plane.nodes {
            PlaneNodes::Deviations { deviations, .. } => deviations.iter().map(|d| value(d) * 1e3).collect(),
            PlaneNodes::Lengths(lengths) => lengths.iter().map(|length| length * 1e3).collect(),
        }
    }

    fn quantity(&self) -> String {
        match self.shown {
            _ if self.drawing.is_some() => "95 % value of |d| in µm".to_owned(),
            PlaneQuantity::Length => "|d| in µm".to_owned(),
            PlaneQuantity::Component(k) => format!("d{} in µm", ["x", "y", "z"][k.min(2)]),
        }
    }

    fn subtitle(&self) -> String {
        let others = self.machine.axes().iter().zip(&self.plane.at).enumerate();
        let held = others.filter(|(i, _)| !self.plane.axes.contains(i));
        let text: Vec<String> =
            held.map(|(_, (axis, q))| format!("{} = {} {}", axis.name, significant(*q, 7), axis.unit())).collect();
        let at = if text.is_empty() { String::new() } else { format!(" at {}", text.join(", ")) };
        let state = if self.state.is_empty() { String::new() } else { format!(", {}", self.state) };
        let (what, from) = match self.drawing {
            Some(_) => ("95 % value of the deviation", ", from bounds"),
            None => ("Deviation", ""),
        };
        format!("{what} over the {}-{} plane{at}{state}{from}", self.axis(0), self.axis(1))
    }

    /// The notes below a picture of what bounds lead to.
    fn bound_notes(&self, values: &[f64], drawn: &DrawSettings, tool: &str) -> Vec<String> {
        vec![
            format!(
                "Colour: the length of the deviation d that 95 % of the drawn machines do not exceed at that place; \
                 {}.",
                self.largest(values)
            ),
            format!("From bounds, nothing is measured{}: {}.", drawn.class_words(), drawn.words()),
            format!("Tool relative to workpiece, first order in the errors{tool}."),
        ]
    }

    fn notes(&self, values: &[f64], exaggeration: Option<f64>) -> Vec<String> {
        let frame = match self.view.frame {
            Frame::Workpiece => "workpiece",
            Frame::Machine => "machine",
            Frame::Tool => "tool",
        };
        let order = match self.order {
            Order::Exact => "exact model".to_owned(),
            Order::Degree(n) => format!("model of order {n}"),
        };
        let approach = match self.view.conditions.approach {
            Approach::Mean => "mean of both directions of approach",
            Approach::Forward => "approached in positive direction",
            Approach::Reverse => "approached in negative direction",
        };
        let tool = if self.machine.tool().name.is_empty() {
            String::new()
        } else {
            format!(", tool {}", self.machine.tool().name)
        };
        if let Some(drawn) = self.drawing {
            return self.bound_notes(values, drawn, &tool);
        }
        let colour = match self.shown {
            PlaneQuantity::Length => "length of the deviation d".to_owned(),
            PlaneQuantity::Component(k) => {
                format!("component of the deviation d along {} of the {frame} frame", ["x", "y", "z"][k.min(2)])
            }
        };
        let drawn = exaggeration.map_or("No deviation within the plane.".to_owned(), |e| self.exaggeration_note(e));
        let first = if self.drawn == PlaneStyle::Colours { "Colour" } else { "In all directions" };
        let shared = if self.like.is_some_and(|like| !std::ptr::eq(like, self.plane)) {
            " Colours and factor are those of the first picture."
        } else {
            ""
        };
        vec![
            format!("{first}: {colour}; {}.{shared}", self.largest(values)),
            "Sign: actual minus nominal position of the functional point, tool relative to workpiece.".to_owned(),
            drawn,
            format!("Frame: {frame}, {order}, {approach}{tool}."),
        ]
    }

    fn exaggeration_note(&self, exaggeration: f64) -> String {
        let [right, times] = [self.axis(0).to_owned(), thousands(exaggeration)];
        match self.drawn {
            PlaneStyle::Colours => format!(
                "Arrows: the part of d within the plane, {times} times as long as it is; to the right is too far in \
                 +{right}."
            ),
            PlaneStyle::Grid => format!(
                "Grey: nominal grid; blue: displaced by the part of d within the plane, {times} times as far as it \
                 is; to the right is too far in +{right}."
            ),
        }
    }

    fn largest(&self, values: &[f64]) -> String {
        let order = |a: &usize, b: &usize| values[*a].abs().total_cmp(&values[*b].abs()).then(b.cmp(a));
        let worst = (0..values.len()).max_by(order).unwrap_or(0);
        let Point { x, y } = self.node(worst % self.plane.counts[0], worst / self.plane.counts[0]);
        let value = values.get(worst).copied().unwrap_or(0.0);
        let place = format!("{} = {}, {} = {} mm", self.axis(0), significant(x, 6), self.axis(1), significant(y, 6));
        format!("largest {} µm at {place}", significant(value, 4))
    }

    /// Every band over the ones below it: a path of whole cells and of cut ones.
    fn fill(&self, svg: &mut Svg, values: &[f64], bands: &ColourBands, scale: f64) {
        let (width, height) = self.area(scale);
        svg.rect((LEFT, TOP), (width, height), &format!(r#"fill="{}""#, bands.colour(0)));
        for band in 1..bands.count() {
            let data = self.region(values, bands.level(band), scale);
            if !data.is_empty() {
                let colour = bands.colour(band);
                // The thin line closes the seams between neighbouring cells.
                svg.path(&data, &format!(r#"fill="{colour}" stroke="{colour}" stroke-width="0.3""#));
            }
        }
    }

    /// Region in which the value is at least the level.
    fn region(&self, values: &[f64], level: f64, scale: f64) -> String {
        let [columns, rows] = self.plane.counts;
        let mut data = String::new();
        for j in 0..rows - 1 {
            let mut whole: Option<usize> = None;
            for i in 0..columns {
                let cell = (i + 1 < columns).then(|| self.cell(values, level, i, j));
                match (cell, whole) {
                    (Some(cell), None) if cell.len() == 4 && self.is_whole(values, level, i, j) => whole = Some(i),
                    (Some(_), Some(_)) if self.is_whole(values, level, i, j) => {}
                    (cell, run) => {
                        if let Some(start) = run.or(whole.take()) {
                            let corners = [(start, j), (i, j), (i, j + 1), (start, j + 1)];
                            data += &polygon(&corners.map(|(i, j)| self.at(scale, self.node(i, j))));
                            whole = None;
                        }
                        if let Some(cell) = cell.filter(|cell| cell.len() > 2) {
                            data += &polygon(&cell.iter().map(|p| self.at(scale, *p)).collect::<Vec<_>>());
                        }
                    }
                }
            }
        }
        data
    }

    fn corners(&self, values: &[f64], i: usize, j: usize) -> [(Point, f64); 4] {
        [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            .map(|(i, j)| (self.node(i, j), values[j * self.plane.counts[0] + i]))
    }

    fn is_whole(&self, values: &[f64], level: f64, i: usize, j: usize) -> bool {
        self.corners(values, i, j).iter().all(|(_, value)| *value >= level)
    }

    /// The cell cut off where the value, linear along its edges, falls below the level.
    fn cell(&self, values: &[f64], level: f64, i: usize, j: usize) -> Vec<Point> {
        let corners = self.corners(values, i, j);
        let mut polygon = Vec::new();
        for (k, (a, va)) in corners.into_iter().enumerate() {
            let (b, vb) = corners[(k + 1) % 4];
            if va >= level {
                polygon.push(a);
            }
            if (va >= level) != (vb >= level) {
                let t = (level - va) / (vb - va);
                polygon.push(Point { x: a.x + (b.x - a.x) * t, y: a.y + (b.y - a.y) * t });
            }
        }
        polygon
    }

    /// Border, ticks and names of the axes.
    fn frame(&self, svg: &mut Svg, scale: f64) {
        let (width, height) = self.area(scale);
        let (width, height) = (width + 2.0 * self.margin(), height + 2.0 * self.margin());
        svg.rect((LEFT, TOP), (width, height), &format!(r#"fill="none" stroke="{INK}""#));
        let tick = format!(r#"stroke="{INK}""#);
        let step = round_step(self.span(0), ((width / 80.0) as usize).clamp(1, 8));
        let at = |value: &f64| self.at(scale, Point { x: *value, y: 0.0 }).x;
        for value in thin_ticks(ticks(self.interval(0), step), at, 40.0) {
            let (x, y) = (at(&value), TOP + height);
            svg.line((x, y), (x, y + 5.0), &tick);
            svg.text((x, y + 19.0), &tick_text(value, step), Font::plain(13.0), TextAnchor::Middle, 0.0);
        }
        let step = round_step(self.span(1), ((height / 50.0) as usize).clamp(1, 8));
        let at = |value: &f64| self.at(scale, Point { x: 0.0, y: *value }).y;
        for value in thin_ticks(ticks(self.interval(1), step), at, 14.0) {
            let y = at(&value);
            svg.line((LEFT - 5.0, y), (LEFT, y), &tick);
            svg.text((LEFT - 9.0, y + 4.0), &tick_text(value, step), Font::plain(13.0), TextAnchor::End, 0.0);
        }
        svg.text(
            (LEFT + width / 2.0, TOP + height + 40.0),
            &format!("{} in mm", self.axis(0)),
            Font::plain(14.0),
            TextAnchor::Middle,
            0.0,
        );
        svg.text(
            (22.0, TOP + height / 2.0),
            &format!("{} in mm", self.axis(1)),
            Font::plain(14.0),
            TextAnchor::Middle,
            -90.0,
        );
    }

    /// Every how many nodes there is an arrow.
    fn stride(&self) -> usize {
        let longest = self.plane.counts[0].max(self.plane.counts[1]) as f64;
        ((longest / ARROWS).round() as usize).max(1)
    }

    /// Nodes with an arrow: from half their distance off the edge, so that arrows stay near the area.
    fn arrow_nodes(&self) -> Vec<(usize, usize)> {
        let stride = self.stride();
        let places = |count: usize| ((stride / 2).min((count - 1) / 2)..count).step_by(stride);
        places(self.plane.counts[1]).flat_map(|j| places(self.plane.counts[0]).map(move |i| (i, j))).collect()
    }

    /// A round factor that makes the longest arrow about as long as their distance; a grid's longest displacement stays
    /// within the margin too.
    fn exaggeration(&self, scale: f64) -> Option<f64> {
        let of = self.reference();
        let length = |(i, j): (usize, usize)| {
            let [u, v] = of.in_plane(j * of.counts[0] + i).unwrap_or_default();
            libm::hypot(u, v)
        };
        let (nodes, room) = match self.drawn {
            PlaneStyle::Colours => (self.arrow_nodes(), 45.0),
            PlaneStyle::Grid => {
                ((0..of.counts[1]).flat_map(|j| (0..of.counts[0]).map(move |i| (i, j))).collect(), MARGIN)
            }
        };
        let longest = nodes.into_iter().map(length).fold(0.0, f64::max);
        let intervals = (self.plane.counts[0].max(self.plane.counts[1]) - 1) as f64;
        let distance = self.span(0).max(self.span(1)) / intervals * self.stride() as f64;
        // Beyond the first bound there is nothing but rounding to draw.
        (longest > 1e-9 && scale > 0.0).then(|| {
            let exact = distance.min(room / scale) * 0.95 / longest;
            let step = round_step(exact, 1);
            // `round_step` rounds up; arrows must not grow into each other.
            if step <= exact { step } else { previous(step) }
        })
    }

    fn arrows(&self, svg: &mut Svg, scale: f64) {
        let Some(exaggeration) = self.exaggeration(scale) else { return };
        for (i, j) in self.arrow_nodes() {
            let (from, [u, v]) = (self.at(scale, self.node(i, j)), self.in_plane(i, j));
            let pixels = exaggeration * scale;
            svg.circle(from, 1.3, &format!(r#"fill="{INK}""#));
            svg.arrow(from, Point { x: from.x + u * pixels, y: from.y - v * pixels }, 1.2, INK);
        }
    }
}

/// Thins ticks to those at least `apart` px apart: those of a very short side would cover each other.
fn thin_ticks(ticks: Vec<f64>, at: impl Fn(&f64) -> f64, apart: f64) -> Vec<f64> {
    let mut kept: Vec<f64> = Vec::new();
    for tick in ticks {
        if kept.last().is_none_or(|last| (at(&tick) - at(last)).abs() >= apart) {
            kept.push(tick);
        }
    }
    kept
}

/// The next smaller of 1, 2, 5 times a power of ten.
fn previous(step: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(step) + 1e-9));
    match (step / power).round() as i64 {
        5 => 2.0 * power,
        2 => power,
        _ => 0.5 * power,
    }
}

/// `20 000`: groups of three digits with narrow blanks.
fn thousands(value: f64) -> String {
    if value < 1000.0 {
        return significant(value, 4);
    }
    let digits = format!("{value:.0}");
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i) % 3 == 0 {
            text.push('\u{a0}');
        }
        text.push(digit);
    }
    text
}
