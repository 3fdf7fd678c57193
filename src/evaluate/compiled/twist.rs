//! Errors as twists about the machine's zero point: the terms that order 1 sums.
//!
//! The errors (delta, eps) about a point o displace r by `delta + eps x (r - o)`. That is a displacement of the
//! machine's zero point and a rotation: constants are added up and curves of tables mapped, before any pose is known.

use super::chain::{CompiledChain, CompiledJoint, ErrorsAtPoint, LocationEffect, NominalMotion};
use super::curves::{CompiledCurves, Six};
use super::vector::cross;

/// A joint of order 1: its nominal motion, and its errors as twists.
#[derive(Debug, Clone)]
pub struct TwistJoint {
    /// Nominal motion.
    pub motion: NominalMotion,
    /// Point of a rotary axis.
    pub origin: [f64; 3],
    /// Twists `(delta - eps x o, eps)`; `None` if there are no errors.
    pub curves: Option<CompiledCurves>,
    /// True if the errors act on the workpiece's side of the motion.
    pub outside: bool,
    /// True if the walk reads the sine and cosine of the position.
    pub turns: bool,
    /// A constant twist on the workpiece's side of the joint.
    pub constant: Option<Six>,
    /// Displacement per mm of travel, of a linear axis that is not square.
    pub bend: Option<[f64; 3]>,
}

/// Returns `sign` times the errors `(delta, eps)` about a point as displacement of the machine's zero point and
/// rotation.
pub fn twist(six: &Six, about: &[f64; 3], sign: f64) -> Six {
    let [dx, dy, dz, ex, ey, ez] = six.map(|e| e * sign);
    let [x, y, z] = cross([ex, ey, ez], *about);
    [dx - x, dy - y, dz - z, ex, ey, ez]
}

fn place(placed: &ErrorsAtPoint) -> Six {
    twist(&placed.six, &placed.about, if placed.inverse { -1.0 } else { 1.0 })
}

/// Returns the sum of two constants; an absent one is zero.
fn add(a: Option<Six>, b: Option<Six>) -> Option<Six> {
    match (a, b) {
        (Some(a), Some(b)) => Some(std::array::from_fn(|k| a[k] + b[k])),
        (a, b) => a.or(b),
    }
}

/// The joints of a chain with their twists.
#[derive(Debug, Clone)]
pub struct TwistChain {
    /// Joints from the workpiece to the tool.
    pub joints: Vec<TwistJoint>,
    /// A constant twist on the tool's side of all joints.
    pub end: Option<Six>,
}

impl TwistChain {
    /// Folds location errors into the curves where a joint has any, else into constant twists.
    pub fn new(chain: &CompiledChain) -> Self {
        // The constant twist on the workpiece's side of the next joint, from the workpiece on.
        let mut pending = chain.workpiece_setup.as_ref().map(place);
        let mut joints: Vec<TwistJoint> = Vec::new();
        for link in &chain.joints {
            let [outer, inner] = constants(link);
            let sign = if link.inverse { -1.0 } else { 1.0 };
            let mut curves = link.curves.clone().map_errors(|six| twist(six, &link.origin, sign));
            let mut before = add(pending, outer);
            pending = inner;
            if !curves.is_zero() {
                let constant = if link.outside { before.take() } else { pending.take() };
                curves = curves.plus(&constant.unwrap_or_default());
            }
            // A constant that remains on this side goes to the joint before, which may hold it in its tables.
            if let Some(TwistJoint { outside: false, curves: Some(last), .. }) = joints.last_mut() {
                *last = std::mem::take(last).plus(&before.take().unwrap_or_default());
            }
            joints.push(TwistJoint {
                turns: link.turns,
                motion: link.motion,
                origin: link.origin,
                curves: (!curves.is_zero()).then_some(curves),
                outside: link.outside,
                constant: before,
                bend: bend(link),
            });
        }
        Self { joints, end: add(pending, chain.spindle.as_ref().map(place)) }
    }
}

/// Returns the constant twists of a joint's location errors on its workpiece side and on its tool side.
fn constants(link: &CompiledJoint) -> [Option<Six>; 2] {
    let Some(location) = &link.location else { return [None, None] };
    match (link.location_effect, link.motion) {
        (LocationEffect::Around, NominalMotion::Slide(_)) => [None, None],
        (LocationEffect::Around, NominalMotion::Turn(_)) => {
            let outer = place(location);
            [Some(outer), Some(outer.map(|e| -e))]
        }
        (LocationEffect::Outermost, _) => [Some(place(location)), None],
        (LocationEffect::Innermost, _) => [None, Some(place(location))],
    }
}

/// Returns `eps x u`, by which the direction of a linear axis deviates.
fn bend(link: &CompiledJoint) -> Option<[f64; 3]> {
    match (link.motion, &link.location) {
        (NominalMotion::Slide(u), Some(location)) if link.location_effect == LocationEffect::Around => {
            let [.., a, b, c] = location.six;
            Some(cross([a, b, c], u))
        }
        _ => None,
    }
}
