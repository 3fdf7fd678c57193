//! The field of the 3D view: deviations on a coarse grid over three axes, at a few stations of the others,
//! of all errors together, of groups and single errors (first order), and after compensation.
//!
//! Positions and vectors are in directions of the machine frame, positions relative to the workpiece origin: so the
//! volume does not move while a table turns.

use super::given::MachineInput;
use crate::analysis::budget::{BoundedLength, Draws, effects_at};
use crate::analysis::{View, deviation_in, rest, space_axes};
use crate::evaluate::{Bare, Deviation, Frame, Poses, error_by_error, evaluate, frame_rotation};
use crate::machine::{Axis, ErrorId, ErrorTerm, Machine, Pose, axis_positions};
use crate::report::pictures::round_step;
use crate::report::text::{BudgetFigures, pose_words};
use nalgebra::Vector3;
use rayon::prelude::*;
use serde::Serialize;
use serde_json::{Value, json};

/// The grid, and the deviations at its nodes.
#[derive(Debug, Clone, Serialize)]
pub struct FieldData {
    /// Axes of the grid, the first running fastest.
    grid: Vec<GridAxis>,
    /// Positions of the other axes.
    stations: Vec<FieldStation>,
    layers: Vec<FieldLayer>,
    /// Factors to choose from.
    exaggerations: Vec<f64>,
    /// Index of the factor to begin with.
    exaggeration: usize,
}

#[derive(Debug, Clone, Serialize)]
struct GridAxis {
    name: String,
    unit: &'static str,
    positions: Vec<f64>,
}

/// One set of positions of the other axes.
#[derive(Debug, Clone, Serialize)]
struct FieldStation {
    label: String,
    /// Nominal tip at each node, relative to the workpiece origin in machine directions, mm; three numbers a node.
    nominal_mm: Vec<f64>,
}

#[derive(Debug, Clone, Serialize)]
struct FieldLayer {
    id: String,
    label: String,
    /// `total`, `axis`, `kind`, `error`, `after` or `removed`.
    group: &'static str,
    /// One for each station.
    at: Vec<LayerAt>,
}

#[derive(Debug, Clone, Serialize)]
struct LayerAt {
    /// Deviations in nm (machine directions), three numbers a node.
    #[serde(skip_serializing_if = "Option::is_none")]
    deviation_nm: Option<Vec<i64>>,
    /// Lengths in nm, a number a node, of what bounds lead to in place of deviations.
    #[serde(skip_serializing_if = "Option::is_none")]
    length_nm: Option<Vec<i64>>,
    /// The end of the colour scale.
    max_um: f64,
    mean_um: f64,
    /// Numbers on the colour scale.
    ticks_um: Vec<f64>,
    /// Node of the largest, and where it is.
    worst: usize,
    worst_at: Value,
}

/// Approximate limit of the numbers in all layers together: with both engines the page is sent by mail.
const MAX_NUMBERS: usize = 160_000;

/// Numbers of nodes of a grid axis, from the largest to the smallest. Odd, so that there is a middle.
const NODES: [usize; 5] = [11, 9, 7, 5, 3];

/// Number of nodes of a grid axis of what bounds lead to: each node takes as long as all machines drawn.
const BOUNDED_NODES: usize = 7;

const MAX_STATIONS: usize = 8;

impl FieldData {
    /// Evaluates all layers.
    pub fn new(given: &MachineInput<'_>) -> Self {
        let machine = given.machine;
        let axes = grid_axes(machine);
        let poses = stations(machine, &axes);
        let groups = groups(machine);
        let layers = 1 + groups.len() + 2 * given.written.len();
        let numbers = |n: usize| 3 * layers * poses.len() * n.pow(u32::try_from(axes.len()).unwrap_or(3));
        let count = NODES.into_iter().find(|n| numbers(*n) <= MAX_NUMBERS).unwrap_or(NODES[NODES.len() - 1]);
        let lattice = Lattice { given, axes, count };
        let stations: Vec<Sampled> = poses.iter().map(|pose| lattice.sample(pose, &groups)).collect();
        let layers = lattice.layers(&stations, &groups);
        let largest = layers.first().map_or(0.0, |layer| layer.at.iter().map(|at| at.max_um).fold(0.0, f64::max));
        let exaggerations = exaggerations();
        Self {
            exaggeration: first_factor(&exaggerations, extent(&stations), largest * 1e-3),
            grid: lattice.axes.iter().map(|axis| lattice.grid_axis(*axis)).collect(),
            stations: lattice.stations(&poses, stations),
            layers,
            exaggerations,
        }
    }
}

impl FieldData {
    /// Evaluates all layers of a machine of which nothing is measured: lengths, from its bounds.
    pub fn of_bounds(given: &MachineInput<'_>, bounded: &BudgetFigures) -> Self {
        let machine = given.machine;
        let axes = grid_axes(machine);
        let poses = stations(machine, &axes);
        let groups = bound_groups(machine, bounded);
        let count = BOUNDED_NODES;
        let lattice = Lattice { given, axes, count };
        let nodes: Vec<Pose> =
            poses.iter().flat_map(|station| (0..lattice.len()).map(|node| lattice.pose(station, node))).collect();
        let found = given.at(bounded, &Poses::Listed(nodes.clone()), Frame::Workpiece, None);
        let rows: Vec<Vec<f64>> = nodes.par_iter().map(|pose| effect_squares(machine, bounded, pose)).collect();
        let of = |lengths: Vec<f64>| lengths.chunks(lattice.len()).map(|at| lattice.of_lengths(at)).collect();
        let group = |g: &LayerGroup<usize>| FieldLayer {
            id: g.id.clone(),
            label: g.label.clone(),
            group: g.group,
            at: of(rows.iter().map(|row| g.members.iter().map(|i| row[*i]).sum::<f64>().sqrt() * 1e3).collect()),
        };
        let total = |id: &str, label: &str, length: fn(&BoundedLength) -> f64| FieldLayer {
            id: id.to_owned(),
            label: label.to_owned(),
            group: "total",
            at: of(found.poses.iter().map(|pose| length(&pose.position) * 1e3).collect()),
        };
        let mut layers = vec![total("total", "95 % of the drawn machines", |of| of.p95)];
        layers.push(total("rss", "RSS of all bounds", |of| of.rss));
        layers.extend(groups.iter().map(group));
        let nominal =
            |pose: &Pose| evaluate(machine, &given.conditions.at_pose(pose), given.order, Frame::Machine).nominal;
        let places: Vec<Vector3<f64>> = nodes.par_iter().map(nominal).collect();
        let sampled = places.chunks(lattice.len()).map(|at| Sampled { nominal: at.to_vec(), nodes: Vec::new() });
        Self {
            exaggeration: 0,
            grid: lattice.axes.iter().map(|axis| lattice.grid_axis(*axis)).collect(),
            stations: lattice.stations(&poses, sampled.collect()),
            layers,
            exaggerations: vec![1.0],
        }
    }
}

/// Squared effects of the bounds alone on the position at a pose, mm^2, in their order.
fn effect_squares(machine: &Machine, bounded: &BudgetFigures, pose: &[f64]) -> Vec<f64> {
    let mut squares = vec![0.0; bounded.bounds.len()];
    let draws = Draws::new(bounded.drawing.seed, bounded.drawing.distribution);
    effects_at(machine, &bounded.bounds, pose, &draws, None)
        .into_iter()
        .for_each(|(i, length)| squares[i] = length * length);
    squares
}

/// Groups of bounds, by their indices: by kind, by axis, and one by one.
fn bound_groups(machine: &Machine, bounded: &BudgetFigures) -> Vec<LayerGroup<usize>> {
    let bounds = || bounded.bounds.iter().enumerate();
    let members = |keep: &dyn Fn(&ErrorId) -> bool| bounds().filter(|(_, b)| keep(&b.error)).map(|(i, _)| i).collect();
    let alone = bounds().map(|(i, b)| LayerGroup::new(b.to_string(), format!("{b} at its bound"), "error", vec![i]));
    by_kind_and_axis(machine, "RSS of all", &members, alone)
}

/// Three linear axes that span space; where there are fewer, axes of the chain fill up.
fn grid_axes(machine: &Machine) -> Vec<usize> {
    let mut axes = space_axes(machine);
    let moves = |i: &usize| machine.volume()[*i].max > machine.volume()[*i].min;
    for axis in (0..machine.axes().len()).filter(moves) {
        if axes.len() < 3 && !axes.contains(&axis) {
            axes.push(axis);
        }
    }
    axes
}

/// All at rest; then each axis that is not of the grid at its ends or quarters, alone.
fn stations(machine: &Machine, grid: &[usize]) -> Vec<Pose> {
    let home = rest(machine);
    let mut list = vec![home.clone()];
    for axis in (0..home.len()).filter(|axis| !grid.contains(axis)) {
        let volume = machine.volume()[axis];
        let places: &[f64] =
            if machine.is_continuous(axis) { &[90.0, 180.0, 270.0] } else { &[volume.min, volume.max] };
        for place in places.iter().filter(|q| (volume.min..=volume.max).contains(*q) && **q != home[axis]) {
            let mut pose = home.clone();
            pose[axis] = *place;
            list.push(pose);
        }
    }
    list.truncate(MAX_STATIONS);
    list
}

/// A choice of errors or bounds.
struct LayerGroup<T> {
    id: String,
    label: String,
    group: &'static str,
    members: Vec<T>,
}

impl<T> LayerGroup<T> {
    fn new(id: String, label: String, group: &'static str, members: Vec<T>) -> Self {
        Self { id, label, group, members }
    }
}

/// Groups of errors by kind, by axis, and one by one.
fn groups(machine: &Machine) -> Vec<LayerGroup<ErrorId>> {
    let known: Vec<ErrorId> =
        machine.errors().filter(|(_, term)| !matches!(term, ErrorTerm::Tolerance(_))).map(|(id, _)| id).collect();
    let members = |keep: &dyn Fn(&ErrorId) -> bool| known.iter().filter(|id| keep(id)).cloned().collect();
    let alone = known.iter().map(|id| LayerGroup::new(id.to_string(), id.to_string(), "error", vec![id.clone()]));
    by_kind_and_axis(machine, "all", &members, alone)
}

/// Those of the errors that a condition keeps.
type Members<'a, T> = &'a dyn Fn(&dyn Fn(&ErrorId) -> bool) -> Vec<T>;

/// Groups that have members: by kind, by axis, and those given alone.
fn by_kind_and_axis<T>(
    machine: &Machine,
    what: &str,
    members: Members<'_, T>,
    alone: impl Iterator<Item = LayerGroup<T>>,
) -> Vec<LayerGroup<T>> {
    let kind = |id: &str, location: bool| {
        let label = format!("{what} {id} errors");
        LayerGroup::new(id.to_owned(), label, "kind", members(&|error| error.is_location() == location))
    };
    let mut groups = vec![kind("location", true), kind("component", false)];
    let names = machine.axes().iter().map(|axis| axis.name.to_string());
    for name in names.chain(machine.chain().spindle().map(ToString::to_string)) {
        let of_axis = members(&|error| error.axis.as_str() == name);
        groups.push(LayerGroup::new(format!("axis-{name}"), format!("{what} errors of {name}"), "axis", of_axis));
    }
    groups.extend(alone);
    groups.retain(|group| !group.members.is_empty());
    groups
}

/// One station, evaluated: by node the nominal tip (mm) and by layer the deviation (mm).
struct Sampled {
    nominal: Vec<Vector3<f64>>,
    nodes: Vec<Vec<Vector3<f64>>>,
}

/// The grid at work.
struct Lattice<'a> {
    given: &'a MachineInput<'a>,
    axes: Vec<usize>,
    count: usize,
}

impl Lattice<'_> {
    fn len(&self) -> usize {
        self.axes.iter().map(|_| self.count).product()
    }

    fn position(&self, axis: usize, node: usize) -> f64 {
        let grid = self.given.machine.volume()[axis];
        if node + 1 == self.count {
            grid.max
        } else {
            grid.min + (grid.max - grid.min) * node as f64 / (self.count - 1) as f64
        }
    }

    /// The pose of a node; the first axis runs fastest.
    fn pose(&self, station: &Pose, node: usize) -> Pose {
        let mut pose = station.clone();
        let mut rest = node;
        for axis in &self.axes {
            pose[*axis] = self.position(*axis, rest % self.count);
            rest /= self.count;
        }
        pose
    }

    fn grid_axis(&self, axis: usize) -> GridAxis {
        let of = &self.given.machine.axes()[axis];
        let positions = (0..self.count).map(|node| self.position(axis, node)).collect();
        GridAxis { name: of.name.to_string(), unit: of.unit(), positions }
    }

    fn sample(&self, station: &Pose, groups: &[LayerGroup<ErrorId>]) -> Sampled {
        let rows: Vec<_> =
            (0..self.len()).into_par_iter().map(|node| self.node(&self.pose(station, node), groups)).collect();
        let (nominal, nodes) = rows.into_iter().unzip();
        Sampled { nominal, nodes }
    }

    /// Nominal tip, and the deviation of every layer, in machine directions.
    fn node(&self, pose: &Pose, groups: &[LayerGroup<ErrorId>]) -> (Vector3<f64>, Vec<Vector3<f64>>) {
        let MachineInput { machine, order, conditions, written, .. } = *self.given;
        let view = View { conditions, frame: Frame::Machine };
        let total = deviation_in(&Bare { machine, order }, pose, view).position;
        let alone = error_by_error(machine, &conditions.at_pose(pose));
        let turn = frame_rotation(machine, pose, Frame::Machine).unwrap_or_else(nalgebra::Matrix3::identity);
        let together = |group: &LayerGroup<ErrorId>| {
            let members = alone.iter().filter(|(id, _)| group.members.contains(id));
            turn * members.map(|(_, d): &(ErrorId, Deviation)| d.position).sum::<Vector3<f64>>()
        };
        let mut row = vec![total];
        row.extend(groups.iter().map(together));
        for one in written {
            let field = one.effect.field(machine, &one.target);
            let left = deviation_in(&*field, pose, view).position;
            row.extend([left, total - left]);
        }
        (evaluate(machine, &conditions.at_pose(pose), order, Frame::Machine).nominal, row)
    }

    fn stations(&self, poses: &[Pose], sampled: Vec<Sampled>) -> Vec<FieldStation> {
        let others: Vec<usize> = (0..poses[0].len()).filter(|axis| !self.axes.contains(axis)).collect();
        let micrometre = |x: &f64| (x * 1e3).round() / 1e3 + 0.0;
        let station = |(pose, s): (&Pose, Sampled)| FieldStation {
            label: pose_words(self.given.machine, &others, pose),
            nominal_mm: s.nominal.iter().flat_map(|p| p.iter().map(micrometre).collect::<Vec<_>>()).collect(),
        };
        poses.iter().zip(sampled).map(station).collect()
    }

    fn layers(&self, stations: &[Sampled], groups: &[LayerGroup<ErrorId>]) -> Vec<FieldLayer> {
        let mut heads = vec![("total".to_owned(), "all errors".to_owned(), "total")];
        heads.extend(groups.iter().map(|g| (g.id.clone(), g.label.clone(), g.group)));
        for written in self.given.written {
            let name = &written.target.manifest.target;
            heads.push((format!("after-{name}"), format!("after {name}"), "after"));
            heads.push((format!("removed-{name}"), format!("removed by {name}"), "removed"));
        }
        heads.into_iter().enumerate().map(|(k, (id, label, group))| self.layer(k, id, label, group, stations)).collect()
    }

    fn layer(&self, k: usize, id: String, label: String, group: &'static str, stations: &[Sampled]) -> FieldLayer {
        let at = stations.iter().map(|station| self.layer_at(k, station)).collect();
        FieldLayer { id, label, group, at }
    }

    fn layer_at(&self, k: usize, station: &Sampled) -> LayerAt {
        let lengths: Vec<f64> = station.nodes.iter().map(|row| row[k].norm() * 1e3).collect();
        let deviation_nm = station.nodes.iter().flat_map(|row| nanometres(&row[k])).collect();
        LayerAt { deviation_nm: Some(deviation_nm), length_nm: None, ..self.of_lengths(&lengths) }
    }

    /// A layer of lengths, um.
    fn of_lengths(&self, lengths: &[f64]) -> LayerAt {
        let worst = (0..lengths.len()).fold(0, |best, i| if lengths[i] > lengths[best] { i } else { best });
        let at = |node: usize| {
            let pose = self.pose(&rest(self.given.machine), node);
            let all = axis_positions(self.given.machine, &pose);
            let names = self.axes.iter().map(|axis| &self.given.machine.axes()[*axis]);
            let pick = |axis: &Axis| (axis.name.to_string(), all[axis.name.as_str()].into());
            Value::Object(names.map(pick).collect())
        };
        let max_um = lengths.get(worst).copied().unwrap_or(0.0);
        let step = round_step(max_um, 4);
        LayerAt {
            deviation_nm: None,
            length_nm: Some(lengths.iter().map(|um| (um * 1e3).round() as i64).collect()),
            max_um,
            ticks_um: (0..=4).map(|i| f64::from(i) * step).filter(|tick| *tick <= max_um * (1.0 + 1e-9)).collect(),
            mean_um: lengths.iter().sum::<f64>() / lengths.len().max(1) as f64,
            worst,
            worst_at: if lengths.is_empty() { json!({}) } else { at(worst) },
        }
    }
}

fn nanometres(v: &Vector3<f64>) -> [i64; 3] {
    v.map(|x| (x * 1e6).round() as i64).into()
}

/// 1, 2, 5 times powers of ten.
fn exaggerations() -> Vec<f64> {
    let decade = |power: f64| [1.0, 2.0, 5.0].map(|x| x * power);
    [1.0, 10.0, 100.0, 1e3, 1e4, 1e5].into_iter().flat_map(decade).chain([1e6]).collect()
}

/// Longest side of the box around all nodes of the first station, mm.
fn extent(stations: &[Sampled]) -> f64 {
    let nodes = stations.first().map_or(&[][..], |s| &s.nominal);
    let side = |k: usize| {
        let (min, max) = nodes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p[k]), b.max(p[k])));
        max - min
    };
    (0..3).map(side).fold(0.0, f64::max)
}

/// The largest factor that draws the largest deviation no longer than a fifth of the box.
fn first_factor(factors: &[f64], extent: f64, largest: f64) -> usize {
    let fits = |factor: &&f64| **factor * largest <= extent / 5.0;
    factors.iter().filter(fits).count().saturating_sub(1)
}
