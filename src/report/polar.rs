//! The polar diagram of a ball bar: radial deviations about the least-squares centre, one exaggeration
//! for all planes.

use super::scale::round_step;
use super::svg::{Anchor, Font, INK, Picture, Svg, fitted, number, polygon};
use crate::analysis::instrument::BallBar;
use crate::machine::sin_cos_degrees;
use crate::units::significant;

/// Circles to be drawn side by side.
#[derive(Debug, Clone, Copy)]
pub struct PolarPicture<'a> {
    /// The first line.
    pub title: &'a str,
    /// The second line.
    pub subtitle: &'a str,
    /// The circles.
    pub circles: &'a [BallBar],
}

const PANEL: f64 = 290.0;
const LEFT: f64 = 24.0;
const TOP: f64 = 84.0;
/// Radius of the nominal circle, px.
const NOMINAL: f64 = 96.0;
/// Rings on either side of it.
const RINGS: i32 = 2;
/// From ring to ring, px.
const PITCH: f64 = 19.0;
const WAYS: [(&str, &str, &str); 2] =
    [("counter-clockwise", "#3b6ea8", ""), ("clockwise", "#b4533c", r#" stroke-dasharray="5 3""#)];

impl PolarPicture<'_> {
    /// The picture.
    pub fn picture(&self) -> Picture {
        let width = 2.0 * LEFT + PANEL * self.circles.len().max(2) as f64;
        let mut svg = Svg::new(width, TOP + PANEL + 100.0);
        svg.text((LEFT, 32.0), &fitted(self.title, 60), Font::bold(18.0), Anchor::Start, 0.0);
        svg.text((LEFT, 54.0), &fitted(self.subtitle, (width / 7.5) as usize), Font::faint(13.0), Anchor::Start, 0.0);
        let ring = self.ring();
        for (i, circle) in self.circles.iter().enumerate() {
            panel(&mut svg, circle, (LEFT + PANEL * (i as f64 + 0.5), TOP + PANEL * 0.5), ring);
        }
        let below = TOP + PANEL + 58.0;
        for (i, (name, colour, dash)) in WAYS.iter().enumerate() {
            let x = LEFT + 170.0 * i as f64;
            svg.line(
                (x, below - 4.0),
                (x + 26.0, below - 4.0),
                &format!(r#"stroke="{colour}" stroke-width="1.8"{dash}"#),
            );
            svg.text((x + 32.0, below), name, Font::plain(12.0), Anchor::Start, 0.0);
        }
        let note = format!(
            "One ring is {} µm of radial deviation; the dark circle is the nominal radius. Outwards: the machine is too far out.",
            significant(ring, 4)
        );
        svg.text((LEFT, below + 22.0), &note, Font::faint(12.0), Anchor::Start, 0.0);
        svg.picture(&format!("{}: {}", self.title, self.subtitle))
    }

    /// Micrometres from ring to ring.
    fn ring(&self) -> f64 {
        let all = self.circles.iter().flat_map(|c| c.centred.iter().flatten());
        let largest = all.fold(0.0_f64, |max, x| max.max(x.abs()));
        // Below a picometre there is nothing but rounding to draw.
        round_step(largest.max(1e-6), RINGS as usize)
    }
}

fn panel(svg: &mut Svg, circle: &BallBar, centre: (f64, f64), ring: f64) {
    for k in -RINGS..=RINGS {
        let style = if k == 0 {
            format!(r#"fill="none" stroke="{INK}" stroke-width="{}""#, number(1.1))
        } else {
            r##"fill="none" stroke="#d5dae0""##.to_owned()
        };
        svg.circle(centre, NOMINAL + PITCH * f64::from(k), &style);
    }
    let outer = NOMINAL + PITCH * f64::from(RINGS) + 6.0;
    svg.line((centre.0 - outer, centre.1), (centre.0 + outer, centre.1), r##"stroke="#d5dae0""##);
    svg.line((centre.0, centre.1 - outer), (centre.0, centre.1 + outer), r##"stroke="#d5dae0""##);
    for (way, (_, colour, dash)) in circle.centred.iter().zip(WAYS) {
        let point = |(r, angle): (&f64, &f64)| {
            let (sine, cosine) = sin_cos_degrees(*angle);
            let at = NOMINAL + PITCH * r / ring;
            (centre.0 + at * cosine, centre.1 - at * sine)
        };
        let points: Vec<(f64, f64)> = way.iter().zip(&circle.angles).map(point).collect();
        svg.path(&polygon(&points), &format!(r#"fill="none" stroke="{colour}" stroke-width="1.5"{dash}"#));
    }
    let [first, second] = circle.plane.directions().map(|i| ["+X", "+Y", "+Z"][i]);
    svg.text((centre.0 + outer, centre.1 - 5.0), first, Font::bold(12.0), Anchor::End, 0.0);
    svg.text((centre.0 + 6.0, centre.1 - outer + 4.0), second, Font::bold(12.0), Anchor::Start, 0.0);
    let below = centre.1 + outer + 22.0;
    let title = format!("{}: G(b) {} µm", circle.plane.name(), significant(circle.bidirectional, 3));
    svg.text((centre.0, below), &title, Font::bold(13.0), Anchor::Middle, 0.0);
    let line = format!(
        "G {} and {} µm, squareness {} µrad",
        significant(circle.deviation[0], 3),
        significant(circle.deviation[1], 3),
        significant(circle.squareness, 3)
    );
    svg.text((centre.0, below + 18.0), &line, Font::faint(12.0), Anchor::Middle, 0.0);
}
