//! Linear axes that span no more than a plane (a lathe's X and Z): a rotary axis about the tool axis, which the
//! direction does not depend on, turns the place into that plane.

use super::linear;
use super::tool_pose::unturned_tool_pose;
use crate::machine::{AxisKind, Machine, Pose, Travel};
use nalgebra::Vector3;

/// A change of the direction below this (rad) is rounding.
const SAME_DIRECTION_RAD: f64 = 1e-9;

/// Lengths below this (mm) are rounding: no turn moves the place.
const STILL_MM: f64 = 1e-9;

/// Returns the candidates with one more axis turned so that the place lies in the plane of the linear axes; nearest to
/// the reference first.
pub fn turn_into_plane(machine: &Machine, tip: &Vector3<f64>, candidates: &[Pose], reference: &[f64]) -> Vec<Pose> {
    if candidates.first().is_none_or(|pose| linear::normal(machine.axes(), pose).is_none()) {
        return Vec::new();
    }
    let rotary = |axis: &usize| machine.axes()[*axis].kind == AxisKind::Rotary;
    let of = |pose: &Pose| -> Vec<Pose> {
        let axes = (0..machine.axes().len()).filter(rotary);
        axes.flat_map(|axis| TurningAxis { machine, tip, pose, axis }.poses(reference[axis])).collect()
    };
    candidates.iter().flat_map(of).collect()
}

/// A candidate of which one more axis is turned.
struct TurningAxis<'a> {
    machine: &'a Machine,
    tip: &'a Vector3<f64>,
    pose: &'a Pose,
    axis: usize,
}

impl TurningAxis<'_> {
    fn at(&self, degrees: f64) -> Pose {
        let mut pose = self.pose.clone();
        pose[self.axis] = degrees;
        pose
    }

    /// Returns the distance of the place from the plane, mm; `None` if the linear axes span none, or all of space.
    fn beside(&self, degrees: f64) -> Option<f64> {
        let pose = self.at(degrees);
        let normal = linear::normal(self.machine.axes(), &pose)?;
        Some(normal.dot(&(self.tip - unturned_tool_pose(self.machine, &pose).tip)))
    }

    /// Returns the poses whose place lies in the plane. The distance is c + a cos + b sin of the turn if the linear
    /// axes are on one side of this axis, or along it: two turns, or none.
    fn poses(&self, reference: f64) -> Vec<Pose> {
        let direction = |degrees: f64| unturned_tool_pose(self.machine, &self.at(degrees)).direction;
        let turns = (direction(reference + 120.0) - direction(reference)).norm() > SAME_DIRECTION_RAD;
        let thirds = [0.0, 120.0, 240.0].map(|third| self.beside(third));
        let [Some(p), Some(q), Some(r)] = thirds else { return Vec::new() };
        let (c, a, b) = ((p + q + r) / 3.0, (2.0 * p - q - r) / 3.0, (q - r) / libm::sqrt(3.0));
        let size = libm::hypot(a, b);
        if turns || size < STILL_MM || c.abs() > size + STILL_MM {
            return Vec::new();
        }
        let (middle, half) = (libm::atan2(b, a), libm::acos((-c / size).clamp(-1.0, 1.0)));
        let mut found: Vec<f64> =
            [middle - half, middle + half].iter().filter_map(|x| self.within(x.to_degrees(), reference)).collect();
        found.sort_by(|x, y| (x - reference).abs().total_cmp(&(y - reference).abs()));
        found.into_iter().map(|degrees| self.at(degrees)).collect()
    }

    /// Returns the position whole turns away that is nearest to the reference and within the travel.
    fn within(&self, degrees: f64, reference: f64) -> Option<f64> {
        let nearest = degrees + 360.0 * libm::round((reference - degrees) / 360.0);
        match self.machine.axes()[self.axis].travel {
            Travel::Continuous => Some(nearest),
            Travel::Range(min, max) => {
                let turns = [0.0, -360.0, 360.0].map(|turn| nearest + turn);
                turns.into_iter().find(|q| (min..=max).contains(q))
            }
        }
    }
}
