//! Tables that add up: for each the part of the corrections that it alone can hold.
//!
//! The correction c of a linear axis is a function of all positions. A table over the axis a gets its
//! main effect: the mean of c over the volume with a held, less the mean of all. Main effects of
//! different axes have nothing in common, so nothing is compensated twice; tables over two and more axes get the same
//! mean of the residual of the tables before them. Errors that are a sum of functions of one axis each are so met
//! exactly; of the others (a lever arm times an angle) the part that lowers the mean square by the largest amount. The
//! volume is sampled by one list of poses for all nodes: differences between nodes do not depend on its choice where
//! they do not depend on the other axes.

use super::{CorrectionTable, CorrectionTables, product};
use crate::evaluate::node_positions;
use crate::machine::{Machine, Pose};
use rayon::prelude::*;

/// Corrections at poses from the errors of one axis.
type OfAxis<'a> = dyn Fn(&[Pose], usize) -> Vec<Vec<f64>> + Sync + 'a;

/// Corrections at poses: for each those of all axes, for one channel after another (one for the whole
/// machine, or one for every error).
#[derive(Clone, Copy)]
pub(super) struct Demand<'a> {
    /// The mean of forward and reverse.
    pub mean: &'a (dyn Fn(&[Pose]) -> Vec<Vec<f64>> + Sync),
    /// Half of forward less reverse, from the errors of one axis.
    pub half: &'a OfAxis<'a>,
}

/// Poses over which means are taken.
const BACKGROUND: usize = 32;

/// Evenly spread poses: in every axis the multiples of an irrational number, modulo the volume.
fn background(machine: &Machine) -> Vec<Pose> {
    // Powers of the root of x^(d+1) = x + 1: the d-dimensional golden ratio.
    let degree = machine.axes().len() as f64 + 1.0;
    let root = (0..40).fold(1.5, |x, _| libm::pow(1.0 + x, 1.0 / degree));
    let fraction = |i: usize, axis: usize| {
        let x = (i as f64 + 0.5) * libm::pow(root, -(axis as f64 + 1.0));
        x - libm::floor(x)
    };
    let position = |i: usize, axis: usize| {
        let grid = machine.volume()[axis];
        grid.min + (grid.max - grid.min) * fraction(i, axis)
    };
    (0..BACKGROUND).map(|i| (0..machine.axes().len()).map(|axis| position(i, axis)).collect()).collect()
}

/// The value of a set of tables at a pose, channel by channel: tables between nodes are straight.
struct Filled<'a> {
    layout: &'a [CorrectionTable],
    /// Values of each table filled so far: by node, then channel.
    values: Vec<Vec<Vec<f64>>>,
}

impl Filled<'_> {
    /// The mean over poses around a node of what is filled for the axes that a table corrects: channel by channel.
    fn mean(&self, table: &CorrectionTable, around: &[Pose], channels: usize) -> Vec<f64> {
        let width = table.corrected.len();
        let mut sum = vec![0.0; channels * width];
        for (other, rows) in self.layout.iter().zip(&self.values) {
            let shared = other.corrected.iter().enumerate();
            let shared =
                shared.filter_map(|(column, axis)| Some((column, table.corrected.iter().position(|a| a == axis)?)));
            for (column, place) in shared {
                for (node, weight) in around.iter().flat_map(|pose| corners(other, pose)) {
                    let own = rows[node].iter().skip(column).step_by(other.corrected.len());
                    sum.iter_mut().skip(place).step_by(width).zip(own).for_each(|(s, value)| *s += weight * value);
                }
            }
        }
        sum.iter_mut().for_each(|s| *s /= around.len() as f64);
        sum
    }
}

/// Nodes around a pose with their weights, held at the ends.
fn corners(table: &CorrectionTable, pose: &[f64]) -> Vec<(usize, f64)> {
    let mut corners = vec![(0, 1.0)];
    for (axis, nodes) in table.axes.iter().zip(&table.nodes) {
        let q = pose[*axis].clamp(nodes[0], nodes[nodes.len() - 1]);
        let low = nodes.partition_point(|node| *node <= q).clamp(1, nodes.len().max(2) - 1) - 1;
        let fraction = nodes.get(low + 1).map_or(0.0, |high| (q - nodes[low]) / (high - nodes[low]));
        let both = |(node, weight): &(usize, f64)| {
            let base = node * nodes.len() + low;
            [(base, weight * (1.0 - fraction)), (base + 1, weight * fraction)]
        };
        corners = corners.iter().flat_map(both).filter(|(_, weight)| *weight != 0.0).collect();
    }
    corners
}

/// Properties of a table besides its layout.
#[derive(Debug, Clone, Copy)]
pub(super) struct Traits {
    /// A line through position 0, the best one over the volume.
    pub straight: bool,
    /// True if it may hold a constant. The first table of an axis that may holds the mean.
    pub constant: bool,
    /// Number of products of a table over two axes; its values are reduced to them.
    pub products: Option<usize>,
}

/// Rows of means by the axes and the nodes that they are over.
type MeanRows = Vec<((Vec<usize>, Vec<Vec<f64>>), Vec<Vec<f64>>)>;

/// Fills tables; one look at the machine serves the tables of all corrected axes over the same nodes.
pub(super) struct Filler<'a> {
    machine: &'a Machine,
    wanted: Demand<'a>,
    background: Vec<Pose>,
    mean: Vec<f64>,
    means: MeanRows,
    halves: MeanRows,
}

/// Places where a straight line is fitted.
const PLACES: usize = 33;

impl<'a> Filler<'a> {
    pub fn new(machine: &'a Machine, wanted: Demand<'a>) -> Self {
        let background = background(machine);
        let mean = mean(&(wanted.mean)(&background));
        Self { machine, wanted, background, mean, means: Vec::new(), halves: Vec::new() }
    }

    /// Fills tables of a given layout (axes, nodes, corrected axes): one set for every channel.
    pub fn fill(&mut self, layout: &[CorrectionTable], traits: &[Traits]) -> Vec<CorrectionTables> {
        let axes = self.machine.axes().len();
        let mut filled = Filled { layout, values: Vec::new() };
        let mut halves: Vec<Option<Vec<Vec<f64>>>> = Vec::new();
        let mut with_constant: Vec<usize> = Vec::new();
        for (table, traits) in layout.iter().zip(traits) {
            let pick = |all: &[f64]| -> Vec<f64> {
                all.chunks(axes).flat_map(|group| table.corrected.iter().map(|axis| group[*axis])).collect()
            };
            let rows = if let [axis] = table.axes[..] {
                let places = if traits.straight { self.places(axis) } else { table.nodes[0].clone() };
                let mut rows: Vec<Vec<f64>> = self.main(axis, &places).iter().map(|row| pick(row)).collect();
                if traits.constant && !with_constant.contains(&table.corrected[0]) {
                    with_constant.push(table.corrected[0]);
                } else {
                    let mean = pick(&self.mean);
                    rows.iter_mut().for_each(|row| row.iter_mut().zip(&mean).for_each(|(x, m)| *x -= m));
                }
                if traits.straight { line(&places, table, &rows) } else { rows }
            } else {
                // Axes that span the table need no background, and few others a small one. Products need the one of the
                // tables before, or their differences would be taken for a product.
                let count = match (table.axes.len() == axes, traits.products) {
                    (true, _) => 1,
                    (false, None) => BACKGROUND / 2,
                    (false, Some(_)) => BACKGROUND,
                };
                let wanted = self.means(table, count);
                let left = |(node, row): (usize, &Vec<f64>)| {
                    let taken = filled.mean(table, &poses_at(table, node, &self.background[..count]), row.len() / axes);
                    pick(row).iter().zip(taken).map(|(wanted, taken)| wanted - taken).collect()
                };
                let rows: Vec<Vec<f64>> = wanted.par_iter().enumerate().map(left).collect();
                match traits.products.filter(|max| *max < usize::MAX) {
                    Some(max) => by_products(table, &rows, max),
                    None => rows,
                }
            };
            halves.push(table.reverse.is_some().then(|| self.half(table).iter().map(|row| pick(row)).collect()));
            filled.values.push(rows);
        }
        sets(layout, &filled.values, &halves)
    }

    fn places(&self, axis: usize) -> Vec<f64> {
        node_positions(&self.machine.volume()[axis], PLACES)
    }

    fn main(&mut self, axis: usize, nodes: &[f64]) -> Vec<Vec<f64>> {
        self.means(&over(axis, nodes), BACKGROUND)
    }

    /// Returns the mean demand over some of the background at each node of a table.
    fn means(&mut self, table: &CorrectionTable, count: usize) -> Vec<Vec<f64>> {
        let background = &self.background[..count];
        columns_of(&mut self.means, table, || effect(table, background, self.wanted.mean))
    }

    fn half(&mut self, table: &CorrectionTable) -> Vec<Vec<f64>> {
        let (axis, nodes) = (table.axes[0], &table.nodes[0]);
        let half = |poses: &[Pose]| (self.wanted.half)(poses, axis);
        let line = over(axis, nodes);
        columns_of(&mut self.halves, &line, || effect(&line, &self.background, &half))
    }
}

fn columns_of(all: &mut MeanRows, table: &CorrectionTable, fresh: impl FnOnce() -> Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let key = (&table.axes, &table.nodes);
    if let Some((_, rows)) = all.iter().find(|((axes, nodes), _)| (axes, nodes) == key) {
        return rows.clone();
    }
    let rows = fresh();
    all.push(((table.axes.clone(), table.nodes.clone()), rows.clone()));
    rows
}

/// A table over one axis, to be asked about its nodes.
fn over(axis: usize, nodes: &[f64]) -> CorrectionTable {
    CorrectionTable::curve(axis, nodes.to_vec(), axis, Vec::new())
}

/// Returns the least-squares slope over the places, as values at the two nodes of a line through position 0.
fn line(places: &[f64], table: &CorrectionTable, rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let centre = places.iter().sum::<f64>() / places.len() as f64;
    let spread: f64 = places.iter().map(|q| (q - centre) * (q - centre)).sum();
    let width = rows.first().map_or(0, Vec::len);
    let slope = |column: usize| {
        let moment: f64 = places.iter().zip(rows).map(|(q, row)| (q - centre) * row[column]).sum();
        if spread > 0.0 { moment / spread } else { 0.0 }
    };
    table.nodes[0].iter().map(|q| (0..width).map(|column| q * slope(column)).collect()).collect()
}

/// A row of numbers at each of many poses.
type RowsAt<'a> = dyn Fn(&[Pose]) -> Vec<Vec<f64>> + Sync + 'a;

/// Poses that are solved at once, or a few more.
const BLOCK: usize = 256;

/// The mean over the background at each node of a table.
fn effect(table: &CorrectionTable, background: &[Pose], at: &RowsAt) -> Vec<Vec<f64>> {
    let block = |numbers: &[usize]| {
        let rows = at(&numbers.iter().flat_map(|number| poses_at(table, *number, background)).collect::<Vec<Pose>>());
        rows.chunks(background.len()).map(mean).collect::<Vec<_>>()
    };
    let numbers: Vec<usize> = (0..table.len()).collect();
    numbers.par_chunks(BLOCK.div_ceil(background.len())).flat_map_iter(block).collect()
}

/// The background with the axes of a table at one of its nodes.
fn poses_at(table: &CorrectionTable, number: usize, background: &[Pose]) -> Vec<Pose> {
    let positions = table.node(number);
    let at_node = |pose: &Pose| {
        let mut pose = pose.clone();
        table.axes.iter().zip(&positions).for_each(|(axis, q)| pose[*axis] = *q);
        pose
    };
    background.iter().map(at_node).collect()
}

fn mean(rows: &[Vec<f64>]) -> Vec<f64> {
    let mut sum: Vec<f64> = Vec::new();
    for row in rows {
        sum.resize(row.len(), 0.0);
        sum.iter_mut().zip(row).for_each(|(s, x)| *s += x);
    }
    sum.iter_mut().for_each(|s| *s /= rows.len().max(1) as f64);
    sum
}

/// Returns the part of a table over two axes that `max` products can hold, channel by channel.
fn by_products(table: &CorrectionTable, rows: &[Vec<f64>], max: usize) -> Vec<Vec<f64>> {
    let columns = table.nodes[1].len();
    let channel = |c: usize| {
        let values: Vec<f64> = rows.iter().map(|row| row[c]).collect();
        product::sum(&product::parts(&values, columns, max, 0.0), values.len())
    };
    let channels: Vec<Vec<f64>> = (0..rows.first().map_or(0, Vec::len)).map(channel).collect();
    (0..rows.len()).map(|node| channels.iter().map(|values| values[node]).collect()).collect()
}

fn sets(
    layout: &[CorrectionTable],
    values: &[Vec<Vec<f64>>],
    halves: &[Option<Vec<Vec<f64>>>],
) -> Vec<CorrectionTables> {
    let width = |i: usize| layout[i].corrected.len();
    let channels = values.first().and_then(|rows| rows.first()).map_or(0, |row| row.len() / width(0));
    let column = |i: usize, channel: usize, rows: &[Vec<f64>]| -> Vec<f64> {
        rows.iter().flat_map(|row| row[channel * width(i)..(channel + 1) * width(i)].to_vec()).collect()
    };
    let table = |i: usize, channel: usize| {
        let mean = column(i, channel, &values[i]);
        let Some(half) = halves[i].as_ref().map(|rows| column(i, channel, rows)) else {
            return CorrectionTable { values: mean, reverse: None, ..layout[i].clone() };
        };
        let both = |sign: f64| mean.iter().zip(&half).map(|(m, h)| m + sign * h).collect();
        CorrectionTable { values: both(1.0), reverse: Some(both(-1.0)), ..layout[i].clone() }
    };
    let set = |channel| CorrectionTables {
        tables: (0..layout.len()).map(|i| table(i, channel)).collect(),
        ..CorrectionTables::default()
    };
    (0..channels).map(set).collect()
}
