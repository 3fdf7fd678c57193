//! The exact model in closed form: every joint by its increments, so that nothing small is a difference of large
//! numbers.
//!
//! The walk from the tool to the workpiece carries the nominal functional point p, the displacement d of the actual
//! one, and the actual rotation relative to the nominal one. An error motion about o with the linear part 1 + K adds
//! `delta + K (p + d - o)` to d. With orthogonal joints K = a hat(eps) + b hat(eps)^2 with the series of sin t / t and
//! (1 - cos t) / t^2, and the rotation is a quaternion; with linearised joints a and b are rational, and the rotation
//! is a matrix, which need not be orthogonal.

use super::affine::{Section, Sections};
use super::chain::{CompiledChain, CompiledJoint, ErrorsAtPoint, LocationEffect, NominalMotion, RotationAxis, slid};
use super::lookup::{AxisLookup, Chunk, LaneInputs, PoseInputs};
use super::pass::{LaneDeviation, MAX_SQUARED_HALF_ANGLE, PoseKernel};
use super::simd::Lanes;
use super::trigonometry::RADIAN;
use super::vector::{Vector, cross, dot, minus, plus, plus_cross, plus_times, splat, times};

/// Number of terms of the series: exact to rounding up to [`MAX_SQUARED_HALF_ANGLE`].
const TERMS: usize = 10;

/// Returns the coefficients of sin t / t, or of cos t if `even`, by powers of t^2, times `first`.
const fn series(first: f64, even: bool) -> [f64; TERMS] {
    let mut terms = [first; TERMS];
    let mut i = 1;
    while i < TERMS {
        let n = (2 * i) as f64;
        let divisor = if even { (n - 1.0) * n } else { n * (n + 1.0) };
        terms[i] = -terms[i - 1] / divisor;
        i += 1;
    }
    terms
}

/// Coefficients of sin t / t and of cos t by powers of t^2.
const SINC: [f64; TERMS] = series(1.0, false);
const COSINE: [f64; TERMS] = series(1.0, true);

/// Returns the coefficients of asin s / s by powers of s^2.
pub const fn arcsine<const N: usize>() -> [f64; N] {
    let mut terms = [1.0; N];
    let mut i = 1;
    while i < N {
        let n = (2 * i) as f64;
        terms[i] = terms[i - 1] * ((n - 1.0) * (n - 1.0)) / (n * (n + 1.0));
        i += 1;
    }
    terms
}

const ARCSINE: [f64; TERMS] = arcsine();

/// Returns the polynomial with these coefficients of the powers 0, 1, ... at x.
#[inline(always)]
pub fn polynomial<V: Lanes>(terms: &[f64], x: V) -> V {
    let mut sum = V::splat(terms[terms.len() - 1]);
    for term in terms[..terms.len() - 1].iter().rev() {
        sum = V::splat(*term).plus_times(sum, x);
    }
    sum
}

/// An error motion, or its inverse, as the walk applies it.
#[derive(Debug, Clone, Copy)]
struct LaneErrorMotion<V> {
    turn: Vector<V>,
    shift: Vector<V>,
    /// K = a hat(turn) + b hat(turn)^2.
    a: V,
    b: V,
    /// Scalar part of the quaternion, and the factor of `turn` in the vector part.
    half: (V, V),
    inverse: bool,
}

/// The actual rotation relative to the nominal one.
trait RelativeRotation<V: Lanes>: Copy {
    fn none() -> Self;
    /// Returns the error motion of six errors, and its squared half angle (rad^2).
    fn motion(six: [V; 6], inverse: bool) -> (LaneErrorMotion<V>, V);
    fn rotate(self, about: &RotationAxis, turn: (V, V)) -> Self;
    fn after(self, motion: &LaneErrorMotion<V>) -> Self;
    fn vector(self) -> (Vector<V>, V);
}

#[derive(Clone, Copy)]
struct Quaternion<V>(V, Vector<V>);

impl<V: Lanes> RelativeRotation<V> for Quaternion<V> {
    #[inline(always)]
    fn none() -> Self {
        Self(V::splat(1.0), [V::splat(0.0); 3])
    }

    #[inline(always)]
    fn motion(six: [V; 6], inverse: bool) -> (LaneErrorMotion<V>, V) {
        let [dx, dy, dz, ex, ey, ez] = six;
        let turn = [ex, ey, ez];
        let half = V::splat(0.5);
        let quarter = dot(turn, turn) * V::splat(0.25);
        let (sine, cosine) = (polynomial(&SINC[..6], quarter), polynomial(&COSINE[..7], quarter));
        let sign = V::splat(if inverse { -1.0 } else { 1.0 });
        let motion = LaneErrorMotion {
            turn,
            shift: [dx, dy, dz],
            a: sine * cosine * sign,
            b: sine * sine * half,
            half: (cosine, sine * half * sign),
            inverse,
        };
        (motion, quarter)
    }

    #[inline(always)]
    fn rotate(self, about: &RotationAxis, turn: (V, V)) -> Self {
        Self(self.0, about.rotate(turn, self.1))
    }

    #[inline(always)]
    fn after(self, motion: &LaneErrorMotion<V>) -> Self {
        let (c, v) = (motion.half.0, times(motion.turn, motion.half.1));
        let vector = plus_cross(plus_times(times(self.1, c), v, self.0), v, self.1);
        Self(c * self.0 - dot(v, self.1), vector)
    }

    #[inline(always)]
    fn vector(self) -> (Vector<V>, V) {
        let square = dot(self.1, self.1);
        (times(self.1, polynomial(&ARCSINE, square) * V::splat(2.0)), square)
    }
}

/// A matrix minus the identity, by columns.
#[derive(Clone, Copy)]
struct Matrix<V>([Vector<V>; 3]);

#[inline(always)]
fn transpose<V: Lanes>([a, b, c]: [Vector<V>; 3]) -> [Vector<V>; 3] {
    [[a[0], b[0], c[0]], [a[1], b[1], c[1]], [a[2], b[2], c[2]]]
}

impl<V: Lanes> RelativeRotation<V> for Matrix<V> {
    #[inline(always)]
    fn none() -> Self {
        Self([[V::splat(0.0); 3]; 3])
    }

    #[inline(always)]
    fn motion(six: [V; 6], inverse: bool) -> (LaneErrorMotion<V>, V) {
        let [dx, dy, dz, ex, ey, ez] = six;
        let (turn, zero, one) = ([ex, ey, ez], V::splat(0.0), V::splat(1.0));
        // (1 + H)^-1 = 1 - H / (1 + s) + H^2 / (1 + s) with s the squared length of the vector.
        let factor = if inverse { one.quotient(one + dot(turn, turn)) } else { zero };
        let a = if inverse { zero - factor } else { one };
        (LaneErrorMotion { turn, shift: [dx, dy, dz], a, b: factor, half: (one, zero), inverse }, zero)
    }

    #[inline(always)]
    fn rotate(self, about: &RotationAxis, turn: (V, V)) -> Self {
        let [a, b, c] = self.0;
        let [a, b, c] = transpose([about.rotate(turn, a), about.rotate(turn, b), about.rotate(turn, c)]);
        Self(transpose([about.rotate(turn, a), about.rotate(turn, b), about.rotate(turn, c)]))
    }

    #[inline(always)]
    fn after(self, motion: &LaneErrorMotion<V>) -> Self {
        let mut columns = self.0;
        for k in 0..3 {
            let mut whole = columns[k];
            whole[k] = whole[k] + V::splat(1.0);
            columns[k] = plus(columns[k], motion.displacement_of(whole));
        }
        Self(columns)
    }

    #[inline(always)]
    fn vector(self) -> (Vector<V>, V) {
        let [a, b, c] = self.0;
        let half = V::splat(0.5);
        ([(b[2] - c[1]) * half, (c[0] - a[2]) * half, (a[1] - b[0]) * half], V::splat(0.0))
    }
}

impl<V: Lanes> LaneErrorMotion<V> {
    /// Returns K y.
    #[inline(always)]
    fn displacement_of(&self, y: Vector<V>) -> Vector<V> {
        let once = cross(self.turn, y);
        plus_times(times(once, self.a), cross(self.turn, once), self.b)
    }
}

impl LaneErrorMotion<f64> {
    #[inline(always)]
    fn splat<V: Lanes>(&self) -> LaneErrorMotion<V> {
        LaneErrorMotion {
            turn: splat(&self.turn),
            shift: splat(&self.shift),
            a: V::splat(self.a),
            b: V::splat(self.b),
            half: (V::splat(self.half.0), V::splat(self.half.1)),
            inverse: self.inverse,
        }
    }
}

/// A constant error motion and its inverse, about a point.
#[derive(Debug, Clone, Copy)]
struct ConstantMotion {
    motion: LaneErrorMotion<f64>,
    inverse: LaneErrorMotion<f64>,
    about: [f64; 3],
}

impl ConstantMotion {
    /// Returns `None` if the rotation is too large for the series.
    fn new(placed: &ErrorsAtPoint, linearised: bool) -> Option<Self> {
        let motion = |inverse| match linearised {
            true => Matrix::motion(placed.six, inverse),
            false => Quaternion::motion(placed.six, inverse),
        };
        let ((motion, squared_half_angle), (inverse, _)) = (motion(placed.inverse), motion(!placed.inverse));
        (squared_half_angle <= MAX_SQUARED_HALF_ANGLE).then_some(Self { motion, inverse, about: placed.about })
    }
}

/// The quantities that the walk carries from the tool to the workpiece.
struct ExactWalk<V, R> {
    point: Vector<V>,
    displacement: Vector<V>,
    relative: R,
    squared_half_angle: V,
}

impl<V: Lanes, R: RelativeRotation<V>> ExactWalk<V, R> {
    /// Returns the state at a point with its displacement, before any rotation.
    #[inline(always)]
    fn at(point: Vector<V>, displacement: Vector<V>) -> Self {
        Self { point, displacement, relative: R::none(), squared_half_angle: V::splat(0.0) }
    }

    #[inline(always)]
    fn apply(&mut self, motion: &LaneErrorMotion<V>, about: &[f64; 3]) {
        let arm = plus(minus(self.point, splat(about)), self.displacement);
        let added = if motion.inverse {
            minus(motion.displacement_of(minus(arm, motion.shift)), motion.shift)
        } else {
            plus(motion.displacement_of(arm), motion.shift)
        };
        self.displacement = plus(self.displacement, added);
        self.relative = self.relative.after(motion);
    }

    #[inline(always)]
    fn motion(&mut self, motion: &LaneErrorMotion<V>, squared_half_angle: V, about: &[f64; 3]) {
        self.squared_half_angle = self.squared_half_angle.larger(squared_half_angle);
        self.apply(motion, about);
    }

    #[inline(always)]
    fn apply_constant(&mut self, constant: &ConstantMotion) {
        self.apply(&constant.motion.splat(), &constant.about);
    }

    /// Rotates on by the correction of a rotary axis (deg), which need not be small.
    #[inline(always)]
    fn rotate_on(&mut self, about: &RotationAxis, angle: V, origin: &[f64; 3]) {
        let [x, y, z] = times(splat(&about.direction()), angle * V::splat(RADIAN));
        let zero = V::splat(0.0);
        let (motion, squared_half_angle) = Quaternion::motion([zero, zero, zero, x, y, z], false);
        self.squared_half_angle = self.squared_half_angle.larger(squared_half_angle);
        self.apply(&motion, origin);
    }

    #[inline(always)]
    fn link<I: LaneInputs<V>>(
        &mut self,
        link: &CompiledJoint,
        axis: usize,
        location: Option<&ConstantMotion>,
        inputs: I,
    ) {
        let zero = V::splat(0.0);
        let (q, added) = (inputs.position(axis), inputs.added(axis));
        let command = match added {
            Some(added) => q + added,
            None => q,
        };
        let turn = if link.turns { inputs.turn(axis) } else { (zero, zero) };
        let errors = if link.errors { Some(R::motion(inputs.errors(axis), link.inverse)) } else { None };
        if let (Some(location), LocationEffect::Innermost) = (location, link.location_effect) {
            self.apply_constant(location);
        }
        if let (Some((motion, squared_half_angle)), false) = (&errors, link.outside) {
            self.motion(motion, *squared_half_angle, &link.origin);
        }
        let around = if link.location_effect == LocationEffect::Around { location } else { None };
        match &link.motion {
            NominalMotion::Slide(direction) => self.slide(direction, around, q, command, added),
            NominalMotion::Turn(about) => self.turn(about, &link.origin, around, turn, added),
        }
        if let (Some((motion, squared_half_angle)), true) = (&errors, link.outside) {
            self.motion(motion, *squared_half_angle, &link.origin);
        }
        if let (Some(location), LocationEffect::Outermost) = (location, link.location_effect) {
            self.apply_constant(location);
        }
    }

    /// Passes a linear axis; its location error only bends its direction.
    #[inline(always)]
    fn slide(&mut self, direction: &[f64; 3], around: Option<&ConstantMotion>, q: V, command: V, added: Option<V>) {
        self.point = slid(direction, q, self.point);
        if let Some(added) = added {
            self.displacement = plus_times(self.displacement, splat(direction), added);
        }
        if let Some(location) = around {
            let bent = location.motion.displacement_of(*direction);
            self.displacement = plus_times(self.displacement, splat(&bent), command);
        }
    }

    /// Passes a rotary axis: N, or Loc N Loc^-1.
    #[inline(always)]
    fn turn(
        &mut self,
        about: &RotationAxis,
        origin: &[f64; 3],
        around: Option<&ConstantMotion>,
        turn: (V, V),
        added: Option<V>,
    ) {
        if let Some(location) = around {
            self.apply(&location.inverse.splat(), origin);
        }
        self.point = about.rotate_about(turn, origin, self.point);
        self.displacement = about.rotate(turn, self.displacement);
        self.relative = self.relative.rotate(about, turn);
        if let Some(added) = added {
            self.rotate_on(about, added, origin);
        }
        if let Some(location) = around {
            self.apply_constant(location);
        }
    }
}

/// The compiled exact model.
#[derive(Debug, Clone)]
pub struct ExactModel {
    chain: CompiledChain,
    locations: Vec<Option<ConstantMotion>>,
    spindle: Option<ConstantMotion>,
    workpiece_setup: Option<ConstantMotion>,
}

impl ExactModel {
    /// Returns `None` if a constant error is too large for the series.
    pub fn new(chain: CompiledChain) -> Option<Self> {
        let fixed = |placed: &Option<ErrorsAtPoint>| match placed {
            Some(placed) => ConstantMotion::new(placed, chain.linearised).map(Some),
            None => Some(None),
        };
        Some(Self {
            locations: chain.joints.iter().map(|link| fixed(&link.location)).collect::<Option<_>>()?,
            spindle: fixed(&chain.spindle)?,
            workpiece_setup: fixed(&chain.workpiece_setup)?,
            chain,
        })
    }

    #[inline(always)]
    fn chain<V: Lanes, R: RelativeRotation<V>>(&self, inputs: PoseInputs<'_>) -> LaneDeviation<V> {
        let chain = &self.chain;
        let mut state = ExactWalk::<V, R>::at(splat(&chain.tip), splat(&chain.tool));
        if let Some(spindle) = &self.spindle {
            state.apply_constant(spindle);
        }
        for (axis, link) in chain.joints.iter().enumerate().rev() {
            state.link(link, axis, self.locations[axis].as_ref(), inputs);
        }
        if let Some(workpiece_setup) = &self.workpiece_setup {
            state.apply_constant(workpiece_setup);
        }
        let (rotation, squared_half_angle) = state.relative.vector();
        LaneDeviation {
            position: state.displacement,
            rotation,
            squared_half_angle: state.squared_half_angle.larger(squared_half_angle),
        }
    }

    fn past<R: RelativeRotation<f64>>(&self, section: Section, point: [f64; 3]) -> ([f64; 3], f64) {
        let mut state = ExactWalk::<f64, R>::at(point, [0.0; 3]);
        match section {
            Section::Joint(axis, at) => {
                state.link(&self.chain.joints[axis], axis, self.locations[axis].as_ref(), at);
            }
            Section::Spindle => self.spindle.iter().for_each(|spindle| state.apply_constant(spindle)),
            Section::WorkpieceSetup => {
                self.workpiece_setup.iter().for_each(|workpiece_setup| state.apply_constant(workpiece_setup))
            }
        }
        (state.displacement, state.squared_half_angle)
    }
}

impl Sections for ExactModel {
    fn chain(&self) -> &CompiledChain {
        &self.chain
    }

    fn displacement_past(&self, section: Section, point: [f64; 3]) -> ([[f64; 3]; 2], f64) {
        let (displacement, squared_half_angle) = match self.chain.linearised {
            true => self.past::<Matrix<f64>>(section, point),
            false => self.past::<Quaternion<f64>>(section, point),
        };
        ([displacement, [0.0; 3]], squared_half_angle)
    }
}

impl PoseKernel for ExactModel {
    type Workspace = ();
    const EMPTY: () = ();

    #[inline(always)]
    fn lookup<V: Lanes>(&self, axes: &mut [AxisLookup], _: &mut (), chunk: Chunk<'_>) {
        self.chain.look_up::<V>(axes, chunk);
    }

    #[inline(always)]
    fn at<V: Lanes>(&self, _: &(), inputs: PoseInputs<'_>) -> LaneDeviation<V> {
        if self.chain.linearised { self.chain::<V, Matrix<V>>(inputs) } else { self.chain::<V, Quaternion<V>>(inputs) }
    }
}
