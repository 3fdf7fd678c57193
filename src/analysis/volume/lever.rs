//! Lever arms, which turn angular errors into displacements of the functional point.

use crate::analysis::design::budget::{Bound, bounds};
use crate::evaluate::{Poses, Random};
use crate::lower::sensitivities_to;
use crate::machine::{Approach, AxisName, Direction, ErrorFamily, ErrorId, ErrorTerm, Machine, Pose};
use nalgebra::Vector3;

/// Distance of the functional point from the point about which an axis's angular errors rotate, mm.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Lever {
    /// At the zero pose.
    pub at_zero: f64,
    /// The longest over the volume: at the zero pose, at its corners and at some poses within.
    pub longest: f64,
}

/// Number of random poses at which arms are measured, besides the corners of the volume.
const RANDOM_POSES: usize = 500;

/// Maximum number of axes with which all corners are visited.
const MAX_CORNER_AXES: usize = 10;

/// Returns the lever arms of all axes, in their order.
pub fn levers(machine: &Machine) -> Vec<Lever> {
    let zero = vec![0.0; machine.axes().len()];
    let mut levers: Vec<Lever> =
        arms(machine, &zero).into_iter().map(|at_zero| Lever { at_zero, longest: at_zero }).collect();
    for pose in corners(machine).into_iter().chain(Poses::Random(Random::of(machine, RANDOM_POSES, 0)).iter()) {
        for (lever, arm) in levers.iter_mut().zip(arms(machine, &pose)) {
            lever.longest = lever.longest.max(arm);
        }
    }
    levers
}

/// Returns for every axis what hangs on its arm: the fraction of the sum of squares, over all errors each by itself and
/// poses of the volume, that its angular component errors make. Errors that are only bounded count at their bounds.
/// `None` for a machine without errors.
pub fn arm_shares(machine: &Machine) -> Option<Vec<f64>> {
    let terms: Vec<(ErrorId, &ErrorTerm)> = machine.errors().collect();
    let ids: Vec<ErrorId> = terms.iter().map(|(id, _)| id.clone()).collect();
    let framed: Vec<Bound> = bounds(machine, None).into_iter().filter(|bound| !bound.by_letter).collect();
    let mut squares = vec![0.0; machine.axes().len()];
    let mut total = 0.0;
    let mut count = |id: &ErrorId, square: f64| {
        total += square;
        let axis = machine.axis_index(id.axis.as_str());
        if let Some(axis) = axis.filter(|_| id.direction.is_rotation() && !id.is_location()) {
            squares[axis] += square;
        }
    };
    for pose in Poses::Random(Random::of(machine, RANDOM_POSES, 0)).iter() {
        for (s, (id, term)) in sensitivities_to(machine, &pose, &ids).iter().zip(&terms) {
            let position = machine.axis_index(id.axis.as_str()).map_or(0.0, |axis| pose[axis]);
            let size = match term {
                ErrorTerm::Tolerance(bound) => *bound,
                term => term.value(position, Approach::Mean),
            };
            count(id, s.deviation.norm_squared() * size * size);
        }
        for bound in &framed {
            let of_letters = sensitivities_to(machine, &pose, &bound.letter_ids());
            let parts = of_letters.iter().zip(bound.direction).map(|(s, part)| s.deviation * part);
            count(&bound.error, parts.sum::<Vector3<f64>>().norm_squared() * bound.tolerance * bound.tolerance);
        }
    }
    (total > 0.0).then(|| squares.into_iter().map(|square| square / total).collect())
}

/// Returns the arms at a pose, mm. With r the arm, unit rotations about three perpendicular directions displace by
/// vectors whose squared lengths sum up to 2 r^2; so the arm is the same in every convention.
fn arms(machine: &Machine, pose: &[f64]) -> Vec<f64> {
    let tilts = |axis: &AxisName| -> Vec<ErrorId> {
        let tilt = |d: &Direction| ErrorId { axis: axis.clone(), family: ErrorFamily::Component, direction: *d };
        Direction::ALL[3..].iter().map(tilt).collect()
    };
    let ids: Vec<ErrorId> = machine.axes().iter().flat_map(|axis| tilts(&axis.name)).collect();
    let sensitivities = sensitivities_to(machine, pose, &ids);
    sensitivities
        .chunks(3)
        .map(|three| (three.iter().map(|s| s.deviation.norm_squared()).sum::<f64>() / 2.0).sqrt())
        .collect()
}

fn corners(machine: &Machine) -> Vec<Pose> {
    let volume = machine.volume();
    if volume.len() > MAX_CORNER_AXES {
        return Vec::new();
    }
    let corner = |k: usize| {
        volume.iter().enumerate().map(|(i, grid)| if k >> i & 1 == 0 { grid.min } else { grid.max }).collect()
    };
    (0..1 << volume.len()).map(corner).collect()
}
