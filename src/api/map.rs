//! The error over a volume.

use super::bounded::{AddingBounds, DrawnBounds};
use super::map_bounds;
use super::map_result::{BodyDiagonal, MapOptions, MapPoses, MapResult, Uncompensated, WorstPose};
use super::map_tables::{MapTable, Tables};
use crate::analysis::budget::Percentile;
use crate::analysis::figure_bands::field_bands;
use crate::analysis::{
    self, DiagonalRun, MAX_POSES, MAX_SURVEYED, Survey, SurveyTask, View, body_diagonals, deviations, rest,
};
use crate::controller::{ControllerEffect, ControllerTarget, Depth};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::{CompiledField, Deviation, Field, Frame, OneDegree, Order, Poses, Tally, worst};
use crate::file_set::effect::named_effect;
use crate::job::characteristics::ValuedField;
use crate::job::features::features;
use crate::job::job_file::Job;
use crate::job::machine_file::{MachineFile, order_of};
use crate::job::over::Over;
use crate::job::path::{LargestStep, PathResult};
use crate::job::played::played;
use crate::job::poses::axis_positions;
use crate::job::tool_poses::ReachedToolPoses;
use crate::machine::Machine;
use crate::report::plane_picture::Subject;
use crate::report::{Rows, WorkRows};
use crate::run::{Call, Count, Refused, Reply, Run};
use std::ops::Range;

/// Maps the deviations of a machine over its volume.
///
/// Fails for more than 1e9 poses (1e6 where nothing is measured), and for a picture or a file of tool poses that does
/// not fit the machine.
pub fn map(file: &MachineFile, options: &MapOptions, run: Run<'_>) -> Reply<MapResult> {
    map_tables(file, options, Vec::new(), run)
}

/// Maps as [`map`] does, and writes every pose with its deviation into tables.
///
/// Fails also if a table cannot be written; then tables may be incomplete.
pub fn map_tables(
    file: &MachineFile,
    options: &MapOptions,
    tables: Vec<MapTable<'_>>,
    run: Run<'_>,
) -> Reply<MapResult> {
    Call::answer(run, file.sources(), |call| {
        options.job().with_tool(call, file, |call, file| volume(call, file, options, tables, &WholeMap))
    })
}

/// Maps as [`map`] does, with deviations of several engines.
pub(crate) fn map_of_parts(
    file: &MachineFile,
    options: &MapOptions,
    parts: &dyn MapParts,
    run: Run<'_>,
) -> Reply<MapResult> {
    Call::answer(run, file.sources(), |call| {
        options.job().with_tool(call, file, |call, file| volume(call, file, options, Vec::new(), parts))
    })
}

/// Gives the deviations of a map that is held as a whole.
pub(crate) trait MapParts {
    /// Ends a call that is to compute part of a map that is not held as a whole.
    fn refuse_other(&self) -> Result<(), Refused> {
        Ok(())
    }

    /// Returns the deviations of a field at all poses (mm, rad).
    fn deviations(
        &self,
        call: &mut Call<'_>,
        field: &dyn Field,
        poses: &Poses,
        view: View,
    ) -> Result<Vec<Deviation>, Refused> {
        computed(call, field, poses, 0..poses.len(), view)
    }
}

struct WholeMap;

impl MapParts for WholeMap {}

/// Computes the deviations of a field at some of the poses (mm, rad).
pub(crate) fn computed(
    call: &Call<'_>,
    field: &dyn Field,
    poses: &Poses,
    range: Range<usize>,
    view: View,
) -> Result<Vec<Deviation>, Refused> {
    call.stage("poses", range.len(), |advance| deviations(field, poses, range, view, advance))
}

/// Intervals of a body diagonal.
const DIAGONAL_STEPS: usize = 20;

fn volume(
    call: &mut Call<'_>,
    file: &MachineFile,
    options: &MapOptions,
    tables: Vec<MapTable<'_>>,
    parts: &dyn MapParts,
) -> Result<MapResult, Refused> {
    call.check_counts(&[Count::Machines(options.samples)])?;
    if let MapPoses::Random(0) | MapPoses::LowDiscrepancy(0) = options.poses {
        return call.usage("a map takes 1 pose at least");
    }
    let machine: &Machine = file;
    let settings = (&options.tolerances, options.samples, options.seed);
    if let Some(drawn) = DrawnBounds::of(call, machine, settings)? {
        degree(call, options, true)?;
        parts.refuse_other()?;
        return map_bounds::volume(call, file, options, (drawn, tables));
    }
    let order = options.degree.map_or_else(|| order_of(machine, options.order), Order::Degree);
    let view = View { conditions: options.approach.into(), frame: options.frame };
    let place =
        options.picture.as_ref().map(|picture| picture.place(call, machine, options.target.is_some())).transpose()?;
    let job = options.job().read(call, file)?;
    let part =
        degree(call, options, job.as_ref().is_some_and(Job::has_part))?.map(|degree| OneDegree { machine, degree });
    let tool_poses = job.as_ref().map(|job| job.poses.reached(call, machine)).transpose()?;
    let toleranced = Job::characteristics(job.as_ref(), call, machine, tool_poses.as_ref())?;
    let compensation = compensation(call, machine, options, order)?;
    let poses = options.poses.of(call, (machine, options.seed), tool_poses.as_ref())?;
    if poses.len() > MAX_SURVEYED {
        return call.refuse(too_many(poses.len()));
    }
    let set_up = options.set_up(call, machine, &poses, job.as_ref())?;
    let whole = CompiledField::new(machine, order);
    let unreferred: &dyn Field = part.as_ref().map_or(&whole as &dyn Field, |part| part);
    let replayed = compensation.as_ref().map(|(target, effect)| effect.field(machine, target));
    let [set_up_bare, set_up_replayed] = [Some(unreferred), replayed.as_deref()]
        .map(|field| field.and_then(|field| set_up.field(field, order, view.conditions)));
    let bare: &dyn Field = set_up_bare.as_ref().map_or(unreferred, |field| field);
    let corrected = set_up_replayed.as_ref().map(|field| field as &dyn Field).or(replayed.as_deref());
    let field = corrected.unwrap_or(bare);
    let name = options.target.as_deref().unwrap_or_default();
    let work = tool_poses.as_ref().map(WorkRows::of);
    let rows = Rows { machine, poses: &poses, view, order, target: name, work: work.as_ref(), drawn: None };
    let before = match &replayed {
        Some(_) => Some(found(call, bare, &rows, Vec::new(), parts, 0)?.0.statistics),
        None => None,
    };
    let (survey, p95_over_volume) = found(call, field, &rows, tables, parts, options.worst)?;
    let state = if name.is_empty() { String::new() } else { format!("after {name}") };
    let before_field = replayed.is_some().then_some(bare);
    let subject = Subject { field, state: &state, before: before_field };
    let drawn = options.picture.as_ref().zip(place.as_ref());
    let picture = drawn.map(|(picture, place)| picture.picture(place, &subject, view, order));
    let features = tool_poses.as_ref().map(|of| features(field, of, view, replayed.is_none(), set_up.removed()));
    let features = features.unwrap_or_default();
    let rows_of = |of| played(field, of, view, replayed.is_none(), set_up.removed());
    let played = tool_poses.as_ref().filter(|_| options.played).map(rows_of).unwrap_or_default();
    let (conditions, removed, bare) = (view.conditions, set_up.removed(), replayed.is_none());
    let valued = ValuedField { field, conditions, removed, bare, seed: options.seed };
    let reached = tool_poses.as_ref().map(|reached| reached.poses.as_slice());
    let (tolerances, samples, seed) = settings;
    let adding = AddingBounds { machine, tolerances, samples, seed, work: reached, reference: set_up.removed() };
    let bounds_add = if part.is_some() { None } else { adding.added(call)? };
    let characteristics = toleranced.map(|of| adding.characteristics(call, &of, valued)).transpose()?;
    // They are of the volume, not of a part.
    let diagonals = match &tool_poses {
        Some(_) => Vec::new(),
        None => body_diagonals(field, &view.conditions.at_pose(&rest(machine)), DIAGONAL_STEPS),
    };
    let over = Over::work(machine, &set_up.reference, tool_poses.as_ref(), poses.len());
    let result = result(&rows, over, &survey, &diagonals);
    let uncompensated = before.map(|s| Uncompensated { position_um: s.position_um, rotation_urad: s.rotation_urad });
    let besides: Vec<usize> = survey.worst.iter().map(|(i, _)| *i).collect();
    // What is uncertain is the error as a whole.
    let bands =
        || field_bands(field, &poses, survey.statistics, &besides, view.conditions, options.seed, set_up.removed());
    let uncertainty = if part.is_some() { None } else { bands() };
    let target = options.target.clone();
    let limit = Job::limit(job.as_ref(), tolerances.statistic, tool_poses.as_ref());
    let band = uncertainty.as_ref().map(|of| &of.position_um);
    let limit = limit.map(|limit| adding.limit(call, limit, field, &result.position_um, band)).transpose()?;
    let path = tool_poses.as_ref().map(|reached| path(call, field, reached, view)).transpose()?.flatten();
    Ok(MapResult {
        degree: options.degree,
        limit,
        picture,
        path,
        tool_poses,
        features,
        characteristics: characteristics.unwrap_or_default(),
        bounds_add,
        target,
        uncompensated,
        uncertainty,
        p95_over_volume,
        played,
        ..result
    })
}

/// Returns the degree that is mapped alone; it is one of values, over the volume, of a bare machine as it is.
fn degree(call: &mut Call<'_>, options: &MapOptions, is_other: bool) -> Result<Option<u8>, Refused> {
    let is_other = is_other || options.order.is_some() || options.target.is_some() || options.reference.is_some();
    if options.degree.is_some() && is_other {
        return call.usage(
            "`--degree` maps a part of the errors' values over the volume: not of bounds, and no --order, --target, \
             --reference, --job, --tool-poses",
        );
    }
    Ok(options.degree)
}

/// Returns the events of a path with the largest step of the deviation of a field.
fn path(
    call: &Call<'_>,
    field: &dyn Field,
    reached: &ReachedToolPoses,
    view: View,
) -> Result<Option<PathResult>, Refused> {
    reached.path_with_step(|steps| {
        let (poses, view) = (Poses::Listed(reached.poses.clone()), View { frame: Frame::Workpiece, ..view });
        let found = computed(call, field, &poses, 0..poses.len(), view)?;
        Ok(LargestStep::of_values(&found, steps))
    })
}

/// Number of poses at which the warnings of a compensation are found.
const CERTIFIED: usize = 1000;

/// Returns the effect of the files that `compile` would write for the target, with its warnings.
fn compensation(
    call: &mut Call<'_>,
    machine: &Machine,
    options: &MapOptions,
    order: Order,
) -> Result<Option<(ControllerTarget, ControllerEffect)>, Refused> {
    let Some(name) = &options.target else { return Ok(None) };
    if order != Order::Exact {
        return call
            .usage("a compensated machine is mapped with the exact model: omit `--order`, or give `--order exact`");
    }
    let depth = Depth { poses: CERTIFIED, seed: options.seed };
    let (target, effect, _) = named_effect(call, machine, name, &options.compensation, depth)?;
    Ok(Some((target, effect)))
}

fn too_many(count: usize) -> Diagnostic {
    let count = if count == usize::MAX { "more than can be counted".to_owned() } else { count.to_string() };
    Diagnostic::new(codes::E0812, format!("there are {count} poses; a map takes {MAX_SURVEYED} at most")).help(
        "take fewer random poses (`--random 100000`), or for the grid larger steps under `volume` in the machine file",
    )
}

/// Maps a field; the tables are written. Of random poses that are held the 95 % value over the whole volume is found,
/// too.
fn found(
    call: &mut Call<'_>,
    field: &dyn Field,
    rows: &Rows<'_>,
    tables: Vec<MapTable<'_>>,
    parts: &dyn MapParts,
    count: usize,
) -> Result<(Survey, Option<Percentile>), Refused> {
    let (poses, view) = (rows.poses, rows.view);
    let tables = Tables::new(*rows, tables).or_else(|refusal| call.refuse(refusal))?;
    if poses.len() > MAX_POSES {
        parts.refuse_other()?;
        return Ok((tables.survey(call, SurveyTask { field, poses, view, worst: count })?, None));
    }
    let analysis::Map { deviations, statistics } = analysis::Map::of(parts.deviations(call, field, poses, view)?);
    tables.write(&deviations).or_else(|refusal| call.refuse(refusal))?;
    let worst = worst(&deviations, count).into_iter().map(|i| (i, deviations[i])).collect();
    let p95 = matches!(poses, Poses::Random(_)).then(|| {
        let mut lengths: Vec<f64> = deviations.iter().map(|deviation| deviation.position.norm() * 1e3).collect();
        lengths.sort_by(f64::total_cmp);
        Percentile::of(&lengths, 95)
    });
    Ok((Survey { statistics, worst }, p95))
}

fn result(rows: &Rows<'_>, over: Over, survey: &Survey, diagonals: &[DiagonalRun]) -> MapResult {
    let Rows { machine, poses, .. } = *rows;
    let worst = |(i, deviation): &(usize, Deviation)| WorstPose {
        axes: axis_positions(machine, &poses.get(*i)),
        // Adding zero turns -0 into 0.
        deviation_um: (deviation.position * 1e3).map(|x| x + 0.0).into(),
        length_um: deviation.position.norm() * 1e3,
    };
    let diagonal = |d: &DiagonalRun| {
        let [from, to] = [&d.ends[0], &d.ends[1]].map(|pose| axis_positions(machine, pose));
        let deviations_um = d.deviations.iter().map(|x| x * 1e3 + 0.0).collect();
        let (length_mm, range_um) = (d.length, d.range() * 1e3);
        BodyDiagonal { name: d.name.clone(), from, to, length_mm, range_um, deviations_um }
    };
    MapResult {
        worst: survey.worst.iter().map(worst).collect(),
        diagonals: diagonals.iter().map(diagonal).collect(),
        p95_relative_error: (poses.len() > MAX_POSES).then_some(Tally::QUANTILE_ERROR),
        ..MapResult::empty(rows, over, survey.statistics)
    }
}
