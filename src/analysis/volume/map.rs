//! Maps: a field at many poses, all kept.

use crate::evaluate::{
    Batch, Columns, CompiledModel, Deviation, Field, Frame, Order, Output, PoseColumns, Poses, Statistics,
    frame_rotation,
};
use crate::machine::{Approach, OperatingConditions};
use crate::run::{Advance, Cancelled};
use nalgebra::Vector3;
use rayon::prelude::*;
use std::ops::Range;

/// Maximum number of poses of a map, which keeps all deviations for exact quantiles; a
/// [`survey`](super::survey::survey()) takes more.
pub const MAX_POSES: usize = 1_000_000;

/// Poses per task of a thread, and per step of the progress.
const BLOCK: usize = 512;

/// Operating conditions and frame of a map.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct View {
    /// Conditions in which the machine stands at the poses.
    pub conditions: OperatingConditions,
    /// Frame of the vectors.
    pub frame: Frame,
}

/// The deviations at all poses, in their order.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Actual minus nominal, in the frame asked for (mm, rad).
    pub deviations: Vec<Deviation>,
    /// Their statistics.
    pub statistics: Statistics,
}

/// Reason why there is no map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapFailure {
    /// More than [`MAX_POSES`] poses.
    TooManyPoses(usize),
    /// The job is cancelled.
    Cancelled,
}

impl From<Cancelled> for MapFailure {
    fn from(Cancelled: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// Returns a field's deviations at all poses with their statistics. Calls `progress` with the number of poses done
/// since its last call. Fails with more than [`MAX_POSES`] poses.
pub fn map(field: &dyn Field, poses: &Poses, view: View, progress: Advance<'_>) -> Result<Map, MapFailure> {
    if poses.len() > MAX_POSES {
        return Err(MapFailure::TooManyPoses(poses.len()));
    }
    Ok(Map::of(deviations(field, poses, 0..poses.len(), view, progress)?))
}

impl Map {
    /// Returns the map of deviations (mm, rad).
    pub fn of(deviations: Vec<Deviation>) -> Self {
        let statistics = Statistics::of(&deviations);
        Self { deviations, statistics }
    }
}

/// Returns a field's deviations at a range of poses: to the bit the same on any number of threads, and in any range.
pub(crate) fn deviations(
    field: &dyn Field,
    poses: &Poses,
    range: Range<usize>,
    view: View,
    progress: Advance<'_>,
) -> Result<Vec<Deviation>, Cancelled> {
    let mut deviations = vec![Deviation { position: Vector3::zeros(), rotation: Vector3::zeros() }; range.len()];
    let frames = frames(field, view.frame);
    deviations.par_chunks_mut(BLOCK).enumerate().try_for_each(|(block, chunk)| {
        let (mut at, mut columns) = (PoseColumns::new(field.machine().axes().len()), Columns::new(chunk.len()));
        let first = range.start + block * BLOCK;
        poses.fill(first..first + chunk.len(), &mut at);
        field.deviations(&at.batch(), view.conditions, columns.output(chunk.len()));
        into_frame(frames.as_ref(), view.frame, &at.batch(), columns.output(chunk.len()));
        chunk.iter_mut().enumerate().for_each(|(i, deviation)| *deviation = columns.get(i));
        progress(chunk.len())
    })?;
    Ok(deviations)
}

/// Returns a compiled model that serves [`into_frame`] for a field's machine; `None` if its deviations are in the
/// frame.
pub(crate) fn frames(field: &dyn Field, frame: Frame) -> Option<CompiledModel> {
    let turned = frame != Frame::Workpiece || field.machine().workpiece_rotation().is_some();
    turned.then(|| CompiledModel::new(field.machine(), Order::Degree(1), Approach::Mean))
}

/// Rotates deviations of a field at poses (mm, deg) into a frame, in place; without a model they stay.
pub(crate) fn into_frame(frames: Option<&CompiledModel>, frame: Frame, poses: &Batch<'_>, out: Output<'_>) {
    if let Some(frames) = frames {
        frames.to_frame(frame, poses, out);
    }
}

/// Returns the deviation at a pose (mm, deg), in the conditions and the frame of the view.
pub fn deviation_in(field: &dyn Field, pose: &[f64], view: View) -> Deviation {
    let deviation = field.deviation(&view.conditions.at_pose(pose));
    match frame_rotation(field.machine(), pose, view.frame) {
        Some(r) => deviation.rotated(&r),
        None => deviation,
    }
}
