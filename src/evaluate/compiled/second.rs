//! Order 2: every joint's own second order, and every pair of joints once.
//!
//! Beside the sums of order 1 the walk carries a displacement and a rotation of second degree. A joint adds to them its
//! own square and its product with the sums so far, which are the joints on its tool side: all pairs, in one walk. With
//! E^-1 in place of E (`errors_are: body`) the signs and the squares change as in the series of the inverse.

use super::affine::{Section, Sections};
use super::chain::{CompiledChain, CompiledJoint, ErrorsAtPoint, LocationEffect, NominalMotion, RotationAxis, slid};
use super::curves::splat_six;
use super::lookup::{AxisLookup, Chunk, LaneInputs, PoseInputs};
use super::pass::{LaneDeviation, PoseKernel};
use super::simd::Lanes;
use super::vector::{Vector, cross, minus, plus, plus_cross, plus_times, splat, times};

/// The compiled model of order 2.
#[derive(Debug, Clone)]
pub struct SecondOrder {
    chain: CompiledChain,
}

/// The quantities that the walk carries from the tool to the workpiece: first and second degree.
struct SecondOrderWalk<V> {
    point: Vector<V>,
    displacement: [Vector<V>; 2],
    rotation: [Vector<V>; 2],
    /// Coefficient of hat(eps)^2 in an error matrix, and in its inverse.
    squares: [V; 2],
}

impl<V: Lanes> SecondOrderWalk<V> {
    /// Returns the state at a point with its displacement, before any rotation.
    #[inline(always)]
    fn at(chain: &CompiledChain, point: Vector<V>, displacement: Vector<V>) -> Self {
        let zero = [V::splat(0.0); 3];
        // exp: 1/2 and 1/2; 1 + hat: 0, and 1 in its inverse.
        let squares = if chain.linearised { [0.0, 1.0] } else { [0.5, 0.5] };
        Self {
            point,
            displacement: [displacement, zero],
            rotation: [zero; 2],
            squares: [V::splat(squares[0]), V::splat(squares[1])],
        }
    }

    #[inline(always)]
    fn apply(&mut self, six: [V; 6], inverse: bool, about: &[f64; 3]) {
        let [dx, dy, dz, ex, ey, ez] = six;
        let sign = V::splat(if inverse { -1.0 } else { 1.0 });
        let (shift, turn) = (times([dx, dy, dz], sign), times([ex, ey, ez], sign));
        let once = cross(turn, minus(self.point, splat(about)));
        let [first, second] = self.displacement;
        // The inverse rotates the point that its own translation has moved.
        let moved = if inverse { plus(first, shift) } else { first };
        let square = self.squares[usize::from(inverse)];
        let added = plus_cross(times(cross(turn, once), square), turn, moved);
        self.displacement = [plus(first, plus(shift, once)), plus(second, added)];
        let [first, second] = self.rotation;
        let product = cross(turn, first);
        self.rotation = [plus(first, turn), plus_times(second, product, V::splat(0.5))];
    }

    #[inline(always)]
    fn place(&mut self, placed: &ErrorsAtPoint, undone: bool) {
        self.apply(splat_six(&placed.six), placed.inverse != undone, &placed.about);
    }

    #[inline(always)]
    fn slide(&mut self, direction: &[f64; 3], around: Option<&ErrorsAtPoint>, q: V) {
        self.point = slid(direction, q, self.point);
        if let Some(location) = around {
            let [.., a, b, c] = splat_six(&location.six);
            let once = cross([a, b, c], splat(direction));
            let twice = times(cross([a, b, c], once), self.squares[0]);
            let [first, second] = self.displacement;
            self.displacement = [plus_times(first, once, q), plus_times(second, twice, q)];
        }
    }

    #[inline(always)]
    fn turn(&mut self, about: &RotationAxis, origin: &[f64; 3], around: Option<&ErrorsAtPoint>, turn: (V, V)) {
        if let Some(location) = around {
            self.place(location, true);
        }
        self.point = about.rotate_about(turn, origin, self.point);
        let ([d, dd], [w, ww]) = (self.displacement, self.rotation);
        self.displacement = [about.rotate(turn, d), about.rotate(turn, dd)];
        self.rotation = [about.rotate(turn, w), about.rotate(turn, ww)];
        if let Some(location) = around {
            self.place(location, false);
        }
    }

    #[inline(always)]
    fn link<I: LaneInputs<V>>(&mut self, link: &CompiledJoint, axis: usize, inputs: I) {
        let zero = V::splat(0.0);
        let q = inputs.position(axis);
        let turn = if link.turns { inputs.turn(axis) } else { (zero, zero) };
        let errors = if link.errors { Some(inputs.errors(axis)) } else { None };
        let location = link.location.as_ref();
        if let (Some(location), LocationEffect::Innermost) = (location, link.location_effect) {
            self.place(location, false);
        }
        if let (Some(six), false) = (errors, link.outside) {
            self.apply(six, link.inverse, &link.origin);
        }
        let around = if link.location_effect == LocationEffect::Around { location } else { None };
        match &link.motion {
            NominalMotion::Slide(direction) => self.slide(direction, around, q),
            NominalMotion::Turn(about) => self.turn(about, &link.origin, around, turn),
        }
        if let (Some(six), true) = (errors, link.outside) {
            self.apply(six, link.inverse, &link.origin);
        }
        if let (Some(location), LocationEffect::Outermost) = (location, link.location_effect) {
            self.place(location, false);
        }
    }
}

impl SecondOrder {
    /// Returns `None` if location errors count in the real part.
    pub fn new(chain: CompiledChain) -> Option<Self> {
        (!chain.real_locations).then_some(Self { chain })
    }
}

impl Sections for SecondOrder {
    fn chain(&self) -> &CompiledChain {
        &self.chain
    }

    fn displacement_past(&self, section: Section, point: [f64; 3]) -> ([[f64; 3]; 2], f64) {
        let mut state = SecondOrderWalk::at(&self.chain, point, [0.0; 3]);
        match section {
            Section::Joint(axis, at) => state.link(&self.chain.joints[axis], axis, at),
            Section::Spindle => self.chain.spindle.iter().for_each(|spindle| state.place(spindle, false)),
            Section::WorkpieceSetup => {
                self.chain.workpiece_setup.iter().for_each(|workpiece_setup| state.place(workpiece_setup, false))
            }
        }
        (state.displacement, 0.0)
    }
}

impl PoseKernel for SecondOrder {
    type Workspace = ();
    const EMPTY: () = ();

    #[inline(always)]
    fn lookup<V: Lanes>(&self, axes: &mut [AxisLookup], _: &mut (), chunk: Chunk<'_>) {
        self.chain.look_up::<V>(axes, chunk);
    }

    #[inline(always)]
    fn at<V: Lanes>(&self, _: &(), inputs: PoseInputs<'_>) -> LaneDeviation<V> {
        let chain = &self.chain;
        let mut state = SecondOrderWalk::<V>::at(chain, splat(&chain.tip), splat(&chain.tool));
        if let Some(spindle) = &chain.spindle {
            state.place(spindle, false);
        }
        for (axis, link) in chain.joints.iter().enumerate().rev() {
            state.link(link, axis, inputs);
        }
        if let Some(workpiece_setup) = &chain.workpiece_setup {
            state.place(workpiece_setup, false);
        }
        let [d, dd] = state.displacement;
        let [w, ww] = state.rotation;
        LaneDeviation { position: plus(dd, d), rotation: plus(ww, w), squared_half_angle: V::splat(0.0) }
    }
}
