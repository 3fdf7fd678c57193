//! The frame of each axis: along it, and two directions across that the machine itself gives, so that they turn with
//! the machine. On an upright machine they are the letters.
//!
//! Three perpendicular directions of the machine come from its linear axes, then its tool axis, then its rotary axes,
//! each by its letter. An axis counts as the letter of its name, or, if it points elsewhere, as the nearest direction
//! of the machine; across it lie the direction of the machine that is most nearly perpendicular to it, cut to be so,
//! and what completes the three. A machine with one direction only has none across: the letters stand in.

use super::{Axis, AxisKind, Direction, ErrorFamily, ErrorId, Machine};
use nalgebra::Vector3;

/// Below this sine two directions are parallel.
const PARALLEL: f64 = 1e-6;
/// From this sine on two directions give a frame without much ado.
const APART: f64 = 0.5;
/// An axis counts as the letter of its name above this cosine.
const NAMED: f64 = 0.1;
/// Cosines this close are equal, so that rounding decides nothing.
const EQUAL: f64 = 1e-9;

type Three = [Vector3<f64>; 3];

/// The frames of all joints: axes in the machine's order, then the spindle.
#[derive(Debug, Clone, PartialEq)]
pub struct Frames {
    machine: Three,
    joints: Vec<JointFrame>,
}

/// The frame of an axis, or of the spindle along the tool axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointFrame {
    /// Index of the direction along the axis: 0 to 2 as X, Y, Z.
    pub along: usize,
    directions: Three,
    /// Axes of the rotations that are squareness to X, Y or Z: perpendicular to both axes.
    squareness: [Option<Vector3<f64>>; 3],
}

impl JointFrame {
    /// Returns the unit vector of a translation, or of the axis of a rotation, that a letter names in this frame.
    pub fn direction(&self, family: ErrorFamily, letter: Direction) -> [f64; 3] {
        let slot = letter.index() % 3;
        let normal = self.squareness[slot].filter(|_| family == ErrorFamily::Location && letter.is_rotation());
        normal.unwrap_or(self.directions[slot]).into()
    }

    /// Returns the axis, 0 to 2 as X, Y, Z, to which a location error is squareness.
    pub fn squareness_to(&self, family: ErrorFamily, letter: Direction) -> Option<usize> {
        let slot = letter.index() % 3;
        let square = family == ErrorFamily::Location && letter.is_rotation() && slot != self.along;
        self.squareness[slot].filter(|_| square).map(|_| 3 - slot - self.along)
    }

    /// True if a letter is along the axis in this frame.
    pub fn is_along(&self, letter: Direction) -> bool {
        letter.index() % 3 == self.along
    }
}

impl Frames {
    /// Returns the frames of a machine. The spindle turns about the axis of the default tool.
    pub fn of(machine: &Machine) -> Self {
        let tool = Vector3::from(machine.tools().first().map_or([0.0, 0.0, 1.0], |tool| tool.direction));
        let three = machine_directions(machine, tool);
        let mut frames = Self { machine: three, joints: Vec::new() };
        let axes = machine.axes();
        frames.joints = axes.iter().map(|axis| frames.framed(axes, axis, axis.direction)).collect();
        frames.joints.push(frames.around(tool, Some(2)));
        frames
    }

    /// Returns the frame of a joint by its index.
    pub fn joint(&self, joint: usize) -> &JointFrame {
        &self.joints[joint.min(self.joints.len() - 1)]
    }

    /// Returns the frame that an axis would have with another direction.
    pub fn framed(&self, axes: &[Axis], axis: &Axis, direction: [f64; 3]) -> JointFrame {
        let mut frame = self.around(Vector3::from(direction), home(axis));
        if let Some(own) = main(axis).filter(|own| *own == frame.along) {
            let before =
                axes.iter().filter_map(|other| Some((main(other)?, other))).filter(|(letter, _)| *letter < own);
            for (letter, other) in before {
                let third = 3 - own - letter;
                let (u, v) = (Vector3::from(other.direction), Vector3::from(direction));
                let normal = if (third + 1) % 3 == letter { u.cross(&v) } else { v.cross(&u) };
                frame.squareness[third] = (normal.norm() > PARALLEL).then(|| normal.normalize());
            }
        }
        frame
    }

    fn around(&self, u: Vector3<f64>, home: Option<usize>) -> JointFrame {
        let cosine = |i: usize| u.dot(&self.machine[i]).abs();
        let nearest = (1..3).fold(0, |best, i| if cosine(i) > cosine(best) + EQUAL { i } else { best });
        let along = home.filter(|i| cosine(*i) > NAMED).unwrap_or(nearest);
        let (a, b) = if along == 0 { (1, 2) } else { (0, 3 - along) };
        let (first, second) = if cosine(b) < cosine(a) - EQUAL { (b, a) } else { (a, b) };
        let mut directions = [u; 3];
        directions[first] = (self.machine[first] - u * u.dot(&self.machine[first])).normalize();
        directions[second] = third(along, &u, first, &directions[first]);
        JointFrame { along, directions, squareness: [None; 3] }
    }
}

/// Completes two of three perpendicular directions, right-handed.
fn third(i: usize, a: &Vector3<f64>, j: usize, b: &Vector3<f64>) -> Vector3<f64> {
    if (i + 1) % 3 == j { a.cross(b) } else { b.cross(a) }
}

fn machine_directions(machine: &Machine, tool: Vector3<f64>) -> Three {
    let of = |kind: AxisKind| {
        let mut list: Vec<&Axis> = machine.axes().iter().filter(|axis| axis.kind == kind).collect();
        // By name, so that the order of the chain does not matter.
        list.sort_by_key(|axis| (home(axis).unwrap_or(3), axis.name.clone()));
        list.into_iter().map(|axis| (home(axis), Vector3::from(axis.direction))).collect::<Vec<_>>()
    };
    let mut known = of(AxisKind::Linear);
    known.push((Some(2), tool));
    known.extend(of(AxisKind::Rotary));
    let (home, u) = known[0];
    let first = home.unwrap_or(0);
    let sine = |v: &Vector3<f64>| u.cross(v).norm();
    let beside = [APART, PARALLEL].into_iter().find_map(|least| known.iter().find(|(_, v)| sine(v) > least));
    let (home, v) = beside.copied().unwrap_or_else(|| {
        let letter = (1..3).fold(0, |best, i| if u[i].abs() < u[best].abs() { i } else { best });
        (None, Vector3::ith(letter, 1.0))
    });
    let second = home.filter(|letter| *letter != first).unwrap_or((first + 1) % 3);
    let mut three = [u; 3];
    three[second] = (v - u * u.dot(&v)).normalize();
    three[3 - first - second] = third(first, &u, second, &three[second]);
    three
}

/// Returns the direction (0 to 2 as X, Y, Z) of the letter of an axis's name, which may have digits behind it.
fn home(axis: &Axis) -> Option<usize> {
    let mut letters = axis.name.as_str().chars();
    let letter = letters.next().and_then(|letter| "XYZUVWPQRABC".find(letter))?;
    letters.all(|c| c.is_ascii_digit()).then_some(letter % 3)
}

/// Returns the same for the linear axes X, Y and Z, between which squareness is.
fn main(axis: &Axis) -> Option<usize> {
    axis.name.main().filter(|_| axis.kind == AxisKind::Linear)
}

impl ErrorId {
    /// Returns the same error by the letter of a direction in machine coordinates, if it is one, either way round.
    pub fn lettered(&self, direction: &[f64; 3]) -> Option<Self> {
        let slot = (0..3).find(|i| (0..3).all(|k| k == *i || direction[k].abs() < EQUAL))?;
        let turned = if self.direction.is_rotation() { 3 } else { 0 };
        Some(Self { direction: Direction::ALL[slot + turned], ..self.clone() })
    }
}
