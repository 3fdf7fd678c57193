//! Lever arms, which turn angular errors into displacements of the functional point.

use crate::analysis::design::budget::{Bound, bounds};
use crate::evaluate::{Poses, Random};
use crate::lower::{JointError, NominalJoints, Quantity};
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
    let arms = Arms::new(machine);
    let zero = vec![0.0; machine.axes().len()];
    let mut levers: Vec<Lever> =
        arms.at(machine, &zero).into_iter().map(|at_zero| Lever { at_zero, longest: at_zero }).collect();
    for pose in corners(machine).into_iter().chain(Poses::Random(Random::of(machine, RANDOM_POSES, 0)).iter()) {
        for (lever, arm) in levers.iter_mut().zip(arms.at(machine, &pose)) {
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
    let errors: Vec<JointError> = terms.iter().map(|(id, _)| JointError::new(machine, id)).collect();
    let framed: Vec<Bound> = bounds(machine, None).into_iter().filter(|bound| !bound.by_letter).collect();
    let letters = |bound: &Bound| bound.letter_ids().map(|id| JointError::new(machine, &id));
    let framed: Vec<(&Bound, [JointError; 3])> = framed.iter().map(|bound| (bound, letters(bound))).collect();
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
        let (at, joints) = (Approach::Mean.at_pose(&pose), NominalJoints::at(machine, &pose));
        let effect = |error: &JointError| error.effect(&joints, Quantity::Position);
        for (error, (id, term)) in errors.iter().zip(&terms) {
            let size = match term {
                ErrorTerm::Tolerance(bound) => *bound,
                term => term.value(&error.argument(&at)),
            };
            count(id, effect(error).norm_squared() * size * size);
        }
        for (bound, letters) in &framed {
            let parts = letters.iter().zip(bound.direction).map(|(error, part)| effect(error) * part);
            count(&bound.error, parts.sum::<Vector3<f64>>().norm_squared() * bound.tolerance * bound.tolerance);
        }
    }
    (total > 0.0).then(|| squares.into_iter().map(|square| square / total).collect())
}

/// The angular component errors of every axis.
struct Arms(Vec<[JointError; 3]>);

impl Arms {
    fn new(machine: &Machine) -> Self {
        let tilts = |axis: &AxisName| {
            let tilt = |direction| ErrorId { axis: axis.clone(), family: ErrorFamily::Component, direction };
            [Direction::A, Direction::B, Direction::C].map(|direction| JointError::new(machine, &tilt(direction)))
        };
        Self(machine.axes().iter().map(|axis| tilts(&axis.name)).collect())
    }

    /// Returns the arms at a pose, mm. With r the arm, unit rotations about three perpendicular directions displace by
    /// vectors whose squared lengths sum up to 2 r^2; so the arm is the same in every convention.
    fn at(&self, machine: &Machine, pose: &[f64]) -> Vec<f64> {
        let joints = NominalJoints::at(machine, pose);
        let square = |error: &JointError| error.effect(&joints, Quantity::Position).norm_squared();
        self.0.iter().map(|three| (three.iter().map(square).sum::<f64>() / 2.0).sqrt()).collect()
    }
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
