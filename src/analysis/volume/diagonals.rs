//! The four body diagonals of the volume of three linear axes: a quick check of a machine (ISO 230-6).

use crate::analysis::inverse::tool_pose;
use crate::evaluate::Field;
use crate::machine::{Approach, AxisKind, Machine, Pose};
use nalgebra::Vector3;

/// One diagonal, run from end to end with the other axes at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagonal {
    /// Its direction by the signs of the three axes' motions: `ppp`, `npp`, `pnp`, `nnp`.
    pub name: String,
    /// Where it starts and ends (mm, deg).
    pub ends: [Pose; 2],
    /// Nominal length, mm.
    pub length: f64,
    /// Deviation of the displacement along it from the start, step by step, mm: the first is 0.
    pub deviations: Vec<f64>,
}

impl Diagonal {
    /// Largest minus smallest deviation along it, mm.
    pub fn range(&self) -> f64 {
        let (min, max) =
            self.deviations.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
        if max >= min { max - min } else { 0.0 }
    }
}

/// Signs of the motion, in the order of the field.
const SIGNS: [(&str, [bool; 3]); 4] = [
    ("ppp", [true, true, true]),
    ("npp", [false, true, true]),
    ("pnp", [true, false, true]),
    ("nnp", [false, false, true]),
];

/// The body diagonals over the volume of [`space_axes`], `steps` intervals each; none if there are no
/// three such axes. `at` is where the other axes are (mm, deg).
pub fn body_diagonals(field: &dyn Field, at: &[f64], steps: usize, approach: Approach) -> Vec<Diagonal> {
    let machine = field.machine();
    let Ok(axes) = <[usize; 3]>::try_from(space_axes(machine)) else { return Vec::new() };
    SIGNS.iter().map(|(name, signs)| diagonal(field, at, steps.max(1), approach, (name, &axes, signs))).collect()
}

fn diagonal(
    field: &dyn Field,
    at: &[f64],
    steps: usize,
    approach: Approach,
    (name, axes, signs): (&str, &[usize; 3], &[bool; 3]),
) -> Diagonal {
    let machine = field.machine();
    let pose = |share: f64| {
        let mut pose = at.to_vec();
        for (axis, positive) in axes.iter().zip(signs) {
            let grid = machine.volume()[*axis];
            let (from, to) = if *positive { (grid.min, grid.max) } else { (grid.max, grid.min) };
            pose[*axis] = if share == 1.0 { to } else { from + (to - from) * share };
        }
        pose
    };
    let ends = [pose(0.0), pose(1.0)];
    let way = tool_pose(machine, &ends[1]).tip - tool_pose(machine, &ends[0]).tip;
    let along: Vector3<f64> = way.try_normalize(0.0).unwrap_or_default();
    let start = field.deviation(&ends[0], approach).position;
    let step = |i| (field.deviation(&pose(i as f64 / steps as f64), approach).position - start).dot(&along);
    Diagonal { name: name.to_owned(), ends, length: way.norm(), deviations: (0..=steps).map(step).collect() }
}

/// Up to three linear axes with room to move that span space (of several parallel ones the first),
/// sorted by name.
pub fn space_axes(machine: &Machine) -> Vec<usize> {
    let room = |i: &usize| {
        let grid = machine.volume()[*i];
        machine.axes()[*i].kind == AxisKind::Linear && grid.max > grid.min
    };
    let mut candidates: Vec<usize> = (0..machine.axes().len()).filter(room).collect();
    candidates.sort_by(|a, b| machine.axes()[*a].name.cmp(&machine.axes()[*b].name));
    let mut basis: Vec<Vector3<f64>> = Vec::new();
    let mut chosen = Vec::new();
    for axis in candidates {
        let direction = Vector3::from(machine.axes()[axis].direction);
        let rest = basis.iter().fold(direction, |rest, b| rest - b * b.dot(&rest));
        // Axes less than 3 deg apart count as parallel.
        if let Some(new) = rest.try_normalize(0.05) {
            basis.push(new);
            chosen.push(axis);
        }
    }
    chosen
}
