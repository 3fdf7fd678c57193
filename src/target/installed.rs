//! What is on the machine now, and what is to be written on top of it.

use super::{Replay, Target};
use crate::compensation::{LatticeRequest, Table, Tables};
use crate::machine::{Approach, Machine};

impl Target {
    /// The tables for a machine whose errors were measured with other tables in force: the old plus the new,
    /// rounded like any tables of the target.
    pub fn tables_over(&self, machine: &Machine, request: &LatticeRequest, installed: &Tables) -> Tables {
        let mechanisms = &self.manifest.mechanism;
        let at = |table: &Table, positions: &[f64], reverse: bool| -> Vec<f64> {
            let alone = Tables { tables: vec![table.clone()], errors: Vec::new() };
            let replay = Replay::new(machine, self, &alone);
            let mut pose = vec![0.0; machine.axes().len()];
            table.axes.iter().zip(positions).for_each(|(axis, q)| pose[*axis] = *q);
            let added = replay.added(&pose, if reverse { Approach::Reverse } else { Approach::Forward });
            table.corrected.iter().map(|axis| added[*axis]).collect()
        };
        let mut sum = self.tables(machine, request).plus(installed, &at);
        sum.quantise(machine, |table| mechanisms.rules(table).map(|rules| &rules.increment));
        sum.merged()
    }
}
