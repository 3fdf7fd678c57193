//! Order 1: the sum over the joints of Ad(prefix) times the joint's six errors.
//!
//! From the tool to the workpiece a point and two vectors are carried: the functional point, its displacement,
//! and the rotation, all in the frame reached. So every prefix is applied once, to what has been summed, and a linear axis
//! costs nothing but the way of the point. The errors (delta, eps) about a point o displace p by
//! `eps x p + (delta - eps x o)`: the bracket is folded into the tables, and so are location errors.

use super::ahead::{Ahead, CHUNK, Part, Scattered, Wanted};
use super::batch::Task;
use super::curves::{Curves, Six, splat_six};
use super::lanes::Lanes;
use super::links::{Link, Links, Located, Motion, Placed, Vector, cross, plus, slid, splat};
use super::steps::{self, Step, Sum};

/// The plan of order 1.
#[derive(Debug, Clone)]
pub struct FirstOrder {
    /// From the workpiece to the tool.
    pub joints: Vec<Joint>,
    /// From the tool to the workpiece, by the numbers of the joints.
    steps: Vec<Step>,
    pub tip: [f64; 3],
    pub tool: [f64; 3],
    /// Constant twist at the tool.
    pub end: Option<Six>,
}

/// A joint of it.
#[derive(Debug, Clone)]
pub struct Joint {
    pub motion: Motion,
    pub origin: [f64; 3],
    /// Twists `(delta - eps x o, eps)`; `None` if there are no errors.
    pub curves: Option<Curves>,
    pub outside: bool,
    /// Are the sine and cosine of the position needed?
    pub turns: bool,
    /// A constant twist on the workpiece's side of the joint.
    pub constant: Option<Six>,
    /// Displacement per mm of way, of an axis that is not square.
    pub bend: Option<[f64; 3]>,
}

/// `(delta, eps)` about a point to displacement of the machine's zero point, and rotation.
fn twist(six: &Six, about: &[f64; 3], sign: f64) -> Six {
    let [dx, dy, dz, ex, ey, ez] = six.map(|e| e * sign);
    let [x, y, z] = cross([ex, ey, ez], *about);
    [dx - x, dy - y, dz - z, ex, ey, ez]
}

fn placed(placed: &Placed) -> Six {
    twist(&placed.six, &placed.about, if placed.inverse { -1.0 } else { 1.0 })
}

/// Sum of constants that are there or not.
fn sum(a: Option<Six>, b: Option<Six>) -> Option<Six> {
    match (a, b) {
        (Some(a), Some(b)) => Some(std::array::from_fn(|k| a[k] + b[k])),
        (a, b) => a.or(b),
    }
}

impl FirstOrder {
    /// `None` where location errors count in the real part.
    pub fn new(links: &Links) -> Option<Self> {
        if links.real_locations {
            return None;
        }
        // The constant twist on the workpiece's side of what comes next, from the workpiece on.
        let mut pending = links.clamping.as_ref().map(placed);
        let mut joints: Vec<Joint> = Vec::new();
        for link in &links.joints {
            let [outer, inner] = constants(link);
            let sign = if link.inverse { -1.0 } else { 1.0 };
            let mut curves = link.curves.clone().mapped(|six| twist(six, &link.origin, sign));
            let mut before = sum(pending, outer);
            pending = inner;
            if !curves.is_zero() {
                let constant = if link.outside { before.take() } else { pending.take() };
                curves = curves.plus(&constant.unwrap_or_default());
            }
            // What is left on this side goes to the joint before, which may hold it in its tables.
            if let Some(Joint { outside: false, curves: Some(last), .. }) = joints.last_mut() {
                *last = std::mem::take(last).plus(&before.take().unwrap_or_default());
            }
            joints.push(Joint {
                turns: link.turns,
                motion: link.motion,
                origin: link.origin,
                curves: (!curves.is_zero()).then_some(curves),
                outside: link.outside,
                constant: before,
                bend: bend(link),
            });
        }
        let end = sum(pending, links.spindle.as_ref().map(placed));
        let steps = steps::of(&joints, end);
        Some(Self { joints, steps, tip: links.tip, tool: links.tool, end })
    }
}

impl FirstOrder {
    /// The same of the joint next to the tool alone.
    pub fn inner(&self, joint: &Joint) -> Self {
        let joints = vec![joint.clone()];
        Self { steps: steps::of(&joints, self.end), joints, ..*self }
    }

    /// From the tool past all steps.
    #[inline(always)]
    pub fn walk<V: Lanes>(&self, inputs: Scattered<'_>) -> State<V> {
        let zero = V::splat(0.0);
        let mut state = State { point: splat(&self.tip), displacement: splat(&self.tool), rotation: [zero; 3] };
        for step in &self.steps {
            if let Some(axis) = step.motion {
                let joint = &self.joints[axis];
                let turn = if joint.turns { inputs.turn(axis) } else { (zero, zero) };
                state.moved(joint, inputs.position(axis), turn);
            }
            if let Some(sum) = &step.sum {
                state.summed(sum, inputs);
            }
            if let Some(axis) = step.errors {
                state.add(inputs.six(axis));
            }
            if let Some(constant) = &step.constant {
                state.add(splat_six(constant));
            }
        }
        state
    }
}

impl Task for FirstOrder {
    #[inline(always)]
    fn ahead<V: Lanes>(&self, axes: &mut [Ahead], part: Part<'_>) {
        for axis in 0..axes.len() {
            let joint = &self.joints[axis];
            axes[axis].look::<V>(Wanted { turns: joint.turns, curves: joint.curves.as_ref() }, axis, part);
        }
        for step in &self.steps {
            if let Some(axis) = step.errors
                && let Some(curves) = &self.joints[axis].curves
            {
                axes[axis].six::<V>(curves, axis, part);
            }
        }
    }

    #[inline(always)]
    fn at<V: Lanes>(&self, inputs: Scattered<'_>) -> (Vector<V>, Vector<V>, V) {
        let State { displacement, rotation, .. } = self.walk(inputs);
        (displacement, rotation, V::splat(0.0))
    }
}

/// What is carried from the tool to the workpiece. Nothing here is indexed by a variable: it would not stay in registers.
#[derive(Clone, Copy)]
pub struct State<V> {
    pub point: Vector<V>,
    pub displacement: Vector<V>,
    pub rotation: Vector<V>,
}

impl<V: Lanes> State<V> {
    /// By a joint's own motion.
    #[inline(always)]
    fn moved(&mut self, joint: &Joint, q: V, turn: (V, V)) {
        match &joint.motion {
            Motion::Slide(direction) => {
                self.point = slid(direction, q, self.point);
                if let Some(bend) = &joint.bend {
                    self.displacement = slid(bend, q, self.displacement);
                }
            }
            Motion::Turn(about) => {
                self.point = about.turned_about(turn, &joint.origin, self.point);
                self.displacement = about.turned(turn, self.displacement);
                self.rotation = about.turned(turn, self.rotation);
            }
        }
    }

    /// The errors of several axes, transposed once.
    #[inline(always)]
    fn summed(&mut self, sum: &Sum, inputs: Scattered<'_>) {
        let mut rows = sum.first.1.rows::<V, CHUNK>(inputs.spots(sum.first.0));
        for (axis, curves) in &sum.others {
            curves.add_rows::<V, CHUNK>(&mut rows, inputs.spots(*axis));
        }
        let [x, y, z, ex, ey, ez, aside, other] = V::columns(&rows);
        self.add([x, y, z, ex, ey, ez]);
        if let Some(slide) = sum.slide {
            let q: V = inputs.position(slide.axis);
            let [x, y, z] = self.displacement;
            self.displacement = match slide.along {
                0 => [x, y + aside * q, z + other * q],
                1 => [x + aside * q, y, z + other * q],
                _ => [x + aside * q, y + other * q, z],
            };
        }
    }

    /// A twist more.
    #[inline(always)]
    fn add(&mut self, [x, y, z, ex, ey, ez]: [V; 6]) {
        let lever = cross([ex, ey, ez], self.point);
        self.displacement = plus(self.displacement, plus([x, y, z], lever));
        self.rotation = plus(self.rotation, [ex, ey, ez]);
    }
}

/// Constant twists of a joint on the workpiece's side and on the tool's side.
fn constants(link: &Link) -> [Option<Six>; 2] {
    let Some(location) = &link.location else { return [None, None] };
    match (link.located, link.motion) {
        (Located::Around, Motion::Slide(_)) => [None, None],
        (Located::Around, Motion::Turn(_)) => {
            let outer = placed(location);
            [Some(outer), Some(outer.map(|e| -e))]
        }
        (Located::Outermost, _) => [Some(placed(location)), None],
        (Located::Innermost, _) => [None, Some(placed(location))],
    }
}

/// `eps x u`: the direction of an axis that is not square.
fn bend(link: &Link) -> Option<[f64; 3]> {
    match (link.motion, &link.location) {
        (Motion::Slide(u), Some(location)) if link.located == Located::Around => {
            let [.., a, b, c] = location.six;
            Some(cross([a, b, c], u))
        }
        _ => None,
    }
}
