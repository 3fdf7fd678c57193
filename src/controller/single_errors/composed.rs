//! From kinematic parameters and tables for what they leave to the certificate of both.

use super::{certify, certify_kinematics};
use crate::compensation::{CorrectionTables, Scope};
use crate::controller::certificate::{
    Certificate, Depth, Figures, ModuleSet, SingleErrorResidual, TablesUnderTest, judge_module,
};
use crate::controller::kinematics::{KinematicsModule, Parameters};
use crate::controller::manifest::ControllerTarget;
use crate::machine::Machine;

/// Parameters with their target, and tables.
pub type ComposedSets<'a> = ((&'a ControllerTarget, &'a Parameters), TablesUnderTest<'a>);

/// Certifies parameters and tables together. `rest` is the machine that the tables are for. Returns the figures after
/// the parameters alone beside the certificate.
///
/// A single error is judged in two steps: what the parameters leave of it stands in `rest`, and has tables of its own.
pub fn certify_sets(
    machine: &Machine,
    rest: &Machine,
    ((target, parameters), tables): ComposedSets,
    scope: Scope,
    depth: Depth,
) -> (Certificate, Figures) {
    let module = KinematicsModule::KinematicParameters(parameters.clone());
    let first = certify_kinematics(machine, target, &module, &CorrectionTables::default(), depth);
    let second = certify(rest, tables, scope, depth.poses, depth.seed);
    let mut both = judge_module(machine, ModuleSet { module: &module, tables }, &[], depth);
    let left = |one: &SingleErrorResidual| {
        let after = second.errors.iter().find(|other| other.error == one.error);
        SingleErrorResidual::new(one.error.clone(), one.alone_um, after.map_or(0.0, |after| after.residual_um))
    };
    both.errors = first.errors.iter().map(left).collect();
    both.single_error_poses = first.single_error_poses.min(second.single_error_poses);
    both.shifted = second.shifted;
    (both, first.compensated)
}
