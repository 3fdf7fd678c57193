//! From a kinematics module to its certificate: makes the modules of single errors and has them judged.

use crate::compensation::CorrectionTables;
use crate::controller::certificate::{Certificate, Depth, ModuleSet, SingleErrorModule, TablesUnderTest, judge_module};
use crate::controller::emit::{Limits, RAISE_LIMIT};
use crate::controller::kinematics::KinematicsModule;
use crate::controller::manifest::ControllerTarget;
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::{ErrorId, ErrorTerm, Machine};
use crate::units::significant;
use rayon::prelude::*;

/// Certifies a module and the tables beside it, over the volume and error by error.
pub fn certify_kinematics(
    machine: &Machine,
    target: &ControllerTarget,
    module: &KinematicsModule,
    beside: &CorrectionTables,
    depth: Depth,
) -> Certificate {
    let singles = single_error_modules(machine, target, module.orientation());
    let tables = TablesUnderTest { target, tables: beside, installed: None };
    judge_module(machine, ModuleSet { module, tables }, &singles, depth)
}

fn single_error_modules(machine: &Machine, target: &ControllerTarget, orientation: bool) -> Vec<SingleErrorModule> {
    let known = machine.errors().filter(|(_, term)| !matches!(term, ErrorTerm::Tolerance(_)));
    let ids: Vec<ErrorId> = known.map(|(id, _)| id).collect();
    let alone = |error: &ErrorId| {
        let machine = machine.filtered(|id| id == error);
        let module = KinematicsModule::of(&machine, target, orientation).ok();
        SingleErrorModule { error: error.clone(), module, beside: target.reversal_tables(&machine) }
    };
    ids.par_iter().map(alone).collect()
}

impl Limits {
    /// Returns a refusal for every limit that a module's correction exceeds: of the functional point and of the tool
    /// axis.
    pub fn module_excesses(&self, certificate: &Certificate) -> Vec<Diagnostic> {
        let (position, axis) =
            (certificate.uncompensated.position_um.max, certificate.uncompensated.tool_axis_urad.max);
        let refusal = |what: String| Diagnostic::new(codes::E0602, what).help(RAISE_LIMIT);
        let length = (position > self.length_mm * 1e3).then(|| {
            refusal(format!(
                "a deviation of {} mm is above the limit of {} mm",
                significant(position * 1e-3, 4),
                self.length_mm
            ))
        });
        let angle = (axis > self.angle_rad * 1e6).then(|| {
            let mrad = |urad: f64| significant(urad * 1e-3, 4);
            refusal(format!(
                "a tilt of the tool by {} mrad is above the limit of {} mrad",
                mrad(axis),
                mrad(self.angle_rad * 1e6)
            ))
        });
        length.into_iter().chain(angle).collect()
    }
}
