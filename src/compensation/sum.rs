//! Tables that add up: for each the part of the corrections that it alone can hold.
//!
//! The correction c of a linear axis is a function of all positions. A table over the axis a gets its
//! main effect: the mean of c over the volume with a held, less the mean of all. Main effects of
//! different axes have nothing in common, so nothing is compensated twice; tables over two and more
//! axes get the same mean of what the tables before them leave. Errors that are a sum of functions of
//! one axis each are so met exactly; of the others (a lever arm times an angle) the part that lessens
//! the mean square most. The volume is sampled by one list of poses for all nodes: differences
//! between nodes do not depend on its choice where they do not depend on the other axes.

use super::{Table, Tables};
use crate::evaluate::node_positions;
use crate::machine::{Machine, Pose};
use rayon::prelude::*;

/// Corrections at a pose: those of all axes, for one channel after another (one for the whole machine,
/// or one for every error).
pub(super) struct Wanted<'a> {
    /// The mean of forward and reverse.
    pub mean: &'a (dyn Fn(&[f64]) -> Vec<f64> + Sync),
    /// Half of forward less reverse, from the errors of one axis.
    pub half: &'a (dyn Fn(&[f64], usize) -> Vec<f64> + Sync),
}

/// Poses over which means are taken.
const BACKGROUND: usize = 32;

/// Evenly spread poses: in every axis the multiples of an irrational number, modulo the volume.
pub(super) fn background(machine: &Machine) -> Vec<Pose> {
    // Powers of the root of x^(d+1) = x + 1: the d-dimensional golden ratio.
    let degree = machine.axes().len() as f64 + 1.0;
    let root = (0..40).fold(1.5, |x, _| libm::pow(1.0 + x, 1.0 / degree));
    let share = |i: usize, axis: usize| {
        let x = (i as f64 + 0.5) * libm::pow(root, -(axis as f64 + 1.0));
        x - libm::floor(x)
    };
    let position = |i: usize, axis: usize| {
        let grid = machine.volume()[axis];
        grid.min + (grid.max - grid.min) * share(i, axis)
    };
    (0..BACKGROUND).map(|i| (0..machine.axes().len()).map(|axis| position(i, axis)).collect()).collect()
}

/// The value of a set of tables at a pose, channel by channel: tables between nodes are straight.
struct Filled<'a> {
    layout: &'a [Table],
    /// Values of each table filled so far: by node, then channel.
    values: Vec<Vec<Vec<f64>>>,
    axes: usize,
}

impl Filled<'_> {
    fn subtract(&self, pose: &[f64], wanted: &mut [f64]) {
        for (table, rows) in self.layout.iter().zip(&self.values) {
            for (node, weight) in corners(table, pose) {
                for (channel, value) in rows[node].iter().enumerate() {
                    let (group, column) = (channel / table.corrected.len(), channel % table.corrected.len());
                    wanted[group * self.axes + table.corrected[column]] -= weight * value;
                }
            }
        }
    }
}

/// Nodes around a pose with their weights, held at the ends.
fn corners(table: &Table, pose: &[f64]) -> Vec<(usize, f64)> {
    let mut corners = vec![(0, 1.0)];
    for (axis, nodes) in table.axes.iter().zip(&table.nodes) {
        let q = pose[*axis].clamp(nodes[0], nodes[nodes.len() - 1]);
        let low = nodes.partition_point(|node| *node <= q).clamp(1, nodes.len().max(2) - 1) - 1;
        let share = nodes.get(low + 1).map_or(0.0, |high| (q - nodes[low]) / (high - nodes[low]));
        let both = |(node, weight): &(usize, f64)| {
            let base = node * nodes.len() + low;
            [(base, weight * (1.0 - share)), (base + 1, weight * share)]
        };
        corners = corners.iter().flat_map(both).filter(|(_, weight)| *weight != 0.0).collect();
    }
    corners
}

/// Fills tables of a given layout (axes, nodes, corrected axes): one set for every channel. A table
/// with `straight` is a line through position 0, the best one over the volume.
pub(super) fn fill(machine: &Machine, layout: &[Table], straight: &[bool], wanted: &Wanted) -> Vec<Tables> {
    let axes = machine.axes().len();
    let background = background(machine);
    let all_mean = mean(background.iter().map(|pose| (wanted.mean)(pose)));
    let mut effects = Effects { machine, background: &background, wanted, known: Vec::new() };
    let mut filled = Filled { layout, values: Vec::new(), axes };
    let mut halves: Vec<Option<Vec<Vec<f64>>>> = Vec::new();
    for (table, straight) in layout.iter().zip(straight) {
        let pick = |all: &[f64]| -> Vec<f64> {
            all.chunks(axes).flat_map(|group| table.corrected.iter().map(|axis| group[*axis])).collect()
        };
        let rows = if table.axes.len() == 1 {
            let main = effects.main(table, *straight);
            let mut rows: Vec<Vec<f64>> = main.iter().map(|row| pick(row)).collect();
            let mean = pick(&all_mean);
            rows.iter_mut().for_each(|row| row.iter_mut().zip(&mean).for_each(|(x, m)| *x -= m));
            if *straight { line(&effects.places(table), table, &rows) } else { rows }
        } else {
            let left = |pose: &[f64]| {
                let mut all = (wanted.mean)(pose);
                filled.subtract(pose, &mut all);
                pick(&all)
            };
            effect(table, &background, &left)
        };
        halves.push(table.reverse.is_some().then(|| {
            let half = |pose: &[f64]| pick(&(wanted.half)(pose, table.axes[0]));
            effect(table, &background, &half)
        }));
        filled.values.push(rows);
    }
    sets(layout, &filled.values, &halves)
}

/// Main effects over nodes: one look at the machine serves the tables of all corrected axes.
struct Effects<'a> {
    machine: &'a Machine,
    background: &'a [Pose],
    wanted: &'a Wanted<'a>,
    known: Vec<(Table, Vec<Vec<f64>>)>,
}

/// Places where a straight line is fitted.
const PLACES: usize = 33;

impl Effects<'_> {
    fn places(&self, table: &Table) -> Vec<f64> {
        node_positions(&self.machine.volume()[table.axes[0]], PLACES)
    }

    fn main(&mut self, table: &Table, straight: bool) -> Vec<Vec<f64>> {
        let nodes = if straight { self.places(table) } else { table.nodes[0].clone() };
        let over = Table::curve(table.axes[0], nodes, table.axes[0], Vec::new());
        if let Some((_, rows)) = self.known.iter().find(|(known, _)| *known == over) {
            return rows.clone();
        }
        let rows = effect(&over, self.background, self.wanted.mean);
        self.known.push((over, rows.clone()));
        rows
    }
}

/// The least-squares slope over the places, as values at the two nodes of a line through position 0.
fn line(places: &[f64], table: &Table, rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let centre = places.iter().sum::<f64>() / places.len() as f64;
    let spread: f64 = places.iter().map(|q| (q - centre) * (q - centre)).sum();
    let width = rows.first().map_or(0, Vec::len);
    let slope = |column: usize| {
        let moment: f64 = places.iter().zip(rows).map(|(q, row)| (q - centre) * row[column]).sum();
        if spread > 0.0 { moment / spread } else { 0.0 }
    };
    table.nodes[0].iter().map(|q| (0..width).map(|column| q * slope(column)).collect()).collect()
}

/// The mean over the background at each node of a table.
fn effect(table: &Table, background: &[Pose], at: &(dyn Fn(&[f64]) -> Vec<f64> + Sync)) -> Vec<Vec<f64>> {
    let node = |number: usize| {
        let positions = table.node(number);
        mean(background.iter().map(|pose| {
            let mut pose = pose.clone();
            table.axes.iter().zip(&positions).for_each(|(axis, q)| pose[*axis] = *q);
            at(&pose)
        }))
    };
    (0..table.len()).into_par_iter().map(node).collect()
}

fn mean(rows: impl Iterator<Item = Vec<f64>>) -> Vec<f64> {
    let mut sum: Vec<f64> = Vec::new();
    let mut count = 0.0;
    for row in rows {
        sum.resize(row.len(), 0.0);
        sum.iter_mut().zip(row).for_each(|(s, x)| *s += x);
        count += 1.0;
    }
    sum.iter_mut().for_each(|s| *s /= f64::max(count, 1.0));
    sum
}

/// One set of tables for every channel.
fn sets(layout: &[Table], values: &[Vec<Vec<f64>>], halves: &[Option<Vec<Vec<f64>>>]) -> Vec<Tables> {
    let width = |i: usize| layout[i].corrected.len();
    let channels = values.first().and_then(|rows| rows.first()).map_or(0, |row| row.len() / width(0));
    let column = |i: usize, channel: usize, rows: &[Vec<f64>]| -> Vec<f64> {
        rows.iter().flat_map(|row| row[channel * width(i)..(channel + 1) * width(i)].to_vec()).collect()
    };
    let table = |i: usize, channel: usize| {
        let mean = column(i, channel, &values[i]);
        let Some(half) = halves[i].as_ref().map(|rows| column(i, channel, rows)) else {
            return Table { values: mean, reverse: None, ..layout[i].clone() };
        };
        let both = |sign: f64| mean.iter().zip(&half).map(|(m, h)| m + sign * h).collect();
        Table { values: both(1.0), reverse: Some(both(-1.0)), ..layout[i].clone() }
    };
    let set = |channel| Tables { tables: (0..layout.len()).map(|i| table(i, channel)).collect(), errors: Vec::new() };
    (0..channels).map(set).collect()
}
