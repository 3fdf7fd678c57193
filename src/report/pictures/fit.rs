//! Prediction against data over a plane: the nominal points, where they were measured, where the fitted machine puts
//! them, all displacements drawn larger by one factor.

use super::scale::{round_step, tick_text, ticks};
use super::svg::{FAINT, FIRST, Font, INK, Point, SECOND, Svg, TextAnchor};
use crate::units::Interval;
use crate::units::significant;

/// One pose: nominal position (mm), and the in-plane deviations (mm).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitPoint {
    /// Commanded positions of the axes.
    pub nominal: (f64, f64),
    /// Measured, actual minus nominal.
    pub measured: (f64, f64),
    /// The same as the fitted machine has it.
    pub predicted: (f64, f64),
}

/// A plane to be drawn.
#[derive(Debug, Clone)]
pub struct FitPicture<'a> {
    /// The machine's name.
    pub machine: &'a str,
    /// The axis to the right, and the one upwards.
    pub axes: [&'a str; 2],
    /// Positions of the other axes.
    pub slice: String,
    /// The poses.
    pub points: Vec<FitPoint>,
}

const WIDTH: f64 = 740.0;
const LEFT: f64 = 112.0;
const TOP: f64 = 116.0;
const WIDEST: f64 = 540.0;
const HIGHEST: f64 = 460.0;
/// Between the outermost points and the frame.
const MARGIN: f64 = 44.0;

/// Lowest and highest of some numbers, a little apart.
fn span(values: impl Iterator<Item = f64>) -> Interval {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if high > low { Interval::new(low, high) } else { Interval::new(low - 1.0, low + 1.0) }
}

impl FitPicture<'_> {
    /// The picture as an SVG file.
    pub fn svg(&self) -> String {
        let across = span(self.points.iter().map(|p| p.nominal.0));
        let up = span(self.points.iter().map(|p| p.nominal.1));
        let scale = (WIDEST / across.span()).min(HIGHEST / up.span());
        let size = Point { x: across.span() * scale, y: up.span() * scale };
        let at = |x: f64, y: f64| Point { x: LEFT + (x - across.min) * scale, y: TOP + (up.max - y) * scale };
        let magnified = self.magnification(scale);
        let moved = |p: &FitPoint, d: (f64, f64)| at(p.nominal.0 + d.0 * magnified, p.nominal.1 + d.1 * magnified);
        let mut svg = Svg::new(WIDTH, TOP + size.y + MARGIN + 100.0);
        let subtitle = format!("Prediction and data over {}-{}, {}", self.axes[0], self.axes[1], self.slice);
        svg.heading(LEFT - MARGIN, self.machine, 60, &subtitle, 84);
        self.grid(&mut svg, across, up, size, &at);
        for p in &self.points {
            let (nominal, read, said) = (at(p.nominal.0, p.nominal.1), moved(p, p.measured), moved(p, p.predicted));
            let faint = format!(r#"stroke="{FAINT}" stroke-width="0.8""#);
            svg.line(nominal, read, &faint);
            svg.circle(nominal, 1.4, &format!(r#"fill="{FAINT}""#));
            svg.circle(read, 4.2, &format!(r#"fill="none" stroke="{FIRST}" stroke-width="1.4""#));
            let cross = format!(r#"stroke="{SECOND}" stroke-width="1.4""#);
            svg.line((said.x - 3.4, said.y - 3.4), (said.x + 3.4, said.y + 3.4), &cross);
            svg.line((said.x - 3.4, said.y + 3.4), (said.x + 3.4, said.y - 3.4), &cross);
        }
        let below = TOP + size.y + MARGIN + 56.0;
        svg.circle((LEFT + 6.0, below - 4.0), 4.2, &format!(r#"fill="none" stroke="{FIRST}" stroke-width="1.4""#));
        svg.text((LEFT + 18.0, below), "measured", Font::plain(12.0), TextAnchor::Start, 0.0);
        let cross = format!(r#"stroke="{SECOND}" stroke-width="1.4""#);
        svg.line((LEFT + 103.0, below - 7.4), (LEFT + 109.0, below - 0.6), &cross);
        svg.line((LEFT + 103.0, below - 0.6), (LEFT + 109.0, below - 7.4), &cross);
        svg.text((LEFT + 118.0, below), "predicted", Font::plain(12.0), TextAnchor::Start, 0.0);
        let words = format!("displacements drawn {} times as large", significant(magnified, 4));
        svg.text((LEFT + 200.0, below), &words, Font::faint(12.0), TextAnchor::Start, 0.0);
        svg.text((LEFT, below + 20.0), &self.words(), Font::plain(12.0), TextAnchor::Start, 0.0);
        svg.picture(&format!("{}: {subtitle}", self.machine)).svg()
    }

    fn words(&self) -> String {
        let rms = |f: &dyn Fn(&FitPoint) -> (f64, f64)| {
            let sum: f64 = self.points.iter().map(f).map(|(x, y)| x * x + y * y).sum();
            significant(libm::sqrt(sum / self.points.len().max(1) as f64) * 1e3, 3)
        };
        let data = rms(&|p| p.measured);
        let residual = rms(&|p| (p.measured.0 - p.predicted.0, p.measured.1 - p.predicted.1));
        let count = self.points.len();
        format!(
            "{count} points, root mean square in the plane: {data} µm measured, {residual} µm residual after the \
             prediction"
        )
    }

    /// Returns the magnification at which the largest displacement is as long as the margin allows, rounded down to 1,
    /// 2 or 5.
    fn magnification(&self, scale: f64) -> f64 {
        let sizes = self.points.iter().flat_map(|p| [p.measured, p.predicted]).map(|(x, y)| libm::hypot(x, y));
        let largest = sizes.fold(0.0, f64::max);
        if !(largest > 0.0 && largest.is_finite()) {
            return 1.0;
        }
        let max = MARGIN / (largest * scale);
        // The step above a tenth of it is between it and a tenth.
        [10.0, 5.0, 2.0, 1.0].into_iter().map(|f| round_step(max / 10.0, 1) * f).find(|m| *m <= max).unwrap_or(1.0)
    }

    fn grid(&self, svg: &mut Svg, across: Interval, up: Interval, size: Point, at: &impl Fn(f64, f64) -> Point) {
        let frame = format!(r#"fill="none" stroke="{INK}" stroke-width="0.8""#);
        svg.rect((LEFT - MARGIN, TOP - MARGIN), (size.x + 2.0 * MARGIN, size.y + 2.0 * MARGIN), &frame);
        let (bottom, side) = (TOP + size.y + MARGIN, LEFT - MARGIN);
        let step = round_step(across.span(), 7);
        for tick in ticks(across, step) {
            let x = at(tick, up.min).x;
            svg.line((x, bottom), (x, bottom + 5.0), &format!(r#"stroke="{INK}" stroke-width="0.8""#));
            svg.text((x, bottom + 18.0), &tick_text(tick, step), Font::plain(11.0), TextAnchor::Middle, 0.0);
        }
        let step = round_step(up.span(), 7);
        for tick in ticks(up, step) {
            let y = at(across.min, tick).y;
            svg.line((side - 5.0, y), (side, y), &format!(r#"stroke="{INK}" stroke-width="0.8""#));
            svg.text((side - 8.0, y + 4.0), &tick_text(tick, step), Font::plain(11.0), TextAnchor::End, 0.0);
        }
        let names = [format!("{} in mm", self.axes[0]), format!("{} in mm", self.axes[1])];
        svg.text((LEFT + size.x / 2.0, bottom + 34.0), &names[0], Font::plain(12.0), TextAnchor::Middle, 0.0);
        svg.text((22.0, TOP + size.y / 2.0), &names[1], Font::plain(12.0), TextAnchor::Middle, -90.0);
    }
}
