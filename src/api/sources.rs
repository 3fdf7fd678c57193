//! Each error alone over the volume, or over a job: which of them dominate.

use crate::analysis::{ErrorStatistics, MapFailure, View, error_statistics, map, rest};
use crate::evaluate::{CompiledField, Field, Frame, Order, Poses, Random, worst};
use crate::job::job_file::{Job, JobPaths};
use crate::job::machine_file::{MachineFile, bounded_only, order_of};
use crate::job::over::Over;
use crate::job::poses::{AxisPositions, axis_positions, poses};
use crate::job::reference::{Reference, SetUp};
use crate::job::reference_text::ReferenceOption;
use crate::machine::{Approach, AxisKind, Direction, ErrorFamily, ErrorId, Machine, Pose};
use crate::run::{Call, Cancelled, Count, Refused, Reply, Run};
use crate::syntax::{component_words, location_words};
use indexmap::IndexMap;
use std::path::PathBuf;

/// Options of [`sources`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default)]
pub struct SourcesOptions {
    /// Number of random poses over the volume, at most [`SourcesOptions::MAX_POSES`].
    pub poses: usize,
    /// Seed of the poses.
    pub seed: u64,
    /// A file of tool poses in place of the volume.
    pub tool_poses: Option<PathBuf>,
    /// A job file in place of the volume; `none` leaves the job of the machine file out.
    pub job: Option<PathBuf>,
    /// True if the tool poses are one continuous path; by default what the job file says, or else of CL data alone.
    pub path: Option<bool>,
    /// Motion that the part's set-up takes out of every effect; by default as of a map. Without a minimum zone, which
    /// is not linear, but the best fit.
    #[schemars(with = "Option<ReferenceOption>")]
    pub reference: Option<Reference>,
    /// Pose of [`ErrorSource::at_um`], mm and deg, in the order of the chain; the worst of the poses by default.
    pub at: Option<Pose>,
    /// Order of all errors together; exact by default, unless the conventions of the machine name an order.
    pub order: Option<Order>,
    /// Side of approach, where forward and reverse curves were given.
    pub approach: Approach,
}

impl SourcesOptions {
    /// Largest number of poses: all errors at all poses are held at once.
    pub const MAX_POSES: usize = 10_000;

    fn job_paths(&self) -> JobPaths<'_> {
        JobPaths { job: self.job.as_deref(), tool_poses: self.tool_poses.as_deref(), axis_poses: None, path: self.path }
    }
}

impl Default for SourcesOptions {
    fn default() -> Self {
        let (tool_poses, job, path, reference) = (None, None, None, None);
        let (order, approach) = (None, Approach::default());
        Self { poses: 2000, seed: 1, tool_poses, job, path, reference, at: None, order, approach }
    }
}

/// Each error that has a value, alone.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct ErrorSources {
    /// Name of the machine.
    pub machine: String,
    /// Poses and reference of the effects.
    pub over: Over,
    /// Number of poses.
    pub poses: usize,
    /// Seed of the poses.
    pub seed: u64,
    /// The pose of [`ErrorSource::at_um`], mm and deg.
    pub at: AxisPositions,
    /// The errors, largest 95 % position deviation first.
    pub errors: Vec<ErrorSource>,
}

/// One error alone, first order.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct ErrorSource {
    /// Name of the error.
    pub error: ErrorId,
    /// What it is, in words.
    pub words: String,
    /// 95 % of the poses have a smaller position deviation, um.
    pub p95_um: f64,
    /// Largest position deviation, um.
    pub max_um: f64,
    /// 95 % of the poses have a smaller rotation of the tool, urad.
    pub p95_urad: f64,
    /// Its part along the deviation at one pose, um: the parts of all errors are, to first order, its length.
    pub at_um: f64,
}

/// Returns the effect of each error alone over random poses of the volume, or over a job.
///
/// Fails for more than [`SourcesOptions::MAX_POSES`] poses, and for a pose that does not fit the machine. Warns of a
/// machine of which nothing is measured.
pub fn sources(file: &MachineFile, options: &SourcesOptions, run: Run) -> Reply<ErrorSources> {
    Call::answer(run, file.sources(), |call| {
        options.job_paths().with_tool(call, file, |call, file| find(call, file, options))
    })
}

fn find(call: &mut Call, machine: &MachineFile, options: &SourcesOptions) -> Result<ErrorSources, Refused> {
    let SourcesOptions { poses: count, seed, order, approach, .. } = *options;
    call.check_counts(&[Count::Poses(count)])?;
    let job = options.job_paths().read(call, machine)?;
    let reached = job.as_ref().map(|job| job.poses.reached(call, machine)).transpose()?;
    let list = match &reached {
        Some(reached) => Poses::Listed(reached.poses.clone()),
        None => Poses::Random(Random::of(machine, count, seed)),
    };
    if list.len() > SourcesOptions::MAX_POSES {
        return call.usage(format!("sources take {} poses at most", SourcesOptions::MAX_POSES));
    }
    call.extend(bounded_only(machine));
    let held: Vec<Pose> = list.iter().collect();
    let set_up = match Job::set_up(job.as_ref(), call, machine, options.reference.as_ref(), &held)? {
        zone if zone.reference.is_minimum_zone() => SetUp::best_fit(machine, &held),
        set_up => set_up,
    };
    let (order, view) = (order_of(machine, order), View { conditions: approach.into(), frame: Frame::Workpiece });
    let compiled = CompiledField::new(machine, order);
    let referenced = set_up.field(&compiled, order, view.conditions);
    let field: &dyn Field = referenced.as_ref().map_or(&compiled, |field| field);
    let at = match &options.at {
        Some(at) => poses(call, machine, (&[], std::slice::from_ref(at), None))?.swap_remove(0),
        None => {
            let all = call.stage("poses", list.len(), |advance| match map(field, &list, view, advance) {
                Err(MapFailure::Cancelled) => Err(Cancelled),
                all => Ok(all),
            })?;
            let deviations = all.map(|map| map.deviations).unwrap_or_default();
            worst(&deviations, 1).first().map_or_else(|| rest(machine), |i| list.get(*i))
        }
    };
    let errors = error_statistics(field, &list, &approach.at_pose(&at), set_up.removed());
    Ok(ErrorSources {
        machine: machine.name().to_owned(),
        over: Over::work(machine, &set_up.reference, reached.as_ref(), list.len()),
        poses: list.len(),
        seed,
        at: axis_positions(machine, &at),
        errors: errors.into_iter().map(|of| source(machine, of)).collect(),
    })
}

fn source(machine: &Machine, of: ErrorStatistics) -> ErrorSource {
    ErrorSource {
        words: words(machine, &of.error),
        p95_um: of.position.p95,
        max_um: of.position.max,
        p95_urad: of.rotation.p95,
        at_um: of.along + 0.0,
        error: of.error,
    }
}

/// Returns what each error is that an axis or the spindle can have, in words, by name in the order of the chain.
pub(crate) fn all_words(machine: &Machine) -> IndexMap<String, String> {
    let both: &[ErrorFamily] = &[ErrorFamily::Component, ErrorFamily::Location];
    let axes = machine.axes().iter().map(|axis| (&axis.name, both));
    let spindle = machine.chain().spindle().map(|name| (name, &both[1..]));
    let mut words_by_name = IndexMap::new();
    for (axis, families) in axes.chain(spindle) {
        for (family, direction) in
            families.iter().flat_map(|family| Direction::ALL.map(|direction| (family, direction)))
        {
            let error = ErrorId { axis: axis.clone(), family: *family, direction };
            let _ = words_by_name.insert(error.to_string(), words(machine, &error));
        }
    }
    words_by_name
}

/// Returns what an error is, in words; an axis that is not of the chain is the spindle.
pub(crate) fn words(machine: &Machine, error: &ErrorId) -> String {
    let axis = machine.axes().iter().find(|axis| axis.name == error.axis);
    let rotary = axis.is_none_or(|axis| axis.kind == AxisKind::Rotary);
    let direction = axis.map_or(machine.tool().direction, |axis| axis.direction);
    // The words name the machine's axis only where the axis is parallel to it.
    let along = direction.iter().position(|x| x.abs() > 1.0 - 1e-9);
    let form = if error.is_location() { location_words } else { component_words };
    form(error.axis.as_str(), rotary, along, error.direction.index())
}
