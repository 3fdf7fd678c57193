//! Bands of colour between round levels, and their bar.

use super::picture::PlaneQuantity;
use crate::report::pictures::scale::{diverging_colour, rising, round_step, tick_text};
use crate::report::pictures::svg::{FAINT, Font, INK, Point, Svg, TextAnchor, number};

/// Maximum number of bands of colour.
const BANDS: usize = 14;

/// Bands of colour between round levels.
pub(crate) struct ColourBands {
    first: f64,
    step: f64,
    count: usize,
    signed: bool,
}

impl ColourBands {
    pub(crate) fn new(values: &[f64], shown: PlaneQuantity) -> Self {
        let (min, max) =
            values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), v| (min.min(*v), max.max(*v)));
        let signed = shown != PlaneQuantity::Length;
        let (min, max) = if max >= min { (min, max) } else { (0.0, 0.0) };
        // Differences below a tenth of a nanometre are rounding, not errors.
        let step = round_step((max - min).max(1e-4), BANDS - 2);
        let first = libm::floor(min / step + 1e-9) * step;
        let count = libm::ceil((max - first) / step - 1e-9).clamp(1.0, 3.0 * BANDS as f64) as usize;
        Self { first, step, count, signed }
    }

    pub(crate) fn count(&self) -> usize {
        self.count
    }

    pub(crate) fn level(&self, band: usize) -> f64 {
        self.first + self.step * band as f64
    }

    pub(crate) fn colour(&self, band: usize) -> String {
        let middle = self.level(band) + 0.5 * self.step;
        if self.signed {
            let largest = self.level(0).abs().max(self.level(self.count).abs());
            diverging_colour(middle / largest.max(self.step))
        } else {
            rising((band as f64 + 0.5) / self.count as f64)
        }
    }

    pub(crate) fn bar(&self, svg: &mut Svg, corner: Point, height: f64, quantity: &str) {
        let band = height / self.count as f64;
        // Every how many levels there is a number; zero has one.
        let every = self.count.div_ceil((height / 18.0) as usize).max(1);
        for k in 0..=self.count {
            let y = corner.y + height - band * k as f64;
            if k < self.count {
                svg.rect((corner.x, y - band), (18.0, band), &format!(r#"fill="{}""#, self.colour(k)));
            }
            if ((self.level(k) / self.step).round() as i64) % every as i64 == 0 {
                svg.line((corner.x + 18.0, y), (corner.x + 23.0, y), &format!(r#"stroke="{INK}""#));
                svg.text(
                    (corner.x + 27.0, y + 4.0),
                    &tick_text(self.level(k), self.step),
                    Font::plain(13.0),
                    TextAnchor::Start,
                    0.0,
                );
            }
        }
        let outline = format!(r#"fill="none" stroke="{FAINT}" stroke-width="{}""#, number(0.8));
        svg.rect(corner, (18.0, height), &outline);
        svg.text((corner.x + 78.0, corner.y + height / 2.0), quantity, Font::plain(14.0), TextAnchor::Middle, -90.0);
    }
}
