//! The controllers' arithmetic on their tables. It is written from measurements on each controller or its documents,
//! not from the code that filled the tables.

use super::lookup::{between, cell, period, single_precision, stepped};
use super::model;
use crate::compensation::{CorrectionTable, CorrectionTables, Spacing};
use crate::controller::manifest::ControllerTarget;
use crate::controller::manifest::{Arithmetic, Controller, Interpolation, LookupPosition, OutsideTable};
use crate::evaluate::{Deviation, Field, commanded_deviation};
use crate::machine::{Approach, Machine, OperatingPoint};

/// A controller with tables loaded.
#[derive(Debug, Clone)]
pub struct Replay<'a> {
    machine: &'a Machine,
    tables: &'a CorrectionTables,
    controller: Controller,
    /// True for each table that is looked up modulo 360 deg on continuous axes.
    modulo: Vec<bool>,
    /// True for each table that is a factor: a line has no end.
    factors: Vec<bool>,
    /// True if tables of an axis over itself are the scale of its drive.
    scaled: bool,
    /// The fraction of a section at which a table steps to its next value; none for straight lines.
    step_at: Option<f64>,
    /// The tables in force when the machine was measured: its errors are their residual.
    installed: Option<Box<Replay<'a>>>,
}

impl<'a> Replay<'a> {
    /// Loads tables of a target.
    pub fn new(machine: &'a Machine, target: &ControllerTarget, tables: &'a CorrectionTables) -> Self {
        let mechanisms = &target.manifest.mechanism;
        let modulo = tables.tables.iter().map(|t| mechanisms.rules(t).is_some_and(|rules| rules.modulo)).collect();
        let line = |t| mechanisms.rules(t).is_some_and(|rules| rules.spacing == Spacing::Line);
        let factors = tables.tables.iter().map(line).collect();
        let scaled = mechanisms.own_axis.as_ref().is_some_and(|own| own.scale.is_some());
        let controller = target.manifest.controller;
        // In which of two ways the control is set is not in its files.
        let step_at = (controller.interpolation == Interpolation::Step).then_some(1.0);
        Self { machine, tables, controller, modulo, factors, scaled, step_at, installed: None }
    }

    /// Replaces tables that were in force when the machine's errors were measured.
    pub fn over(self, installed: Option<Self>) -> Self {
        Self { installed: installed.map(Box::new), ..self }
    }

    /// The fraction of a section at which a table steps to its next value; none for straight lines.
    pub fn step_at(&self) -> Option<f64> {
        self.step_at
    }

    /// Changes values in steps, at a fraction of the section between two points from 0 to 1.
    pub fn stepping_at(self, fraction: f64) -> Self {
        Self { step_at: Some(fraction), ..self }
    }

    /// Returns the motions that the controller adds to a command (mm, deg).
    pub fn addition(&self, at: &OperatingPoint<'_>) -> Vec<f64> {
        let command = at.axes;
        let mut added = vec![0.0; command.len()];
        if !self.tables.errors.is_empty() {
            added = model::motion(self.machine, command, &self.tables.errors);
            self.tables.senses.iter().for_each(|(axis, sense)| added[*axis] *= sense);
        }
        let moved = |added: &[f64]| -> Vec<f64> { command.iter().zip(added).map(|(q, c)| q + c).collect() };
        let scale = |table: &CorrectionTable| self.scaled && table.axes.len() == 1 && table.axes == table.corrected;
        match self.controller.lookup {
            LookupPosition::Command => self.add_tables(at, &mut added, |table| !scale(table)),
            LookupPosition::LinesThenPlanes => {
                let line = |table: &CorrectionTable| table.axes.len() == 1 && !scale(table);
                self.add_tables(at, &mut added, line);
                let moved = moved(&added);
                self.add_tables(&at.conditions.at_pose(&moved), &mut added, |table| table.axes.len() > 1);
            }
            // Klipper and Marlin: y' = y - z*yz, then x' = x - y'*xy - z*xz.
            LookupPosition::Corrected => {
                let mut order: Vec<usize> = self.tables.tables.iter().map(|t| t.corrected[0]).collect();
                order.sort_by_key(|axis| std::cmp::Reverse(self.machine.axes()[*axis].name.clone()));
                order.dedup();
                for axis in order {
                    let moved = moved(&added);
                    let of_axis = |table: &CorrectionTable| table.corrected[0] == axis && !scale(table);
                    self.add_tables(&at.conditions.at_pose(&moved), &mut added, of_axis);
                }
            }
        }
        if self.scaled {
            // Of the motors: what all else has made of the command.
            let moved = moved(&added);
            self.add_tables(&at.conditions.at_pose(&moved), &mut added, scale);
        }
        if let Some(installed) = &self.installed {
            let before = installed.addition(at);
            added.iter_mut().zip(before).for_each(|(a, b)| *a -= b);
        }
        added
    }

    fn add_tables(&self, at: &OperatingPoint<'_>, added: &mut [f64], keep: impl Fn(&CorrectionTable) -> bool) {
        let looked_up = self.modulo.iter().zip(&self.factors);
        for (table, (modulo, factor)) in self.tables.tables.iter().zip(looked_up).filter(|(table, _)| keep(table)) {
            if let ([axis], [corrected]) = (&table.axes[..], &table.corrected[..]) {
                // Steps count from where the axis was homed.
                let home = self.machine.axes()[*axis].home.filter(|_| *factor && axis == corrected).unwrap_or(0.0);
                let position = self.lookup_position(table, 0, *axis, at.axes[*axis] - home, *modulo);
                let outside = if *factor { OutsideTable::Extrapolate } else { self.controller.outside };
                added[*corrected] += self.curve(table, position, at.conditions.approach, outside);
                continue;
            }
            for (node, weight) in self.corners(table, at.axes, *modulo) {
                let row = &table.values[node * table.corrected.len()..];
                table.corrected.iter().zip(row).for_each(|(axis, value)| added[*axis] += weight * value);
            }
        }
    }

    /// Returns the value of a table over one axis at a position.
    fn curve(&self, table: &CorrectionTable, position: f64, approach: Approach, outside: OutsideTable) -> f64 {
        let column = |values: &[f64]| match (self.controller.arithmetic, self.step_at) {
            (Arithmetic::Float64, Some(at)) => stepped(&table.nodes[0], values, position, outside, at),
            (Arithmetic::Float32TrimAndSlope, _) => single_precision(&table.nodes[0], values, position),
            (Arithmetic::Float64, None) => between(&table.nodes[0], values, position, outside),
        };
        let Some(reverse) = &table.reverse else { return column(&table.values) };
        match approach {
            Approach::Forward => column(&table.values),
            Approach::Reverse => column(reverse),
            Approach::Mean => 0.5 * (column(&table.values) + column(reverse)),
        }
    }

    /// Returns the position at which a table is looked up.
    fn lookup_position(&self, table: &CorrectionTable, place: usize, axis: usize, position: f64, modulo: bool) -> f64 {
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

    /// Returns the nodes of a lattice's cell around a command, with their multilinear weights.
    pub fn corners(&self, lattice: &CorrectionTable, command: &[f64], modulo: bool) -> Vec<(usize, f64)> {
        let mut corners = vec![(0, 1.0)];
        for (place, (axis, nodes)) in lattice.axes.iter().zip(&lattice.nodes).enumerate() {
            let position = self.lookup_position(lattice, place, *axis, command[*axis], modulo);
            let Some((low, high, fraction)) = cell(nodes, position, self.controller.outside) else { return Vec::new() };
            corners = corners
                .iter()
                .flat_map(|(node, weight)| {
                    let base = node * nodes.len();
                    [(base + low, weight * (1.0 - fraction)), (base + high, weight * fraction)]
                })
                .filter(|(_, weight)| *weight != 0.0)
                .collect();
        }
        corners
    }

    /// Returns the nodes around a command for the only lattice of a set.
    pub fn lattice_corners(&self, command: &[f64]) -> Vec<(usize, f64)> {
        let first = self.tables.tables.first().zip(self.modulo.first());
        first.map_or_else(Vec::new, |(lattice, modulo)| self.corners(lattice, command, *modulo))
    }
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

    fn deviation(&self, at: &OperatingPoint<'_>) -> Deviation {
        let added = self.replay.addition(at);
        let command: Vec<f64> = at.axes.iter().zip(&added).map(|(q, c)| q + c).collect();
        commanded_deviation(self.machine, at.axes, &at.conditions.at_pose(&command))
    }
}
