//! The map of a machine of which nothing is measured: what its bounds lead to.

use super::bounded::DrawnBounds;
use super::map_result::{MapFromBounds, MapOptions, MapResult, WorstBoundedPose};
use super::map_tables::{MapTable, Tables};
use super::withheld::LimitWork;
use crate::analysis::budget::{BoundedDeviation, PoseByPose};
use crate::analysis::{MAX_POSES, View};
use crate::diagnostic::{Diagnostic, codes};
use crate::evaluate::{Order, Poses};
use crate::job::job_file::Job;
use crate::job::machine_file::MachineFile;
use crate::job::over::Over;
use crate::job::poses::axis_positions;
use crate::machine::{Machine, Pose};
use crate::report::plane_picture::BoundedSubject;
use crate::report::{Rows, WorkRows};
use crate::run::{Call, Refused};

pub(crate) fn volume(
    call: &mut Call<'_>,
    file: &MachineFile,
    options: &MapOptions,
    (drawn, tables): (DrawnBounds, Vec<MapTable<'_>>),
) -> Result<MapResult, Refused> {
    refuse_measured(call, options)?;
    let machine: &Machine = file;
    let place = options.picture.as_ref().map(|picture| picture.bounded_place(call, machine)).transpose()?;
    let job = options.job().read(call, file)?;
    let tool_poses = job.as_ref().map(|job| job.poses.reached(call, machine)).transpose()?;
    let toleranced = Job::characteristics(job.as_ref(), call, machine, tool_poses.as_ref())?;
    let poses = options.poses.of(call, (machine, options.seed), tool_poses.as_ref())?;
    if poses.len() > MAX_POSES {
        return call.refuse(too_many(poses.len()));
    }
    let view = View { conditions: options.approach.into(), frame: options.frame };
    let work = tool_poses.as_ref().map(WorkRows::of);
    let order = Order::Degree(1);
    let drawing = drawn.drawing.clone();
    let rows = Rows { machine, poses: &poses, view, order, target: "", work: work.as_ref(), drawn: Some(&drawing) };
    let tables = Tables::new(rows, tables).or_else(|refusal| call.refuse(refusal))?;
    let set_up = options.set_up(call, machine, &poses, job.as_ref())?;
    set_up.refuse_minimum_zone(call, "a map of bounds")?;
    let drawn = drawn.without(set_up.removed());
    let found = drawn.at(call, machine, &poses, view.frame)?;
    tables.write(&found.poses).or_else(|refusal| call.refuse(refusal))?;
    let p95 = |poses: Vec<Pose>| {
        let found = drawn.at(call, machine, &Poses::Listed(poses), view.frame)?;
        Ok(found.poses.iter().map(|pose| pose.position.p95).collect())
    };
    let subject = BoundedSubject { machine, view, drawing: &drawn.drawing, p95: &p95 };
    let drawn_picture = options.picture.as_ref().zip(place.as_ref());
    let picture = drawn_picture.map(|(picture, place)| picture.bounded_picture(place, &subject)).transpose()?;
    let features = tool_poses.as_ref().map(|reached| drawn.features(machine, reached, &found));
    let characteristics = toleranced.map(|of| drawn.characteristics(call, machine, &of)).transpose()?;
    let figures = drawn.figures(&found);
    let statistic = options.tolerances.statistic;
    let limit = Job::limit(job.as_ref(), statistic, tool_poses.as_ref());
    let judged = LimitWork {
        machine,
        bounds: &drawn.bounds,
        poses: tool_poses.as_ref().map_or(&[], |reached| &reached.poses),
        reference: drawn.removed.as_ref(),
        tolerances: &options.tolerances,
        samples: options.samples,
        seed: options.seed,
    };
    let against = |limit| judged.open(call, figures.position_um.monte_carlo.against(&limit, None));
    let limit = limit.map(against).transpose()?;
    let over = Over::work(machine, &set_up.reference, tool_poses.as_ref(), poses.len());
    let path = tool_poses
        .as_ref()
        .map(|reached| reached.path_with_step(|steps| drawn.largest_step(call, machine, &poses, steps)));
    let path = path.transpose()?.flatten();
    let result = MapResult::empty(&rows, over, figures.statistics(poses.len()));
    let worst = worst(machine, &poses, &found, options.worst);
    Ok(MapResult {
        limit,
        from: Some("bounds"),
        bounds: Some(MapFromBounds { figures, worst }),
        features: features.unwrap_or_default(),
        path,
        characteristics: characteristics.unwrap_or_default(),
        tool_poses,
        picture,
        ..result
    })
}

fn refuse_measured(call: &mut Call<'_>, options: &MapOptions) -> Result<(), Refused> {
    if options.target.is_some() {
        return call.usage("nothing of the machine is measured, so there is nothing to compensate: omit `--target`");
    }
    refuse_order(call, options.order)
}

/// Refuses an order of the errors other than the first.
pub(crate) fn refuse_order(call: &mut Call<'_>, order: Option<Order>) -> Result<(), Refused> {
    match order {
        None | Some(Order::Degree(1)) => Ok(()),
        Some(_) => call.usage("what bounds lead to is computed to first order: omit `--order`"),
    }
}

fn too_many(count: usize) -> Diagnostic {
    let message = format!("the map has {count} poses; from bounds it takes {MAX_POSES} at most");
    Diagnostic::new(codes::E0812, message)
        .help("take random poses (`--random 10000`), or larger steps under `volume` in the machine file")
}

/// The poses with the largest 95 % values; of equal ones the first.
fn worst(machine: &Machine, poses: &Poses, found: &PoseByPose, count: usize) -> Vec<WorstBoundedPose> {
    let p95 = |i: &usize| found.poses[*i].position.p95;
    let mut order: Vec<usize> = (0..found.poses.len()).collect();
    order.sort_by(|a, b| p95(b).total_cmp(&p95(a)).then(a.cmp(b)));
    order.truncate(count);
    let one = |i: usize| {
        let BoundedDeviation { position, .. } = found.poses[i];
        let axes = axis_positions(machine, &poses.get(i));
        WorstBoundedPose { axes, rss_um: position.rss * 1e3, p95_um: position.p95 * 1e3 }
    };
    order.into_iter().map(one).collect()
}
