//! Deviations of many drawn machines at once: per pose a small matrix for every joint, times the
//! errors of [`SAMPLE_LANES`] samples side by side. Each error lives in one joint, so this is a sum over joints.

use super::bounds::Bound;
use super::draw::{Draws, NODES};
use crate::lower::{Quantity, SideWeights, TwistMap, twists};
use crate::machine::{Axis, Machine, Travel};

/// Number of samples computed side by side.
pub const SAMPLE_LANES: usize = 40;

/// A number per sample.
pub type SampleLanes = [f64; SAMPLE_LANES];

/// The bounds of one joint's errors by direction (mm, rad), with the index of each in the list of bounds.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointBounds {
    location: [Option<usize>; 6],
    component: [Option<usize>; 6],
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
        let six = if bound.error.is_location() { &mut joints[index].location } else { &mut joints[index].component };
        six[bound.error.direction.index()] = Some(i);
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

/// The errors of a joint in a chunk of samples (mm, rad).
#[derive(Debug)]
pub struct JointSamples {
    location: Option<Box<[SampleLanes; 6]>>,
    nodes: Vec<[SampleLanes; 6]>,
}

/// A chunk of drawn machines.
#[derive(Debug)]
pub struct SampleChunk(Vec<JointSamples>);

impl SampleChunk {
    /// Draws samples `first..first + SAMPLE_LANES`.
    pub fn new(joints: &[JointBounds], bounds: &[Bound], draws: &Draws, first: usize) -> Self {
        Self(joints.iter().map(|joint| drawn(joint, bounds, draws, first)).collect())
    }

    /// Returns the location errors of a joint, if it has any.
    pub fn location(&self, joint: usize) -> Option<&[SampleLanes; 6]> {
        self.0[joint].location.as_deref()
    }

    /// Returns the component errors of a joint at a point of its curves, if it has any.
    pub fn component(&self, joint: usize, at: CurvePoint) -> Option<[SampleLanes; 6]> {
        let [low, high] = self.0[joint].nodes.get(at.node..at.node + 2)? else { return None };
        let mut six = [[0.0; SAMPLE_LANES]; 6];
        for ((out, a), b) in six.iter_mut().zip(low).zip(high) {
            for lane in 0..SAMPLE_LANES {
                out[lane] = a[lane] + at.fraction * (b[lane] - a[lane]);
            }
        }
        Some(six)
    }
}

fn drawn(joint: &JointBounds, bounds: &[Bound], draws: &Draws, first: usize) -> JointSamples {
    let any = |six: &[Option<usize>; 6]| six.iter().any(Option::is_some);
    let location = any(&joint.location).then(|| {
        let mut six = Box::new([[0.0; SAMPLE_LANES]; 6]);
        for (row, bound) in six.iter_mut().zip(joint.location).filter_map(|(row, i)| Some((row, &bounds[i?]))) {
            let draw = |lane: usize| bound.tolerance * draws.constant(&bound.error, first + lane);
            *row = std::array::from_fn(draw);
        }
        six
    });
    let mut nodes = Vec::new();
    if any(&joint.component) {
        nodes = vec![[[0.0; SAMPLE_LANES]; 6]; NODES];
        for (k, bound) in joint.component.iter().enumerate().filter_map(|(k, i)| Some((k, &bounds[(*i)?]))) {
            for lane in 0..SAMPLE_LANES {
                let curve = draws.curve(&bound.error, first + lane, joint.closed);
                nodes.iter_mut().zip(curve).for_each(|(node, u)| node[k][lane] = bound.tolerance * u);
            }
        }
    }
    JointSamples { location, nodes }
}

/// Adds a map times the errors of every sample.
pub fn add(map: &TwistMap, errors: &[SampleLanes; 6], to: &mut [SampleLanes; 3]) {
    for (row, out) in map.iter().zip(to) {
        for lane in 0..SAMPLE_LANES {
            let near = row[0] * errors[0][lane] + row[1] * errors[1][lane] + row[2] * errors[2][lane];
            let far = row[3] * errors[3][lane] + row[4] * errors[4][lane] + row[5] * errors[5][lane];
            out[lane] += near + far;
        }
    }
}

/// Returns squared lengths.
pub fn squares(d: &[SampleLanes; 3]) -> SampleLanes {
    std::array::from_fn(|lane| d[0][lane] * d[0][lane] + d[1][lane] * d[1][lane] + d[2][lane] * d[2][lane])
}

/// The maps of all joints at a pose, for any number of samples.
#[derive(Debug, Clone)]
pub struct BudgetPose {
    /// Maps of location and of component errors of every joint.
    maps: Vec<[TwistMap; 2]>,
    points: Vec<CurvePoint>,
    /// Deviation that is the same in every sample.
    fixed: [f64; 3],
}

impl BudgetPose {
    /// Returns the maps of a machine at a pose (mm, deg).
    pub fn new(machine: &Machine, joints: &[JointBounds], pose: &[f64], quantity: Quantity) -> Self {
        let weights = machine.axes().iter().map(|axis| {
            [SideWeights::location(axis, machine.conventions()), SideWeights::component(axis, machine.conventions())]
        });
        let weights = weights.chain([[SideWeights::SPINDLE; 2]]);
        let maps = twists(machine, pose, quantity).iter().zip(weights).map(|(t, w)| w.map(|w| w.map(t))).collect();
        let points = joints.iter().zip(pose).map(|(joint, q)| joint.curve_point(*q));
        let points = points.chain([CurvePoint { node: 0, fraction: 0.0 }]).collect();
        Self { maps, points, fixed: [0.0; 3] }
    }

    /// Returns the pose with a deviation (mm or rad) that every sample has besides the drawn one.
    pub fn with_fixed(self, fixed: [f64; 3]) -> Self {
        Self { fixed, ..self }
    }

    /// The deviation that every sample has.
    pub fn fixed(&self) -> [f64; 3] {
        self.fixed
    }

    /// Returns the deviations of every sample of a chunk (mm or rad).
    pub fn deviations(&self, chunk: &SampleChunk) -> [SampleLanes; 3] {
        let mut d = self.fixed.map(|fixed| [fixed; SAMPLE_LANES]);
        for (joint, ([location, component], point)) in self.maps.iter().zip(&self.points).enumerate() {
            if let Some(errors) = chunk.location(joint) {
                add(location, errors, &mut d);
            }
            if let Some(errors) = chunk.component(joint, *point) {
                add(component, &errors, &mut d);
            }
        }
        d
    }

    /// Returns the deviation by each bounded error in one sample, in the order of the bounds.
    pub fn parts(&self, chunk: &SampleChunk, joints: &[JointBounds], lane: usize, count: usize) -> Vec<[f64; 3]> {
        let mut parts = vec![[0.0; 3]; count];
        for (joint, (([location, component], point), bounds)) in
            self.maps.iter().zip(&self.points).zip(joints).enumerate()
        {
            let drawn = [chunk.location(joint).copied(), chunk.component(joint, *point)];
            let indices = [&bounds.location, &bounds.component];
            for ((map, errors), index) in [location, component].into_iter().zip(drawn).zip(indices) {
                let Some(errors) = errors else { continue };
                for (k, bound) in index.iter().enumerate().filter_map(|(k, i)| Some((k, (*i)?))) {
                    parts[bound] = std::array::from_fn(|i| map[i][k] * errors[k][lane]);
                }
            }
        }
        parts
    }

    /// Returns the deviation by each error at its bound, in the order of the bounds.
    pub fn extremes(&self, joints: &[JointBounds], bounds: &[Bound]) -> Vec<[f64; 3]> {
        let mut extremes = vec![[0.0; 3]; bounds.len()];
        for (maps, joint) in self.maps.iter().zip(joints) {
            for (map, index) in maps.iter().zip([&joint.location, &joint.component]) {
                for (k, bound) in index.iter().enumerate().filter_map(|(k, i)| Some((k, (*i)?))) {
                    extremes[bound] = std::array::from_fn(|i| map[i][k] * bounds[bound].tolerance);
                }
            }
        }
        extremes
    }
}
