//! From a machine to a target's rounded tables.

use super::Target;
use crate::compensation::{Capability, LatticeRequest, Tables, lattice, own_axis_tables};
use crate::machine::Machine;

impl Target {
    /// Fills the tables of the target's mechanism and rounds them to its increments. Own-axis tables
    /// have nothing to choose; the request is for lattices.
    pub fn tables(&self, machine: &Machine, request: &LatticeRequest) -> Tables {
        let mut tables = match self.manifest.capability() {
            Capability::OwnAxis(capability) => Tables::OwnAxis(own_axis_tables(machine, &capability)),
            Capability::Lattice(capability) => Tables::Lattice(lattice(machine, &capability, request)),
            // What has no tables has none to fill.
            Capability::Kinematics => Tables::OwnAxis(Vec::new()),
        };
        tables.quantise(self.manifest.increment());
        tables
    }
}
