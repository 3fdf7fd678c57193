//! The compiled chain: everything about a machine's joints that does not depend on the pose.

use super::curves::{CompiledCurves, Six};
use super::lookup::{AxisLookup, Chunk, LookupRequest};
use super::simd::Lanes;
use super::vector::{Vector, cross, dot, minus, plus, plus_times, splat, times};
use crate::machine::{
    Axis, AxisKind, JointConvention, Joints, LocationAction, LocationOrder, Machine, MotionSide, OperatingConditions,
};

/// A machine's chain, ready for the walk of any order. Lengths in mm, angles in rad, positions of rotary axes in deg.
#[derive(Debug, Clone)]
pub struct CompiledChain {
    /// Joints in the order of the machine's axes: from the workpiece to the tool.
    pub joints: Vec<CompiledJoint>,
    /// The functional point at the zero pose, mm.
    pub tip: [f64; 3],
    /// Its displacement by the set-up of the tool, mm.
    pub tool: [f64; 3],
    /// Errors of the spindle about the gauge point.
    pub spindle: Option<ErrorsAtPoint>,
    /// Set-up errors of the workpiece about its origin; inverted.
    pub workpiece_setup: Option<ErrorsAtPoint>,
    /// True if error matrices are 1 + hat(eps) rather than rotations.
    pub linearised: bool,
    /// True if location errors count in the real part.
    pub real_locations: bool,
}

/// Six constant errors about a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorsAtPoint {
    /// The errors (mm, rad).
    pub six: Six,
    /// The point, mm.
    pub about: [f64; 3],
    /// True if the inverse of their matrix acts.
    pub inverse: bool,
}

/// A joint.
#[derive(Debug, Clone)]
pub struct CompiledJoint {
    /// Its nominal motion.
    pub motion: NominalMotion,
    /// Point of a rotary axis; that about which the errors turn.
    pub origin: [f64; 3],
    /// Component errors.
    pub curves: CompiledCurves,
    /// True if there are any.
    pub errors: bool,
    /// True if a walk reads the sine and cosine of the position.
    pub turns: bool,
    /// True if they act before the motion, seen from the workpiece (E M rather than M E).
    pub outside: bool,
    /// True if the inverse of their matrix acts.
    pub inverse: bool,
    /// Location errors.
    pub location: Option<ErrorsAtPoint>,
    /// Their place among the joint's factors.
    pub location_effect: LocationEffect,
}

impl CompiledJoint {
    /// Returns the data that the walks of order 2 and of the exact model read at this joint.
    #[inline(always)]
    pub fn lookup_request(&self) -> LookupRequest<'_> {
        LookupRequest { turns: self.turns, curves: if self.errors { Some(&self.curves) } else { None } }
    }
}

/// The place of a location error among the factors of its joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LocationEffect {
    /// `Loc N Loc^-1`.
    Around,
    /// Before the motion and the component errors, seen from the workpiece.
    Outermost,
    /// After both.
    Innermost,
}

/// Nominal motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NominalMotion {
    /// A translation by the position times this vector.
    Slide([f64; 3]),
    /// A rotation by the position, about a direction through the origin.
    Turn(RotationAxis),
}

/// The direction of a rotary axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RotationAxis {
    /// Machine axis 0 to 2, and the sense: 1 or -1.
    Principal(usize, f64),
    /// Any unit vector.
    Oblique([f64; 3]),
}

impl CompiledChain {
    /// Returns `None` if the error curves cannot be compiled.
    pub fn new(machine: &Machine, conditions: OperatingConditions) -> Option<Self> {
        let conventions = machine.conventions();
        let link = |(i, axis): (usize, &Axis)| link(machine, i, axis, conditions);
        let placed = |six: Six, about, inverse| (six != [0.0; 6]).then_some(ErrorsAtPoint { six, about, inverse });
        let spindle = machine.spindle_errors().map(|errors| errors.location_values());
        Some(Self {
            joints: machine.axes().iter().enumerate().map(link).collect::<Option<_>>()?,
            tip: machine.tool().tip,
            tool: machine.setup().tool,
            spindle: spindle.and_then(|six| placed(six, machine.tool().gauge, false)),
            workpiece_setup: placed(machine.setup().workpiece, machine.workpiece(), true),
            linearised: conventions.joints == Joints::Linearised,
            real_locations: conventions.location_order == LocationOrder::Real,
        })
    }

    /// Looks up, for a chunk of poses, everything that the walks of order 2 and of the exact model read.
    #[inline(always)]
    pub fn look_up<V: Lanes>(&self, axes: &mut [AxisLookup], chunk: Chunk<'_>) {
        for axis in 0..axes.len() {
            let request = self.joints[axis].lookup_request();
            axes[axis].fill::<V>(request, axis, chunk);
            if let Some(curves) = request.curves {
                axes[axis].fill_errors::<V>(curves, axis, chunk);
            }
        }
    }
}

fn link(machine: &Machine, index: usize, axis: &Axis, conditions: OperatingConditions) -> Option<CompiledJoint> {
    let convention = axis.convention(machine.conventions());
    let errors = machine.axis_errors(index);
    let six = errors.location_values();
    let (motion, curves) = (motion(axis, &convention), CompiledCurves::new(errors, conditions)?);
    let (location_effect, inverse) = match convention.location {
        LocationAction::Displaces => (LocationEffect::Around, false),
        LocationAction::Factor(factor) if factor.side == MotionSide::Outer => {
            (LocationEffect::Outermost, factor.inverse)
        }
        LocationAction::Factor(factor) => (LocationEffect::Innermost, factor.inverse),
    };
    Some(CompiledJoint {
        errors: !curves.is_zero(),
        turns: matches!(motion, NominalMotion::Turn(_)) || curves.has_harmonics(),
        motion,
        origin: convention.pivot,
        curves,
        outside: convention.component.side == MotionSide::Outer,
        inverse: convention.component.inverse,
        location: (six != [0.0; 6]).then_some(ErrorsAtPoint { six, about: convention.pivot, inverse }),
        location_effect,
    })
}

fn motion(axis: &Axis, convention: &JointConvention) -> NominalMotion {
    let direction = axis.direction.map(|u| u * convention.motion_sign);
    match axis.kind {
        AxisKind::Linear => NominalMotion::Slide(direction),
        AxisKind::Rotary => {
            let unit =
                (0..3).find(|k| (0..3).all(|j| if j == *k { direction[j].abs() == 1.0 } else { direction[j] == 0.0 }));
            NominalMotion::Turn(
                unit.map_or(RotationAxis::Oblique(direction), |k| RotationAxis::Principal(k, direction[k])),
            )
        }
    }
}

impl RotationAxis {
    /// Returns a vector rotated by the angle with this sine and cosine.
    #[inline(always)]
    pub fn rotate<V: Lanes>(&self, (s, c): (V, V), v: Vector<V>) -> Vector<V> {
        match *self {
            Self::Principal(0, sense) => {
                let s = s * V::splat(sense);
                [v[0], (c * v[1]).minus_times(s, v[2]), (c * v[2]).plus_times(s, v[1])]
            }
            Self::Principal(1, sense) => {
                let s = s * V::splat(sense);
                [(c * v[0]).plus_times(s, v[2]), v[1], (c * v[2]).minus_times(s, v[0])]
            }
            Self::Principal(_, sense) => {
                let s = s * V::splat(sense);
                [(c * v[0]).minus_times(s, v[1]), (c * v[1]).plus_times(s, v[0]), v[2]]
            }
            Self::Oblique(u) => {
                let u = splat(&u);
                let along = (V::splat(1.0) - c) * dot(u, v);
                plus_times(plus_times(times(v, c), cross(u, v), s), u, along)
            }
        }
    }

    /// Returns a point rotated about an origin; of a machine axis, the component along it stays as it is.
    #[inline(always)]
    pub fn rotate_about<V: Lanes>(&self, turn: (V, V), origin: &[f64; 3], point: Vector<V>) -> Vector<V> {
        let o = splat(origin);
        let [x, y, z] = plus(self.rotate(turn, minus(point, o)), o);
        match self {
            Self::Principal(0, _) => [point[0], y, z],
            Self::Principal(1, _) => [x, point[1], z],
            Self::Principal(..) => [x, y, point[2]],
            Self::Oblique(_) => [x, y, z],
        }
    }

    /// Returns the unit vector of the direction.
    pub fn direction(&self) -> [f64; 3] {
        match *self {
            Self::Principal(k, sense) => std::array::from_fn(|i| if i == k { sense } else { 0.0 }),
            Self::Oblique(u) => u,
        }
    }
}

/// Returns a point moved by the position times a direction; a machine axis costs one sum.
#[inline(always)]
pub fn slid<V: Lanes>(direction: &[f64; 3], position: V, point: Vector<V>) -> Vector<V> {
    const ONE: u64 = 1.0_f64.to_bits();
    let mut moved = point;
    for k in 0..3 {
        // Compared as integers, which leaves the vector registers alone.
        let bits = direction[k].to_bits();
        if bits == ONE {
            moved[k] = point[k] + position;
        } else if bits << 1 != 0 {
            moved[k] = point[k].plus_times(position, V::splat(direction[k]));
        }
    }
    moved
}
