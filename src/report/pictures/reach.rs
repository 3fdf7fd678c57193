//! The workspace: sections of a box, each tip coloured by the share of tool directions that are reached there.

use super::frame::{PlotAxis, PlotFrame};
use super::scale::rising;
use super::svg::{FAINT, Font, Picture, Svg, TextAnchor, truncate, wrap};
use crate::analysis::ReachGrid;
use crate::units::significant;

/// Width of the picture, and of a section, px.
const WIDTH: f64 = 1000.0;
const SECTION: f64 = 218.0;
/// Left and upper edge of the first section, and the distances to the next ones.
const LEFT: f64 = 84.0;
const TOP: f64 = 108.0;
const ACROSS: f64 = 306.0;
const GAP: f64 = 92.0;
/// Sections of a row, and of the picture at most.
const COLUMNS: usize = 3;
const SECTIONS: usize = 6;
const SIDES: [&str; 3] = ["X", "Y", "Z"];

/// Sections of a box.
pub struct ReachPicture<'a> {
    /// The title.
    pub title: &'a str,
    /// The tips.
    pub grid: &'a ReachGrid,
    /// Share of the directions reached at each tip, 0 to 1, x running fastest.
    pub shares: &'a [f64],
    /// Lines below.
    pub notes: &'a [String],
}

impl ReachPicture<'_> {
    /// Returns the picture.
    pub fn picture(&self) -> Picture {
        let (normal, steps) = self.sections();
        let [right, up] = sides_of(normal);
        let height = self.height(right, up);
        let rows = steps.len().div_ceil(COLUMNS);
        let notes: Vec<String> = self.notes.iter().flat_map(|note| wrap(note, 118)).collect();
        let below = TOP + rows as f64 * (height + GAP) - 20.0;
        let mut svg = Svg::new(WIDTH, below + 18.5 * notes.len() as f64 + 12.0);
        let subtitle = format!("Reach of the nominal machine, sections across {} of the part", SIDES[normal]);
        svg.text((28.0, 32.0), &truncate(self.title, 80), Font::bold(18.0), TextAnchor::Start, 0.0);
        svg.text((28.0, 54.0), &subtitle, Font::faint(14.0), TextAnchor::Start, 0.0);
        for (i, step) in steps.iter().enumerate() {
            let left = LEFT + ACROSS * (i % COLUMNS) as f64;
            let top = TOP + (height + GAP) * (i / COLUMNS) as f64;
            let frame = PlotFrame { left, top, width: SECTION, height };
            self.section(&mut svg, &frame, normal, *step);
        }
        bar(&mut svg);
        for (i, note) in notes.iter().enumerate() {
            svg.text((28.0, below + 18.5 * i as f64), note, Font::plain(13.5), TextAnchor::Start, 0.0);
        }
        svg.picture(&format!("{}: {subtitle}", self.title))
    }

    /// Returns the side across which the box is cut, and the steps along it that are drawn: Z, but a side of one step
    /// for a box without height there.
    fn sections(&self) -> (usize, Vec<usize>) {
        let counts = self.grid.counts;
        let normal = [2, 1, 0].into_iter().find(|side| counts[*side] == 1).unwrap_or(2);
        let drawn = counts[normal].min(SECTIONS);
        let last = counts[normal] - 1;
        let step = |i: usize| if drawn > 1 { (i * last + (drawn - 1) / 2) / (drawn - 1) } else { 0 };
        (normal, (0..drawn).map(step).collect())
    }

    /// Returns the height of a section, px: to scale, within limits.
    fn height(&self, right: usize, up: usize) -> f64 {
        let length = |side: usize| self.grid.region[side][1] - self.grid.region[side][0];
        let ratio = length(up) / length(right);
        if ratio.is_finite() { (SECTION * ratio).clamp(60.0, 400.0) } else { SECTION }
    }

    fn section(&self, svg: &mut Svg, frame: &PlotFrame, normal: usize, step: usize) {
        let [right, up] = sides_of(normal);
        let grid = self.grid;
        let (columns, rows) = (grid.counts[right], grid.counts[up]);
        let (width, height) = (frame.width / columns as f64, frame.height / rows as f64);
        for j in 0..rows {
            for i in 0..columns {
                let mut at = [0; 3];
                (at[normal], at[right], at[up]) = (step, i, j);
                let index = at[0] + grid.counts[0] * (at[1] + grid.counts[1] * at[2]);
                let share = self.shares.get(index).copied().unwrap_or(0.0);
                if share > 0.0 {
                    let corner = (frame.left + width * i as f64, frame.top + frame.height - height * (j + 1) as f64);
                    let colour = rising(share);
                    // The thin line closes the seams between neighbouring cells.
                    let style = format!(r#"fill="{colour}" stroke="{colour}" stroke-width="0.3""#);
                    svg.rect(corner, (width, height), &style);
                }
            }
        }
        // A cell reaches half a step beyond its tip.
        let ends = |side: usize| {
            let [min, max] = grid.region[side];
            let half = 0.5 * (max - min) / grid.counts[side].saturating_sub(1).max(1) as f64;
            PlotAxis::new(min - half, max + half)
        };
        frame.horizontal(svg, &ends(right), &format!("{}, mm", SIDES[right]));
        frame.vertical(svg, &ends(up), &format!("{}, mm", SIDES[up]));
        let head = format!("{} = {} mm", SIDES[normal], significant(grid.position(normal, step), 6));
        svg.text((frame.left, frame.top - 9.0), &head, Font::plain(13.0), TextAnchor::Start, 0.0);
    }
}

/// Returns the sides that are drawn to the right and upwards across a side.
fn sides_of(normal: usize) -> [usize; 2] {
    match normal {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    }
}

fn bar(svg: &mut Svg) {
    const STEPS: usize = 20;
    let (left, width) = (WIDTH - 300.0, 200.0 / STEPS as f64);
    for k in 0..STEPS {
        let colour = rising((k as f64 + 0.5) / STEPS as f64);
        svg.rect((left + width * k as f64, 44.0), (width, 12.0), &format!(r#"fill="{colour}""#));
    }
    svg.rect((left, 44.0), (200.0, 12.0), &format!(r#"fill="none" stroke="{FAINT}""#));
    svg.text((left - 8.0, 54.5), "0", Font::plain(12.0), TextAnchor::End, 0.0);
    svg.text((left + 208.0, 54.5), "all directions", Font::plain(12.0), TextAnchor::Start, 0.0);
}
