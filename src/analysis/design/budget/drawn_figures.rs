//! Figures of drawn machines that are functions of their deviations at some poses, such as the roundness of a feature:
//! the value of each machine, and the parts of the bounds in the 95 % value.

use super::bounds::Bound;
use super::draw::Draws;
use super::kernel::{BudgetPose, JointBounds, SAMPLE_LANES, SampleChunk, SampleLanes, by_joint_without};
use super::totals::around_95;
use crate::analysis::reference::PartReference;
use crate::lower::Quantity;
use crate::machine::{Machine, Pose};
use crate::run::{Advance, Cancelled};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Returns the values of all figures by deviations (mm) at the poses.
pub type FiguresAt<'a> = dyn Fn(&[Vector3<f64>]) -> Vec<f64> + Sync + 'a;

/// Returns the derivatives of a figure by the deviations (mm) at poses: with the deviations they sum up to its value.
pub type WeightsAt<'a> = dyn Fn(usize, &[Vector3<f64>]) -> Vec<(usize, Vector3<f64>)> + Sync + 'a;

/// The request for figures of drawn machines.
#[derive(Clone, Copy)]
pub struct FiguresRequest<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// The bounded errors, at least one.
    pub bounds: &'a [Bound],
    /// The poses (mm, deg).
    pub poses: &'a [Pose],
    /// Deviations (mm) at the poses that every machine has besides; empty without.
    pub constant: &'a [Vector3<f64>],
    /// The reference of the part, which its set-up takes out.
    pub reference: Option<&'a PartReference>,
    /// The generator of drawn machines.
    pub draws: &'a Draws,
    /// Number of drawn machines, at least 1.
    pub samples: usize,
    /// The figures.
    pub figures: &'a FiguresAt<'a>,
    /// Their derivatives.
    pub weights: &'a WeightsAt<'a>,
}

/// A figure of drawn machines.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DrawnFigure {
    /// Its value in each machine, in the order of drawing (mm).
    pub values: Vec<f64>,
    /// Mean part of each bound in the machines about the 95 % value (mm).
    pub parts: Vec<f64>,
    /// Mean part of the deviations that every machine has (mm).
    pub constant: f64,
}

/// Returns the figures of drawn machines; the same to the bit on any number of threads. Calls `progress` with the
/// number of machines drawn since its last call: in all twice the samples.
pub fn draw_figures(request: FiguresRequest<'_>, progress: Advance<'_>) -> Result<Vec<DrawnFigure>, Cancelled> {
    let FiguresRequest { machine, bounds, samples, .. } = request;
    let joints = by_joint_without(machine, bounds, request.reference);
    let place = |pose: &Pose| BudgetPose::new(machine, &joints, pose, Quantity::Position);
    let places: Vec<BudgetPose> = request.poses.par_iter().map(place).collect();
    let chunks = samples.div_ceil(SAMPLE_LANES);
    let lanes = |chunk: usize| SAMPLE_LANES.min(samples - chunk * SAMPLE_LANES);
    let of_chunk = |chunk: usize| {
        let drawn = DrawnPositions::new(&request, &places, &joints, chunk);
        progress(lanes(chunk))?;
        Ok((0..lanes(chunk)).map(|lane| (request.figures)(&drawn.at(&request, lane))).collect::<Vec<_>>())
    };
    let values: Vec<Vec<Vec<f64>>> = (0..chunks).into_par_iter().map(of_chunk).collect::<Result<_, Cancelled>>()?;
    let values: Vec<Vec<f64>> = values.into_iter().flatten().collect();
    let figures = values.first().map_or(0, Vec::len);
    let about: Vec<Vec<usize>> = (0..figures).map(|k| about_95(&values, k)).collect();
    // Figures by the samples of a chunk that are about their 95 % value.
    let parts_of = |chunk: usize| {
        let sample = |lane: usize| chunk * SAMPLE_LANES + lane;
        let wanted = |lane: usize, k: usize| about[k].binary_search(&sample(lane)).is_ok();
        progress(lanes(chunk))?;
        if !(0..lanes(chunk)).any(|lane| (0..figures).any(|k| wanted(lane, k))) {
            return Ok(Vec::new());
        }
        let drawn = DrawnPositions::new(&request, &places, &joints, chunk);
        let removed = drawn.chunk.removed_by_source(&joints);
        let mut found = Vec::new();
        for lane in 0..lanes(chunk) {
            let positions = drawn.at(&request, lane);
            for k in (0..figures).filter(|k| wanted(lane, *k)) {
                let weights = (request.weights)(k, &positions);
                found.push((k, drawn.parts(&request, &places, &joints, &removed, lane, &weights)));
            }
        }
        Ok(found)
    };
    let parts: Vec<Vec<(usize, Parts)>> =
        (0..chunks).into_par_iter().map(parts_of).collect::<Result<_, Cancelled>>()?;
    let empty = |k: usize| DrawnFigure {
        values: values.iter().map(|figures| figures[k]).collect(),
        parts: vec![0.0; bounds.len()],
        constant: 0.0,
    };
    let mut all: Vec<DrawnFigure> = (0..figures).map(empty).collect();
    for (k, part) in parts.into_iter().flatten() {
        let share = 1.0 / about[k].len() as f64;
        all[k].parts.iter_mut().zip(&part.bounds).for_each(|(sum, x)| *sum += x * share);
        all[k].constant += part.constant * share;
    }
    Ok(all)
}

/// Returns the deviations (mm) of one drawn machine at the poses of a request.
pub fn drawn_positions(request: &FiguresRequest<'_>, sample: usize) -> Vec<Vector3<f64>> {
    let joints = by_joint_without(request.machine, request.bounds, request.reference);
    let place = |pose: &Pose| BudgetPose::new(request.machine, &joints, pose, Quantity::Position);
    let places: Vec<BudgetPose> = request.poses.par_iter().map(place).collect();
    DrawnPositions::new(request, &places, &joints, sample / SAMPLE_LANES).at(request, sample % SAMPLE_LANES)
}

/// Returns the samples whose values are about the 95 % value of a figure, in rising order of their indices.
fn about_95(values: &[Vec<f64>], figure: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a][figure].total_cmp(&values[*b][figure]).then(a.cmp(b)));
    let mut about = order[around_95(values.len())].to_vec();
    about.sort_unstable();
    about
}

/// Parts of a figure in one machine (mm).
struct Parts {
    bounds: Vec<f64>,
    constant: f64,
}

/// The positions of a chunk of drawn machines at all poses.
struct DrawnPositions {
    chunk: SampleChunk,
    deviations: Vec<[SampleLanes; 3]>,
}

impl DrawnPositions {
    fn new(request: &FiguresRequest<'_>, places: &[BudgetPose], joints: &[JointBounds], chunk: usize) -> Self {
        let chunk = SampleChunk::new(joints, request.bounds, request.draws, chunk * SAMPLE_LANES);
        let deviations = places.iter().map(|place| place.deviations(&chunk)).collect();
        Self { chunk, deviations }
    }

    /// Returns the deviations of one machine at the poses (mm).
    fn at(&self, request: &FiguresRequest<'_>, lane: usize) -> Vec<Vector3<f64>> {
        let mut list: Vec<Vector3<f64>> =
            self.deviations.iter().map(|[x, y, z]| Vector3::new(x[lane], y[lane], z[lane])).collect();
        list.iter_mut().zip(request.constant).for_each(|(d, constant)| *d += constant);
        list
    }

    fn parts(
        &self,
        request: &FiguresRequest<'_>,
        places: &[BudgetPose],
        joints: &[JointBounds],
        removed: &[Vec<[SampleLanes; 6]>],
        lane: usize,
        weights: &[(usize, Vector3<f64>)],
    ) -> Parts {
        let count = request.bounds.len();
        let mut parts = Parts { bounds: vec![0.0; count], constant: 0.0 };
        for (pose, weight) in weights {
            let vectors = places[*pose].parts(&self.chunk, removed, joints, lane, count);
            let along = vectors.iter().map(|v| weight.dot(&Vector3::from(*v)));
            parts.bounds.iter_mut().zip(along).for_each(|(sum, x)| *sum += x);
            parts.constant += request.constant.get(*pose).map_or(0.0, |constant| weight.dot(constant));
        }
        parts
    }
}
