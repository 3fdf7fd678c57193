//! Places of a part over two ranges: the share in reach, or the figure of the deviation.

use super::frame::{PlotAxis, PlotFrame};
use super::scale::rising;
use super::svg::{FAINT, Font, INK, Picture, Point, Svg, TextAnchor, wrap};
use crate::job::place_grid::PlaceRange;
use crate::job::place_study::TriedPlace;
use crate::job::placement::Placement;
use crate::units::significant;

/// Width of the picture, px.
const WIDTH: f64 = 760.0;
/// Left and upper edge of the diagram.
const LEFT: f64 = 96.0;
const TOP: f64 = 92.0;
/// Largest width and height of the diagram, and its height with one range.
const WIDEST: f64 = 600.0;
const HIGHEST: f64 = 420.0;
const STRIP: f64 = 70.0;
/// Characters of a note.
const NOTE: usize = 98;
/// Radius of the dot of a place that is not told apart from the best, px.
const OPEN: f64 = 2.2;
/// Colour of a place that is not ranked.
const APART: &str = "#cfd3d7";

/// Places over the first two ranges of several values; of those in a cell the best is drawn.
pub struct PlacementPicture<'a> {
    /// The title.
    pub title: &'a str,
    /// Poses and reference of the places.
    pub over: &'a str,
    /// The ranges.
    pub ranges: &'a [PlaceRange],
    /// The places, those of the ranges first.
    pub tried: &'a [TriedPlace],
    /// The place of the job.
    pub own: &'a TriedPlace,
    /// The best place.
    pub best: Option<&'a TriedPlace>,
    /// The figure of the deviation in words; none for the share in reach.
    pub figures: Option<&'a str>,
}

/// The ranges of the two sides: index, and the number of values.
#[derive(Clone, Copy)]
struct Side<'a> {
    index: usize,
    range: &'a PlaceRange,
}

impl PlacementPicture<'_> {
    /// Returns the picture.
    pub fn picture(&self) -> Picture {
        let [across, up] = self.sides();
        let notes: Vec<String> = self.notes(up).iter().flat_map(|note| wrap(note, NOTE)).collect();
        let (width, height) = size(across, up);
        let below = TOP + height + 66.0;
        let mut svg = Svg::new(WIDTH, below + 18.5 * notes.len() as f64 + 4.0);
        let what = self.figures.unwrap_or("share of the tool poses in reach");
        let subtitle = format!("Places of the part: {what}");
        svg.heading(28.0, self.title, 60, &subtitle, 60);
        let frame = PlotFrame { left: LEFT, top: TOP, width, height };
        let axes = [across, up].map(|side| side.map(|side| axis(side.range)));
        self.cells(&mut svg, &frame, [across, up]);
        if let (Some(side), Some(axis)) = (across, &axes[0]) {
            frame.horizontal(&mut svg, axis, &name(side.range));
        }
        match (up, &axes[1]) {
            (Some(side), Some(axis)) => frame.vertical(&mut svg, axis, &name(side.range)),
            _ => svg.rect((LEFT, TOP), (width, height), &format!(r#"fill="none" stroke="{FAINT}""#)),
        }
        self.marks(&mut svg, &frame, [across, up]);
        self.bar(&mut svg);
        for (i, note) in notes.iter().enumerate() {
            svg.text((28.0, below + 18.5 * i as f64), note, Font::plain(13.5), TextAnchor::Start, 0.0);
        }
        svg.picture(&format!("{}: {subtitle}", self.title))
    }

    /// Returns the first two ranges of several values; the first range where none has.
    fn sides(&self) -> [Option<Side<'_>>; 2] {
        let all = || self.ranges.iter().enumerate().map(|(index, range)| Side { index, range });
        let mut varied = all().filter(|side| side.range.count > 1);
        [varied.next().or_else(|| all().next()), varied.next()]
    }

    /// Returns the least and the largest figure of ranked places, um.
    fn extremes(&self) -> [f64; 2] {
        let ranked = self.tried.iter().filter(|of| of.rank.is_some()).filter_map(|of| of.um);
        let [least, most] =
            ranked.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], um| [least.min(um), most.max(um)]);
        if least <= most { [least, most] } else { [0.0; 2] }
    }

    fn cells(&self, svg: &mut Svg, frame: &PlotFrame, sides: [Option<Side<'_>>; 2]) {
        let counts = sides.map(|side| side.map_or(1, |side| side.range.count));
        let mut best: Vec<Option<&TriedPlace>> = vec![None; counts[0] * counts[1]];
        let all: usize = self.ranges.iter().map(|range| range.count).product();
        for (index, place) in self.tried.iter().take(all).enumerate() {
            let [i, j] = sides.map(|side| side.map_or(0, |side| self.step(index, side.index)));
            let cell = &mut best[j * counts[0] + i];
            // Ranked ones first, then those that reach the most.
            let worth = |of: &TriedPlace| (of.rank.map(std::cmp::Reverse), of.reached);
            if cell.is_none_or(|known| worth(known) < worth(place)) {
                *cell = Some(place);
            }
        }
        let (width, height) = (frame.width / counts[0] as f64, frame.height / counts[1] as f64);
        for (index, place) in best.into_iter().enumerate().filter_map(|(index, place)| Some((index, place?))) {
            let (i, j) = (index % counts[0], index / counts[0]);
            let corner = (frame.left + width * i as f64, frame.top + frame.height - height * (j + 1) as f64);
            if let Some(colour) = self.colour(place) {
                // The thin line closes the seams between neighbouring cells.
                let style = format!(r#"fill="{colour}" stroke="{colour}" stroke-width="0.3""#);
                svg.rect(corner, (width, height), &style);
            }
            if place.is_open() {
                let at = Point { x: corner.0 + 0.5 * width, y: corner.1 + 0.5 * height };
                svg.circle(at, OPEN.min(0.2 * width.min(height)), &format!(r#"fill="{INK}""#));
            }
            if let Some(rewinds) = place.rewinds.filter(|rewinds| *rewinds > 0 && width > 16.0 && height > 14.0) {
                let at = (corner.0 + width - 3.0, corner.1 + 12.0);
                svg.text(at, &rewinds.to_string(), Font::plain(10.0), TextAnchor::End, 0.0);
            }
        }
    }

    /// Returns the step of a range at an index of the grid.
    fn step(&self, index: usize, range: usize) -> usize {
        let before: usize = self.ranges[..range].iter().map(|range| range.count).product();
        index / before % self.ranges[range].count
    }

    /// Returns the colour of a place; `None` where nothing is reached.
    fn colour(&self, place: &TriedPlace) -> Option<String> {
        let [least, most] = self.extremes();
        let fraction = |um: f64| if most > least { (um - least) / (most - least) } else { 0.0 };
        match (place.um, place.rank) {
            _ if place.reached == 0 => None,
            _ if self.figures.is_none() => Some(rising(place.share)),
            (Some(um), Some(_)) => Some(rising(fraction(um))),
            _ => Some(APART.to_owned()),
        }
    }

    fn at(&self, frame: &PlotFrame, sides: [Option<Side<'_>>; 2], place: &Placement) -> Option<Point> {
        let [x, y] = sides.map(|side| side.map_or(0.5, |side| fraction(side.range, place)));
        let inside = |fraction: f64| (0.0..=1.0).contains(&fraction);
        let point = Point { x: frame.left + frame.width * x, y: frame.top + frame.height * (1.0 - y) };
        (inside(x) && inside(y)).then_some(point)
    }

    /// A square at the place of the job, a ring at the best.
    fn marks(&self, svg: &mut Svg, frame: &PlotFrame, sides: [Option<Side<'_>>; 2]) {
        let halo = r#"fill="none" stroke="white" stroke-width="5""#;
        let line = format!(r#"fill="none" stroke="{INK}" stroke-width="2""#);
        if let Some(Point { x, y }) = self.at(frame, sides, &self.own.place) {
            [halo, &line].into_iter().for_each(|style| svg.rect((x - 9.0, y - 9.0), (18.0, 18.0), style));
        }
        if let Some(at) = self.best.and_then(|best| self.at(frame, sides, &best.place)) {
            [halo, &line].into_iter().for_each(|style| svg.circle(at, 5.0, style));
        }
    }

    fn notes(&self, up: Option<Side<'_>>) -> Vec<String> {
        let mut notes = vec![format!("{}.", self.over)];
        let colours = "white: nothing is reached";
        notes.push(if self.figures.is_some() {
            format!("Grey: other or fewer tool poses than the ranked places, or no reference; {colours}.")
        } else {
            format!("Colour: share; {colours}.")
        });
        let marks = match self.best {
            Some(best) => format!("Ring: the best place, {}. Square: the place of the job.", words(self.ranges, best)),
            None => "Square: the place of the job.".to_owned(),
        };
        notes.push(marks);
        let [across, _] = self.sides();
        let drawn: Vec<&str> = [across, up].into_iter().flatten().map(|side| side.range.of).collect();
        let others: Vec<&str> = self.ranges.iter().filter(|of| of.count > 1).map(|of| of.of).collect();
        let others: Vec<&str> = others.into_iter().filter(|of| !drawn.contains(of)).collect();
        if !others.is_empty() {
            notes.push(format!("Each cell is the best place over {}.", others.join(", ")));
        }
        if self.tried.iter().any(TriedPlace::is_open) {
            notes.push("Dots: places that the machines drawn do not tell apart from the best.".to_owned());
        }
        if self.tried.iter().any(|of| of.rewinds.is_some_and(|rewinds| rewinds > 0)) {
            notes.push("Numbers: rewinds of the path, which rank before the figure.".to_owned());
        }
        notes
    }

    fn bar(&self, svg: &mut Svg) {
        const STEPS: usize = 20;
        let [left, width] = [LEFT + WIDEST - 160.0, 120.0 / STEPS as f64];
        for k in 0..STEPS {
            let colour = rising((k as f64 + 0.5) / STEPS as f64);
            svg.rect((left + width * k as f64, 66.0), (width, 12.0), &format!(r#"fill="{colour}""#));
        }
        svg.rect((left, 66.0), (120.0, 12.0), &format!(r#"fill="none" stroke="{FAINT}""#));
        let [least, most] = if self.figures.is_some() {
            let [least, most] = self.extremes();
            [significant(least, 4), format!("{} µm", significant(most, 4))]
        } else {
            ["0".to_owned(), "all".to_owned()]
        };
        svg.text((left - 8.0, 76.5), &least, Font::plain(12.0), TextAnchor::End, 0.0);
        svg.text((left + 128.0, 76.5), &most, Font::plain(12.0), TextAnchor::Start, 0.0);
    }
}

/// Returns a place in words, such as `X -50 mm, C 90 deg, 24.2 µm`.
fn words(ranges: &[PlaceRange], of: &TriedPlace) -> String {
    let numbers = ranges.iter().map(|r| format!("{} {} {}", r.of, significant(r.of_place(&of.place), 6), r.unit));
    let share = (of.share < 1.0).then(|| format!("{} % in reach", significant(100.0 * of.share, 4)));
    let figure = of.um.map(|um| format!("{} µm", significant(um, 4)));
    numbers.chain(share).chain(figure).collect::<Vec<_>>().join(", ")
}

fn name(range: &PlaceRange) -> String {
    format!("{} of the part, {}", range.of, range.unit)
}

/// Returns the ends of the axis of a range: a cell reaches half a step beyond its place.
fn ends(range: &PlaceRange) -> [f64; 2] {
    let [first, last] = range.ends;
    let half = if range.count > 1 { 0.5 * (last - first) / (range.count - 1) as f64 } else { 0.5 };
    [first - half, last + half]
}

fn axis(range: &PlaceRange) -> PlotAxis {
    let [first, last] = ends(range);
    if range.unit == "deg" { PlotAxis::degrees(first, last) } else { PlotAxis::new(first, last) }
}

/// Returns where a place is along the axis of a range, 0 to 1 within it.
fn fraction(range: &PlaceRange, place: &Placement) -> f64 {
    let [first, last] = ends(range);
    (range.of_place(place) - first) / (last - first)
}

/// Returns width and height of the diagram, px: to scale for two lengths, within limits.
fn size(across: Option<Side<'_>>, up: Option<Side<'_>>) -> (f64, f64) {
    let Some((across, up)) = across.zip(up) else { return (WIDEST, STRIP) };
    let span = |side: Side<'_>| ends(side.range)[1] - ends(side.range)[0];
    if across.range.unit != up.range.unit {
        return (WIDEST, 0.6 * WIDEST);
    }
    let scale = (WIDEST / span(across)).min(HIGHEST / span(up));
    ((span(across) * scale).max(120.0), (span(up) * scale).max(STRIP))
}
