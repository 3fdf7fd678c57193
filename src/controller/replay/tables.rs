//! What the controller does with its tables, in its own arithmetic. Written from what was measured
//! on or documented of each controller, not from the code that filled the tables.

use crate::compensation::{CorrectionTable, CorrectionTables, Spacing, model_correction};
use crate::controller::manifest::ControllerTarget;
use crate::controller::manifest::{Arithmetic, Controller, Lookup, OutsideTable};
use crate::evaluate::{Batch, CompiledModel, Deviation, Field, Order, Output, PoseColumns, commanded_deviation};
use crate::machine::{Approach, Machine};

/// A controller with tables loaded.
#[derive(Debug, Clone)]
pub struct Replay<'a> {
    machine: &'a Machine,
    tables: &'a CorrectionTables,
    controller: Controller,
    /// Which tables are looked up modulo 360 deg on continuous axes.
    modulo: Vec<bool>,
    /// Which tables are a factor: a line has no end.
    factors: Vec<bool>,
    /// What was in force when the machine was measured: its errors are those that were left then.
    installed: Option<Box<Replay<'a>>>,
}

impl<'a> Replay<'a> {
    /// Loads tables of a target.
    pub fn new(machine: &'a Machine, target: &ControllerTarget, tables: &'a CorrectionTables) -> Self {
        let mechanisms = &target.manifest.mechanism;
        let modulo = tables.tables.iter().map(|t| mechanisms.rules(t).is_some_and(|rules| rules.modulo)).collect();
        let line = |t| mechanisms.rules(t).is_some_and(|rules| rules.spacing == Spacing::Line);
        let factors = tables.tables.iter().map(line).collect();
        Self { machine, tables, controller: target.manifest.controller, modulo, factors, installed: None }
    }

    /// The same on a machine whose errors were measured with other tables in force.
    pub fn over(self, installed: Option<Self>) -> Self {
        Self { installed: installed.map(Box::new), ..self }
    }

    /// What the controller adds to a command (mm, deg) approached from one side.
    pub fn added(&self, command: &[f64], approach: Approach) -> Vec<f64> {
        let mut added = vec![0.0; command.len()];
        if !self.tables.errors.is_empty() {
            added = model_correction(self.machine, command, &self.tables.errors).0;
        }
        match self.controller.lookup {
            Lookup::Command => self.add_tables(command, approach, &mut added, |_| true),
            Lookup::LinesThenPlanes => {
                let line = |table: &CorrectionTable| table.axes.len() == 1;
                self.add_tables(command, approach, &mut added, line);
                let at: Vec<f64> = command.iter().zip(&added).map(|(q, c)| q + c).collect();
                self.add_tables(&at, approach, &mut added, |table| !line(table));
            }
            // Klipper and Marlin: y' = y - z*yz, then x' = x - y'*xy - z*xz.
            Lookup::Corrected => {
                let mut order: Vec<usize> = self.tables.tables.iter().map(|t| t.corrected[0]).collect();
                order.sort_by_key(|axis| std::cmp::Reverse(self.machine.axes()[*axis].name.clone()));
                order.dedup();
                for axis in order {
                    let at: Vec<f64> = command.iter().zip(&added).map(|(q, c)| q + c).collect();
                    self.add_tables(&at, approach, &mut added, |table| table.corrected[0] == axis);
                }
            }
        }
        if let Some(installed) = &self.installed {
            let before = installed.added(command, approach);
            added.iter_mut().zip(before).for_each(|(a, b)| *a -= b);
        }
        added
    }

    fn add_tables(&self, at: &[f64], approach: Approach, added: &mut [f64], keep: impl Fn(&CorrectionTable) -> bool) {
        let looked_up = self.modulo.iter().zip(&self.factors);
        for (table, (modulo, factor)) in self.tables.tables.iter().zip(looked_up).filter(|(table, _)| keep(table)) {
            if let ([axis], [corrected]) = (&table.axes[..], &table.corrected[..]) {
                let position = self.turned(table, 0, *axis, at[*axis], *modulo);
                let outside = if *factor { OutsideTable::Extrapolate } else { self.controller.outside };
                added[*corrected] += self.curve(table, position, approach, outside);
                continue;
            }
            for (node, weight) in self.corners(table, at, *modulo) {
                let row = &table.values[node * table.corrected.len()..];
                table.corrected.iter().zip(row).for_each(|(axis, value)| added[*axis] += weight * value);
            }
        }
    }

    /// A table over one axis at a position.
    fn curve(&self, table: &CorrectionTable, position: f64, approach: Approach, outside: OutsideTable) -> f64 {
        let column = |values: &[f64]| match (self.controller.arithmetic, outside) {
            (Arithmetic::Float32TrimAndSlope, _) => single_precision(&table.nodes[0], values, position),
            (Arithmetic::Float64, outside) => double_precision(&table.nodes[0], values, position, outside),
        };
        let Some(reverse) = &table.reverse else { return column(&table.values) };
        match approach {
            Approach::Forward => column(&table.values),
            Approach::Reverse => column(reverse),
            Approach::Mean => 0.5 * (column(&table.values) + column(reverse)),
        }
    }

    /// The position at which a table is looked up.
    fn turned(&self, table: &CorrectionTable, place: usize, axis: usize, position: f64, modulo: bool) -> f64 {
        let nodes = &table.nodes[place];
        let first = nodes[0];
        if modulo && self.machine.is_continuous(axis) {
            return first + (position - first).rem_euclid(360.0);
        }
        if self.controller.outside == OutsideTable::RollOver && nodes.len() > 1 {
            return first + (position - first).rem_euclid(period(nodes));
        }
        position
    }

    /// Nodes of the cell of a lattice around a command, with their multilinear weights.
    pub fn corners(&self, lattice: &CorrectionTable, command: &[f64], modulo: bool) -> Vec<(usize, f64)> {
        let mut corners = vec![(0, 1.0)];
        for (place, (axis, nodes)) in lattice.axes.iter().zip(&lattice.nodes).enumerate() {
            let position = self.turned(lattice, place, *axis, command[*axis], modulo);
            let Some((low, high, share)) = cell(nodes, position, self.controller.outside) else { return Vec::new() };
            corners = corners
                .iter()
                .flat_map(|(node, weight)| {
                    let base = node * nodes.len();
                    [(base + low, weight * (1.0 - share)), (base + high, weight * share)]
                })
                .filter(|(_, weight)| *weight != 0.0)
                .collect();
        }
        corners
    }

    /// The same for the only lattice of a set.
    pub fn lattice_corners(&self, command: &[f64]) -> Vec<(usize, f64)> {
        let first = self.tables.tables.first().zip(self.modulo.first());
        first.map_or_else(Vec::new, |(lattice, modulo)| self.corners(lattice, command, *modulo))
    }
}

/// A table that rolls over begins again one step after its last point.
fn period(nodes: &[f64]) -> f64 {
    let last = nodes.len() - 1;
    2.0 * nodes[last] - nodes[last - 1] - nodes[0]
}

/// Nodes at both ends of the cell and the share of the upper one; none where nothing is added. Behind the last point of
/// a table that rolls over comes the first one of the next round.
fn cell(nodes: &[f64], position: f64, outside: OutsideTable) -> Option<(usize, usize, f64)> {
    let last = nodes.len() - 1;
    let beyond = position < nodes[0] || position > nodes[last];
    if last == 0 {
        return (!(beyond && outside == OutsideTable::Nothing)).then_some((0, 0, 0.0));
    }
    match outside {
        OutsideTable::Nothing if beyond => return None,
        OutsideTable::Extrapolate => {}
        OutsideTable::RollOver if position > nodes[last] => {
            let way = nodes[0] + period(nodes) - nodes[last];
            return Some((last, 0, (position - nodes[last]) / way));
        }
        _ if position <= nodes[0] => return Some((0, 0, 0.0)),
        _ if position >= nodes[last] => return Some((last, last, 0.0)),
        _ => {}
    }
    let mut low = 0;
    while low + 2 <= last && nodes[low + 1] <= position {
        low += 1;
    }
    Some((low, low + 1, (position - nodes[low]) / (nodes[low + 1] - nodes[low])))
}

fn double_precision(positions: &[f64], values: &[f64], position: f64, outside: OutsideTable) -> f64 {
    match cell(positions, position, outside) {
        None => 0.0,
        Some((low, _, 0.0)) => values[low],
        Some((low, high, share)) => values[low] * (1.0 - share) + values[high] * share,
    }
}

/// The value of the last node at or below the position, and its number.
fn interval(positions: &[f64], position: f64) -> usize {
    positions.iter().rposition(|node| *node <= position).unwrap_or(0)
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
        let _ = CompiledModel::new(self.machine, Order::Exact, approach).commanded(poses, &added.batch(), out);
    }
}
