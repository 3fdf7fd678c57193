//! A lattice of corrections over any of the axes, and how many nodes each axis gets.

use super::{Correction, Jacobian, Lattice, LatticeCapability, Scope, correct};
use crate::evaluate::{Bare, Field, Order, random_poses};
use crate::machine::{Approach, AxisKind, Grid, Machine, Pose};
use rayon::prelude::*;

/// Fills a lattice over all axes of the volume. Nodes are solved for the mean of forward and reverse.
pub fn lattice(machine: &Machine, capability: &LatticeCapability, scope: Scope) -> Lattice {
    let rotary = capability.corrects_rotary && matches!(scope, Scope::Pose { .. });
    let kept = |axis: &usize| rotary || machine.axes()[*axis].kind == AxisKind::Linear;
    let all = 0..machine.axes().len();
    let corrected = all.clone().filter(kept).collect();
    let mut lattice =
        Lattice { axes: all.collect(), nodes: lattice_nodes(machine, capability), corrected, values: Vec::new() };
    let scope = if rotary { scope } else { Scope::Position };
    lattice.values = (0..lattice.len())
        .into_par_iter()
        .flat_map_iter(|number| {
            let Correction(all) = correct(machine, &lattice.pose(machine, number), Approach::Mean, scope).correction;
            lattice.corrected.iter().map(move |axis| all[*axis]).collect::<Vec<_>>()
        })
        .collect();
    lattice
}

/// Nodes of every axis: the steps of the machine file's volume, made coarser where that costs least
/// until the capability is not exceeded.
pub fn lattice_nodes(machine: &Machine, capability: &LatticeCapability) -> Vec<Vec<f64>> {
    let volume = machine.volume();
    let mut counts: Vec<usize> = volume.iter().map(steps).collect();
    let mut errors: Vec<Option<f64>> = vec![None; counts.len()];
    while counts.iter().product::<usize>() > capability.max_nodes {
        for (axis, error) in errors.iter_mut().enumerate() {
            let coarser = coarser(counts[axis]);
            let fresh = || coarser.map_or(f64::INFINITY, |n| interpolation_error(machine, axis, n));
            let _ = error.get_or_insert_with(fresh);
        }
        let cheapest = errors.iter().enumerate().min_by(|a, b| a.1.unwrap_or(f64::INFINITY).total_cmp(&b.1.unwrap_or(f64::INFINITY)));
        let Some((axis, _)) = cheapest else { break };
        let Some(count) = coarser(counts[axis]) else { break };
        counts[axis] = count;
        errors[axis] = None;
    }
    volume.iter().zip(counts).map(|(grid, n)| capability.increment.distinct(spread(grid, n))).collect()
}

/// Nodes that keep every distance within the step.
fn steps(grid: &Grid) -> usize {
    // A hair of tolerance: 500 mm in steps of 62.5 mm are 8 intervals, not 9.
    libm::ceil((grid.max - grid.min) / grid.step - 1e-9).max(1.0) as usize + 1
}

/// A tenth fewer nodes; two are the least.
fn coarser(count: usize) -> Option<usize> {
    (count > 2).then(|| (count - (count / 10).max(1)).max(2))
}

fn spread(grid: &Grid, count: usize) -> Vec<f64> {
    let last = (count - 1) as f64;
    (0..count).map(|i| grid.min + (grid.max - grid.min) * (i as f64 / last)).collect()
}

/// Where interpolation is tried out.
const PLACES: usize = 48;

/// How wrong linear interpolation between `count` nodes along one axis is (mm): the RMS over places
/// spread through the volume, first order, at the middle of intervals.
fn interpolation_error(machine: &Machine, axis: usize, count: usize) -> f64 {
    let nodes = spread(&machine.volume()[axis], count);
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
    let deviation = Bare { machine, order: Order::Exact }.deviation(pose, Approach::Mean);
    let Correction(all) = Jacobian::at(machine, pose).correction(&deviation, &Correction::none(machine), None);
    all
}
