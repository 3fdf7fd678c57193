//! Order 1: the sum over the joints of Ad(prefix) times the joint's six errors.
//!
//! The walk from the tool to the workpiece carries a point and two vectors: the functional point, the rotation, and the
//! displacement of a point of reference, all in the frame reached. So every prefix is applied once, to the sum so far,
//! and the lever of the functional point about the point of reference counts once, at the end. The errors (delta, eps)
//! about a point o displace r by `delta + eps x (r - o)`: that is folded into the tables, and so are location errors
//! (`twist`).

use super::chain::{CompiledChain, NominalMotion, RotationAxis};
use super::curves::{Six, splat_six};
use super::lookup::{AxisLookup, CHUNK, Chunk, LookupRequest, PoseInputs};
use super::pass::{LaneDeviation, PoseKernel};
use super::simd::Lanes;
use super::steps::{self, Sum, WalkStep};
use super::twist::{TwistChain, TwistJoint};
use super::vector::{Vector, minus, plus, plus_cross, splat};

/// The compiled model of order 1.
#[derive(Debug, Clone)]
pub struct FirstOrder {
    /// Joints from the workpiece to the tool.
    joints: Vec<TwistJoint>,
    /// Steps from the tool to the workpiece; joints by their index.
    steps: Vec<WalkStep>,
    /// The functional point at the zero pose minus the first point of reference, mm.
    point: [f64; 3],
    /// Its displacement by the set-up of the tool, mm.
    tool: [f64; 3],
}

impl FirstOrder {
    /// Returns `None` if location errors count in the real part.
    pub fn new(chain: &CompiledChain) -> Option<Self> {
        if chain.real_locations {
            return None;
        }
        let TwistChain { joints, end } = TwistChain::new(chain);
        let point = minus(chain.tip, steps::reference(&joints, joints.len()));
        Some(Self { steps: steps::steps(&joints, end), joints, point, tool: chain.tool })
    }

    /// Walks a chunk of poses from the tool past all steps.
    #[inline(always)]
    fn walk<V: Lanes>(&self, states: &mut WalkStates, axes: &[AxisLookup], chunk: Chunk<'_>) {
        states.begin::<V>(self, chunk.count);
        for step in &self.steps {
            if let Some(axis) = step.motion {
                states.pass_joint::<V>(&self.joints[axis], step, &axes[axis], chunk.positions(axis));
            }
            if let Some(sum) = &step.sum {
                states.add_sum::<V>(sum, axes, chunk);
            }
            if let Some((axis, _)) = &step.errors {
                states.add_errors::<V>(&axes[*axis], chunk.count);
            }
            if let Some(constant) = &step.constant {
                states.add_constant::<V>(constant, chunk.count);
            }
        }
    }
}

impl PoseKernel for FirstOrder {
    type Workspace = WalkStates;
    const EMPTY: WalkStates = WalkStates::NONE;

    #[inline(always)]
    fn lookup<V: Lanes>(&self, axes: &mut [AxisLookup], states: &mut WalkStates, chunk: Chunk<'_>) {
        for axis in 0..axes.len() {
            let joint = &self.joints[axis];
            axes[axis].fill::<V>(LookupRequest { turns: joint.turns, curves: joint.curves.as_ref() }, axis, chunk);
        }
        for step in &self.steps {
            if let Some((axis, curves)) = &step.errors {
                axes[*axis].fill_errors::<V>(curves, *axis, chunk);
            }
        }
        self.walk::<V>(states, axes, chunk);
    }

    #[inline(always)]
    fn at<V: Lanes>(&self, states: &WalkStates, inputs: PoseInputs<'_>) -> LaneDeviation<V> {
        states.at(inputs.i)
    }
}

/// The quantities that the walk carries, for a chunk of poses. Every step goes over the whole chunk: deciding what a
/// step does costs as much as doing it for one vector.
#[repr(C, align(64))]
pub struct WalkStates {
    /// The functional point minus the point of reference.
    point: ChunkVectors,
    /// Displacement of the point of reference.
    displacement: ChunkVectors,
    rotation: ChunkVectors,
}

struct ChunkVectors([[f64; CHUNK]; 3]);

impl ChunkVectors {
    const NONE: Self = Self([[0.0; CHUNK]; 3]);

    #[inline(always)]
    fn get<V: Lanes>(&self, i: usize) -> Vector<V> {
        // The mask changes nothing; it shows the compiler that the vector lies within the chunk.
        let (i, [x, y, z]) = (i & (CHUNK - V::COUNT), &self.0);
        [V::load(&x[i..]), V::load(&y[i..]), V::load(&z[i..])]
    }

    #[inline(always)]
    fn put<V: Lanes>(&mut self, i: usize, vector: Vector<V>) {
        let (i, [x, y, z]) = (i & (CHUNK - V::COUNT), &mut self.0);
        vector[0].store(&mut x[i..]);
        vector[1].store(&mut y[i..]);
        vector[2].store(&mut z[i..]);
    }

    #[inline(always)]
    fn add<V: Lanes>(&mut self, k: usize, i: usize, more: V) {
        let place = &mut self.0[k][i & (CHUNK - V::COUNT)..];
        (V::load(place) + more).store(place);
    }

    #[inline(always)]
    fn add_product<V: Lanes>(&mut self, k: usize, i: usize, a: V, b: V) {
        let place = &mut self.0[k][i & (CHUNK - V::COUNT)..];
        V::load(place).plus_times(a, b).store(place);
    }

    #[inline(always)]
    fn column<V: Lanes>(&self, k: usize, i: usize) -> V {
        V::load(&self.0[k][i & (CHUNK - V::COUNT)..])
    }
}

impl WalkStates {
    /// The state before any chunk.
    pub const NONE: Self =
        Self { point: ChunkVectors::NONE, displacement: ChunkVectors::NONE, rotation: ChunkVectors::NONE };

    /// Sets the state at the tool.
    #[inline(always)]
    fn begin<V: Lanes>(&mut self, model: &FirstOrder, count: usize) {
        let (mut i, point) = (0, splat::<V>(&model.point));
        while i < count {
            self.point.put(i, point);
            self.displacement.put(i, splat::<V>(&model.tool));
            self.rotation.put(i, [V::splat(0.0); 3]);
            i += V::COUNT;
        }
    }

    /// Returns the deviations: the lever of the functional point about the point of reference counts here.
    #[inline(always)]
    fn at<V: Lanes>(&self, i: usize) -> LaneDeviation<V> {
        let rotation = self.rotation.get(i);
        let position = plus_cross(self.displacement.get(i), rotation, self.point.get(i));
        LaneDeviation { position, rotation, squared_half_angle: V::splat(0.0) }
    }

    /// Passes the nominal motion of a joint.
    #[inline(always)]
    fn pass_joint<V: Lanes>(&mut self, joint: &TwistJoint, step: &WalkStep, lookup: &AxisLookup, positions: &[f64]) {
        match joint.motion {
            NominalMotion::Slide(direction) => self.slid::<V>(&direction, joint.bend.as_ref(), step.rotated, positions),
            // One call per machine axis: the compiler drops the component that stays as it is.
            NominalMotion::Turn(RotationAxis::Principal(0, sense)) => {
                self.rotate::<V>(&RotationAxis::Principal(0, sense), lookup, positions.len());
            }
            NominalMotion::Turn(RotationAxis::Principal(1, sense)) => {
                self.rotate::<V>(&RotationAxis::Principal(1, sense), lookup, positions.len());
            }
            NominalMotion::Turn(RotationAxis::Principal(_, sense)) => {
                self.rotate::<V>(&RotationAxis::Principal(2, sense), lookup, positions.len());
            }
            NominalMotion::Turn(RotationAxis::Oblique(direction)) => {
                self.rotate::<V>(&RotationAxis::Oblique(direction), lookup, positions.len());
            }
        }
        if let Some(shift) = &step.shift {
            self.shift_points::<V>(shift, positions.len());
        }
    }

    /// Moves by the positions times a direction; before all errors a machine axis costs one sum.
    #[inline(always)]
    fn slid<V: Lanes>(&mut self, direction: &[f64; 3], bend: Option<&[f64; 3]>, rotated: bool, positions: &[f64]) {
        for k in 0..3 {
            let (factor, bend, mut i) = (direction[k], bend.map_or(0.0, |bend| bend[k]), 0);
            while factor != 0.0 && i < positions.len() {
                let q = V::load(&positions[i..]);
                let travel = if factor == 1.0 { q } else { q * V::splat(factor) };
                self.advance_point(k, i, travel, rotated);
                i += V::COUNT;
            }
            i = 0;
            while bend != 0.0 && i < positions.len() {
                self.displacement.add_product(k, i, V::load(&positions[i..]), V::splat(bend));
                i += V::COUNT;
            }
        }
    }

    /// Moves the point of reference.
    #[inline(always)]
    fn shift_points<V: Lanes>(&mut self, by: &[f64; 3], count: usize) {
        for k in 0..3 {
            let mut i = 0;
            while by[k] != 0.0 && i < count {
                self.advance_point(k, i, V::splat(-by[k]), true);
                i += V::COUNT;
            }
        }
    }

    /// Moves the functional point along machine axis k, away from the point of reference.
    #[inline(always)]
    fn advance_point<V: Lanes>(&mut self, k: usize, i: usize, travel: V, rotated: bool) {
        self.point.add(k, i, travel);
        if rotated {
            let (next, last) = ((k + 1) % 3, (k + 2) % 3);
            let (a, b): (V, V) = (self.rotation.column(last, i), self.rotation.column(next, i));
            self.displacement.add_product(next, i, V::splat(0.0) - a, travel);
            self.displacement.add_product(last, i, b, travel);
        }
    }

    /// Rotates about an axis through the point of reference.
    #[inline(always)]
    fn rotate<V: Lanes>(&mut self, about: &RotationAxis, lookup: &AxisLookup, count: usize) {
        let mut i = 0;
        while i < count {
            let turn = lookup.turn::<V>(i);
            self.point.put(i, about.rotate(turn, self.point.get(i)));
            self.displacement.put(i, about.rotate(turn, self.displacement.get(i)));
            self.rotation.put(i, about.rotate(turn, self.rotation.get(i)));
            i += V::COUNT;
        }
    }

    /// Adds the errors of several axes: rows summed, then transposed once.
    #[inline(always)]
    fn add_sum<V: Lanes>(&mut self, sum: &Sum, axes: &[AxisLookup], chunk: Chunk<'_>) {
        let mut i = 0;
        while i < chunk.count {
            let mut rows = sum.first.1.rows::<V, CHUNK>(axes[sum.first.0].table_vector(i));
            for (axis, curves) in &sum.others {
                curves.add_rows::<V, CHUNK>(&mut rows, axes[*axis].table_vector(i));
            }
            let [x, y, z, ex, ey, ez, lever_a, lever_b] = V::transpose(&rows);
            self.add::<V>(i, [x, y, z, ex, ey, ez]);
            if let Some(slide) = sum.slide {
                let q = V::load(&chunk.positions(slide.axis)[i..]);
                let [x, y, z]: Vector<V> = self.displacement.get(i);
                let moved = match slide.along {
                    0 => [x, y.plus_times(lever_a, q), z.plus_times(lever_b, q)],
                    1 => [x.plus_times(lever_a, q), y, z.plus_times(lever_b, q)],
                    _ => [x.plus_times(lever_a, q), y.plus_times(lever_b, q), z],
                };
                self.displacement.put(i, moved);
            }
            i += V::COUNT;
        }
    }

    #[inline(always)]
    fn add_errors<V: Lanes>(&mut self, lookup: &AxisLookup, count: usize) {
        let mut i = 0;
        while i < count {
            self.add::<V>(i, lookup.errors(i));
            i += V::COUNT;
        }
    }

    #[inline(always)]
    fn add_constant<V: Lanes>(&mut self, constant: &Six, count: usize) {
        let mut i = 0;
        while i < count {
            self.add::<V>(i, splat_six(constant));
            i += V::COUNT;
        }
    }

    #[inline(always)]
    fn add<V: Lanes>(&mut self, i: usize, [x, y, z, ex, ey, ez]: [V; 6]) {
        self.displacement.put(i, plus(self.displacement.get(i), [x, y, z]));
        self.rotation.put(i, plus(self.rotation.get(i), [ex, ey, ez]));
    }
}
