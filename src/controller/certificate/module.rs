//! The certificate of a kinematics module.

use super::judge::{
    Certificate, ErrorLeft, Judgement, MAX_SINGLE_POSES, Strongest, deviations, judge, strongest_at, verdict, worse_p95,
};
use crate::compensation::CorrectionTables;
use crate::controller::emit::Limits;
use crate::controller::kinematics::{KinematicsModule, ModuleField};
use crate::controller::manifest::ControllerTarget;
use crate::controller::replay::Replay;
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::{Bare, Field, Order, random_poses};
use crate::machine::{Approach, ErrorId, ErrorTerm, Machine, Pose};
use crate::units::significant;
use rayon::prelude::*;

/// How many poses, from which seed.
#[derive(Debug, Clone, Copy)]
pub struct Depth {
    /// Poses of the certificate.
    pub poses: usize,
    /// Their seed.
    pub seed: u64,
}

/// What a module and the tables beside it leave, over the volume and error by error. The module holds the mean of
/// forward and reverse; the direction of approach that is worse counts.
pub fn certify_kinematics(
    machine: &Machine,
    target: &ControllerTarget,
    (carried, beside): (&KinematicsModule, &CorrectionTables),
    depth: Depth,
) -> Certificate {
    let poses: Vec<Pose> = random_poses(machine, depth.poses, depth.seed);
    let driven = ModuleField::new(machine, carried).beside(Replay::new(machine, target, beside));
    let bare = Bare { machine, order: Order::Exact };
    let Judgement { approach, uncompensated, compensated, raised } = judge(&bare, &driven, &poses);
    let zero = vec![0.0; machine.axes().len()];
    Certificate {
        poses: depth.poses,
        approach,
        uncompensated,
        compensated,
        errors: singles(machine, target, carried.orientation(), &poses[..poses.len().min(MAX_SINGLE_POSES)]),
        at_reference: [Approach::Forward, Approach::Reverse].map(|approach| driven.added(&zero, approach)),
        shifted: None,
        raised,
        strongest: strongest(machine, carried, &poses),
    }
}

/// Every error alone, with a module made for it alone.
fn singles(machine: &Machine, target: &ControllerTarget, orientation: bool, poses: &[Pose]) -> Vec<ErrorLeft> {
    let known = machine.errors().filter(|(_, term)| !matches!(term, ErrorTerm::Tolerance(_)));
    let ids: Vec<ErrorId> = known.map(|(id, _)| id).collect();
    let alone = |error: &ErrorId| {
        let machine = machine.filtered(|id| id == error);
        let p95 = |field: &dyn Field| worse_p95(&machine, |approach| deviations(field, poses, approach));
        let before = p95(&Bare { machine: &machine, order: Order::Exact });
        let tables = target.reversal_tables(&machine);
        let driven = |own: &KinematicsModule| {
            p95(&ModuleField::new(&machine, own).beside(Replay::new(&machine, target, &tables)))
        };
        let after = KinematicsModule::of(&machine, target, orientation).map(|own| driven(&own));
        verdict(error.clone(), before, after.unwrap_or(before))
    };
    ids.par_iter().map(alone).collect()
}

/// Where the sign is best tested: the largest motion that the module alone adds to correct the position.
fn strongest(machine: &Machine, carried: &KinematicsModule, poses: &[Pose]) -> Option<Strongest> {
    let carried = carried.clone().without_orientation();
    let module = ModuleField::new(machine, &carried);
    strongest_at(machine, (poses, &[Approach::Mean]), |pose, approach| module.added(pose, approach))
}

impl Limits {
    /// Limits on what a module corrects: the deviation of the functional point and of the tool axis.
    pub fn exceeded_by(&self, certificate: &Certificate) -> Vec<Diagnostic> {
        let (position, axis) = (certificate.uncompensated.all.position_um.max, certificate.uncompensated.tool_axis.max);
        let refusal = |what: String| {
            Diagnostic::new(codes::E0602, what).help(
                "check the error values and their units; if they are right, raise the limit: --max-correction \"2 mm, 10 mrad, 0.05\"",
            )
        };
        let length = (position > self.length * 1e3).then(|| {
            refusal(format!(
                "a deviation of {} mm is above the limit of {} mm",
                significant(position * 1e-3, 4),
                self.length
            ))
        });
        let angle = (axis > self.angle * 1e6).then(|| {
            let mrad = |urad: f64| significant(urad * 1e-3, 4);
            refusal(format!(
                "a tilt of the tool by {} mrad is above the limit of {} mrad",
                mrad(axis),
                mrad(self.angle * 1e6)
            ))
        });
        length.into_iter().chain(angle).collect()
    }
}
