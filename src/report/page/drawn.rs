//! The pictures of a machine on the page.

use super::data::MachineData;
use super::given::MachineInput;
use super::render::Pictures;
use crate::analysis::zone::ProfilePoint;
use crate::analysis::{Plane, View, rest, space_axes};
use crate::evaluate::{Bare, Field, Frame, Poses};
use crate::job::round_features::RoundFeature;
use crate::machine::Pose;
use crate::report::pictures::{
    DialPanel, PlanePicture, PlaneQuantity, PlaneStyle, PolarPicture, axis_curves, chain_picture,
};
use crate::report::plane_picture::cells;
use crate::report::text::BudgetFigures;
use crate::units::significant;
use nalgebra::Vector3;
use std::convert::Infallible;

/// Intervals along the longer side of a plane.
const PLANE_NODES: f64 = 48.0;

/// The same for what bounds lead to: each node takes as long as all machines drawn.
const BOUNDED_NODES: f64 = 24.0;

const BARS: usize = 14;

impl Pictures {
    /// Draws a machine.
    pub fn new(given: &MachineInput<'_>, data: &MachineData) -> Self {
        let machine = given.machine;
        let curves = (0..machine.axes().len())
            .filter_map(|axis| Some((machine.axes()[axis].name.to_string(), axis_curves(machine, axis)?.svg())));
        let axes = space_axes(machine);
        let pairs = [(0, 1), (0, 2), (1, 2)].into_iter().filter_map(|(a, b)| Some([*axes.get(a)?, *axes.get(b)?]));
        Self {
            chain: chain_picture(machine).svg(),
            curves: curves.collect(),
            planes: pairs.map(|axes| plane(given, axes)).collect(),
            pareto: data.pareto(BARS).map_or_else(String::new, |picture| picture.svg()),
            round: round(given).unwrap_or_default(),
            instruments: given.instruments.pictures(machine),
            budget: given
                .budget
                .iter()
                .flat_map(|b| [b.pareto(machine.name(), BARS).svg(), b.waterfall(machine.name(), BARS).svg()])
                .collect(),
        }
    }
}

/// The profiles of the round features of a job; `None` without.
fn round(given: &MachineInput<'_>) -> Option<String> {
    let mut panels: Vec<DialPanel> = given.round.iter().map(dial).collect();
    let radius = |of: &RoundFeature| of.profile.radius;
    let times: Vec<f64> = given.round.iter().map(|of| PolarPicture::magnification(&panels, radius(of))).collect();
    for ((panel, of), times) in panels.iter_mut().zip(given.round).zip(times) {
        let around = [significant(of.profile.least_squares * 1e3, 3), significant(radius(of), 4)];
        let [width, radius] = around;
        panel.line = format!("least squares {width} \u{b5}m; {}\u{d7} at R {radius} mm", significant(times, 2));
    }
    let drawn = given.round.iter().any(|of| of.drawn);
    let which = if drawn { ", the machine drawn whose roundness is the 95 % value" } else { "" };
    let subtitle = format!("{}, deviation along the normal{which}", given.machine.name());
    (!panels.is_empty()).then(|| PolarPicture::profiles("Roundness", &subtitle, &panels).picture().svg())
}

/// The profile of a round feature, from the largest gap on; closed if no gap is larger than three steps.
fn dial(of: &RoundFeature) -> DialPanel {
    let points = &of.profile.points;
    let count = points.len();
    let gap = |i: usize| (points[(i + 1) % count].angle_deg - points[i].angle_deg).rem_euclid(360.0);
    let widest = (0..count).fold(0, |best, i| if gap(i) > gap(best) { i } else { best });
    let order = (1..=count).map(|k| &points[(widest + k) % count]);
    let curve = |value: fn(&ProfilePoint) -> f64| order.clone().map(|p| (p.angle_deg, value(p) * 1e3)).collect();
    let width = significant(of.profile.minimum_zone * 1e3, 3);
    let name = if of.feature.is_empty() { "tool poses" } else { of.feature.as_str() };
    DialPanel {
        directions: of.across.map(|direction| direction_name(&direction)),
        curves: vec![curve(|p| p.deviation), curve(|p| p.circle)],
        marks: Vec::new(),
        closed: gap(widest) <= 3.0 * 360.0 / count as f64,
        title: format!("{name}: roundness {width} \u{b5}m{}", if of.drawn { ", 95 % value" } else { "" }),
        line: String::new(),
    }
}

/// A direction by the axis that is next to it.
fn direction_name(direction: &Vector3<f64>) -> String {
    let axis = direction.iamax();
    let sign = if direction[axis] < 0.0 { "\u{2212}" } else { "+" };
    format!("{sign}{}", ["X", "Y", "Z"][axis])
}

/// A plane as a map and as a grid, and after each compensation with the same colours.
fn plane(given: &MachineInput<'_>, axes: [usize; 2]) -> (String, Vec<String>) {
    let MachineInput { machine, order, conditions, .. } = *given;
    let view = View { conditions, frame: Frame::Workpiece };
    let names = axes.map(|i| machine.axes()[i].name.to_string());
    let heading = format!("{}-{} plane", names[0], names[1]);
    if let Some(bounded) = given.budget() {
        return (heading, vec![bound_plane(given, bounded, axes, view)]);
    }
    let counts = cells(machine, axes, PLANE_NODES);
    let of = |field: &dyn Field| Plane::of(field, axes, &rest(machine), counts, view);
    let bare = of(&Bare { machine, order });
    let (state, like) = if given.written.is_empty() { ("", None) } else { ("uncompensated", Some(&bare)) };
    let picture = PlanePicture {
        machine,
        plane: &bare,
        view,
        order,
        shown: PlaneQuantity::Length,
        drawn: PlaneStyle::Colours,
        state,
        like,
        drawing: None,
    };
    let mut svgs = vec![picture.svg(), PlanePicture { drawn: PlaneStyle::Grid, ..picture }.svg()];
    for written in given.written {
        let after = of(&*written.effect.field(machine, &written.target));
        let state = format!("after {}", written.target.manifest.target);
        for drawn in [PlaneStyle::Colours, PlaneStyle::Grid] {
            svgs.push(PlanePicture { plane: &after, drawn, state: &state, like: Some(&bare), ..picture }.svg());
        }
    }
    (heading, svgs)
}

/// The plane of a machine of which nothing is measured: the 95 % value.
fn bound_plane(given: &MachineInput<'_>, bounded: &BudgetFigures, axes: [usize; 2], view: View) -> String {
    let machine = given.machine;
    let p95 = |poses: Vec<Pose>| {
        let found = given.at(bounded, &Poses::Listed(poses), Frame::Workpiece, None);
        Ok::<_, Infallible>(found.poses.iter().map(|pose| pose.position.p95).collect())
    };
    let Ok(plane) = Plane::of_lengths(machine, axes, &rest(machine), cells(machine, axes, BOUNDED_NODES), p95);
    let picture = PlanePicture {
        machine,
        plane: &plane,
        view,
        order: given.order,
        shown: PlaneQuantity::Length,
        drawn: PlaneStyle::Colours,
        state: "",
        like: None,
        drawing: Some(&bounded.drawing),
    };
    picture.svg()
}
