//! Deviation and E_VE at poses.

use super::algebra;
use super::effects::{ErrorEffect, InversePole, Neglected, effects, inverse};
use super::terms::{DegreePart, MonomialPart, Parts, matrix, row};
use crate::analysis::figure_bands::PoseUncertainty;
use crate::analysis::{View, deviation_in};
use crate::evaluate::{Bare, Deviation, Evaluation, Frame, Order, expand, expand_over, frame_rotation};
use crate::job::job_file::{Job, JobPaths, NO_JOB};
use crate::job::machine_file::{MachineFile, bounded_only, order_of};
use crate::job::over::Over;
use crate::job::path::PathResult;
use crate::job::poses::{AxisPositions, axis_positions, poses};
use crate::job::reference::{Reference, SetUp};
use crate::job::reference_text::ReferenceOption;
use crate::job::tool_poses::ReachedToolPoses;
use crate::lower::WeilLift;
use crate::machine::{Approach, Machine, OperatingConditions, Pose};
use crate::run::{Call, Refused, Reply, Run};
use nalgebra::Vector3;
use std::path::{Path, PathBuf};

/// Options of [`eval`].
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct EvalOptions {
    /// Poses as text, `X=100,C=90`: mm and deg; omitted axes are at 0.
    pub at: Vec<String>,
    /// Poses as numbers, mm and deg, each as long as the machine has axes and in the order of the chain.
    pub poses: Vec<Vec<f64>>,
    /// A CSV file of poses: a header of axis names, one pose a line, mm and deg.
    pub pose_file: Option<PathBuf>,
    /// A job file instead of poses: the poses for its tool poses, without what its set-up takes out.
    pub job: Option<PathBuf>,
    /// True if the tool poses are one continuous path, solved as a whole; by default what the job file says, or else of
    /// CL data alone.
    pub path: Option<bool>,
    /// Motion that the part's set-up takes out of the deviations; by default what the job says, otherwise nothing.
    #[schemars(with = "Option<ReferenceOption>")]
    pub reference: Option<Reference>,
    /// Order of the errors; exact by default, unless the conventions of the machine name an order.
    pub order: Option<Order>,
    /// Side of approach, where forward and reverse curves were given.
    pub approach: Approach,
    /// Frame of the vectors.
    pub frame: Frame,
    /// Follows errors over a Weil algebra instead, in the words of the section `algebra` of a machine file; an empty
    /// text takes that section.
    pub algebra: Option<String>,
    /// Solves for the displacements of the axes that undo the errors, over `algebra`.
    pub inverse: bool,
    /// Lists the effect of 1 um or 1 urad of every error.
    pub sensitivity: bool,
    /// Lists the effect of pairs of errors, and the error of order 1. Implies `sensitivity`.
    pub interactions: bool,
}

impl EvalOptions {
    /// Returns the files of the job. Poses that are asked for come before the job of the machine file.
    fn job_paths(&self) -> JobPaths<'_> {
        let is_posed = !self.at.is_empty() || !self.poses.is_empty() || self.pose_file.is_some();
        let posed = is_posed.then(|| Path::new(NO_JOB));
        JobPaths { job: self.job.as_deref().or(posed), tool_poses: None, axis_poses: None, path: self.path }
    }
}

/// Deviations at poses.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct EvalResult {
    /// Name of the machine.
    pub machine: String,
    /// `exact`, a degree, or the algebra in words.
    pub order: String,
    /// The algebra asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub algebra: Option<algebra::AlgebraResult>,
    /// Frame of the vectors.
    pub frame: Frame,
    /// Side of approach.
    pub direction: Approach,
    /// Name of the tool; empty for a tool without a name.
    pub tool: String,
    /// What the result is over, for a job or a reference, and where something is taken out of the deviations.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub over: Option<Over>,
    /// Events of the path, if the tool poses are one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<PathResult>,
    /// Events of the path at each pose in words, empty at a pose without; none of single poses.
    #[serde(skip)]
    pub events: Vec<String>,
    /// Units of the numbers.
    pub units: EvalUnits,
    /// The poses in their order.
    pub poses: Vec<PoseResult>,
    /// Bound of the terms that order 1 neglects, over these poses and over [`EvalResult::BOUND_POSES`] of the volume.
    #[serde(skip)]
    pub neglected: Option<Neglected>,
}

impl EvalResult {
    /// Random poses of the volume behind [`EvalResult::neglected`].
    pub const BOUND_POSES: usize = super::effects::BOUND_POSES;
}

/// Units of an [`EvalResult`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct EvalUnits {
    /// Unit of positions and deviations of points.
    pub position: &'static str,
    /// Unit of rotations.
    pub rotation: &'static str,
    /// Unit of positions of linear axes.
    pub linear_axis: &'static str,
    /// Unit of positions of rotary axes.
    pub rotary_axis: &'static str,
}

const UNITS: EvalUnits = EvalUnits { position: "mm", rotation: "rad", linear_axis: "mm", rotary_axis: "deg" };

/// Deviation at one pose.
#[derive(Debug, Clone, serde::Serialize, schemars::JsonSchema)]
pub struct PoseResult {
    /// The pose, mm and deg.
    pub axes: AxisPositions,
    /// Nominal position of the functional point from the workpiece origin, mm.
    pub nominal: [f64; 3],
    /// Actual minus nominal position of the functional point, mm.
    pub deviation: [f64; 3],
    /// Actual minus nominal orientation of the tool, rad.
    pub rotation: [f64; 3],
    /// The part of the deviation along the normal of the surface, out of the material, mm; none where the tool poses
    /// have no columns NX, NY, NZ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub along_normal: Option<f64>,
    /// `T_tool^-1 T_work`, actual minus nominal, row by row; of the machine, whatever the reference.
    pub e_ve: [[f64; 4]; 4],
    /// Axes that the pose takes beyond the range in which their curves were measured.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub beyond_measured: Vec<String>,
    /// Expanded uncertainty of the deviation, where the machine states that of its errors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<PoseUncertainty>,
    /// Effect of each error, with [`EvalOptions::sensitivity`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensitivity: Option<Vec<ErrorEffect>>,
    /// Effect of pairs of errors, with [`EvalOptions::interactions`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interactions: Option<Vec<ErrorEffect>>,
    /// Bound of the terms that order 1 neglects at this pose, with [`EvalOptions::interactions`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order_1_neglects: Option<Neglected>,
    /// Parts of the monomials of an algebra, or of the powers of one generator with an order, lowest degree first;
    /// those that are 0 left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coefficients: Option<Vec<MonomialPart>>,
    /// Their sums by degree.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub degrees: Option<Vec<DegreePart>>,
    /// Motions of the axes that undo the errors, mm and deg, with [`EvalOptions::inverse`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inverse: Option<AxisPositions>,
    /// The pole at which they hold the position alone: what is free, and what is left.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inverse_pole: Option<InversePole>,
}

/// Evaluates a machine at poses.
///
/// Fails for a pose that does not fit the machine, and where an error curve is not known. Warns of poses beyond the
/// travel.
pub fn eval(file: &MachineFile, options: &EvalOptions, run: Run) -> Reply<EvalResult> {
    Call::answer(run, file.sources(), |call| {
        options.job_paths().with_tool(call, file, |call, file| evaluate_poses(call, file, options))
    })
}

fn evaluate_poses(call: &mut Call, machine: &MachineFile, options: &EvalOptions) -> Result<EvalResult, Refused> {
    call.extend(bounded_only(machine));
    let asked = (options.at.as_slice(), options.poses.as_slice(), options.pose_file.as_ref());
    let job = options.job_paths().read(call, machine)?;
    let reached = job.as_ref().map(|job| job.poses.reached(call, machine)).transpose()?;
    let poses = match &reached {
        Some(reached) => reached.poses.clone(),
        None => poses(call, machine, asked)?,
    };
    let set_up = set_up(call, machine, options, job.as_ref(), &poses)?;
    let lift = options.algebra.as_deref().map(|text| algebra::lift(call, machine, text, poses.len())).transpose()?;
    if options.inverse && lift.is_none() {
        return call.usage("displacements that undo the errors need an algebra");
    }
    let (order, conditions) = (order_of(machine, options.order), OperatingConditions::from(options.approach));
    let one = |pose: &Pose| match &lift {
        Some(lift) => expand_over(machine, &conditions.at_pose(pose), lift, options.frame),
        None => expand(machine, &conditions.at_pose(pose), order, options.frame),
    };
    let parts = Parts::new(order, lift.as_ref(), poses.len(), set_up.removed().is_none());
    call.extend(parts.left_out());
    let found = |pose: &Pose| {
        let expansion = one(pose);
        let mut result = result(machine, pose, &expansion.sum);
        (result.coefficients, result.degrees) = parts.of(&expansion.terms);
        result
    };
    let mut results: Vec<PoseResult> = poses.iter().map(found).collect();
    let bare = Bare { machine, order };
    if let Some(field) = set_up.field(&bare, order, conditions) {
        let view = View { conditions, frame: options.frame };
        results.iter_mut().zip(&poses).for_each(|(result, pose)| result.put(&deviation_in(&field, pose, view)));
    }
    for ((result, pose), point) in results.iter_mut().zip(&poses).zip(reached.iter().flat_map(|of| &of.surface)) {
        let turn = frame_rotation(machine, pose, options.frame);
        let normal = point.normal.map(|normal| turn.map_or(normal, |turn| turn * normal));
        result.along_normal = normal.map(|normal| normal.dot(&Vector3::from(result.deviation)) + 0.0);
    }
    if let Some(list) = PoseUncertainty::at(machine, &poses, conditions, options.frame, set_up.removed()) {
        results.iter_mut().zip(list).for_each(|(result, uncertainty)| result.uncertainty = Some(uncertainty));
    }
    let neglected = besides(call, machine, &poses, options, lift.as_ref(), &mut results)?;
    let over = (job.is_some() || options.reference.is_some() || set_up.removed().is_some())
        .then(|| Over::work(machine, &set_up.reference, reached.as_ref(), poses.len()));
    Ok(EvalResult {
        machine: machine.name().to_owned(),
        order: lift.as_ref().map_or_else(|| order.to_string(), algebra::name),
        algebra: lift.as_ref().map(algebra::AlgebraResult::of),
        frame: options.frame,
        direction: options.approach,
        tool: machine.tool().name.clone(),
        over,
        events: reached.as_ref().map_or_else(Vec::new, ReachedToolPoses::events),
        path: reached.and_then(|reached| reached.path),
        units: UNITS,
        poses: results,
        neglected,
    })
}

/// Returns the set-up of the part, of which the effects of single errors know nothing.
fn set_up(
    call: &mut Call<'_>,
    machine: &Machine,
    options: &EvalOptions,
    job: Option<&Job>,
    poses: &[Pose],
) -> Result<SetUp, Refused> {
    let effects = options.sensitivity || options.interactions || options.algebra.is_some();
    if effects && job.is_none() && options.reference.is_none() {
        return Ok(SetUp::machine());
    }
    let set_up = Job::set_up(job, call, machine, options.reference.as_ref(), poses)?;
    if effects && set_up.removed().is_some() {
        return call.usage("effects of single errors and algebras are of machine coordinates: `--reference machine`");
    }
    Ok(set_up)
}

/// Adds the requested results beside deviations.
fn besides(
    call: &mut Call,
    machine: &Machine,
    poses: &[Pose],
    options: &EvalOptions,
    lift: Option<&WeilLift>,
    results: &mut [PoseResult],
) -> Result<Option<Neglected>, Refused> {
    let mut neglected = None;
    if options.sensitivity || options.interactions {
        let (list, most) = effects(call, machine, poses, options.approach.into(), options.interactions)?;
        neglected = most;
        for (result, effects) in results.iter_mut().zip(list) {
            result.sensitivity = Some(effects.sensitivity);
            (result.interactions, result.order_1_neglects) = (effects.interactions, effects.neglected);
        }
    }
    if let Some(lift) = lift.filter(|_| options.inverse) {
        for (result, pose) in results.iter_mut().zip(poses) {
            let (by, pole) = inverse(call, machine, &options.approach.at_pose(pose), lift)?;
            (result.inverse, result.inverse_pole) = (Some(by), pole);
        }
    }
    Ok(neglected)
}

impl PoseResult {
    /// Takes another deviation.
    fn put(&mut self, deviation: &Deviation) {
        (self.deviation, self.rotation) = (row(&deviation.position), row(&deviation.rotation));
    }
}

fn result(machine: &Machine, pose: &Pose, evaluation: &Evaluation) -> PoseResult {
    PoseResult {
        axes: axis_positions(machine, pose),
        nominal: row(&evaluation.nominal),
        deviation: row(&evaluation.deviation.position),
        rotation: row(&evaluation.deviation.rotation),
        along_normal: None,
        e_ve: matrix(&evaluation.e_ve),
        beyond_measured: machine.beyond_measured(pose).map(|axis| axis.name.to_string()).collect(),
        uncertainty: None,
        sensitivity: None,
        interactions: None,
        order_1_neglects: None,
        coefficients: None,
        degrees: None,
        inverse: None,
        inverse_pole: None,
    }
}
