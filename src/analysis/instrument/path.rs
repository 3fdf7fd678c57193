//! A path of poses, driven by the exact model with every axis approached from the side it comes from.

use crate::analysis::inverse::{Unreachable, place, rest};
use crate::lower::{Chain, ErrorValues, Exact, NominalPose, values};
use crate::machine::{Approach, AxisKind, Machine, Pose};
use nalgebra::Vector3;

/// A path through poses (mm, deg).
#[derive(Debug, Clone, PartialEq)]
pub struct PosePath {
    /// The poses, in order.
    pub poses: Vec<Pose>,
    /// True if the last pose leads to the first again.
    pub closed: bool,
}

/// A motion below this (mm, deg) is rounding: the axis does not move.
const MIN_MOTION: f64 = 1e-9;

impl PosePath {
    /// Returns the side from which every axis comes at every pose. An axis that does not move keeps its last side;
    /// before it has ever moved, it is at the mean of both.
    fn approaches(&self) -> Vec<Vec<Approach>> {
        let axes = self.poses.first().map_or(0, Vec::len);
        let mut sides = vec![Approach::Mean; axes];
        let mut all = Vec::new();
        // The first round of a closed path yields the approach of its first pose only; the first pose of an open path
        // is approached in the sense of its first motion.
        let lead = if self.closed { self.poses.len() } else { 1.min(self.poses.len().saturating_sub(1)) };
        let count = self.poses.len();
        for step in 0..lead + count {
            let (from, to) = match (self.closed, step) {
                (true, _) => ((step + count - 1) % count, step % count),
                (false, 0) if lead == 1 => (0, 1),
                (false, _) => ((step - lead).saturating_sub(1), step - lead),
            };
            for (side, (a, b)) in sides.iter_mut().zip(self.poses[from].iter().zip(&self.poses[to])) {
                if (b - a).abs() > MIN_MOTION {
                    *side = if b > a { Approach::Forward } else { Approach::Reverse };
                }
            }
            if step >= lead {
                all.push(sides.clone());
            }
        }
        all
    }

    /// Returns the deviation of the functional point at every pose, unturned workpiece frame, mm.
    pub fn deviations(&self, machine: &Machine) -> Vec<Vector3<f64>> {
        self.poses.iter().zip(self.approaches()).map(|(pose, sides)| deviation_from(machine, pose, &sides)).collect()
    }
}

/// Returns the deviation of the functional point (unturned workpiece frame, mm) at a pose (mm, deg), with a side of
/// approach per axis.
pub fn deviation_from(machine: &Machine, pose: &[f64], sides: &[Approach]) -> Vector3<f64> {
    let of = |side: Approach| values(machine, &side.at_pose(pose));
    let (mean, forward, reverse) = (of(Approach::Mean), of(Approach::Forward), of(Approach::Reverse));
    let axis = |(i, side): (usize, &Approach)| match side {
        Approach::Mean => mean.axes[i],
        Approach::Forward => forward.axes[i],
        Approach::Reverse => reverse.axes[i],
    };
    let errors = ErrorValues { axes: sides.iter().enumerate().map(axis).collect(), ..mean.clone() };
    let real = Chain::<f64>::actual(machine, pose, &errors, &Exact).tool_in_workpiece(&machine.workpiece());
    real.translation - NominalPose::at(machine, pose).pose.translation
}

/// Returns the pose (mm, deg) with rotary axes at rest and linear ones at a fraction of their interval in the volume: 0
/// its start, 1 its end.
pub fn within(machine: &Machine, fraction: f64) -> Pose {
    let at_rest = rest(machine);
    let at = |((axis, grid), rest): ((&crate::machine::Axis, &crate::machine::Grid), f64)| match axis.kind {
        AxisKind::Linear => grid.min + fraction * (grid.max - grid.min),
        AxisKind::Rotary => rest,
    };
    machine.axes().iter().zip(machine.volume()).zip(at_rest).map(at).collect()
}

/// Returns the poses that hold the functional point at places of the workpiece (mm), rotary axes as in `pose`.
pub fn hold(
    machine: &Machine,
    pose: &[f64],
    tips: impl Iterator<Item = Vector3<f64>>,
) -> Result<Vec<Pose>, Unreachable> {
    tips.map(|tip| place(machine, &tip, pose).map_err(|miss| miss.why)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use Approach::{Forward, Mean, Reverse};

    #[test]
    fn axes_are_approached_from_where_they_come() {
        let poses = |list: &[[f64; 2]]| list.iter().map(|p| p.to_vec()).collect();
        let open = PosePath { poses: poses(&[[0.0, 5.0], [1.0, 5.0], [2.0, 4.0], [1.0, 4.0]]), closed: false };
        assert_eq!(open.approaches(), [[Forward, Mean], [Forward, Mean], [Forward, Reverse], [Reverse, Reverse]]);
        let closed = PosePath { poses: poses(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), closed: true };
        assert_eq!(
            closed.approaches(),
            [[Reverse, Reverse], [Forward, Reverse], [Forward, Forward], [Reverse, Forward]]
        );
        assert_eq!(PosePath { poses: poses(&[[0.0, 0.0]]), closed: false }.approaches(), [[Mean, Mean]]);
    }
}
