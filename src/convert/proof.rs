//! The proof: both machines evaluated, exact model, from every direction of approach.

use crate::algebra::{Htm, skew_vector};
use crate::evaluate::{Nodes, Poses, Random};
use crate::lower::{Chain, ErrorValues, Exact, values};
use crate::machine::{Approach, Grid, Machine, OperatingPoint, Pose};

/// The largest differences of two machines that should be the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proof {
    /// Poses on a grid over the volume, and random ones over the travels.
    pub poses: [usize; 2],
    /// Largest difference of the functional point, mm.
    pub position: f64,
    /// Largest difference of the orientation, rad.
    pub rotation: f64,
    /// The same two where positions are approached from one side, without the mean of both; infinite where the
    /// machine knows no sides.
    pub one_sided: [f64; 2],
}

/// Approximate maximum number of grid nodes.
const NODES: f64 = 4000.0;
const RANDOM: usize = 2000;
const APPROACHES: [Approach; 3] = [Approach::Mean, Approach::Forward, Approach::Reverse];

impl Proof {
    /// True if the difference is at most this (mm; rotations: over a metre).
    pub fn holds(&self, within_mm: f64) -> bool {
        self.position <= within_mm && self.rotation <= within_mm * 1e-3
    }
}

/// Compares a machine with its conversion, whose axes may count in the opposite sense.
pub fn prove(old: &Machine, new: &Machine) -> Proof {
    let count = old.axes().len().max(1) as f64;
    let each = libm::floor(libm::pow(NODES, 1.0 / count)).max(2.0);
    let coarse = |grid: &Grid| Grid { step: ((grid.max - grid.min) / (each - 1.0)).max(grid.step.min(1e-3)), ..*grid };
    let volume: Vec<Grid> = old.volume().iter().map(coarse).collect();
    let travels = old.axes().iter().map(|axis| axis.travel.interval()).collect();
    let lists = [Poses::Nodes(Nodes::new(&volume)), Poses::Random(Random::new(travels, RANDOM, 1))];
    let approaches = &APPROACHES[..if old.is_bidirectional() { 3 } else { 1 }];
    let one_sided = [if approaches.len() > 1 { 0.0 } else { f64::INFINITY }; 2];
    let mut proof = Proof { poses: [lists[0].len(), lists[1].len()], position: 0.0, rotation: 0.0, one_sided };
    for pose in lists.iter().flat_map(Poses::iter) {
        for &approach in approaches {
            let [position, rotation] = difference(old, new, &approach.at_pose(&pose));
            proof.position = largest(proof.position, position);
            proof.rotation = largest(proof.rotation, rotation);
            if approach != Approach::Mean {
                let [a, b] = proof.one_sided;
                proof.one_sided = [largest(a, position), largest(b, rotation)];
            }
        }
    }
    proof
}

/// NaN is the largest of all.
fn largest(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

fn difference(old: &Machine, new: &Machine, at: &OperatingPoint<'_>) -> [f64; 2] {
    let pose = at.axes;
    let over: Vec<bool> = old.axes().iter().zip(new.axes()).map(|(a, b)| a.sign() != b.sign()).collect();
    let turned: Pose = pose.iter().zip(&over).map(|(q, over)| if *over { -q } else { *q }).collect();
    let errors = values_at(new, &at.conditions.at_pose(&turned), &over);
    let before = Chain::actual(old, pose, &values(old, at), &Exact).tool_in_workpiece(&old.workpiece());
    let after = Chain::actual(new, &turned, &errors, &Exact).tool_in_workpiece(&new.workpiece());
    let nominal = [(old, pose), (new, &turned[..])]
        .map(|(machine, pose)| Chain::<f64>::nominal(machine, pose).tool_in_workpiece(&machine.workpiece()));
    let [real, nominal] = [apart(&before, &after), apart(&nominal[0], &nominal[1])];
    [largest(real[0], nominal[0]), largest(real[1], nominal[1])]
}

/// A rising position of an axis that counts in the opposite sense is a falling one.
fn values_at(machine: &Machine, at: &OperatingPoint<'_>, over: &[bool]) -> ErrorValues {
    let mut errors = values(machine, at);
    let other = values(machine, &OperatingPoint { conditions: at.conditions.reversed(), ..*at });
    for ((own, other), over) in errors.axes.iter_mut().zip(other.axes).zip(over) {
        if *over {
            *own = other;
        }
    }
    errors
}

fn apart(a: &Htm<f64>, b: &Htm<f64>) -> [f64; 2] {
    let relative = b.linear * a.linear.transpose();
    // A linearised joint stretches: that is a difference too.
    let stretch = (b.linear - a.linear).amax();
    [(b.translation - a.translation).norm(), largest(skew_vector(&relative).norm(), stretch)]
}
