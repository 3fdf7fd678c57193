//! The kinematic chain as a picture: bed in the middle, the axes that carry the workpiece to the left, those that carry
//! the tool to the right.

use super::svg::{FAINT, Font, INK, Picture, Point, Svg, TextAnchor, polyline, truncate, wrap};
use crate::analysis::{Lever, levers};
use crate::machine::{Axis, AxisKind, Body, Branch, Machine, Sense, Travel};
use crate::units::significant;
use nalgebra::Vector3;

const BOX: (f64, f64) = (124.0, 214.0);
const SMALL: f64 = 76.0;
const GAP: f64 = 22.0;
const MARGIN: f64 = 28.0;
const TOP: f64 = 92.0;
const MOTION: &str = "#1d5fa8";

/// A body with its place in the row.
enum ChainBody<'a> {
    Axis(&'a Axis, Lever),
    /// End of the chain: its name, its kind, and a line about it.
    End(String, &'static str, String),
}

impl ChainBody<'_> {
    fn width(&self) -> f64 {
        if matches!(self, ChainBody::Axis(..)) { BOX.0 } else { SMALL }
    }
}

/// The chain as a picture.
pub fn chain_picture(machine: &Machine) -> Picture {
    let stations = stations(machine);
    let row: f64 = stations.iter().map(ChainBody::width).sum::<f64>() + GAP * (stations.len() - 1) as f64;
    let width = (row + 2.0 * MARGIN).max(620.0);
    let notes = wrap(NOTE, (width / 6.9) as usize);
    let mut svg = Svg::new(width, TOP + BOX.1 + 40.0 + 17.0 * notes.len() as f64);
    let title = truncate(machine.name(), (width / 12.0) as usize);
    svg.text((MARGIN, 34.0), &title, Font::bold(18.0), TextAnchor::Start, 0.0);
    svg.text((MARGIN, 58.0), &truncate(&machine.chain().to_string(), 100), Font::faint(14.0), TextAnchor::Start, 0.0);
    let mut x = (width - row) / 2.0;
    for (i, station) in stations.iter().enumerate() {
        let middle = TOP + BOX.1 / 2.0;
        if i > 0 {
            svg.line((x - GAP, middle), (x, middle), &format!(r#"stroke="{INK}" stroke-width="3""#));
        }
        draw(&mut svg, station, x);
        x += station.width() + GAP;
    }
    for (i, note) in notes.iter().enumerate() {
        svg.text((MARGIN, TOP + BOX.1 + 36.0 + 17.0 * i as f64), note, Font::plain(12.0), TextAnchor::Start, 0.0);
    }
    svg.picture(&format!("{}: kinematic chain {}", machine.name(), machine.chain()))
}

const NOTE: &str = "Blue: motion of the tool relative to the workpiece for a positive command, in machine coordinates \
    at the zero pose; lengths in mm. A prime marks an axis that carries the workpiece. Arm: longest distance in the \
    volume from the \
    point about which the axis's angular errors turn to the functional point; an angle of 10 µrad moves it by 1 µm \
    for every 100 mm of arm.";

fn stations(machine: &Machine) -> Vec<ChainBody<'_>> {
    let levers = levers(machine);
    let station = |body: &Body| match body {
        Body::Axis(name) => machine.axis_index(name.as_str()).map(|i| ChainBody::Axis(&machine.axes()[i], levers[i])),
        Body::Spindle(name) => Some(ChainBody::End(format!("({name})"), "spindle", String::new())),
        Body::Workpiece => Some(ChainBody::End("w".to_owned(), "workpiece", String::new())),
        Body::Tool => Some(ChainBody::End("t".to_owned(), "tool", machine.tool().name.clone())),
        Body::Bed => None,
    };
    let side = |branch| machine.chain().branch(branch).into_iter().filter_map(station).collect::<Vec<_>>();
    let mut row = side(Branch::Workpiece);
    row.reverse();
    row.push(ChainBody::End("b".to_owned(), "bed", String::new()));
    row.extend(side(Branch::Tool));
    row
}

fn draw(svg: &mut Svg, station: &ChainBody<'_>, x: f64) {
    match station {
        ChainBody::Axis(axis, lever) => draw_axis(svg, axis, *lever, x),
        ChainBody::End(name, what, remark) => draw_end(svg, name, what, remark, x),
    }
}

fn draw_end(svg: &mut Svg, name: &str, what: &str, remark: &str, x: f64) {
    let bed = what == "bed";
    let height = if bed { BOX.1 } else { 96.0 };
    let top = TOP + (BOX.1 - height) / 2.0;
    let fill = if bed { "#d9dee3" } else { "#f4f1e8" };
    svg.rect((x, top), (SMALL, height), &format!(r#"rx="6" fill="{fill}" stroke="{INK}""#));
    let (centre, middle) = (x + SMALL / 2.0, TOP + BOX.1 / 2.0);
    svg.text(
        (centre, middle),
        &truncate(name, 8),
        Font::bold(if name.chars().count() > 4 { 13.0 } else { 20.0 }),
        TextAnchor::Middle,
        0.0,
    );
    svg.text((centre, middle + 20.0), what, Font::faint(11.5), TextAnchor::Middle, 0.0);
    svg.text((centre, middle + 36.0), &truncate(remark, 11), Font::faint(11.0), TextAnchor::Middle, 0.0);
}

fn draw_axis(svg: &mut Svg, axis: &Axis, lever: Lever, x: f64) {
    svg.rect((x, TOP), BOX, &format!(r#"rx="6" fill="white" stroke="{INK}""#));
    let centre = x + BOX.0 / 2.0;
    let prime = if axis.branch == Branch::Workpiece { "′" } else { "" };
    svg.text((centre, TOP + 27.0), &format!("{}{prime}", axis.name), Font::bold(20.0), TextAnchor::Middle, 0.0);
    draw_motion(svg, axis, Point { x: centre - 4.0, y: TOP + 80.0 });
    let lines = [along(axis), travel(axis), origin(axis), format!("arm {} mm", significant(lever.longest.round(), 6))];
    for (i, line) in lines.iter().enumerate() {
        let font = if i == 0 { Font::plain(12.0) } else { Font::faint(11.5) };
        svg.text((centre, TOP + 148.0 + 17.0 * i as f64), &truncate(line, 19), font, TextAnchor::Middle, 0.0);
    }
}

/// `linear +X`, or the vector of an oblique axis, whose kind the drawing shows.
fn along(axis: &Axis) -> String {
    let text = direction(axis);
    if text.starts_with('(') {
        return text;
    }
    let kind = if axis.kind == AxisKind::Linear { "linear" } else { "rotary" };
    format!("{kind} {text}")
}

/// `+X`, or the vector of an oblique axis; a command of the sense `direct` moves the tool against it.
pub(crate) fn direction(axis: &Axis) -> String {
    let letters = ["X", "Y", "Z"];
    let upright = (0..3).find(|i| (axis.direction[*i].abs() - 1.0).abs() < 1e-12);
    let text = match upright {
        Some(i) => format!("{}{}", if axis.direction[i] < 0.0 { "-" } else { "+" }, letters[i]),
        None => format!("({})", axis.direction.map(|x| significant(x, 2)).join(", ")),
    };
    let direct = axis.branch == Branch::Workpiece && axis.sense == Sense::Direct;
    if direct { format!("{text} direct") } else { text }
}

fn travel(axis: &Axis) -> String {
    match axis.travel {
        Travel::Range(min, max) => format!("{} to {} {}", significant(min, 6), significant(max, 6), axis.unit()),
        Travel::Continuous => "continuous".to_owned(),
    }
}

fn origin(axis: &Axis) -> String {
    let [x, y, z] = axis.origin.map(|v| significant(v, 5));
    format!("at {x}, {y}, {z}")
}

/// A view from the front, from above and a little from the left: X to the right, Y away, Z up.
fn project(v: &Vector3<f64>, centre: Point, scale: f64) -> Point {
    let (x, y) = (0.94 * v.x + 0.42 * v.y, 0.16 * v.x - 0.40 * v.y - 0.95 * v.z);
    Point { x: centre.x + scale * x, y: centre.y + scale * y }
}

fn draw_motion(svg: &mut Svg, axis: &Axis, centre: Point) {
    let thin = format!(r#"stroke="{FAINT}" stroke-width="0.8" opacity="0.7""#);
    for (unit, letter) in [(Vector3::x(), "X"), (Vector3::y(), "Y"), (Vector3::z(), "Z")] {
        svg.line(centre, project(&unit, centre, 38.0), &thin);
        let Point { x, y } = project(&(unit * 1.2), centre, 38.0);
        svg.text((x, y + 3.0), letter, Font::faint(9.0), TextAnchor::Middle, 0.0);
    }
    let u = Vector3::from(axis.direction) * axis.sign();
    if axis.kind == AxisKind::Linear {
        return svg.arrow(project(&(u * -0.75), centre, 36.0), project(&(u * 0.95), centre, 36.0), 3.0, MOTION);
    }
    let dashed = format!(r#"stroke="{MOTION}" stroke-width="1.2" stroke-dasharray="4 3""#);
    svg.line(project(&(u * -0.9), centre, 36.0), project(&(u * 0.9), centre, 36.0), &dashed);
    let (a, b) = across(&u);
    let on_circle = |degrees: f64| {
        let (s, c) = libm::sincos(degrees.to_radians());
        project(&((a * c + b * s) * 0.72), centre, 36.0)
    };
    let arc: Vec<Point> = (0..=44).map(|k| on_circle(20.0 + 6.4 * f64::from(k))).collect();
    svg.path(&polyline(&arc), &format!(r#"fill="none" stroke="{MOTION}" stroke-width="3""#));
    svg.arrow(on_circle(292.0), on_circle(324.0), 3.0, MOTION);
}

/// Two unit vectors that make a right-handed frame with u.
fn across(u: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let helper = if u.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
    let a = (helper - u * u.dot(&helper)).try_normalize(0.0).unwrap_or_else(Vector3::x);
    (a, u.cross(&a))
}
