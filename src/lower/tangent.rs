//! Exact derivatives of the functional point at the actual errors: each source lives in one joint, so
//! dp = P dG s with the actual prefix P and the actual point s that the rest of the walk makes of the tip.

use super::chain::Chain;
use super::joint::{JointElements, Position, error_motion, invert_if, joint};
use super::source::{Exact, Place, Source, Values};
use crate::algebra::{Algebra, Dual, Htm};
use crate::machine::{Direction, Machine};
use nalgebra::Vector3;

/// Where the functional point really is, and how it moves with single errors.
#[derive(Debug, Clone)]
pub struct Tangents {
    /// The actual functional point from the workpiece origin (mm, workpiece frame).
    pub point: Vector3<f64>,
    /// Its derivative by each source asked for (mm per mm or per rad, workpiece frame).
    pub derivatives: Vec<Vector3<f64>>,
}

/// The actual functional point from the workpiece origin (mm, workpiece frame): exact model.
pub fn actual_point(machine: &Machine, pose: &[f64], values: &Values) -> Vector3<f64> {
    let chain = Chain::<f64>::real(machine, pose, values, &Exact);
    let walk = std::iter::once(&chain.clamping).chain(&chain.joints).chain([&chain.spindle]);
    let point = walk.rev().fold(chain.tip, |point, joint| joint.apply(&point.into()));
    point - Vector3::from(machine.workpiece())
}

/// The actual functional point at a pose (mm, deg) with its derivatives by `sources`, at these errors.
pub fn tangents(machine: &Machine, pose: &[f64], values: &Values, sources: &[Source]) -> Tangents {
    let chain = Chain::<f64>::real(machine, pose, values, &Exact);
    let walk: Vec<&Htm<f64>> = std::iter::once(&chain.clamping).chain(&chain.joints).chain([&chain.spindle]).collect();
    let mut prefix = vec![nalgebra::Matrix3::identity()];
    for (k, joint) in walk.iter().enumerate() {
        prefix.push(prefix[k] * joint.linear);
    }
    let mut points = vec![chain.tip];
    for (k, joint) in walk.iter().rev().enumerate() {
        points.push(joint.apply(&points[k].into()));
    }
    points.reverse();
    let derivative = |source: &Source| {
        let k = match source.place {
            Place::Workpiece => 0,
            Place::Location(i) | Place::Component(i) => i + 1,
            Place::Tool => return prefix[walk.len()].column(source.direction.index() % 3).into_owned(),
        };
        let moved = with_generator(machine, pose, values, *source).apply(&points[k + 1].into());
        prefix[k] * moved.map(|x: Dual<2>| x.0[1])
    };
    Tangents {
        point: points[0] - Vector3::from(machine.workpiece()),
        derivatives: sources.iter().map(derivative).collect(),
    }
}

/// The joint over D_1 in which one error has the generator beside its value.
fn with_generator(machine: &Machine, pose: &[f64], values: &Values, source: Source) -> Htm<Dual<2>> {
    let conventions = machine.conventions();
    let marked = |six: &[f64; 6]| -> [Dual<2>; 6] {
        Direction::ALL.map(|d| Dual([six[d.index()], f64::from(u8::from(d == source.direction))]))
    };
    let at = |i: usize| Position::at(&machine.axes()[i], pose[i]);
    let plain = |six: &[f64; 6]| six.iter().any(|e| *e != 0.0).then(|| six.map(Dual::from_real));
    match source.place {
        Place::Location(i) if i < pose.len() => {
            let (location, component) = &values.axes[i];
            let errors = JointElements { location: Some(marked(location)), component: plain(component) };
            joint(&machine.axes()[i], conventions, &at(i), &errors)
        }
        Place::Component(i) => {
            let (location, component) = &values.axes[i];
            let errors = JointElements { location: plain(location), component: Some(marked(component)) };
            joint(&machine.axes()[i], conventions, &at(i), &errors)
        }
        Place::Workpiece => {
            let motion = error_motion(&marked(&values.workpiece), conventions.joints);
            Htm::about(&machine.workpiece(), invert_if(true, motion))
        }
        Place::Location(_) | Place::Tool => {
            let motion = error_motion(&marked(&values.spindle.unwrap_or_default()), conventions.joints);
            Htm::about(&machine.tool().gauge, motion)
        }
    }
}
