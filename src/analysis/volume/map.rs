//! A field over many poses.

use crate::evaluate::{
    Batch, Columns, CompiledModel, Deviation, Field, Frame, Order, Output, PoseColumns, Poses, Statistics,
};
use crate::lower::NominalPose;
use crate::machine::{Approach, Machine};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Exact quantiles need all deviations at once; more poses are surveyed ([`survey`](super::survey::survey())) instead.
pub const MAX_POSES: usize = 1_000_000;

/// Poses per task: long enough to be worth one, short enough for a progress bar.
const BLOCK: usize = 512;

/// How a field is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct View {
    /// From which side the poses are approached.
    pub approach: Approach,
    /// Frame of the vectors.
    pub frame: Frame,
}

/// The deviations at all poses, in their order.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Actual minus nominal, in the frame asked for (mm, rad).
    pub deviations: Vec<Deviation>,
    /// What they come to.
    pub statistics: Statistics,
}

/// A map of so many poses is refused: see [`MAX_POSES`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TooManyPoses(pub usize);

/// Evaluates a field at all poses. Every pose by itself and the sums in their order: the result is
/// the same to the bit on any number of threads. `progress` is told how many poses were done.
pub fn map(
    field: &dyn Field,
    poses: &Poses,
    view: View,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Map, TooManyPoses> {
    if poses.len() > MAX_POSES {
        return Err(TooManyPoses(poses.len()));
    }
    let mut deviations = vec![Deviation { position: Vector3::zeros(), rotation: Vector3::zeros() }; poses.len()];
    let frames = (view.frame != Frame::Workpiece).then(|| frames(field));
    deviations.par_chunks_mut(BLOCK).enumerate().for_each(|(block, chunk)| {
        let (mut at, mut columns) = (PoseColumns::new(field.machine().axes().len()), Columns::new(chunk.len()));
        poses.fill(block * BLOCK..block * BLOCK + chunk.len(), &mut at);
        field.deviations(&at.batch(), view.approach, columns.output(chunk.len()));
        into_frame(frames.as_ref(), view.frame, &at.batch(), columns.output(chunk.len()));
        chunk.iter_mut().enumerate().for_each(|(i, deviation)| *deviation = columns.get(i));
        progress(chunk.len());
    });
    let statistics = Statistics::of(&deviations);
    Ok(Map { deviations, statistics })
}

/// A plan that knows the frames of a field's machine.
pub(crate) fn frames(field: &dyn Field) -> CompiledModel {
    CompiledModel::new(field.machine(), Order::Degree(1), Approach::Mean)
}

/// Turns deviations into the frame asked for.
pub(crate) fn into_frame(frames: Option<&CompiledModel>, frame: Frame, poses: &Batch<'_>, out: Output<'_>) {
    if let Some(frames) = frames {
        frames.to_frame(frame, poses, out);
    }
}

/// Deviation at a pose in the frame asked for.
pub fn deviation_in(field: &dyn Field, pose: &[f64], view: View) -> Deviation {
    let deviation = field.deviation(pose, view.approach);
    match frame_rotation(field.machine(), pose, view.frame) {
        Some(r) => Deviation { position: r * deviation.position, rotation: r * deviation.rotation },
        None => deviation,
    }
}

/// The rotation from the workpiece frame, of the nominal machine; `None` is no rotation.
pub fn frame_rotation(machine: &Machine, pose: &[f64], frame: Frame) -> Option<nalgebra::Matrix3<f64>> {
    match frame {
        Frame::Workpiece => None,
        Frame::Machine => Some(NominalPose::at(machine, pose).r_work),
        Frame::Tool => Some(NominalPose::at(machine, pose).pose.linear.transpose()),
    }
}
