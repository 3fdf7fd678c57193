//! A plane to be drawn, and its places in the picture.

use crate::analysis::{Plane, View};
use crate::evaluate::Order;
use crate::machine::Machine;
use crate::report::pictures::svg::Point;
use crate::report::text::DrawSettings;
use crate::units::Interval;

/// Quantity that the colours show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaneQuantity {
    /// Length of the position deviation.
    Length,
    /// One component of it: 0, 1, 2 for x, y, z of the frame.
    Component(usize),
}

/// Style of the drawing of the plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PlaneStyle {
    /// A colour map, with arrows.
    #[default]
    Colours,
    /// The nominal grid, and the same displaced.
    Grid,
}

/// A plane to be drawn, and how it was computed.
#[derive(Debug, Clone, Copy)]
pub struct PlanePicture<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// The deviations.
    pub plane: &'a Plane,
    /// Frame and approach they were computed with.
    pub view: View,
    /// Order they were computed to.
    pub order: Order,
    /// Quantity that the colours show.
    pub shown: PlaneQuantity,
    /// Style of the drawing.
    pub drawn: PlaneStyle,
    /// State of the machine, such as `after compensation by linuxcnc`; may be empty.
    pub state: &'a str,
    /// The plane (perhaps this one) whose colours, from zero, and exaggeration are shared by pictures that are
    /// to be compared; `None` for a scale of its own.
    pub like: Option<&'a Plane>,
    /// The machines drawn, where the plane holds the length that 95 % of them do not exceed.
    pub drawing: Option<&'a DrawSettings>,
}

pub(super) const LEFT: f64 = 78.0;
pub(super) const TOP: f64 = 74.0;
const WIDEST: f64 = 640.0;
const HIGHEST: f64 = 390.0;
/// Room around a grid for nodes that are displaced beyond its edges.
pub(super) const MARGIN: f64 = 42.0;

impl PlanePicture<'_> {
    /// The plane that sets colours and exaggeration.
    pub(super) fn reference(&self) -> &Plane {
        self.like.unwrap_or(self.plane)
    }

    pub(super) fn axis(&self, k: usize) -> &str {
        self.machine.axes()[self.plane.axes[k]].name.as_str()
    }

    pub(super) fn interval(&self, k: usize) -> Interval {
        let (min, max) = self.plane.intervals[k];
        Interval::new(min, max)
    }

    pub(super) fn span(&self, k: usize) -> f64 {
        self.interval(k).span().max(1e-9)
    }

    pub(super) fn margin(&self) -> f64 {
        if self.drawn == PlaneStyle::Grid { MARGIN } else { 0.0 }
    }

    /// Pixels per mm: the same for both axes, so that one exaggeration is true for all arrows.
    pub(super) fn scale(&self) -> f64 {
        let around = 2.0 * self.margin();
        ((WIDEST - around) / self.span(0)).min((HIGHEST - around) / self.span(1))
    }

    pub(super) fn area(&self, scale: f64) -> (f64, f64) {
        (self.span(0) * scale, self.span(1) * scale)
    }

    pub(super) fn at(&self, scale: f64, position: Point) -> Point {
        let [(left, _), (_, top)] = self.plane.intervals;
        let margin = self.margin();
        Point { x: LEFT + margin + (position.x - left) * scale, y: TOP + margin + (top - position.y) * scale }
    }

    /// Returns the position of a node in the plane, mm.
    pub(super) fn node(&self, i: usize, j: usize) -> Point {
        Point { x: self.plane.position(0, i), y: self.plane.position(1, j) }
    }

    pub(super) fn in_plane(&self, i: usize, j: usize) -> [f64; 2] {
        self.plane.in_plane(j * self.plane.counts[0] + i).unwrap_or_default()
    }

    pub(super) fn title(&self) -> String {
        self.machine.name().to_owned()
    }
}
