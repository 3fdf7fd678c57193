//! From a set to its certificate: fills what the certificate is handed in and has it judged.

use crate::compensation::{Scope, SetLayout, SingleErrors, single_errors};
use crate::controller::certificate::{
    Certificate, Depth, LatticeSubset, TablesUnderTest, judge_tables, single_error_poses,
};
use crate::controller::replay::Replay;
use crate::machine::Machine;

/// Compares the machine with and without tables on `poses` seeded poses.
pub fn certify(machine: &Machine, judged: TablesUnderTest, scope: Scope, poses: usize, seed: u64) -> Certificate {
    let depth = Depth { poses, seed };
    judge_tables(machine, judged, &fill(machine, judged, scope, depth), depth)
}

/// Fills the tables of every error alone; of a lattice the cells that the certificate looks at.
fn fill(machine: &Machine, judged: TablesUnderTest, scope: Scope, depth: Depth) -> SingleErrors {
    let TablesUnderTest { target, tables, .. } = judged;
    let mechanisms = &target.manifest.mechanism;
    let nodes = mechanisms.free_lattice(tables).map_or_else(Vec::new, |_| {
        let replay = Replay::new(machine, target, tables);
        LatticeSubset::of(&replay, single_error_poses(&depth.poses(machine))).nodes
    });
    single_errors(machine, SetLayout { mechanisms, tables, scope, lattice_nodes: &nodes })
}
