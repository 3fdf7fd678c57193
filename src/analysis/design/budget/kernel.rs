//! Deviations of many drawn machines at once: per pose a column for every bounded source of a joint, times the
//! errors of [`SAMPLE_LANES`] samples side by side. Each source lives in one joint, so this is a sum over joints.

use super::bounds::Bound;
use super::draw::{Draws, NODES};
use crate::lower::{Quantity, SideWeights, Twist, TwistMap, twists};
use crate::machine::{Axis, Machine, Travel};

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

/// The sources of a joint in a chunk of samples (mm, rad), in their order.
#[derive(Debug)]
pub struct JointSamples {
    location: Vec<SampleLanes>,
    nodes: Vec<Vec<SampleLanes>>,
}

/// A chunk of drawn machines.
#[derive(Debug)]
pub struct SampleChunk(Vec<JointSamples>);

impl SampleChunk {
    /// Draws samples `first..first + SAMPLE_LANES`.
    pub fn new(joints: &[JointBounds], bounds: &[Bound], draws: &Draws, first: usize) -> Self {
        Self(joints.iter().map(|joint| joint_samples(joint, bounds, draws, first)).collect())
    }

    /// Returns the location errors of a joint.
    pub fn location(&self, joint: usize) -> &[SampleLanes] {
        &self.0[joint].location
    }

    /// Returns the component errors of a joint at a point of its curves.
    pub fn component(&self, joint: usize, at: CurvePoint) -> Vec<SampleLanes> {
        let [low, high] = self.0[joint].nodes.get(at.node..at.node + 2).unwrap_or_default() else { return Vec::new() };
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
        let columns = twists.iter().zip(weights).zip(joints).map(of).collect();
        let points = joints.iter().zip(pose).map(|(joint, q)| joint.curve_point(*q));
        let points = points.chain([CurvePoint { node: 0, fraction: 0.0 }]).collect();
        Self { columns, points, fixed: [0.0; 3] }
    }

    /// Returns the pose with a deviation (mm or rad) that every sample has besides the drawn one.
    pub fn with_constant(self, fixed: [f64; 3]) -> Self {
        Self { fixed, ..self }
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
        }
        parts
    }

    /// Returns the deviation by each source at its bound, in the order of the bounds.
    pub fn extremes(&self, joints: &[JointBounds], bounds: &[Bound]) -> Vec<[f64; 3]> {
        let mut extremes = vec![[0.0; 3]; bounds.len()];
        for (columns, joint) in self.columns.iter().zip(joints) {
            for (columns, sources) in columns.iter().zip([&joint.location, &joint.component]) {
                for (column, source) in columns.iter().zip(sources) {
                    extremes[source.bound] = column.map(|x| x * bounds[source.bound].tolerance);
                }
            }
        }
        extremes
    }
}
