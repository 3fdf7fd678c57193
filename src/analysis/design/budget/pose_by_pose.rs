//! The effect of bounds at every pose by itself: the RSS, and the length below which 95 % of the drawn machines stay
//! there. One drawn machine serves all poses.
//!
//! Lengths of all machines are held for a block of poses at a time, so memory does not grow with their product.

use super::bounds::Bound;
use super::draw::Draws;
use super::kernel::{BudgetPose, JointBounds, SAMPLE_LANES, SampleChunk, SampleLanes, by_joint_without, squares};
use super::quantile::rank;
use crate::analysis::reference::PartReference;
use crate::evaluate::{Frame, Poses, frame_rotation};
use crate::lower::Quantity;
use crate::machine::{Machine, Pose};
use crate::run::Advance;
use nalgebra::Matrix3;
use rayon::prelude::*;

/// The request for the effect of bounds at poses.
#[derive(Clone, Copy)]
pub struct PosesRequest<'a> {
    /// The machine; errors with a value do not count.
    pub machine: &'a Machine,
    /// The bounded errors, at least one.
    pub bounds: &'a [Bound],
    /// The poses, at least one.
    pub poses: &'a Poses,
    /// The reference of the part, which its set-up takes out.
    pub reference: Option<&'a PartReference>,
    /// Frame of the vectors: that of the ranges. Lengths are the same in all.
    pub frame: Frame,
    /// The generator of drawn machines.
    pub draws: &'a Draws,
    /// Number of drawn machines, at least 1.
    pub samples: usize,
}

impl PosesRequest<'_> {
    /// Returns the number of steps that the progress counts.
    pub fn steps(&self) -> usize {
        self.poses.len() * self.samples.div_ceil(SAMPLE_LANES)
    }
}

/// Length of a deviation that is bounded, at one pose (mm or rad).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BoundedLength {
    /// Root of the sum of the squared effects of the bounds.
    pub rss: f64,
    /// The ceil(0.95 n)-th smallest length of n drawn machines.
    pub p95: f64,
}

/// Deviation that is bounded, at one pose.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BoundedDeviation {
    /// Deviation of the functional point, mm.
    pub position: BoundedLength,
    /// Deviation of the orientation of the tool, rad.
    pub rotation: BoundedLength,
}

/// The effect of bounds at poses; of pairs the first is the position (mm), the second the orientation (rad).
#[derive(Debug, Clone, PartialEq)]
pub struct PoseByPose {
    /// Pose by pose, in their order.
    pub poses: Vec<BoundedDeviation>,
    /// The largest length over the poses of each drawn machine, in the order of drawing.
    pub largest: [Vec<f64>; 2],
    /// Component by component, the range over the poses that 95 % of the drawn machines do not exceed.
    pub ranges: [[f64; 3]; 2],
}

/// Position and orientation, in the order of the pairs.
const QUANTITIES: [Quantity; 2] = [Quantity::Position, Quantity::Rotation];

/// Maximum number of lengths of drawn machines that are held for each of the two quantities.
const HELD: usize = 1 << 23;

/// Maximum number of poses in a block.
const MAX_BLOCK: usize = 1 << 13;

/// Returns the effect of bounds at poses; the same to the bit on any number of threads. Calls `progress` with the
/// number of steps done since its last call.
pub fn pose_by_pose<F: Send>(request: PosesRequest<'_>, progress: Advance<'_, F>) -> Result<PoseByPose, F> {
    let joints = by_joint_without(request.machine, request.bounds, request.reference);
    let chunks = request.samples.div_ceil(SAMPLE_LANES);
    let block = (HELD / (chunks * SAMPLE_LANES)).clamp(1, MAX_BLOCK);
    let mut poses = Vec::with_capacity(request.poses.len());
    let mut extremes = vec![SampleExtremes::NONE; chunks];
    for first in (0..request.poses.len()).step_by(block) {
        let count = block.min(request.poses.len() - first);
        let of = |i: usize| PoseEffects::new(&request, &joints, &request.poses.get(first + i));
        let places: Vec<PoseEffects> = (0..count).into_par_iter().map(of).collect();
        let chunk = |(chunk, extremes): (usize, &mut SampleExtremes)| {
            let drawn = SampleChunk::new(&joints, request.bounds, request.draws, chunk * SAMPLE_LANES);
            let lengths = places.iter().map(|place| place.squares(&drawn, extremes)).collect();
            progress(count)?;
            Ok(lengths)
        };
        let squares: Vec<Vec<[SampleLanes; 2]>> =
            extremes.par_iter_mut().enumerate().map(chunk).collect::<Result<_, F>>()?;
        let one = |i: usize| places[i].deviation(&squares, i, request.samples);
        poses.par_extend((0..count).into_par_iter().map(one));
    }
    let largest = [0, 1].map(|q| lanes(&extremes, request.samples, |of| of[q].square).map(f64::sqrt).collect());
    let range = |q: usize, k: usize| {
        let ranges = lanes(&extremes, request.samples, |of| difference(&of[q].components[k]));
        quantile(&mut ranges.collect::<Vec<_>>())
    };
    let ranges = [0, 1].map(|q| std::array::from_fn(|k| range(q, k)));
    Ok(PoseByPose { poses, largest, ranges })
}

/// Values of all samples in their order, from the lanes of each chunk.
fn lanes<'a>(
    extremes: &'a [SampleExtremes],
    samples: usize,
    of: impl Fn(&'a [Extreme; 2]) -> SampleLanes + 'a,
) -> impl Iterator<Item = f64> + 'a {
    extremes.iter().flat_map(move |chunk| of(&chunk.0)).take(samples)
}

fn difference([min, max]: &[SampleLanes; 2]) -> SampleLanes {
    std::array::from_fn(|lane| max[lane] - min[lane])
}

fn quantile(values: &mut [f64]) -> f64 {
    *values.select_nth_unstable_by(rank(values.len(), 95) - 1, f64::total_cmp).1
}

/// Extremes over the poses of position and orientation, for the samples of a chunk.
#[derive(Debug, Clone)]
struct SampleExtremes([Extreme; 2]);

#[derive(Debug, Clone)]
struct Extreme {
    /// Largest squared length.
    square: SampleLanes,
    /// Smallest and largest value of each component.
    components: [[SampleLanes; 2]; 3],
}

impl SampleExtremes {
    const NONE: Self = {
        let components = [[[f64::INFINITY; SAMPLE_LANES], [f64::NEG_INFINITY; SAMPLE_LANES]]; 3];
        let none = Extreme { square: [0.0; SAMPLE_LANES], components };
        Self([Extreme { square: none.square, components: none.components }, none])
    };
}

impl Extreme {
    fn take(&mut self, deviations: &[SampleLanes; 3], squares: &SampleLanes) {
        self.square.iter_mut().zip(squares).for_each(|(largest, square)| *largest = largest.max(*square));
        for (values, [min, max]) in deviations.iter().zip(&mut self.components) {
            min.iter_mut().zip(values).for_each(|(min, value)| *min = min.min(*value));
            max.iter_mut().zip(values).for_each(|(max, value)| *max = max.max(*value));
        }
    }
}

struct PoseEffects {
    effects: [BudgetPose; 2],
    rss: [f64; 2],
    /// From the workpiece frame into that of the vectors.
    turn: Option<Matrix3<f64>>,
}

impl PoseEffects {
    fn new(request: &PosesRequest<'_>, joints: &[JointBounds], pose: &Pose) -> Self {
        let effects = QUANTITIES.map(|quantity| BudgetPose::new(request.machine, joints, pose, quantity));
        let rss = |effects: &BudgetPose| effects.extremes(joints, request.bounds, request.draws).rss();
        let turn = frame_rotation(request.machine, pose, request.frame);
        Self { rss: [rss(&effects[0]), rss(&effects[1])], effects, turn }
    }

    /// Returns the squared lengths of the samples of a chunk, and notes their extremes.
    fn squares(&self, drawn: &SampleChunk, extremes: &mut SampleExtremes) -> [SampleLanes; 2] {
        std::array::from_fn(|q| {
            let deviations = self.effects[q].deviations(drawn);
            let squares = squares(&deviations);
            extremes.0[q].take(&self.turn(deviations), &squares);
            squares
        })
    }

    fn turn(&self, d: [SampleLanes; 3]) -> [SampleLanes; 3] {
        let Some(turn) = &self.turn else { return d };
        let row =
            |i: usize, lane: usize| turn[(i, 0)] * d[0][lane] + turn[(i, 1)] * d[1][lane] + turn[(i, 2)] * d[2][lane];
        std::array::from_fn(|i| std::array::from_fn(|lane| row(i, lane)))
    }

    /// The deviation at this pose, the `index`-th of its block, by the squared lengths of all chunks.
    fn deviation(&self, squares: &[Vec<[SampleLanes; 2]>], index: usize, samples: usize) -> BoundedDeviation {
        let length = |q: usize| {
            let all = squares.iter().flat_map(|chunk| chunk[index][q]).take(samples);
            BoundedLength { rss: self.rss[q], p95: quantile(&mut all.collect::<Vec<_>>()).sqrt() }
        };
        BoundedDeviation { position: length(0), rotation: length(1) }
    }
}

/// Returns the bounds with their effects alone on the position (mm) at a pose, largest first, without what the set-up
/// of the part takes out.
pub fn effects_at(
    machine: &Machine,
    bounds: &[Bound],
    pose: &[f64],
    draws: &Draws,
    reference: Option<&PartReference>,
) -> Vec<(usize, f64)> {
    let joints = by_joint_without(machine, bounds, reference);
    let effects = BudgetPose::new(machine, &joints, pose, Quantity::Position).extremes(&joints, bounds, draws);
    let mut list: Vec<(usize, f64)> = effects.lengths.into_iter().enumerate().collect();
    list.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    list
}
