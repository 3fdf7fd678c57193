//! A lattice of corrections over any of the axes, and how many nodes each axis gets.

use super::{Corrected, Correction, CorrectionTable, Jacobian, LatticeRules, Scope, correct_all};
use crate::evaluate::{Bare, CompiledModel, Field, Order, node_count, node_positions, random_poses};
use crate::machine::{Approach, AxisKind, Grid, Machine, Pose};
use rayon::prelude::*;

/// Request for a lattice.
#[derive(Debug, Clone, PartialEq)]
pub struct LatticeRequest {
    /// Indices of the axes that span it, in the order of the machine's axes; the others are at 0.
    pub axes: Vec<usize>,
    /// Maximum number of nodes (and never more than the capability's).
    pub max_nodes: usize,
    /// Goal and axes of the correction.
    pub scope: Scope,
}

/// Nodes that are solved at once.
const BLOCK: usize = 256;

/// Fills a lattice. Nodes are solved for the mean of forward and reverse.
pub fn lattice(machine: &Machine, rules: &LatticeRules, request: &LatticeRequest) -> CorrectionTable {
    let scope = Scope { rotary: request.scope.rotary && rules.corrects_rotary, ..request.scope };
    let kept = |axis: &usize| scope.rotary || machine.axes()[*axis].kind == AxisKind::Linear;
    let max_nodes = request.max_nodes.min(rules.table.max_points);
    let nodes = lattice_nodes(machine, &request.axes, max_nodes);
    let distinct =
        |(axis, nodes): (&usize, Vec<f64>)| rules.table.increment.distinct(nodes, machine.axes()[*axis].kind);
    let mut lattice = CorrectionTable {
        axes: request.axes.clone(),
        nodes: request.axes.iter().zip(nodes).map(distinct).collect(),
        corrected: (0..machine.axes().len()).filter(kept).collect(),
        values: Vec::new(),
        reverse: None,
        factors: Vec::new(),
    };
    let plan = CompiledModel::new(machine, Order::Exact, Approach::Mean);
    let blocks: Vec<usize> = (0..lattice.len()).step_by(BLOCK).collect();
    lattice.values = blocks
        .into_par_iter()
        .flat_map_iter(|first| {
            let numbers = first..(first + BLOCK).min(lattice.len());
            let poses: Vec<Pose> = numbers.map(|number| lattice.pose(machine, number)).collect();
            let corrected = correct_all(&plan, &poses, scope).unwrap_or_default();
            let row = |c: Corrected| lattice.corrected.iter().map(move |axis| c.correction.0[*axis]);
            corrected.into_iter().flat_map(row).collect::<Vec<_>>()
        })
        .collect();
    lattice
}

/// Nodes of the given axes: the steps of the machine file's volume, made coarser where that costs the least accuracy,
/// until there are at most `max_nodes`.
pub fn lattice_nodes(machine: &Machine, axes: &[usize], max_nodes: usize) -> Vec<Vec<f64>> {
    let volume: Vec<&Grid> = axes.iter().map(|axis| &machine.volume()[*axis]).collect();
    let mut counts: Vec<usize> = volume.iter().map(|grid| node_count(grid).max(2)).collect();
    let mut costs: Vec<Option<f64>> = vec![None; counts.len()];
    while counts.iter().fold(1, |product: usize, n| product.saturating_mul(*n)) > max_nodes {
        for (place, cost) in costs.iter_mut().enumerate() {
            let fresh =
                || coarser(counts[place]).map_or(f64::INFINITY, |n| interpolation_error(machine, axes[place], n));
            let _ = cost.get_or_insert_with(fresh);
        }
        let cost = |place: &usize| costs[*place].unwrap_or(f64::INFINITY);
        let cheapest = (0..counts.len()).min_by(|a, b| cost(a).total_cmp(&cost(b)));
        let Some((place, count)) = cheapest.and_then(|place| Some((place, coarser(counts[place])?))) else { break };
        counts[place] = count;
        costs[place] = None;
    }
    volume.into_iter().zip(counts).map(|(grid, n)| node_positions(grid, n)).collect()
}

/// Returns a count with a tenth fewer nodes, at least two; `None` if `count` has no more.
fn coarser(count: usize) -> Option<usize> {
    (count > 2).then(|| (count - (count / 10).max(1)).max(2))
}

/// Number of places at which interpolation is tested.
const PLACES: usize = 48;

/// Returns the error of linear interpolation between `count` nodes along one axis (mm): the RMS over places spread
/// through the volume, first order, at the middle of intervals.
fn interpolation_error(machine: &Machine, axis: usize, count: usize) -> f64 {
    let nodes = node_positions(&machine.volume()[axis], count);
    let square = |(place, mut pose): (usize, Pose)| {
        let interval = place % (count - 1);
        let (low, high) = (nodes[interval], nodes[interval + 1]);
        let mut at = |q: f64| {
            pose[axis] = q;
            linear_correction(machine, &pose)
        };
        let (a, b, middle) = (at(low), at(high), at(0.5 * (low + high)));
        (0..middle.len()).map(|i| middle[i] - 0.5 * (a[i] + b[i])).map(|e| e * e).sum::<f64>()
    };
    let places = random_poses(machine, PLACES, 0);
    libm::sqrt(places.into_iter().enumerate().map(square).sum::<f64>() / PLACES as f64)
}

/// Corrections of the linear axes to first order (mm).
fn linear_correction(machine: &Machine, pose: &[f64]) -> Vec<f64> {
    let deviation = Bare { machine, order: Order::Exact }.deviation(&Approach::Mean.at_pose(pose));
    let Correction(all) =
        Jacobian::at(machine, pose).correction(&deviation, &Correction::none(machine), Scope::POSITION);
    all
}
