//! Deviations of many drawn machines at once: per pose a column for every bounded source of a joint, times the
//! errors of [`SAMPLE_LANES`] samples side by side. Each source lives in one joint, so this is a sum over joints.

use super::bounds::Bound;
use super::draw::{Draws, NODES};
use crate::analysis::reference::{PartReference, tip_at};
use crate::evaluate::{Deviation, Field};
use crate::lower::{Quantity, SideWeights, Twist, TwistMap, twists};
use crate::machine::{Approach, Axis, Machine, Travel};
use nalgebra::{Vector3, Vector6};

/// Number of samples computed side by side.
pub const SAMPLE_LANES: usize = 40;

/// A number per sample.
pub type SampleLanes = [f64; SAMPLE_LANES];

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
}

/// Returns the bounds joint by joint, without what a reference takes out of their effects.
pub fn by_joint_without(machine: &Machine, bounds: &[Bound], reference: Option<&PartReference>) -> Vec<JointBounds> {
    let mut joints = by_joint(machine, bounds);
    let Some(reference) = reference else { return joints };
    let none = |joint: &JointBounds| RemovedMotions {
        location: vec![Vector6::zeros(); joint.location.len()],
        component: vec![vec![Vector6::zeros(); joint.component.len()]; NODES],
    };
    let mut removed: Vec<RemovedMotions> = joints.iter().map(none).collect();
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
pub struct JointSamples {
    location: Vec<SampleLanes>,
    nodes: Vec<Vec<SampleLanes>>,
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
        let samples: Vec<JointSamples> =
            joints.iter().map(|joint| joint_samples(joint, bounds, draws, first)).collect();
        let mut removed = None;
        for (joint, samples) in joints.iter().zip(&samples) {
            let Some(motions) = &joint.removed else { continue };
            let sum = removed.get_or_insert([[0.0; SAMPLE_LANES]; 6]);
            let values = motions.component.iter().flatten().zip(samples.nodes.iter().flatten());
            for (motion, errors) in values.filter(|(motion, _)| **motion != Vector6::zeros()) {
                for (sum, part) in sum.iter_mut().zip(motion.iter()) {
                    sum.iter_mut().zip(errors).for_each(|(sum, error)| *sum += part * error);
                }
            }
        }
        Self { joints: samples, removed }
    }

    /// Returns the location errors of a joint.
    pub fn location(&self, joint: usize) -> &[SampleLanes] {
        &self.joints[joint].location
    }

    /// Returns the component errors of a joint at a point of its curves.
    pub fn component(&self, joint: usize, at: CurvePoint) -> Vec<SampleLanes> {
        let [low, high] = self.joints[joint].nodes.get(at.node..at.node + 2).unwrap_or_default() else {
            return Vec::new();
        };
        let between = |(a, b): (&SampleLanes, &SampleLanes)| {
            std::array::from_fn(|lane| a[lane] + at.fraction * (b[lane] - a[lane]))
        };
        low.iter().zip(high).map(between).collect()
    }
}

fn joint_samples(joint: &JointBounds, bounds: &[Bound], draws: &Draws, first: usize) -> JointSamples {
    let location = |source: &DrawnSource| {
        let (bound, stream) = (&bounds[source.bound], bounds[source.bound].stream());
        std::array::from_fn(|lane| bound.tolerance * draws.constant(&stream, first + lane))
    };
    let count = joint.component.len();
    let mut nodes = if count == 0 { Vec::new() } else { vec![vec![[0.0; SAMPLE_LANES]; count]; NODES] };
    for (k, source) in joint.component.iter().enumerate() {
        let (bound, stream) = (&bounds[source.bound], bounds[source.bound].stream());
        for lane in 0..SAMPLE_LANES {
            let curve = draws.curve(&stream, first + lane, joint.closed);
            nodes.iter_mut().zip(curve).for_each(|(node, u)| node[k][lane] = bound.tolerance * u);
        }
    }
    JointSamples { location: joint.location.iter().map(location).collect(), nodes }
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

/// Adds effects times the sources of every sample.
pub fn add(columns: &[[f64; 3]], errors: &[SampleLanes], to: &mut [SampleLanes; 3]) {
    for (columns, errors) in columns.chunks(3).zip(errors.chunks(3)) {
        if let ([a, b, c], [x, y, z]) = (columns, errors) {
            for (i, out) in to.iter_mut().enumerate() {
                for lane in 0..SAMPLE_LANES {
                    out[lane] += a[i] * x[lane] + b[i] * y[lane] + c[i] * z[lane];
                }
            }
            continue;
        }
        for (column, error) in columns.iter().zip(errors) {
            for (i, out) in to.iter_mut().enumerate() {
                out.iter_mut().zip(error).for_each(|(out, error)| *out += column[i] * error);
            }
        }
    }
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
        let [tx, ty, tz, wx, wy, wz] = motion;
        for lane in 0..SAMPLE_LANES {
            let motion = Vector6::new(tx[lane], ty[lane], tz[lane], wx[lane], wy[lane], wz[lane]);
            let effect = self.of(&motion);
            from.iter_mut().zip(effect.iter()).for_each(|(d, effect)| d[lane] -= effect);
        }
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
            add(location, chunk.location(joint), &mut d);
            add(component, &chunk.component(joint, *point), &mut d);
        }
        if let Some(removed) = &chunk.removed {
            self.effect.remove(removed, &mut d);
        }
        d
    }

    /// Returns the deviation by each bounded source in one sample, in the order of the bounds.
    pub fn parts(&self, chunk: &SampleChunk, joints: &[JointBounds], lane: usize, count: usize) -> Vec<[f64; 3]> {
        let mut parts = vec![[0.0; 3]; count];
        for (joint, (([location, component], point), bounds)) in
            self.columns.iter().zip(&self.points).zip(joints).enumerate()
        {
            let at_point = chunk.component(joint, *point);
            let of = [(location, &bounds.location, chunk.location(joint)), (component, &bounds.component, &at_point)];
            for (columns, sources, errors) in of {
                for ((column, source), error) in columns.iter().zip(sources).zip(errors) {
                    parts[source.bound] = column.map(|x| x * error[lane]);
                }
            }
            let Some(removed) = &bounds.removed else { continue };
            for (k, source) in bounds.component.iter().enumerate() {
                let nodes = removed.component.iter().zip(&chunk.joints[joint].nodes);
                let motion = nodes.fold(Vector6::zeros(), |sum, (motions, errors)| sum + motions[k] * errors[k][lane]);
                let part = parts[source.bound].iter_mut();
                part.zip(self.effect.of(&motion).iter()).for_each(|(x, effect)| *x -= effect);
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

/// Returns the root mean square length of vectors times random numbers of variance 1 with these correlations.
fn spread(vectors: &[Vector3<f64>], correlations: &[Vec<f64>]) -> f64 {
    let counts: Vec<usize> = (0..vectors.len()).filter(|n| vectors[*n] != Vector3::zeros()).collect();
    let row = |n: &usize| counts.iter().map(|m| vectors[*n].dot(&vectors[*m]) * correlations[*n][*m]).sum::<f64>();
    counts.iter().map(row).sum::<f64>().max(0.0).sqrt()
}
