//! Targets compared on a machine: the errors that the files of each leave.

use super::bounded::DrawnBounds;
use super::certificate::{CertificateScope, CertifiedWork};
use super::compile::CompileOptions;
use super::targets::{TargetSummary, target, targets};
use super::tolerances::ToleranceOptions;
use crate::analysis::budget::drawn_machine;
use crate::controller::{Depth, Figures, Judgement};
use crate::diagnostic::Severity;
use crate::file_set::composition::pairs;
use crate::file_set::effect::uncertified_effect;
use crate::file_set::options::CompensationOptions;
use crate::job::machine_file::MachineFile;
use crate::job::over::{Over, OverKind};
use crate::machine::{Axis, Machine};
use crate::run::{Call, Cancelled, Count, Refused, Reply, Run};
use rayon::prelude::*;
use serde::Serialize;

/// Options of [`compare_targets`].
#[derive(Debug, Clone, PartialEq, Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct CompareTargetsOptions {
    /// Number of poses of the volume.
    pub poses: usize,
    /// Seed of the poses.
    pub seed: u64,
    /// Number of machines that are drawn between the bounds of one of which nothing is measured; none by default.
    pub machines: usize,
    /// The only target that is tried; all by default.
    pub target: Option<String>,
    /// A job over which targets are compared instead of the volume.
    #[serde(flatten)]
    pub work: CertifiedWork,
}

impl Default for CompareTargetsOptions {
    fn default() -> Self {
        let CompileOptions { poses, seed, .. } = CompileOptions::default();
        Self { poses, seed, machines: 0, target: None, work: CertifiedWork::default() }
    }
}

/// The targets that are for a machine, the one that leaves least first, and those that are not.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct TargetComparison {
    /// Name of the machine.
    pub machine: String,
    /// Those with files for the machine.
    pub targets: Vec<TargetResidual>,
    /// Those without.
    pub refused: Vec<RefusedTarget>,
}

/// The errors that the files of a target leave.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct TargetResidual {
    /// Its name; of kinematic parameters with tables for what they leave `A+B`.
    pub target: String,
    /// Errors that it corrects, in words.
    pub expresses: String,
    /// Certainty of the format of each, in a word.
    pub syntax: Vec<&'static str>,
    /// Poses and reference of the figures.
    pub over: Over,
    /// Without the files.
    pub uncompensated: Figures,
    /// With the files.
    pub compensated: Figures,
    /// Fractions that the files take off drawn machines, where errors are only bounded; the figures are then those of
    /// the machine with the median.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drawn: Option<DrawnRepair>,
    /// Warnings of the files, such as that the scale in force is not known.
    pub remarks: Vec<String>,
}

/// Fractions that files take off the figure that decides, over machines drawn between bounds: 1 is all of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct DrawnRepair {
    /// Number of machines drawn.
    pub machines: usize,
    /// The least.
    pub least: f64,
    /// The median; of an even number the lower one.
    pub median: f64,
    /// The most.
    pub most: f64,
}

/// A target that has no files for a machine.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RefusedTarget {
    /// Its name.
    pub target: String,
    /// Code of the diagnostic.
    pub code: String,
    /// The reason.
    pub why: String,
}

impl TargetComparison {
    /// True if errors of the machine have values: otherwise there is nothing to correct yet.
    pub fn is_measured(&self) -> bool {
        self.targets.iter().any(|of| of.deciding_um().0 > 0.0)
    }
}

impl TargetResidual {
    /// Returns the figure that decides, without and with the files, um: over a job the largest position deviation, over
    /// the volume that of 95 % of the poses.
    pub fn deciding_um(&self) -> (f64, f64) {
        let deciding = |of: &Figures| match self.over.kind {
            OverKind::Job | OverKind::AxisPoses => of.position_um.max,
            OverKind::Volume => of.position_um.p95,
        };
        (deciding(&self.uncompensated), deciding(&self.compensated))
    }
}

/// Certifies for each built-in target what its files would leave of the errors of a machine, over a job if there is
/// one, or else over the volume. Kinematic parameters are also tried with the tables of the same control. Nothing is
/// written, formats that are known from memory only are tried too, and axes without a number in the controller are
/// numbered in the order of the file.
///
/// Fails for a job that does not fit the machine.
pub fn compare_targets(file: &MachineFile, options: &CompareTargetsOptions, run: Run<'_>) -> Reply<TargetComparison> {
    Call::answer(run, file.sources(), |call| {
        call.check_counts(&[Count::Poses(options.poses)])?;
        options.work.job_paths().with_tool(call, file, |call, file| compare(call, file, options))
    })
}

fn compare(
    call: &mut Call<'_>,
    file: &MachineFile,
    options: &CompareTargetsOptions,
) -> Result<TargetComparison, Refused> {
    let scope = options.work.scope(call, file, Depth { poses: options.poses, seed: options.seed })?;
    let compensation = numbered(file);
    let attempts = match &options.target {
        Some(name) => vec![Attempt { targets: vec![target(name).or_else(|refusal| call.refuse(refusal))?] }],
        None => attempts(),
    };
    let drawn = drawn(call, file, options)?;
    let outcomes: Vec<Outcome> = call.stage("targets", attempts.len(), |advance| {
        let one = |attempt: &Attempt| {
            let judge = |machine: &Machine| attempt.judge(file, machine, &compensation, &scope);
            let outcome = if drawn.is_empty() {
                judge(file)
            } else {
                drawn.iter().map(judge).collect::<Result<_, _>>().and_then(median)
            };
            advance(1)?;
            Ok(outcome)
        };
        attempts.par_iter().map(one).collect::<Result<_, Cancelled>>()
    })?;
    let (mut targets, mut refused) = (Vec::new(), Vec::new());
    for outcome in outcomes {
        match outcome {
            Ok(found) => targets.push(found),
            Err(refusal) => refused.push(refusal),
        }
    }
    // Where one of two is refused, so are both.
    refused.retain(|of: &RefusedTarget| !of.target.contains('+'));
    targets.sort_by(|a, b| a.deciding_um().1.total_cmp(&b.deciding_um().1));
    Ok(TargetComparison { machine: file.machine.name().to_owned(), targets, refused })
}

/// Maximum number of machines drawn.
const MAX_MACHINES: usize = 1000;

/// Returns machines drawn between the bounds of one of which nothing is measured, as many as are asked for.
fn drawn(call: &mut Call<'_>, file: &MachineFile, options: &CompareTargetsOptions) -> Result<Vec<Machine>, Refused> {
    let CompareTargetsOptions { machines, seed, .. } = *options;
    if machines == 0 {
        return Ok(Vec::new());
    }
    if machines > MAX_MACHINES {
        return call.usage(format!("`machines` is up to {MAX_MACHINES}: files are made for each"));
    }
    let bounds = DrawnBounds::of(call, file, (&ToleranceOptions::default(), machines, seed))?;
    let of = |bounds: DrawnBounds| {
        let draws = bounds.draws();
        (0..machines).map(|sample| drawn_machine(file, &bounds.bounds, &draws, sample)).collect()
    };
    Ok(bounds.map_or_else(Vec::new, of))
}

/// Returns the machine of which the median is taken off, with the fractions of all.
fn median(mut all: Vec<TargetResidual>) -> Outcome {
    let taken = |of: &TargetResidual| {
        let (before, after) = of.deciding_um();
        if before > 0.0 { 1.0 - after / before } else { 0.0 }
    };
    all.sort_by(|a, b| taken(a).total_cmp(&taken(b)));
    let middle = (all.len() - 1) / 2;
    let [least, median, most] = [0, middle, all.len() - 1].map(|i| taken(&all[i]));
    let drawn = Some(DrawnRepair { machines: all.len(), least, median, most });
    Ok(TargetResidual { drawn, ..all.swap_remove(middle) })
}

/// Returns options by which every axis has a number in the controller: in what order it counts changes no figure.
fn numbered(machine: &Machine) -> CompensationOptions {
    let is_numbered = machine.axes().iter().all(|axis| axis.controller.number.is_some());
    let number = |(i, axis): (usize, &Axis)| format!("{}={}", axis.name, i + 1);
    let map = if is_numbered { Vec::new() } else { machine.axes().iter().enumerate().map(number).collect() };
    CompensationOptions { map, ..CompensationOptions::default() }
}

type Outcome = Result<TargetResidual, RefusedTarget>;

/// A target, or two that are compiled together.
struct Attempt {
    targets: Vec<TargetSummary>,
}

/// Returns the built-in targets, and after them the pairs of parameters and tables.
fn attempts() -> Vec<Attempt> {
    let all = targets();
    let named = |name: &str| all.iter().find(|of| of.target == name).cloned();
    let pairs =
        pairs().into_iter().map(|pair| Attempt { targets: pair.iter().filter_map(|name| named(name)).collect() });
    all.iter().map(|of| Attempt { targets: vec![of.clone()] }).chain(pairs).collect()
}

impl Attempt {
    fn judge(
        &self,
        file: &MachineFile,
        machine: &Machine,
        options: &CompensationOptions,
        scope: &CertificateScope,
    ) -> Outcome {
        let target = self.targets.iter().map(|of| of.target.as_str()).collect::<Vec<_>>().join("+");
        let judged = Call::answer_of(Run::default(), file.sources(), |call| {
            let (controller, effect) = uncertified_effect(call, machine, &target, options)?;
            Ok(scope.judge(machine, &*effect.field(machine, &controller)))
        });
        let found = judged.map_err(|refusal| {
            let first = refusal.iter().find(|of| of.severity == Severity::Refusal);
            let [code, why] = first.map_or_else(Default::default, |of| [of.code.to_string(), of.message.clone()]);
            RefusedTarget { target: target.clone(), code, why }
        })?;
        let remarks = found.warnings.iter().map(|of| of.message.clone()).collect();
        let (over, Judgement { uncompensated, compensated, .. }) = found.value;
        let expresses = self.targets.iter().map(|of| of.expresses.as_str()).collect::<Vec<_>>().join("; ");
        let syntax = self.targets.iter().map(|of| of.syntax.level).collect();
        Ok(TargetResidual { target, expresses, syntax, over, uncompensated, compensated, drawn: None, remarks })
    }
}
