//! The certificate of a kinematics module.

use super::{Carried, Driven};
use crate::compensation::{Correction, Jacobian, Scope, Strongest, Tables};
use crate::diagnostic::Diagnostic;
use crate::evaluate::{Bare, Field, Order, random_poses};
use crate::machine::{Approach, AxisKind, ErrorId, ErrorTerm, Machine, Pose};
use crate::target::certificate::{MOST_SINGLE_POSES, approaches, deviations, figures, verdict, worse_p95};
use crate::target::{Certificate, ErrorLeft, Limits, Replay, Target};
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
    target: &Target,
    (carried, beside): (&Carried, &Tables),
    depth: Depth,
) -> Certificate {
    let poses: Vec<Pose> = random_poses(machine, depth.poses, depth.seed);
    let replay = Replay::new(machine, target, beside);
    let driven = Driven::new(machine, carried).beside(&replay);
    let both = approaches(machine).iter().map(|approach| (*approach, figures(&driven, &poses, *approach)));
    let worse = both.reduce(|a, b| if b.1.all.position_um.p95 > a.1.all.position_um.p95 { b } else { a });
    let (approach, compensated) = worse.unwrap_or_else(|| (Approach::Mean, figures(&driven, &poses, Approach::Mean)));
    let bare = Bare { machine, order: Order::Exact };
    let zero = vec![0.0; machine.axes().len()];
    Certificate {
        poses: depth.poses,
        approach,
        uncompensated: figures(&bare, &poses, approach),
        compensated,
        errors: singles(machine, target, carried.orientation(), &poses[..poses.len().min(MOST_SINGLE_POSES)]),
        at_reference: [Approach::Forward, Approach::Reverse].map(|approach| driven.added(&zero, approach)),
        shifted: None,
        strongest: strongest(machine, &poses),
    }
}

/// Every error alone, with a module made for it alone.
fn singles(machine: &Machine, target: &Target, orientation: bool, poses: &[Pose]) -> Vec<ErrorLeft> {
    let known = machine.errors().filter(|(_, term)| !matches!(term, ErrorTerm::Tolerance(_)));
    let ids: Vec<ErrorId> = known.map(|(id, _)| id).collect();
    let alone = |error: &ErrorId| {
        let machine = machine.filtered(|id| id == error);
        let p95 = |field: &dyn Field| worse_p95(&machine, |approach| deviations(field, poses, approach));
        let before = p95(&Bare { machine: &machine, order: Order::Exact });
        let tables = target.reversal_tables(&machine);
        let replay = Replay::new(&machine, target, &tables);
        let after =
            Carried::of(&machine, target, orientation).map(|own| p95(&Driven::new(&machine, &own).beside(&replay)));
        verdict(error.clone(), before, after.unwrap_or(before))
    };
    ids.par_iter().map(alone).collect()
}

/// Where the sign is best tested: the largest deviation along an axis with the rotary axes at 0, where
/// an instrument along that axis reads it.
fn strongest(machine: &Machine, poses: &[Pose]) -> Option<Strongest> {
    let bare = Bare { machine, order: Order::Exact };
    let entry = |pose: &Pose| {
        let level: Pose = machine
            .axes()
            .iter()
            .zip(pose)
            .map(|(axis, q)| if axis.kind == AxisKind::Rotary { 0.0 } else { *q })
            .collect();
        let within = machine.beyond_travel(&level).next().is_none();
        let Correction(all) = Jacobian::at(machine, &level).correction(
            &bare.deviation(&level, Approach::Mean),
            &Correction::none(machine),
            Scope::POSITION,
        );
        let largest = all.iter().copied().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let at = || level.iter().copied().enumerate().collect();
        largest.filter(|(_, value)| within && *value != 0.0).map(|(axis, value)| Strongest { axis, at: at(), value })
    };
    poses.iter().filter_map(entry).max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()))
}

impl Limits {
    /// Limits on what a module corrects: the deviation of the functional point and of the tool axis.
    pub fn exceeded_by(&self, certificate: &Certificate) -> Vec<Diagnostic> {
        let (position, axis) = (certificate.uncompensated.all.position_um.max, certificate.uncompensated.tool_axis.max);
        let refusal = |what: String| {
            Diagnostic::new("E0602", what).help(
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
