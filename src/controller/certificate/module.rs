//! The certificate of a kinematics module.

use super::Certificate;
use super::content::{ProgrammingFigures, ToolDirection};
use super::depth::{Depth, single_error_poses};
use super::figures::{Judgement, deviations, figures, figures_of, judge};
use super::sign_test::{strongest_at, strongest_of};
use super::single_error::{NominalAt, SingleErrorResidual, judge_one, nominal};
use super::tables::TablesUnderTest;
use crate::compensation::CorrectionTables;
use crate::controller::kinematics::{KinematicsModule, ModuleField, Parameters};
use crate::controller::manifest::ControllerTarget;
use crate::controller::replay::Replay;
use crate::evaluate::{Bare, Order};
use crate::machine::{Approach, ErrorId, Machine, OperatingConditions, Pose, Tool};
use rayon::prelude::*;

/// Length by which the second tool of a certificate of kinematic parameters is longer, mm.
const LONGER_TOOL_MM: f64 = 100.0;

#[derive(Debug, Clone, Copy)]
pub(in crate::controller) struct ModuleSet<'a> {
    pub module: &'a KinematicsModule,
    pub tables: TablesUnderTest<'a>,
}

/// A target's module for one error alone; no module if it cannot be made.
#[derive(Debug, Clone)]
pub(in crate::controller) struct SingleErrorModule {
    pub error: ErrorId,
    pub module: Option<KinematicsModule>,
    pub beside: CorrectionTables,
}

/// Compares the machine with and without a module and the tables beside it. The module holds the mean of forward and
/// reverse; the direction of approach that is worse counts. The modules of single errors are made already.
pub(in crate::controller) fn judge_module(
    machine: &Machine,
    set: ModuleSet,
    single_errors: &[SingleErrorModule],
    depth: Depth,
) -> Certificate {
    let poses = depth.poses(machine);
    let driven = set.tables.beside(machine, set.module);
    let bare = Bare { machine, order: Order::Exact };
    let Judgement { approach, uncompensated, compensated, raised } = judge(&bare, &driven, &poses);
    let home = machine.home().unwrap_or_else(|| vec![0.0; machine.axes().len()]);
    let single = nominal(machine, single_error_poses(&poses));
    // The largest motion that the module alone adds to correct the position.
    let positioning = set.module.clone().without_orientation();
    let module = ModuleField::new(machine, &positioning);
    let parameters = set.module.parameters();
    Certificate {
        poses: poses.len(),
        approach,
        uncompensated,
        compensated,
        errors: single_errors.par_iter().map(|one| judge_single(machine, set.tables.target, one, &single)).collect(),
        single_error_poses: single.len(),
        at_reference: [Approach::Forward, Approach::Reverse].map(|approach| driven.addition(&approach.at_pose(&home))),
        shifted: None,
        straight: None,
        raised,
        programming: parameters.map_or_else(Vec::new, |own| programming(machine, own, set, &poses, approach.into())),
        strongest: match parameters {
            Some(_) => strongest_of(machine, &poses, &[Approach::Mean], |at| module.addition(at)),
            None => strongest_at(machine, &poses, &[Approach::Mean], |at| module.addition(at)),
        },
        sign_trials: parameters.map(|parameters| parameters.sign_trials(machine)),
    }
}

/// Figures of a transformation for both ways to program the direction of the tool, for the tools of the file that stand
/// in the spindle as the one in use does, and for one that is longer: parameters are right for every tool.
fn programming(
    machine: &Machine,
    own: &Parameters,
    set: ModuleSet,
    poses: &[Pose],
    conditions: OperatingConditions,
) -> Vec<ProgrammingFigures> {
    let in_use = machine.tool();
    let alike =
        |tool: &&Tool| tool.name != in_use.name && (tool.gauge, tool.direction) == (in_use.gauge, in_use.direction);
    let others = machine.tools().iter().filter(alike).filter_map(|tool| machine.with_tool(&tool.name));
    let of_file = std::iter::once(machine.clone()).chain(others).map(|machine| (machine, 0.0));
    let longer = (machine.with_longer_tool(LONGER_TOOL_MM), LONGER_TOOL_MM);
    let tools: Vec<_> = of_file.chain([longer]).collect();
    let ways: Vec<_> = tools.iter().flat_map(|of| [(of, false), (of, true)]).collect();
    let judged = ways.into_par_iter().map(|((machine, longer_mm), vectors)| {
        let module = KinematicsModule::KinematicParameters(own.clone().with_programming(vectors));
        let driven = set.tables.beside(machine, &module);
        let bare = Bare { machine, order: Order::Exact };
        let uncompensated = figures(&bare, poses, conditions);
        let found = deviations(&driven, poses, conditions);
        let compensated = figures_of(machine, poses, &found);
        let (away, found): (Vec<Pose>, Vec<_>) =
            poses.iter().cloned().zip(found).filter(|(pose, _)| !driven.at_pole(pose)).unzip();
        let at_poles = poses.len() - away.len();
        let away_from_poles = (at_poles > 0 && !away.is_empty()).then(|| figures_of(machine, &away, &found));
        let tool = machine.tool().name.clone();
        ProgrammingFigures {
            tool_direction: if vectors { ToolDirection::Vector } else { ToolDirection::RotaryAxes },
            tool,
            longer_mm: *longer_mm,
            uncompensated,
            compensated,
            at_poles,
            away_from_poles,
        }
    });
    judged.collect()
}

fn judge_single(
    machine: &Machine,
    target: &ControllerTarget,
    single: &SingleErrorModule,
    poses: &[NominalAt],
) -> SingleErrorResidual {
    let alone = machine.filtered(|id| *id == single.error);
    let field = single
        .module
        .as_ref()
        .map(|module| ModuleField::new(&alone, module).beside(Replay::new(&alone, target, &single.beside)));
    judge_one(single.error.clone(), &alone, poses, |_, at| {
        field.as_ref().map_or_else(|| vec![0.0; at.axes.len()], |field| field.addition(at))
    })
}
