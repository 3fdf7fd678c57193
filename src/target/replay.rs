//! What the controller does with its tables, in its own arithmetic. Written from what was measured
//! on or documented of each controller, not from the code that filled the tables.

use super::manifest::{Arithmetic, Controller};
use crate::compensation::{Lattice, OwnAxisTable, Tables};
use crate::evaluate::{Batch, Deviation, Field, Order, Output, Plan, PoseColumns, commanded_deviation};
use crate::machine::{Approach, Machine};

/// A controller with tables loaded.
#[derive(Debug, Clone)]
pub struct Replay<'a> {
    tables: &'a Tables,
    controller: Controller,
    /// Which axes turn without end: a lattice over them is looked up modulo 360 deg.
    continuous: Vec<bool>,
}

impl<'a> Replay<'a> {
    /// Loads tables.
    pub fn new(machine: &Machine, tables: &'a Tables, controller: Controller) -> Self {
        let continuous = (0..machine.axes().len()).map(|axis| machine.is_continuous(axis)).collect();
        Self { tables, controller, continuous }
    }

    /// What the controller adds to a command (mm, deg) approached from one side.
    pub fn added(&self, command: &[f64], approach: Approach) -> Vec<f64> {
        let mut added = vec![0.0; command.len()];
        match self.tables {
            Tables::OwnAxis(tables) => {
                for table in tables {
                    added[table.axis] = self.own_axis(table, command[table.axis], approach);
                }
            }
            Tables::Lattice(lattice) => {
                for (node, weight) in self.corners(lattice, command) {
                    let row = &lattice.values[node * lattice.corrected.len()..];
                    lattice.corrected.iter().zip(row).for_each(|(axis, value)| added[*axis] += weight * value);
                }
            }
        }
        added
    }

    /// One axis's table at a commanded position.
    pub fn own_axis(&self, table: &OwnAxisTable, position: f64, approach: Approach) -> f64 {
        let column = |values: &[f64]| match self.controller.arithmetic {
            Arithmetic::Float64 => double_precision(&table.positions, values, position),
            Arithmetic::Float32TrimAndSlope => single_precision(&table.positions, values, position),
        };
        match approach {
            Approach::Forward => column(&table.forward),
            Approach::Reverse => column(&table.reverse),
            Approach::Mean => 0.5 * (column(&table.forward) + column(&table.reverse)),
        }
    }

    /// Nodes of the cell around a command, with their multilinear weights.
    pub fn corners(&self, lattice: &Lattice, command: &[f64]) -> Vec<(usize, f64)> {
        let mut corners = vec![(0, 1.0)];
        for (axis, nodes) in lattice.axes.iter().zip(&lattice.nodes) {
            let position = if self.continuous[*axis] { within_turn(nodes[0], command[*axis]) } else { command[*axis] };
            let (low, share) = cell(nodes, position);
            corners = corners
                .iter()
                .flat_map(|(node, weight)| {
                    let base = node * nodes.len() + low;
                    [(base, weight * (1.0 - share)), (base + 1, weight * share)]
                })
                .filter(|(_, weight)| *weight != 0.0)
                .collect();
        }
        corners
    }
}

/// The same angle in the turn that starts at the first node.
fn within_turn(first: f64, angle: f64) -> f64 {
    first + (angle - first).rem_euclid(360.0)
}

/// Lower node of the cell and the share of the upper one; held at the ends.
fn cell(nodes: &[f64], position: f64) -> (usize, f64) {
    let last = nodes.len() - 1;
    if last == 0 || position <= nodes[0] {
        return (0, 0.0);
    }
    if position >= nodes[last] {
        return (last, 0.0);
    }
    let mut low = 0;
    while nodes[low + 1] <= position {
        low += 1;
    }
    (low, (position - nodes[low]) / (nodes[low + 1] - nodes[low]))
}

/// The value of the last node at or below the position, and its number.
fn interval(positions: &[f64], position: f64) -> usize {
    positions.iter().rposition(|node| *node <= position).unwrap_or(0)
}

fn double_precision(positions: &[f64], values: &[f64], position: f64) -> f64 {
    let (low, share) = cell(positions, position);
    if share == 0.0 { values[low] } else { values[low] * (1.0 - share) + values[low + 1] * share }
}

/// LinuxCNC: each entry keeps its trim and the slope to the next entry as `float`; the sum is a
/// `double`. Below the first and above the last entry its value is held.
fn single_precision(positions: &[f64], values: &[f64], position: f64) -> f64 {
    let i = interval(positions, position);
    let trim = values[i] as f32;
    if position <= positions[0] || i + 1 >= positions.len() {
        return f64::from(trim);
    }
    let rise = f64::from(values[i + 1] as f32 - trim);
    let slope = (rise / (positions[i + 1] - positions[i])) as f32;
    f64::from(trim) + f64::from(slope) * (position - positions[i])
}

/// A machine whose controller applies tables: mapped like a bare one.
#[derive(Debug, Clone)]
pub struct Compensated<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// Its controller.
    pub replay: Replay<'a>,
}

impl Field for Compensated<'_> {
    fn machine(&self) -> &Machine {
        self.machine
    }

    fn deviation(&self, pose: &[f64], approach: Approach) -> Deviation {
        let added = self.replay.added(pose, approach);
        let command: Vec<f64> = pose.iter().zip(&added).map(|(q, c)| q + c).collect();
        commanded_deviation(self.machine, pose, &command, approach)
    }

    fn deviations(&self, poses: &Batch<'_>, approach: Approach, out: Output<'_>) {
        let mut added = PoseColumns::new(poses.axes().len());
        (0..poses.len()).for_each(|i| added.push(&self.replay.added(&poses.pose(i), approach)));
        // The plan is exact, and as many commands as poses: there is always an answer.
        let _ = Plan::new(self.machine, Order::Exact, approach).commanded(poses, &added.batch(), out);
    }
}
