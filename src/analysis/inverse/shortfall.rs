//! Shortfalls of machines for a work: the tool axis that they cannot hold, and the travel that the work needs.

use super::tool_pose::{Miss, excess, rest, unturned_tool_pose};
use crate::evaluate::radical_inverse;
use crate::machine::{Axis, AxisKind, Machine, Pose};
use nalgebra::Vector3;

/// Number of positions of the rotary axes from which the nearest direction is sought.
const STARTS: u64 = 6;

/// Rounds of turns by one axis after the other.
const ROUNDS: usize = 200;

/// Returns the angle (rad) between a direction (unit vector, workpiece frame) and the nearest one in which the machine
/// can hold its tool, whatever the travels of its rotary axes.
pub fn direction_gap(machine: &Machine, direction: &Vector3<f64>) -> f64 {
    let rotary: Vec<usize> =
        (0..machine.axes().len()).filter(|i| machine.axes()[*i].kind == AxisKind::Rotary).collect();
    let direction = machine.workpiece_rotation().map_or(*direction, |rotation| rotation * direction);
    let starts = if rotary.len() < 2 { 1 } else { STARTS };
    let nearest = |start: u64| {
        let mut pose = rest(machine);
        let bases = [2, 3, 5, 7, 11, 13, 17, 19];
        let of = |(axis, base): (&usize, &u64)| (*axis, 360.0 * radical_inverse(start, *base));
        let spread = rotary.iter().zip(bases.iter().cycle()).map(of).filter(|_| start > 0).collect::<Vec<_>>();
        spread.into_iter().for_each(|(axis, q)| pose[axis] = q);
        nearest_angle(machine, &direction, &rotary, pose)
    };
    (0..starts).map(nearest).fold(f64::INFINITY, f64::min)
}

/// Returns the angle (rad) that is left once no axis alone brings the tool nearer to the direction (unturned).
fn nearest_angle(machine: &Machine, direction: &Vector3<f64>, rotary: &[usize], mut pose: Pose) -> f64 {
    let along = |pose: &Pose| unturned_tool_pose(machine, pose).direction.dot(direction);
    let mut last = along(&pose);
    for _ in 0..ROUNDS {
        for axis in rotary {
            let mut at = |degrees: f64| {
                pose[*axis] = degrees;
                along(&pose)
            };
            // The cosine is c + a cos + b sin of the turn.
            let [p, q, r] = [0.0, 120.0, 240.0].map(&mut at);
            let (a, b) = ((2.0 * p - q - r) / 3.0, (q - r) / libm::sqrt(3.0));
            pose[*axis] = libm::atan2(b, a).to_degrees();
        }
        let now = along(&pose);
        if now - last <= 1e-16 {
            break;
        }
        last = now;
    }
    let reached = unturned_tool_pose(machine, &pose).direction;
    libm::atan2(reached.cross(direction).norm(), reached.dot(direction))
}

/// The positions of each axis (mm, deg) over a work, whether or not they are within the travel.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Needs {
    /// Number of tool poses that count: those that are reached, or would be by longer travels.
    pub rows: usize,
    /// Smallest and largest position of each axis; empty without tool poses.
    pub ranges: Vec<(f64, f64)>,
}

impl Needs {
    /// Returns the needs of the poses and misses of a work.
    pub fn of<'a>(found: impl Iterator<Item = Result<&'a Pose, &'a Miss>>) -> Self {
        let mut needs = Self::default();
        found.filter_map(|pose| pose.map_or_else(|miss| miss.beyond.as_ref(), Some)).for_each(|pose| needs.take(pose));
        needs
    }

    fn take(&mut self, pose: &Pose) {
        self.rows += 1;
        if self.ranges.is_empty() {
            self.ranges = pose.iter().map(|q| (*q, *q)).collect();
        }
        self.ranges.iter_mut().zip(pose).for_each(|((min, max), q)| (*min, *max) = (min.min(*q), max.max(*q)));
    }

    /// Returns by how much (mm, deg) the travel of each axis is too short at its lower and its upper end.
    pub fn short(&self, axes: &[Axis]) -> Vec<[f64; 2]> {
        let mut short = vec![[0.0, 0.0]; self.ranges.len()];
        let ends: [Pose; 2] =
            [self.ranges.iter().map(|(min, _)| *min).collect(), self.ranges.iter().map(|(_, max)| *max).collect()];
        for end in &ends {
            for e in excess(axes, end) {
                let side = usize::from(e.by > 0.0);
                short[e.axis][side] = f64::max(short[e.axis][side], e.by.abs());
            }
        }
        short
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn needs_span_what_is_reached_and_what_would_be() {
        let (a, b) = (vec![1.0, -2.0], Miss::travel(vec![-4.0, 3.0]));
        let none = Miss::new(super::super::Unreachable::Direction);
        let needs = Needs::of([Ok(&a), Err(&b), Err(&none)].into_iter());
        assert_eq!(needs, Needs { rows: 2, ranges: vec![(-4.0, 1.0), (-2.0, 3.0)] });
    }
}
