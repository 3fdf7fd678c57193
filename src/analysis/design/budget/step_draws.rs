//! The largest change of the deviation from one pose of a path to the next, in drawn machines.

use super::kernel::{BudgetPose, SAMPLE_LANES, SampleChunk, SampleLanes, by_joint_without, squares};
use super::pose_by_pose::PosesRequest;
use crate::lower::Quantity;
use crate::run::Advance;
use rayon::prelude::*;

/// The largest step of the position deviation of a drawn machine.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DrawnStep {
    /// Length of the change of the deviation, mm, workpiece frame.
    pub length: f64,
    /// Index of the pose before it.
    pub pose: usize,
}

/// Maximum number of poses whose effects are held.
const MAX_BLOCK: usize = 1 << 13;

/// Returns the largest step of each drawn machine, in the order of drawing, among those from the poses of a list to
/// the poses after them; the same to the bit on any number of threads. Calls `progress` as
/// [`pose_by_pose`](super::pose_by_pose()) does.
pub fn draw_largest_steps<F: Send>(
    request: PosesRequest<'_>,
    from: &[usize],
    progress: Advance<'_, F>,
) -> Result<Vec<DrawnStep>, F> {
    let PosesRequest { machine, bounds, poses, reference, draws, samples, .. } = request;
    let joints = by_joint_without(machine, bounds, reference);
    let mut largest =
        vec![LaneSteps { squares: [0.0; SAMPLE_LANES], poses: [0; SAMPLE_LANES] }; samples.div_ceil(SAMPLE_LANES)];
    for block in from.chunks(MAX_BLOCK) {
        let at = |pose: usize| BudgetPose::new(machine, &joints, &poses.get(pose), Quantity::Position);
        let steps: Vec<BlockStep> = block
            .par_iter()
            .enumerate()
            .map(|(i, pose)| BlockStep {
                pose: *pose,
                // The pose before is that after the step before, where steps follow each other.
                before: (i == 0 || block[i - 1] + 1 != *pose).then(|| at(*pose)),
                after: at(*pose + 1),
            })
            .collect();
        let take = |(chunk, largest): (usize, &mut LaneSteps)| {
            largest.take(&steps, &SampleChunk::new(&joints, bounds, draws, chunk * SAMPLE_LANES));
            progress(block.len())
        };
        largest.par_iter_mut().enumerate().map(take).collect::<Result<Vec<()>, F>>()?;
    }
    let all = largest.iter().flat_map(|of| of.squares.iter().zip(&of.poses));
    Ok(all.take(samples).map(|(square, pose)| DrawnStep { length: square.sqrt(), pose: *pose }).collect())
}

/// Effects at the two poses of a step.
struct BlockStep {
    pose: usize,
    before: Option<BudgetPose>,
    after: BudgetPose,
}

/// The largest steps of the machines of a chunk.
#[derive(Debug, Clone)]
struct LaneSteps {
    squares: SampleLanes,
    poses: [usize; SAMPLE_LANES],
}

impl LaneSteps {
    fn take(&mut self, steps: &[BlockStep], drawn: &SampleChunk) {
        let mut last = [[0.0; SAMPLE_LANES]; 3];
        for BlockStep { pose, before, after } in steps {
            let start = before.as_ref().map_or(last, |before| before.deviations(drawn));
            last = after.deviations(drawn);
            let change = std::array::from_fn(|k| std::array::from_fn(|lane| last[k][lane] - start[k][lane]));
            for (lane, square) in squares(&change).into_iter().enumerate() {
                if square > self.squares[lane] {
                    (self.squares[lane], self.poses[lane]) = (square, *pose);
                }
            }
        }
    }
}
