//! Drawn machines on which the part is set up by a minimum zone, which is not linear in their errors.

use super::kernel::{BudgetPose, SAMPLE_LANES, SampleChunk, SampleLanes, by_joint};
use super::totals::{Request, effects};
use crate::analysis::reference::{PartReference, tip_at};
use crate::evaluate::Deviation;
use crate::lower::Quantity;
use crate::run::{Advance, Cancelled};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Returns the statistic of each drawn machine over the poses without what a reference takes out of all its
/// deviations together, in the order of drawing: of the position (mm), and of the orientation (rad). The points of
/// the reference are the poses of the request. Calls `progress` with the number of machines drawn since its last
/// call.
pub fn draw_with_zone(
    request: Request<'_>,
    zone: &PartReference,
    progress: Advance<'_>,
) -> Result<[Vec<f64>; 2], Cancelled> {
    let Request { machine, bounds, poses, draws, samples, statistic, .. } = request;
    let joints = by_joint(machine, bounds);
    let whole = Request { reference: None, ..request };
    let [positions, rotations] =
        [Quantity::Position, Quantity::Rotation].map(|quantity| effects(&whole, &joints, quantity));
    let tips: Vec<Vector3<f64>> = poses.iter().map(|pose| tip_at(machine, pose)).collect();
    let chunk = |index: usize| {
        let first = index * SAMPLE_LANES;
        let drawn = SampleChunk::new(&joints, bounds, draws, first);
        let all = |places: &[BudgetPose]| places.iter().map(|place| place.deviations(&drawn)).collect::<Vec<_>>();
        let [positions, rotations] = [all(&positions), all(&rotations)];
        let count = SAMPLE_LANES.min(samples - first);
        progress(count)?;
        let sample = |lane: usize| {
            let at = |d: &[SampleLanes; 3]| Vector3::new(d[0][lane], d[1][lane], d[2][lane]);
            let motion = zone.motion(positions.iter().map(at));
            let left = |i: usize| {
                let whole = Deviation { position: at(&positions[i]), rotation: at(&rotations[i]) };
                motion.removed_from(&whole, &tips[i])
            };
            let left: Vec<Deviation> = (0..tips.len()).map(left).collect();
            let of = |length: fn(&Deviation) -> f64| statistic.of(&mut left.iter().map(length).collect::<Vec<_>>());
            [of(|d| d.position.norm()), of(|d| d.rotation.norm())]
        };
        Ok((0..count).map(sample).collect::<Vec<_>>())
    };
    let chunks: Vec<Vec<[f64; 2]>> =
        (0..samples.div_ceil(SAMPLE_LANES)).into_par_iter().map(chunk).collect::<Result<_, Cancelled>>()?;
    Ok([0, 1].map(|k| chunks.iter().flatten().map(|pair| pair[k]).collect()))
}
