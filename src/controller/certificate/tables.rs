//! The certificate of a set of tables.

use super::Certificate;
use super::depth::{Depth, single_error_poses};
use super::figures::{Judgement, approaches, figures, judge};
use super::sign_test::strongest;
use super::single_error::SetOfTables;
use super::zero_shift::{Shiftable, ZeroShift};
use crate::compensation::{CorrectionTables, Reference, SingleErrors, Spacing, TableRules};
use crate::controller::kinematics::{KinematicsModule, ModuleField};
use crate::controller::manifest::{ControllerTarget, Interpolation};
use crate::controller::replay::{Compensated, Replay};
use crate::evaluate::{Bare, Order};
use crate::machine::{Approach, Machine, OperatingPoint};

/// Poses over which both ends of sections are compared.
const ENDS: Depth = Depth { poses: 200, seed: 1 };

/// The tables that a certificate is about.
#[derive(Debug, Clone, Copy)]
pub struct TablesUnderTest<'a> {
    /// The controller.
    pub target: &'a ControllerTarget,
    /// Its tables.
    pub tables: &'a CorrectionTables,
    /// The tables that were in force when the machine was measured, of the same controller.
    pub installed: Option<&'a CorrectionTables>,
}

impl<'a> TablesUnderTest<'a> {
    /// Returns the machine with the tables, in place of those that were in force when it was measured.
    pub fn field(&self, machine: &'a Machine) -> Compensated<'a> {
        Compensated { machine, replay: self.replay(machine) }
    }

    /// Returns the machine with a kinematics module and the tables behind it.
    pub fn beside(&self, machine: &'a Machine, module: &'a KinematicsModule) -> ModuleField<'a> {
        ModuleField::new(machine, module).beside(self.replay(machine))
    }

    /// Returns the controller with the tables. Where they may act in steps, these come at the end of each section that
    /// is worse: where in it they come is not known, and the ends leave most.
    fn replay(&self, machine: &'a Machine) -> Replay<'a> {
        let straight = self.replay_with(machine, |replay| replay);
        if self.target.manifest.controller.interpolation == Interpolation::Linear {
            return straight;
        }
        let poses = ENDS.poses(machine);
        let stepping = [0.0, 1.0].map(|at| self.replay_with(machine, |replay| replay.stepping_at(at)));
        let p95 = |replay: &Replay<'a>| {
            let field = Compensated { machine, replay: replay.clone() };
            let of = |from: &Approach| figures(&field, &poses, (*from).into()).position_um.p95;
            approaches(machine).iter().map(of).fold(0.0, f64::max)
        };
        stepping.into_iter().max_by(|a, b| p95(a).total_cmp(&p95(b))).unwrap_or(straight)
    }

    fn replay_with(&self, machine: &'a Machine, set: impl Fn(Replay<'a>) -> Replay<'a>) -> Replay<'a> {
        let load = |tables| set(Replay::new(machine, self.target, tables));
        load(self.tables).over(self.installed.map(load))
    }
}

/// Compares the machine with and without tables on seeded poses. The tables of single errors are filled already.
pub(in crate::controller) fn judge_tables(
    machine: &Machine,
    judged: TablesUnderTest,
    single_errors: &SingleErrors,
    depth: Depth,
) -> Certificate {
    let TablesUnderTest { target, tables, .. } = judged;
    let poses = depth.poses(machine);
    let bare = Bare { machine, order: Order::Exact };
    let compensated = judged.field(machine);
    let Judgement { approach, uncompensated, compensated: left, raised } = judge(&bare, &compensated, &poses);
    let home = machine.home().unwrap_or_else(|| vec![0.0; machine.axes().len()]);
    let fixed = |rules: &TableRules| rules.reference == Reference::Zero || rules.spacing == Spacing::Line;
    let vanishing = target.manifest.mechanism.iter().any(|(_, rules)| fixed(rules));
    let shifted = || {
        let added = |at: &OperatingPoint<'_>| compensated.replay.addition(at);
        let nothing = |at: &OperatingPoint<'_>| vec![0.0; at.axes.len()];
        let (shift, position_um) = Shiftable { field: &compensated, added: &added }.best_shift(&poses, approach.into());
        ZeroShift {
            shift,
            position_um,
            alone_um: Shiftable { field: &bare, added: &nothing }.best_shift(&poses, approach.into()).1,
        }
    };
    let replay = &compensated.replay;
    let step_at = replay.step_at();
    let straight = || {
        let replay = judged.replay_with(machine, |replay| replay);
        figures(&Compensated { machine, replay }, &poses, approach.into())
    };
    let set = SetOfTables { machine, target, tables, single_errors, step_at };
    let (errors, single_error_poses) = set.judge(single_error_poses(&poses));
    Certificate {
        poses: poses.len(),
        approach,
        uncompensated,
        compensated: left,
        errors,
        single_error_poses,
        at_reference: [Approach::Forward, Approach::Reverse].map(|side| replay.addition(&side.at_pose(&home))),
        shifted: vanishing.then(shifted),
        raised,
        straight: (target.manifest.controller.interpolation == Interpolation::StepOrLinear).then(straight),
        programming: Vec::new(),
        strongest: strongest(machine, tables, &poses, |at| replay.addition(at)),
        sign_trials: None,
    }
}
