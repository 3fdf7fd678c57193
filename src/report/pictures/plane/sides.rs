//! Before and after: the same plane in two states.

use super::picture::PlanePicture;
use crate::report::pictures::svg::{Picture, Svg};

/// Size of a panel of three, as a fraction of a plane's own.
const SHARE: f64 = 0.62;

/// Three panels: before; after, with the colours and the exaggeration of before; and the residual with colours and
/// exaggeration of its own. Both pictures show the same plane of the same machine.
pub fn before_after(before: &PlanePicture<'_>, after: &PlanePicture<'_>) -> Picture {
    let compared = PlanePicture { like: Some(before.plane), ..*after };
    let first = PlanePicture { like: Some(before.plane), ..*before };
    let state = format!("{}, own scale", after.state);
    let left = PlanePicture { like: None, state: &state, ..*after };
    let panels = [first.draw(), compared.draw(), left.draw()];
    let (width, height) = panels.iter().map(Svg::size).fold((0.0, 0.0_f64), |(w, h), s| (w + s.0, h.max(s.1)));
    let mut svg = Svg::new(width * SHARE, height * SHARE);
    let mut x = 0.0;
    for panel in panels {
        let step = panel.size().0 * SHARE;
        svg.place((x, 0.0), SHARE, panel);
        x += step;
    }
    svg.picture(&format!("{}, before and after", before.title()))
}
