//! A field over many poses.

use crate::evaluate::{Deviation, Field, Frame};
use crate::evaluate::{Poses, Statistics};
use crate::lower::Ideal;
use crate::machine::{Approach, Machine};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Exact quantiles need all deviations at once; a map of more poses is refused.
pub const MOST_POSES: usize = 1_000_000;

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

/// A map of so many poses is refused: see [`MOST_POSES`].
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
    if poses.len() > MOST_POSES {
        return Err(TooManyPoses(poses.len()));
    }
    let mut deviations = vec![Deviation { position: Vector3::zeros(), rotation: Vector3::zeros() }; poses.len()];
    deviations.par_chunks_mut(BLOCK).enumerate().for_each(|(block, chunk)| {
        for (i, deviation) in chunk.iter_mut().enumerate() {
            *deviation = deviation_in(field, &poses.get(block * BLOCK + i), view);
        }
        progress(chunk.len());
    });
    let statistics = Statistics::of(&deviations);
    Ok(Map { deviations, statistics })
}

/// Deviation at a pose in the frame asked for.
pub fn deviation_in(field: &dyn Field, pose: &[f64], view: View) -> Deviation {
    let deviation = field.deviation(pose, view.approach);
    match frame_rotation(field.machine(), pose, view.frame) {
        Some(r) => Deviation { position: r * deviation.position, rotation: r * deviation.rotation },
        None => deviation,
    }
}

/// The rotation from the workpiece frame, of the ideal machine; `None` is no rotation.
pub fn frame_rotation(machine: &Machine, pose: &[f64], frame: Frame) -> Option<nalgebra::Matrix3<f64>> {
    match frame {
        Frame::Workpiece => None,
        Frame::Machine => Some(Ideal::at(machine, pose).r_work),
        Frame::Tool => Some(Ideal::at(machine, pose).pose.linear.transpose()),
    }
}
