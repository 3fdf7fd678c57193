//! The zero pose as a drawing in three views: gauge point, tip, workpiece origin, the points about which axes turn, and
//! the lines of rotary axes.

use super::svg::{FAINT, FIRST, Font, INK, Picture, Point, SECOND, Svg, TextAnchor, truncate};
use crate::machine::{AxisKind, Machine};
use crate::units::significant;

/// Side of a view, and its margin, px.
const VIEW: f64 = 260.0;
const MARGIN: f64 = 34.0;
const TOP: f64 = 92.0;
/// Half of the drawn length of a rotary axis, px.
const HALF_LINE: f64 = 42.0;

/// Title of a view, and the machine coordinates that lead to the right and upwards.
const VIEWS: [(&str, usize, usize); 3] = [("front: X, Z", 0, 2), ("right: Y, Z", 1, 2), ("top: X, Y", 0, 1)];

/// A point in machine coordinates (mm), with what turns about it.
struct Mark {
    label: String,
    at: [f64; 3],
    colour: &'static str,
    /// Direction of a rotary axis.
    line: Option<[f64; 3]>,
}

/// Returns the drawing of a machine at its zero pose.
pub fn zero_pose_picture(machine: &Machine) -> Picture {
    let marks = marks(machine);
    let ends = |i: usize| {
        let along = || marks.iter().map(|mark| mark.at[i]);
        [along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max)]
    };
    let ends: [[f64; 2]; 3] = std::array::from_fn(ends);
    let span = ends.iter().map(|[low, high]| high - low).fold(1.0, f64::max);
    let scale = (VIEW - 2.0 * MARGIN - 20.0) / span;
    let width = MARGIN + 3.0 * (VIEW + MARGIN);
    let mut svg = Svg::new(width, TOP + VIEW + 40.0 + 17.0 * marks.len() as f64);
    svg.text((MARGIN, 34.0), &truncate(machine.name(), 70), Font::bold(18.0), TextAnchor::Start, 0.0);
    let subtitle = format!("{}: all axes at 0, machine coordinates, mm", machine.chain());
    svg.text((MARGIN, 58.0), &truncate(&subtitle, 110), Font::faint(14.0), TextAnchor::Start, 0.0);
    for (k, (title, right, up)) in VIEWS.into_iter().enumerate() {
        let corner = Point { x: MARGIN + k as f64 * (VIEW + MARGIN), y: TOP };
        svg.rect(corner, (VIEW, VIEW), &format!(r#"fill="none" stroke="{FAINT}" stroke-width="0.8""#));
        svg.text((corner.x, TOP - 8.0), title, Font::faint(12.0), TextAnchor::Start, 0.0);
        let middle = |i: usize| (ends[i][0] + ends[i][1]) / 2.0;
        let place = |at: [f64; 3]| Point {
            x: corner.x + VIEW / 2.0 + scale * (at[right] - middle(right)),
            y: corner.y + VIEW / 2.0 - scale * (at[up] - middle(up)),
        };
        view(&mut svg, &marks, place, [right, up]);
    }
    for (i, mark) in marks.iter().enumerate() {
        let [x, y, z] = mark.at.map(|v| significant(v, 7));
        let turns =
            mark.line.map_or(String::new(), |u| format!(", line along {}", u.map(|x| significant(x, 4)).join(", ")));
        let text = format!("{}: {x}, {y}, {z}{turns}", mark.label);
        let at = (MARGIN, TOP + VIEW + 30.0 + 17.0 * i as f64);
        svg.text(at, &truncate(&text, 120), Font::plain(12.0), TextAnchor::Start, 0.0);
    }
    svg.picture(&format!("{}: zero pose", machine.name()))
}

fn marks(machine: &Machine) -> Vec<Mark> {
    let tool = machine.tool();
    let point = |label: &str, at, colour| Mark { label: label.to_owned(), at, colour, line: None };
    let mut marks = vec![
        point("gauge", tool.gauge, INK),
        point("tip", tool.tip, INK),
        point("workpiece", machine.workpiece(), SECOND),
    ];
    marks.extend(machine.axes().iter().map(|axis| {
        let is_rotary = axis.kind == AxisKind::Rotary;
        let colour = if is_rotary { FIRST } else { FAINT };
        Mark { label: axis.name.to_string(), at: axis.origin, colour, line: is_rotary.then_some(axis.direction) }
    }));
    marks
}

/// Draws the marks of one view; labels of points that coincide stand in one line.
fn view(svg: &mut Svg, marks: &[Mark], place: impl Fn([f64; 3]) -> Point, [right, up]: [usize; 2]) {
    for mark in marks {
        let Some(line) = mark.line else { continue };
        let (at, along) = (place(mark.at), [line[right], -line[up]].map(|x| x * HALF_LINE));
        if along[0].hypot(along[1]) < HALF_LINE / 10.0 {
            svg.circle(at, 9.0, &format!(r#"fill="none" stroke="{}" stroke-width="1.4""#, mark.colour));
            continue;
        }
        let style = format!(r#"stroke="{}" stroke-width="1.4" stroke-dasharray="6 3""#, mark.colour);
        let [from, to] = [-1.0, 1.0].map(|s| Point { x: at.x + s * along[0], y: at.y + s * along[1] });
        svg.line(from, to, &style);
    }
    if let [gauge, tip, ..] = marks {
        svg.line(place(gauge.at), place(tip.at), &format!(r#"stroke="{INK}" stroke-width="4""#));
    }
    let mut labels: Vec<(Point, String)> = Vec::new();
    for mark in marks {
        let at = place(mark.at);
        svg.circle(at, 3.5, &format!(r#"fill="{}""#, mark.colour));
        match labels.iter_mut().find(|(other, _)| (other.x - at.x).hypot(other.y - at.y) < 8.0) {
            Some((_, label)) => *label += &format!(" {}", mark.label),
            None => labels.push((at, mark.label.clone())),
        }
    }
    for (at, label) in labels {
        svg.text((at.x + 7.0, at.y - 6.0), &truncate(&label, 30), Font::plain(11.0), TextAnchor::Start, 0.0);
    }
}
