//! Deviations of many drawn machines at once: per pose a column for every bounded source of a joint, times the
//! errors of [`SAMPLE_LANES`] samples side by side. Each source lives in one joint, so this is a sum over joints.

use super::bounds::Bound;
use super::draw::{Draws, NODE_PLACES, NODES, NodeValues};
use super::sample_kernels::{AddEffects, AddMotions, CurveNodes, MotionTerm, NodeSums, RemoveMotion, run};
pub use super::sample_kernels::{SAMPLE_LANES, SampleLanes};
use crate::analysis::reference::{PartReference, tip_at};
use crate::evaluate::{Deviation, Field};
use crate::lower::{Quantity, SideWeights, Twist, TwistMap, twists};
use crate::machine::{Approach, Axis, Machine, Travel};
use nalgebra::{Vector3, Vector6};

/// The effect of each source of a joint at a pose, per mm or rad of it.
pub type SourceEffects = Vec<[f64; 3]>;

/// A bounded source of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnSource {
    /// Index in the list of bounds.
    bound: usize,
    /// Translations and rotations X, Y, Z, A, B, C per unit of it.
    letters: [f64; 6],
}

/// The bounded sources of one joint.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointBounds {
    /// Of location errors.
    pub location: Vec<DrawnSource>,
    /// Of component errors.
    pub component: Vec<DrawnSource>,
    interval: (f64, f64),
    closed: bool,
    /// The motions that the set-up of the part takes out; `None` without a set-up.
    removed: Option<RemovedMotions>,
}

/// The motion of the part that its set-up takes out, per unit of the sources of a joint: translation and rotation.
#[derive(Debug, Clone, PartialEq)]
pub struct RemovedMotions {
    /// The motions by location errors.
    location: Vec<Vector6<f64>>,
    /// The motions by component errors at the nodes of their curves, node by node.
    component: Vec<Vec<Vector6<f64>>>,
    /// The latter that are not zero, as the values at the nodes are kept.
    terms: Vec<MotionTerm>,
    /// Those of each source.
    by_source: Vec<Vec<MotionTerm>>,
}

impl RemovedMotions {
    fn none(joint: &JointBounds) -> Self {
        let count = joint.component.len();
        Self {
            location: vec![Vector6::zeros(); joint.location.len()],
            component: vec![vec![Vector6::zeros(); count]; NODES],
            terms: Vec::new(),
            by_source: vec![Vec::new(); count],
        }
    }

    fn list_terms(&mut self) {
        for (index, motion) in self.component.iter().flatten().enumerate() {
            if *motion != Vector6::zeros() {
                let term = MotionTerm { index, motion: (*motion).into() };
                self.terms.push(term);
                let source = index % self.by_source.len();
                self.by_source[source].push(term);
            }
        }
    }
}

/// Returns the bounds joint by joint, without what a reference takes out of their effects.
pub fn by_joint_without(machine: &Machine, bounds: &[Bound], reference: Option<&PartReference>) -> Vec<JointBounds> {
    let mut joints = by_joint(machine, bounds);
    let Some(reference) = reference else { return joints };
    let mut removed: Vec<RemovedMotions> = joints.iter().map(RemovedMotions::none).collect();
    for point in reference.points() {
        let pose = BudgetPose::new(machine, &joints, &point.pose, Quantity::Position);
        for ((removed, [location, component]), at) in removed.iter_mut().zip(&pose.columns).zip(&pose.points) {
            let motion = |column: &[f64; 3]| point.gain * Vector3::from(*column);
            removed.location.iter_mut().zip(location).for_each(|(sum, column)| *sum += motion(column));
            for (node, weight) in at.weights() {
                let sums = removed.component[node].iter_mut();
                sums.zip(component).for_each(|(sum, column)| *sum += motion(column) * weight);
            }
        }
    }
    removed.iter_mut().for_each(RemovedMotions::list_terms);
    joints.iter_mut().zip(removed).for_each(|(joint, removed)| joint.removed = Some(removed));
    joints
}

/// Returns the bounds joint by joint: of every axis in the order of the machine, then of the spindle.
pub fn by_joint(machine: &Machine, bounds: &[Bound]) -> Vec<JointBounds> {
    let joint = |axis: Option<&Axis>| {
        let mut joint = JointBounds::default();
        axis.into_iter().for_each(|axis| joint.travel(axis.travel));
        joint
    };
    let mut joints: Vec<JointBounds> = machine.axes().iter().map(Some).chain([None]).map(joint).collect();
    for (i, bound) in bounds.iter().enumerate() {
        let index = machine.axis_index(bound.error.axis.as_str()).unwrap_or(machine.axes().len());
        let of = if bound.error.is_location() { &mut joints[index].location } else { &mut joints[index].component };
        of.push(DrawnSource { bound: i, letters: bound.letters() });
    }
    joints
}

impl JointBounds {
    /// Takes the travel over which the curves of the joint run.
    pub fn travel(&mut self, travel: Travel) {
        (self.interval, self.closed) = (travel.interval(), travel == Travel::Continuous);
    }

    /// Returns the point of a curve at a position (mm or deg); beyond the travel the curve keeps its end value.
    pub fn curve_point(&self, position: f64) -> CurvePoint {
        let (min, max) = self.interval;
        let along = if self.closed { (position - min).rem_euclid(max - min) } else { position.clamp(min, max) - min };
        let x = if max > min { along / (max - min) * (NODES - 1) as f64 } else { 0.0 };
        let node = (x as usize).min(NODES - 2);
        CurvePoint { node, fraction: x - node as f64 }
    }
}

/// A point between two nodes of a curve.
#[derive(Debug, Clone, Copy)]
pub struct CurvePoint {
    /// Index of the lower node.
    pub node: usize,
    /// Fraction of the interval to the upper node.
    pub fraction: f64,
}

impl CurvePoint {
    /// Returns the two nodes with their weights.
    fn weights(self) -> [(usize, f64); 2] {
        [(self.node, 1.0 - self.fraction), (self.node + 1, self.fraction)]
    }
}

/// The sources of a joint in a chunk of samples (mm, rad), in their order.
#[derive(Debug)]
struct JointSamples {
    location: Vec<SampleLanes>,
    /// Node by node the component errors.
    nodes: Vec<SampleLanes>,
}

impl JointSamples {
    fn new(joint: &JointBounds, bounds: &[Bound], draws: &Draws, first: usize) -> Self {
        let location = |source: &DrawnSource| {
            let bound = &bounds[source.bound];
            draws.constants(&bound.stream(), first).map(|x| bound.tolerance * x)
        };
        let stride = joint.component.len();
        let mut nodes = vec![[0.0; SAMPLE_LANES]; stride * NODES];
        for (k, source) in joint.component.iter().enumerate() {
            let bound = &bounds[source.bound];
            run(CurveNodes {
                waves: draws.waves(joint.closed),
                amplitudes: &draws.amplitudes(&bound.stream(), first),
                tolerance: bound.tolerance,
                distribution: draws.distribution(),
                nodes: &mut nodes[k..],
                stride,
            });
        }
        Self { location: joint.location.iter().map(location).collect(), nodes }
    }

    /// Returns the samples times the tolerances of their bounds.
    fn times(&self, joint: &JointBounds, bounds: &[Bound]) -> Self {
        let of = |sources: &[DrawnSource], values: &Vec<SampleLanes>| {
            let mut values = values.clone();
            let tolerances = sources.iter().map(|source| bounds[source.bound].tolerance).cycle();
            for (lanes, tolerance) in values.iter_mut().zip(tolerances) {
                lanes.iter_mut().for_each(|x| *x *= tolerance);
            }
            values
        };
        Self { location: of(&joint.location, &self.location), nodes: of(&joint.component, &self.nodes) }
    }

    /// Returns the component errors at a node and at the next one.
    fn at(&self, node: usize, count: usize) -> [&[SampleLanes]; 2] {
        let (low, high) = self.nodes[node * count..(node + 2) * count].split_at(count);
        [low, high]
    }
}

/// A chunk of drawn machines.
#[derive(Debug)]
pub struct SampleChunk {
    joints: Vec<JointSamples>,
    /// Translation (mm) and rotation (rad) that the set-up of the part takes out because of component errors.
    removed: Option<[SampleLanes; 6]>,
}

impl SampleChunk {
    /// Draws samples `first..first + SAMPLE_LANES`.
    pub fn new(joints: &[JointBounds], bounds: &[Bound], draws: &Draws, first: usize) -> Self {
        Self::of(joints, joints.iter().map(|joint| JointSamples::new(joint, bounds, draws, first)).collect())
    }

    /// Returns a chunk that is drawn with tolerances of 1 as it is with those of the bounds.
    pub fn times(&self, joints: &[JointBounds], bounds: &[Bound]) -> Self {
        Self::of(joints, joints.iter().zip(&self.joints).map(|(joint, samples)| samples.times(joint, bounds)).collect())
    }

    /// Returns the number of bytes that a chunk takes.
    pub fn bytes(joints: &[JointBounds]) -> usize {
        let values = |joint: &JointBounds| joint.location.len() + NODES * joint.component.len();
        joints.iter().map(values).sum::<usize>() * size_of::<SampleLanes>()
    }

    fn of(joints: &[JointBounds], samples: Vec<JointSamples>) -> Self {
        let mut removed = None;
        for (joint, samples) in joints.iter().zip(&samples) {
            let Some(motions) = &joint.removed else { continue };
            let to = removed.get_or_insert([[0.0; SAMPLE_LANES]; 6]);
            run(AddMotions { terms: &motions.terms, factors: &samples.nodes, to });
        }
        Self { joints: samples, removed }
    }

    /// Adds the effects of the location errors of a joint.
    pub fn add_location(&self, joint: usize, effects: &[[f64; 3]], to: &mut [SampleLanes; 3]) {
        run(AddEffects { effects, errors: &self.joints[joint].location, next: None, to });
    }

    /// Adds the effects of the component errors of a joint at a point of its curves.
    pub fn add_component(&self, joint: usize, at: CurvePoint, effects: &[[f64; 3]], to: &mut [SampleLanes; 3]) {
        let [errors, next] = self.joints[joint].at(at.node, effects.len());
        run(AddEffects { effects, errors, next: Some((next, at.fraction)), to });
    }

    /// Returns the motions that the set-up of the part takes out because of each component error, joint by joint.
    pub fn removed_by_source(&self, joints: &[JointBounds]) -> Vec<Vec<[SampleLanes; 6]>> {
        let of = |(joint, samples): (&JointBounds, &JointSamples)| {
            let motion = |terms: &Vec<MotionTerm>| {
                let mut sum = [[0.0; SAMPLE_LANES]; 6];
                run(AddMotions { terms, factors: &samples.nodes, to: &mut sum });
                sum
            };
            joint.removed.iter().flat_map(|removed| &removed.by_source).map(motion).collect()
        };
        joints.iter().zip(&self.joints).map(of).collect()
    }
}

/// Returns the effects of sources by the map of their joint.
pub fn columns(map: &TwistMap, sources: &[DrawnSource]) -> SourceEffects {
    let effect = |row: &[f64; 6], letters: &[f64; 6]| {
        // A letter by itself keeps its entry to the bit.
        let parts = row.iter().zip(letters).filter(|(_, letter)| **letter != 0.0);
        parts.fold(0.0, |sum, (entry, letter)| sum + entry * letter)
    };
    sources.iter().map(|source| std::array::from_fn(|i| effect(&map[i], &source.letters))).collect()
}

/// Returns squared lengths.
pub fn squares(d: &[SampleLanes; 3]) -> SampleLanes {
    std::array::from_fn(|lane| d[0][lane] * d[0][lane] + d[1][lane] * d[1][lane] + d[2][lane] * d[2][lane])
}

/// The effects of all sources at a pose, for any number of samples.
#[derive(Debug, Clone)]
pub struct BudgetPose {
    /// Deviations by location and by component errors of every joint.
    columns: Vec<[SourceEffects; 2]>,
    points: Vec<CurvePoint>,
    /// Deviation that is the same in every sample.
    fixed: [f64; 3],
    /// The effect of a motion of the part here.
    effect: MotionEffect,
}

/// Takes a motion of the part out of the position deviations (mm) at a place of the part (mm), for all samples.
pub fn remove_motion(motion: &[SampleLanes; 6], tip: &Vector3<f64>, from: &mut [SampleLanes; 3]) {
    MotionEffect::Position(*tip).remove(motion, from);
}

/// The effect of a motion of the part at a pose.
#[derive(Debug, Clone, Copy)]
enum MotionEffect {
    /// On the functional point, which is here, mm.
    Position(Vector3<f64>),
    /// On the orientation of the tool.
    Rotation,
}

impl MotionEffect {
    fn of(self, motion: &Vector6<f64>) -> Vector3<f64> {
        let rotation = Vector3::new(motion[3], motion[4], motion[5]);
        match self {
            Self::Position(tip) => Vector3::new(motion[0], motion[1], motion[2]) + rotation.cross(&tip),
            Self::Rotation => rotation,
        }
    }

    /// Takes the effect of a motion out of deviations, for all samples.
    fn remove(self, motion: &[SampleLanes; 6], from: &mut [SampleLanes; 3]) {
        let tip = match self {
            Self::Position(tip) => Some(tip.into()),
            Self::Rotation => None,
        };
        run(RemoveMotion { motion, tip, from });
    }
}

impl BudgetPose {
    /// Returns the effects in a machine at a pose (mm, deg).
    pub fn new(machine: &Machine, joints: &[JointBounds], pose: &[f64], quantity: Quantity) -> Self {
        let weights = machine.axes().iter().map(|axis| {
            [SideWeights::location(axis, machine.conventions()), SideWeights::component(axis, machine.conventions())]
        });
        let weights = weights.chain([[SideWeights::SPINDLE; 2]]);
        let twists = twists(machine, pose, quantity);
        let of = |((twist, [location, component]), joint): ((&Twist, [SideWeights; 2]), &JointBounds)| {
            [columns(&location.map(twist), &joint.location), columns(&component.map(twist), &joint.component)]
        };
        let mut columns: Vec<[SourceEffects; 2]> = twists.iter().zip(weights).zip(joints).map(of).collect();
        let effect = match quantity {
            Quantity::Position => MotionEffect::Position(tip_at(machine, pose)),
            Quantity::Rotation => MotionEffect::Rotation,
        };
        for ([location, _], removed) in
            columns.iter_mut().zip(joints).filter_map(|(c, j)| Some((c, j.removed.as_ref()?)))
        {
            for (column, motion) in location.iter_mut().zip(&removed.location) {
                column.iter_mut().zip(effect.of(motion).iter()).for_each(|(x, effect)| *x -= effect);
            }
        }
        let points = joints.iter().zip(pose).map(|(joint, q)| joint.curve_point(*q));
        let points = points.chain([CurvePoint { node: 0, fraction: 0.0 }]).collect();
        Self { columns, points, fixed: [0.0; 3], effect }
    }

    /// Returns the pose (mm, deg) with the deviation of a field, which every sample has besides the drawn one.
    pub fn beside(self, field: Option<&dyn Field>, pose: &[f64]) -> Self {
        let Some(field) = field else { return self };
        let Deviation { position, rotation } = field.deviation(&Approach::Mean.at_pose(pose));
        let fixed = match self.effect {
            MotionEffect::Position(_) => position,
            MotionEffect::Rotation => rotation,
        };
        Self { fixed: fixed.into(), ..self }
    }

    /// The deviation that every sample has.
    pub fn constant_deviation(&self) -> [f64; 3] {
        self.fixed
    }

    /// Returns the deviations of every sample of a chunk (mm or rad).
    pub fn deviations(&self, chunk: &SampleChunk) -> [SampleLanes; 3] {
        let mut d = self.fixed.map(|fixed| [fixed; SAMPLE_LANES]);
        for (joint, ([location, component], point)) in self.columns.iter().zip(&self.points).enumerate() {
            chunk.add_location(joint, location, &mut d);
            chunk.add_component(joint, *point, component, &mut d);
        }
        if let Some(removed) = &chunk.removed {
            self.effect.remove(removed, &mut d);
        }
        d
    }

    /// Returns the deviation by each bounded source in one sample, in the order of the bounds; `removed` is
    /// [`SampleChunk::removed_by_source`].
    pub fn parts(
        &self,
        chunk: &SampleChunk,
        removed: &[Vec<[SampleLanes; 6]>],
        joints: &[JointBounds],
        lane: usize,
        count: usize,
    ) -> Vec<[f64; 3]> {
        let mut parts = vec![[0.0; 3]; count];
        for (joint, (([location, component], point), bounds)) in
            self.columns.iter().zip(&self.points).zip(joints).enumerate()
        {
            let samples = &chunk.joints[joint];
            for ((column, source), error) in location.iter().zip(&bounds.location).zip(&samples.location) {
                parts[source.bound] = column.map(|x| x * error[lane]);
            }
            let [low, high] = samples.at(point.node, component.len());
            for (k, (column, source)) in component.iter().zip(&bounds.component).enumerate() {
                let error = low[k][lane] + point.fraction * (high[k][lane] - low[k][lane]);
                let part = &mut parts[source.bound];
                *part = column.map(|x| x * error);
                let Some(motion) = removed[joint].get(k) else { continue };
                let motion = Vector6::from_fn(|i, _| motion[i][lane]);
                part.iter_mut().zip(self.effect.of(&motion).iter()).for_each(|(x, effect)| *x -= effect);
            }
        }
        parts
    }

    /// Returns the effects of the sources at their bounds.
    pub fn extremes(&self, joints: &[JointBounds], bounds: &[Bound], draws: &Draws) -> BoundEffects {
        let mut effects = BoundEffects {
            lengths: vec![0.0; bounds.len()],
            vectors: vec![[0.0; 3]; bounds.len()],
            staying: length(&self.fixed),
        };
        if effects.staying > 0.0 {
            effects.vectors.push(self.fixed);
        }
        for ((columns, point), joint) in self.columns.iter().zip(&self.points).zip(joints) {
            for (kind, (columns, sources)) in columns.iter().zip([&joint.location, &joint.component]).enumerate() {
                for (k, (column, source)) in columns.iter().zip(sources).enumerate() {
                    let tolerance = bounds[source.bound].tolerance;
                    let removed = joint.removed.as_ref().filter(|_| kind == 1);
                    effects.lengths[source.bound] = match removed {
                        None => {
                            let vector = column.map(|x| x * tolerance);
                            effects.vectors[source.bound] = vector;
                            length(&vector)
                        }
                        Some(removed) => {
                            let mut nodes = self.node_effects(column, *point, removed, k);
                            nodes.iter_mut().for_each(|node| *node *= tolerance);
                            effects
                                .vectors
                                .extend(nodes.iter().filter(|v| v.norm() > 0.0).map(|v| <[f64; 3]>::from(*v)));
                            spread(&nodes, draws.correlations(joint.closed))
                        }
                    };
                }
            }
        }
        effects
    }

    /// Returns the effects of the values of a curve at its nodes, per unit, less what the set-up of the part takes out.
    fn node_effects(
        &self,
        column: &[f64; 3],
        point: CurvePoint,
        removed: &RemovedMotions,
        k: usize,
    ) -> Vec<Vector3<f64>> {
        let mut nodes: Vec<Vector3<f64>> =
            removed.component.iter().map(|motions| -self.effect.of(&motions[k])).collect();
        point.weights().into_iter().for_each(|(node, weight)| nodes[node] += Vector3::from(*column) * weight);
        nodes
    }
}

/// The effects of sources at their bounds, at a pose (mm or rad).
#[derive(Debug, Clone, Default)]
pub struct BoundEffects {
    /// The effect of each by itself, in the order of the bounds: of a curve with a reference the standard deviation,
    /// scaled as the bound is to its own.
    pub lengths: Vec<f64>,
    /// Vectors that with any signs make all deviations within the bounds: of each source in the order of the bounds;
    /// then of the errors that stay, whose sign is as good as free, for those of all others are; then, of curves with a
    /// reference, of each value that counts.
    pub vectors: Vec<[f64; 3]>,
    /// The deviation by the errors that stay.
    pub staying: f64,
}

impl BoundEffects {
    /// Returns the root of the sum of squares.
    pub fn rss(&self) -> f64 {
        let bounds: f64 = self.lengths.iter().map(|x| x * x).sum();
        (bounds + self.staying * self.staying).sqrt()
    }
}

/// Returns the length of a vector.
pub fn length(v: &[f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// Returns the root mean square length of vectors at the nodes times random numbers of variance 1 with these
/// correlations.
fn spread(vectors: &[Vector3<f64>], correlations: &[NodeValues]) -> f64 {
    let mut columns = [[0.0; NODE_PLACES]; 3];
    for (n, v) in vectors.iter().enumerate() {
        columns.iter_mut().zip(v.iter()).for_each(|(column, x)| column[n] = *x);
    }
    let counts: Vec<usize> = (0..vectors.len()).filter(|n| vectors[*n] != Vector3::zeros()).collect();
    let mut rows = [0.0; NODE_PLACES];
    run(NodeSums { columns: &columns, counts: &counts, correlations, rows: &mut rows });
    counts.iter().map(|n| rows[*n]).sum::<f64>().max(0.0).sqrt()
}
