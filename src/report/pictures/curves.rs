//! Curves of the component errors as small multiples: an axis has two rows of three panels, translations on
//! one scale and rotations on another, with the points that were given.

use super::scale::{round_step, tick_text, ticks};
use super::svg::{
    FAINT, FIRST, Font, INK, LINE, Picture, Point, SECOND, Svg, TextAnchor, polygon, polyline, truncate, wrap,
};
use crate::machine::{
    Approach, Axis, AxisKind, ComponentError, Curve, Direction, ErrorFamily, ErrorId, ErrorTerm, Machine,
};
use crate::units::Interval;

const PANEL: (f64, f64) = (256.0, 130.0);
const LEFT: f64 = 62.0;
const STEP: (f64, f64) = (320.0, 196.0);
const HEAD: f64 = 64.0;
const WIDTH: f64 = LEFT + 3.0 * STEP.0;
/// Places at which a curve is drawn, besides its points.
const SAMPLES: usize = 180;

/// The curves of one axis as a picture, without the notes that explain it; `None` if it has none.
pub fn axis_curves(machine: &Machine, axis: usize) -> Option<Picture> {
    let block = AxisPanels::new(machine, axis)?;
    let mut svg = Svg::new(WIDTH, block.height());
    block.draw(&mut svg, 0.0);
    Some(svg.picture(&format!("{}: component errors of {}", machine.name(), block.axis.name)))
}

/// The curves of all axes in one picture; `None` if there are none.
pub fn all_curves(machine: &Machine) -> Option<Picture> {
    let blocks: Vec<AxisPanels<'_>> =
        (0..machine.axes().len()).filter_map(|axis| AxisPanels::new(machine, axis)).collect();
    let height: f64 = blocks.iter().map(|block| block.height() + 16.0).sum();
    let notes = notes();
    let mut svg = Svg::new(WIDTH, 44.0 + height + 17.0 * notes.len() as f64 + 12.0);
    svg.text((16.0, 30.0), &truncate(machine.name(), 80), Font::bold(18.0), TextAnchor::Start, 0.0);
    let mut top = 44.0;
    for block in &blocks {
        block.draw(&mut svg, top);
        top += block.height() + 16.0;
    }
    footer(&mut svg, top, &notes);
    (!blocks.is_empty()).then(|| svg.picture(&format!("{}: component errors", machine.name())))
}

fn notes() -> Vec<String> {
    let note = "Dots: points as given; line: the curve evaluated between them. Where two directions of approach were \
     given, \
        blue is forward and brown, dashed, reverse. Band, U: expanded uncertainty (k = 2) where the file states it. \
        Sign: actual minus nominal. Panels of a row have one scale.";
    wrap(note, 130)
}

fn footer(svg: &mut Svg, top: f64, notes: &[String]) {
    for (i, note) in notes.iter().enumerate() {
        svg.text((16.0, top + 8.0 + 17.0 * i as f64), note, Font::faint(12.0), TextAnchor::Start, 0.0);
    }
}

/// Returns the name of a component error in ISO 230-1, in a word or two.
fn word(axis: &Axis, direction: Direction) -> String {
    let letters = ["X", "Y", "Z"];
    let along = (0..3).find(|i| axis.direction[*i].abs() > 0.999);
    let own = along == Some(direction.index() % 3);
    match (axis.kind, direction.is_rotation(), own) {
        (AxisKind::Linear, false, true) => "positioning".to_owned(),
        (AxisKind::Linear, false, false) => format!("straightness in {}", letters[direction.index()]),
        (AxisKind::Linear, true, true) => "roll".to_owned(),
        (AxisKind::Rotary, false, true) => "axial".to_owned(),
        (AxisKind::Rotary, false, false) => format!("radial in {}", letters[direction.index()]),
        (AxisKind::Rotary, true, true) => "angular positioning".to_owned(),
        (_, true, false) => format!("tilt about {}", letters[direction.index() - 3]),
    }
}

/// One panel: an error, and its curves with their points (µm or µrad).
struct Panel {
    name: String,
    word: String,
    curves: Vec<PanelKind>,
    /// Expanded uncertainty of the values, if it is known.
    band: Option<f64>,
    /// Text in place of a missing curve.
    instead: String,
}

struct PanelKind {
    line: Vec<(f64, f64)>,
    points: Vec<(f64, f64)>,
}

struct AxisPanels<'a> {
    axis: &'a Axis,
    interval: Interval,
    panels: Vec<Panel>,
}

impl<'a> AxisPanels<'a> {
    /// `None` if the axis has no curve.
    fn new(machine: &'a Machine, index: usize) -> Option<Self> {
        let axis = &machine.axes()[index];
        let (min, max) = axis.travel.interval();
        let interval = Interval::new(min, max);
        let panels: Vec<Panel> =
            Direction::ALL.iter().map(|direction| panel(machine, index, interval, *direction)).collect();
        panels.iter().any(|panel| !panel.curves.is_empty()).then_some(Self { axis, interval, panels })
    }

    fn height(&self) -> f64 {
        HEAD + 2.0 * STEP.1 - 30.0
    }

    fn draw(&self, svg: &mut Svg, top: f64) {
        let title = format!("{}: component errors over its position in {}", self.axis.name, self.axis.unit());
        svg.text((16.0, top + 24.0), &title, Font::bold(15.0), TextAnchor::Start, 0.0);
        for row in 0..2 {
            let panels = &self.panels[3 * row..3 * row + 3];
            let scale = scale(panels);
            for (column, panel) in panels.iter().enumerate() {
                let corner = Point { x: LEFT + STEP.0 * column as f64, y: top + HEAD + STEP.1 * row as f64 };
                PanelFrame { corner, x: self.interval, y: scale, unit: ["µm", "µrad"][row] }.draw(svg, panel);
            }
        }
    }
}

fn panel(machine: &Machine, index: usize, interval: Interval, direction: Direction) -> Panel {
    let axis = &machine.axes()[index];
    let factor = direction.micro().0;
    let term = machine.axis_errors(index).component[direction.index()].as_ref();
    let (curves, instead) = match term {
        Some(ErrorTerm::Component(component)) => (panel_kinds(component, interval, factor), String::new()),
        Some(ErrorTerm::Tolerance(bound)) => {
            let unit = if direction.is_rotation() { "µrad" } else { "µm" };
            (Vec::new(), format!("tolerance ±{} {unit}", crate::units::significant(bound * factor, 4)))
        }
        _ => (Vec::new(), "not given: zero".to_owned()),
    };
    let id = ErrorId { axis: axis.name.clone(), family: ErrorFamily::Component, direction };
    let band = machine.uncertainty(&id).map(|half| half * factor);
    let sure = band.map_or(String::new(), |half| format!(", U = {}", crate::units::significant(half, 3)));
    Panel { name: id.to_string(), word: word(axis, direction) + &sure, curves, band, instead }
}

fn panel_kinds(component: &ComponentError, interval: Interval, factor: f64) -> Vec<PanelKind> {
    let approaches = match component {
        ComponentError::Single(_) => vec![Approach::Mean],
        ComponentError::Bidirectional { .. } => vec![Approach::Forward, Approach::Reverse],
    };
    let of = |(approach, curve): (Approach, &Curve)| {
        let knots = curve.knots();
        let points: Vec<(f64, f64)> = knots
            .map_or_else(Vec::new, |k| k.positions().iter().zip(k.values()).map(|(p, v)| (*p, v * factor)).collect());
        let even = (0..=SAMPLES).map(|i| interval.min + interval.span() * i as f64 / SAMPLES as f64);
        let within = |p: &f64| interval.contains(*p);
        let mut places: Vec<f64> = even.chain(points.iter().map(|p| p.0).filter(within)).collect();
        places.sort_by(f64::total_cmp);
        let line = places.iter().map(|p| (*p, component.value(&approach.at_position(*p)) * factor)).collect();
        PanelKind { line, points: points.into_iter().filter(|p| within(&p.0)).collect() }
    };
    approaches.into_iter().zip(component.curves()).map(of).collect()
}

/// Interval and step of a row's values; always with zero in it.
fn scale(panels: &[Panel]) -> (f64, f64, f64) {
    let ends = |panel: &Panel, value: f64| [value - panel.band.unwrap_or(0.0), value + panel.band.unwrap_or(0.0)];
    let lines = panels.iter().flat_map(|panel| panel.curves.iter().map(move |curve| (panel, curve)));
    let values = lines.flat_map(|(panel, curve)| curve.line.iter().flat_map(move |p| ends(panel, p.1)));
    let (min, max) = values.fold((0.0_f64, 0.0_f64), |(min, max), v| (min.min(v), max.max(v)));
    // Differences below a tenth of a nanometre are rounding, not errors.
    let step = round_step((max - min).max(1e-4), 4);
    (libm::floor(min / step + 1e-9) * step, libm::ceil(max / step - 1e-9) * step, step)
}

struct PanelFrame {
    corner: Point,
    x: Interval,
    /// Smallest value, largest value, step.
    y: (f64, f64, f64),
    unit: &'static str,
}

impl PanelFrame {
    fn at(&self, x: f64, y: f64) -> Point {
        let (low, high, _) = self.y;
        let fraction = (x - self.x.min) / self.x.span().max(1e-9);
        let rise = (high - y) / (high - low).max(1e-9);
        Point { x: self.corner.x + PANEL.0 * fraction, y: self.corner.y + PANEL.1 * rise }
    }

    fn draw(&self, svg: &mut Svg, panel: &Panel) {
        let Point { x, y } = self.corner;
        svg.text((x, y - 10.0), &format!("{}, {}", panel.name, self.unit), Font::bold(13.0), TextAnchor::Start, 0.0);
        svg.text((x + PANEL.0, y - 10.0), &panel.word, Font::faint(12.0), TextAnchor::End, 0.0);
        self.axes(svg);
        if panel.curves.is_empty() {
            let middle = (x + PANEL.0 / 2.0, y + PANEL.1 / 2.0 + 4.0);
            return svg.text(middle, &panel.instead, Font::faint(12.0), TextAnchor::Middle, 0.0);
        }
        for (curve, colour) in panel.curves.iter().zip([FIRST, SECOND]) {
            if let Some(half) = panel.band {
                let edge = |sign: f64| move |p: &(f64, f64)| (p.0, p.1 + sign * half);
                let upper = curve.line.iter().map(edge(1.0));
                let around = upper.chain(curve.line.iter().rev().map(edge(-1.0)));
                let around: Vec<Point> = around.map(|(q, value)| self.at(q, value)).collect();
                svg.path(&polygon(&around), &format!(r#"fill="{colour}" fill-opacity="0.18" class="band""#));
            }
        }
        for (curve, (colour, dash)) in panel.curves.iter().zip([(FIRST, ""), (SECOND, r#" stroke-dasharray="6 4""#)]) {
            let line: Vec<Point> = curve.line.iter().map(|p| self.at(p.0, p.1)).collect();
            svg.path(&polyline(&line), &format!(r#"fill="none" stroke="{colour}" stroke-width="1.8"{dash}"#));
            for point in &curve.points {
                svg.circle(self.at(point.0, point.1), 2.3, &format!(r#"fill="{colour}""#));
            }
        }
    }

    fn axes(&self, svg: &mut Svg) {
        let Point { x, y } = self.corner;
        let (low, high, step) = self.y;
        for value in ticks(Interval::new(low, high), step) {
            let at = self.at(self.x.min, value).y;
            let zero = value.abs() < 0.5 * step;
            let style =
                if zero { format!(r#"stroke="{FAINT}""#) } else { format!(r#"stroke="{LINE}" stroke-width="0.7""#) };
            svg.line((x, at), (x + PANEL.0, at), &style);
            svg.text((x - 6.0, at + 4.0), &tick_text(value, step), Font::plain(11.5), TextAnchor::End, 0.0);
        }
        let step = round_step(self.x.span(), 5);
        for value in ticks(self.x, step) {
            let at = self.at(value, low).x;
            svg.line((at, y + PANEL.1), (at, y + PANEL.1 + 4.0), &format!(r#"stroke="{INK}""#));
            svg.text((at, y + PANEL.1 + 18.0), &tick_text(value, step), Font::plain(11.5), TextAnchor::Middle, 0.0);
        }
        svg.rect(self.corner, PANEL, &format!(r#"fill="none" stroke="{FAINT}""#));
    }
}
