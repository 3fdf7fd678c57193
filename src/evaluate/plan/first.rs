//! Order 1: the sum over the joints of Ad(prefix) times the joint's six errors.
//!
//! From the tool to the workpiece a point and two vectors are carried: the functional point, its displacement,
//! and the rotation, all in the frame reached. So every prefix is applied once, to what has been summed, and a linear axis
//! costs nothing but the way of the point. The errors (delta, eps) about a point o displace p by
//! `eps x p + (delta - eps x o)`: the bracket is folded into the tables, and so are location errors.

use super::batch::{Slices, Task};
use super::curves::{Curves, Six};
use super::lanes::Lanes;
use super::links::{Link, Links, Located, Motion, Placed, Vector, cross, minus, plus, slid, splat, times};
use super::trigonometry::sin_cos;

/// The plan of order 1.
#[derive(Debug, Clone)]
pub struct FirstOrder {
    /// From the workpiece to the tool.
    pub joints: Vec<Joint>,
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
                turns: link.turns(),
                motion: link.motion,
                origin: link.origin,
                curves: (!curves.is_zero()).then_some(curves),
                outside: link.outside,
                constant: before,
                bend: bend(link),
            });
        }
        let end = sum(pending, links.spindle.as_ref().map(placed));
        Some(Self { joints, tip: links.tip, tool: links.tool, end })
    }
}

impl Task for FirstOrder {
    #[inline(always)]
    fn at<V: Lanes>(&self, poses: &Slices<'_>, at: usize) -> (Vector<V>, Vector<V>, V) {
        let zero = V::splat(0.0);
        let (mut p, mut d, mut w) = (splat::<V>(&self.tip), splat::<V>(&self.tool), [zero; 3]);
        if let Some(constant) = &self.end {
            (d, w) = displaced(p, d, w, constant.map(V::splat));
        }
        for (axis, joint) in self.joints.iter().enumerate().rev() {
            let q = V::load(&poses.axes[axis][at..]);
            let turn = if joint.turns { sin_cos(q) } else { (zero, zero) };
            let errors = joint.curves.as_ref().map(|curves| curves.at(q, turn));
            if let (Some(six), false) = (errors, joint.outside) {
                (d, w) = displaced(p, d, w, six);
            }
            match &joint.motion {
                Motion::Slide(direction) => {
                    p = slid(direction, q, p);
                    if let Some(bend) = &joint.bend {
                        d = plus(d, times(splat(bend), q));
                    }
                }
                Motion::Turn(about) => {
                    let o = splat(&joint.origin);
                    p = plus(about.turned(turn, minus(p, o)), o);
                    d = about.turned(turn, d);
                    w = about.turned(turn, w);
                }
            }
            if let (Some(six), true) = (errors, joint.outside) {
                (d, w) = displaced(p, d, w, six);
            }
            if let Some(constant) = &joint.constant {
                (d, w) = displaced(p, d, w, constant.map(V::splat));
            }
        }
        (d, w, zero)
    }
}

/// The displacement of a point and the rotation, with a twist added.
#[inline(always)]
fn displaced<V: Lanes>(p: Vector<V>, d: Vector<V>, w: Vector<V>, twist: [V; 6]) -> (Vector<V>, Vector<V>) {
    let [x, y, z, ex, ey, ez] = twist;
    let lever = cross([ex, ey, ez], p);
    (plus(d, plus([x, y, z], lever)), plus(w, [ex, ey, ez]))
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
