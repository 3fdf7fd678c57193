//! From a machine to a target's rounded tables.

use super::Target;
use crate::compensation::{Capability, Scope, Tables, lattice, own_axis_tables};
use crate::machine::Machine;

impl Target {
    /// Fills the tables of the target's mechanism and rounds them to its increments.
    pub fn tables(&self, machine: &Machine, scope: Scope) -> Tables {
        let mut tables = match self.manifest.capability() {
            Capability::OwnAxis(capability) => Tables::OwnAxis(own_axis_tables(machine, &capability)),
            Capability::Lattice(capability) => Tables::Lattice(lattice(machine, &capability, scope)),
        };
        tables.quantise(self.manifest.increment());
        tables
    }
}
