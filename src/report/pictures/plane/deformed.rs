//! The plane as a grid: nominal in grey, displaced in blue with one exaggeration.

use super::picture::PlanePicture;
use crate::report::pictures::svg::{Point, Svg, polyline};

/// Lines along the longer side, about.
const LINES: usize = 12;

const NOMINAL: &str = "#c3cad1";
const ACTUAL: &str = "#1d5fa8";

impl PlanePicture<'_> {
    pub(crate) fn draw_deformed(&self, svg: &mut Svg, scale: f64, exaggeration: Option<f64>) {
        let [columns, rows] = self.plane.counts;
        let stride = (columns.max(rows) - 1).div_ceil(LINES).max(1);
        let nominal = |node: (usize, usize)| self.at(scale, self.node(node.0, node.1));
        let times = exaggeration.unwrap_or(0.0) * scale;
        let actual = |node: (usize, usize)| {
            let (from, [u, v]) = (nominal(node), self.in_plane(node.0, node.1));
            Point { x: from.x + u * times, y: from.y - v * times }
        };
        let upward = lines(columns, stride).into_iter().map(|i| (0..rows).map(|j| (i, j)).collect::<Vec<_>>());
        let across = lines(rows, stride).into_iter().map(|j| (0..columns).map(|i| (i, j)).collect());
        let lines: Vec<Vec<(usize, usize)>> = upward.chain(across).collect();
        for line in &lines {
            let path: Vec<Point> = line.iter().map(|node| nominal(*node)).collect();
            svg.path(&polyline(&path), &format!(r#"fill="none" stroke="{NOMINAL}""#));
        }
        for line in &lines {
            let path: Vec<Point> = line.iter().map(|node| actual(*node)).collect();
            svg.path(&polyline(&path), &format!(r#"fill="none" stroke="{ACTUAL}" stroke-width="1.5""#));
        }
    }
}

/// Returns every `stride`-th node, the last one always.
fn lines(count: usize, stride: usize) -> Vec<usize> {
    let mut lines: Vec<usize> = (0..count).step_by(stride).collect();
    if lines.last() != Some(&(count - 1)) {
        lines.push(count - 1);
    }
    lines
}
