//! A laser along the body diagonals of the volume: the actual displacement along each, there and back; with steps, one
//! axis moves at a time, so that every reading belongs to one axis.

use super::bounded::DrivenPath;
use super::path::PosePath;
use crate::lower::NominalPose;
use crate::machine::{AxisKind, Machine, Pose};
use crate::standards::range;
use nalgebra::Vector3;

/// A laser along a diagonal.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Diagonal {
    /// Sense of each axis along it: p or n, in the order of `axes`.
    pub name: String,
    /// Names of the axes.
    pub axes: Vec<String>,
    /// E_d, um: range of both runs, the bidirectional systematic deviation E of ISO 230-2.
    pub e_d_um: f64,
    /// B_d, um: largest difference of both runs.
    pub b_d_um: f64,
    /// Sum of the changes of the reading by each axis's motions on the forward run, um; with steps only.
    pub by_axis_um: Option<Vec<f64>>,
    /// Nominal displacement from the start, mm.
    pub way_mm: Vec<f64>,
    /// Actual minus nominal on the forward run, um; 0 at the start.
    pub there_um: Vec<f64>,
    /// Actual minus nominal on the return run, um, in the order of `way_mm`.
    pub back_um: Vec<f64>,
}

/// Returns all diagonals of the box of up to three linear axes, the others at the pose `at` (mm, deg), with `points`
/// readings per diagonal, or as many steps of every axis. Fewer than two axes have no diagonal.
pub fn diagonals(machine: &Machine, at: &[f64], points: usize, steps: bool) -> Vec<Diagonal> {
    let (axes, senses) = senses(machine);
    senses.iter().map(|rises| diagonal(machine, at, &axes, rises, points, steps)).collect()
}

/// Returns the paths of [`diagonals`] with the range of their readings.
pub fn diagonal_paths<'a>(machine: &Machine, at: &[f64], points: usize, steps: bool) -> Vec<DrivenPath<'a>> {
    let (axes, senses) = senses(machine);
    let one = |rises: &Vec<bool>| {
        let LaserPath { poses, along, .. } = LaserPath::new(machine, at, &axes, rises, points, steps);
        let readings = move |deviations: &[Vector3<f64>]| vec![range(deviations.iter().map(|d| along.dot(d)))];
        DrivenPath { names: vec![name(rises)], poses, readings: Box::new(readings) }
    };
    senses.iter().map(one).collect()
}

fn name(rises: &[bool]) -> String {
    rises.iter().map(|rises| if *rises { 'p' } else { 'n' }).collect()
}

/// Returns the axes that move, with their senses along each diagonal; fewer than two have none.
fn senses(machine: &Machine) -> (Vec<usize>, Vec<Vec<bool>>) {
    let moves =
        |i: &usize| machine.axes()[*i].kind == AxisKind::Linear && machine.volume()[*i].max > machine.volume()[*i].min;
    let mut axes: Vec<usize> = (0..machine.axes().len()).filter(moves).collect();
    // X, Y, Z before others such as W.
    axes.sort_by_key(|i| {
        let name = machine.axes()[*i].name.as_str();
        (!["X", "Y", "Z"].contains(&name), name.to_owned())
    });
    axes.truncate(3);
    if axes.len() < 2 {
        return (axes, Vec::new());
    }
    // The last axis always rises: the other senses are the same diagonals from their other end.
    let count = axes.len();
    let signs = |k: usize| (0..count).map(move |i| k >> i & 1 == 0).collect::<Vec<bool>>();
    let senses = (0..1 << (axes.len() - 1)).map(signs).collect();
    (axes, senses)
}

/// The way of a laser along a diagonal.
struct LaserPath {
    poses: Vec<Pose>,
    /// The axis, of those that move, whose motion leads to each pose after the first; with steps only.
    movers: Vec<usize>,
    /// Nominal places of the functional point, mm.
    places: Vec<Vector3<f64>>,
    along: Vector3<f64>,
}

impl LaserPath {
    fn new(machine: &Machine, at: &[f64], axes: &[usize], rises: &[bool], points: usize, steps: bool) -> Self {
        let intervals = points.max(2) - 1;
        let pose = |counts: &[usize]| {
            let mut pose: Pose = at.to_vec();
            for ((axis, rises), n) in axes.iter().zip(rises).zip(counts) {
                let grid = &machine.volume()[*axis];
                let fraction = *n as f64 / intervals as f64;
                pose[*axis] = grid.min + (grid.max - grid.min) * if *rises { fraction } else { 1.0 - fraction };
            }
            pose
        };
        let mut counts = vec![0; axes.len()];
        let mut poses = vec![pose(&counts)];
        let mut movers = Vec::new();
        for _ in 0..intervals {
            for i in 0..axes.len() {
                counts[i] += 1;
                if steps {
                    poses.push(pose(&counts));
                    movers.push(i);
                }
            }
            if !steps {
                poses.push(pose(&counts));
            }
        }
        let places: Vec<_> = poses.iter().map(|pose| NominalPose::at(machine, pose).pose.translation).collect();
        let along = (places[places.len() - 1] - places[0]).try_normalize(0.0).unwrap_or_default();
        Self { poses, movers, places, along }
    }
}

fn diagonal(machine: &Machine, at: &[f64], axes: &[usize], rises: &[bool], points: usize, steps: bool) -> Diagonal {
    let LaserPath { poses, movers, places, along } = LaserPath::new(machine, at, axes, rises, points, steps);
    let ways: Vec<f64> = places.iter().map(|place| along.dot(&(place - places[0]))).collect();
    let both: Vec<Pose> = poses.iter().cloned().chain(poses.iter().rev().skip(1).cloned()).collect();
    let driven = PosePath { poses: both, closed: false }.deviations(machine);
    let zero = driven[0];
    let read: Vec<f64> = driven.iter().map(|d| along.dot(&(d - zero)) * 1e3).collect();
    let there = read[..poses.len()].to_vec();
    let back: Vec<f64> = read[poses.len() - 1..].iter().rev().copied().collect();
    let by_axis = steps.then(|| {
        let mut sums = vec![0.0; axes.len()];
        there.windows(2).zip(&movers).for_each(|(two, axis)| sums[*axis] += two[1] - two[0]);
        sums
    });
    Diagonal {
        name: name(rises),
        axes: axes.iter().map(|axis| machine.axes()[*axis].name.to_string()).collect(),
        e_d_um: range(there.iter().chain(&back).copied()),
        b_d_um: there.iter().zip(&back).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max),
        by_axis_um: by_axis,
        way_mm: ways,
        there_um: there,
        back_um: back,
    }
}
