//! The minimal set of location errors of a machine: complete, and none of them expressible by the
//! others and the workpiece set-up. Found by the rank of sensitivities, for any chain and convention.
//!
//! Observed are the position of the functional point at two tool lengths and nothing else: the
//! rotation about the tool axis, and with it the spindle's own EC0S, is not.

use crate::evaluate::{Poses, Random};
use crate::lower::{Ideal, sensitivities_to};
use crate::machine::{Axis, AxisKind, AxisName, Direction, ErrorId, ErrorTerm, Machine};
use nalgebra::{DMatrix, Vector3};

/// Poses at which sensitivities are taken: more rows than any chain has location errors.
const POSES: usize = 48;

/// The second tool is longer by this, mm.
const LONGER: f64 = 100.0;

/// A singular value below this share of the largest is zero.
const RANK: f64 = 1e-8;

/// The minimal set, and what the machine file has of it.
#[derive(Debug, Clone, PartialEq)]
pub struct LocationSet {
    /// In ISO order: squareness, then each rotary axis, then the spindle.
    pub members: Vec<(ErrorId, Status)>,
    /// Location errors the file gives besides: they repeat what members can say.
    pub besides: Vec<ErrorId>,
}

/// How a member of the set stands in the machine file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// A value is given.
    Given,
    /// Only a tolerance is given.
    Bounded,
    /// Not given, but what is given says the same.
    Covered,
    /// Not given: taken as zero.
    Missing,
}

impl LocationSet {
    /// The set for a machine's chain, travels and conventions.
    pub fn of(machine: &Machine) -> Self {
        let candidates = candidates(machine);
        let columns = Columns::new(machine, &candidates);
        let mut chosen: Vec<usize> = Vec::new();
        for candidate in 0..candidates.len() {
            let longer = [&chosen[..], &[candidate]].concat();
            if columns.rank(&longer) == longer.len() {
                chosen = longer;
            }
        }
        let given: Vec<usize> = (0..candidates.len()).filter(|i| given(machine, &candidates[*i]).is_some()).collect();
        let covered = |i: usize| columns.rank(&[&given[..], &[i]].concat()) == columns.rank(&given);
        let status = |i: usize| match given_status(machine, &candidates[i]) {
            Some(status) => status,
            None if covered(i) => Status::Covered,
            None => Status::Missing,
        };
        Self {
            members: chosen.iter().map(|i| (candidates[*i].clone(), status(*i))).collect(),
            besides: given.iter().filter(|i| !chosen.contains(i)).map(|i| candidates[*i].clone()).collect(),
        }
    }
}

fn given<'a>(machine: &'a Machine, wanted: &ErrorId) -> Option<&'a ErrorTerm> {
    let joint = match machine.axis_index(wanted.axis.as_str()) {
        Some(axis) => Some(machine.axis_errors(axis)),
        None => machine.spindle_errors(),
    };
    joint?.location[wanted.direction.index()].as_ref()
}

fn given_status(machine: &Machine, error: &ErrorId) -> Option<Status> {
    let bounded =
        |term: &ErrorTerm| if matches!(term, ErrorTerm::Tolerance(_)) { Status::Bounded } else { Status::Given };
    given(machine, error).map(bounded)
}

/// Every location error of the chain, those ISO 230-1 would take first: EC0Y, EB0Z and EA0Z (X is
/// the primary and Y the secondary datum), further linear axes, rotary axes, the spindle's tilts.
fn candidates(machine: &Machine) -> Vec<ErrorId> {
    use Direction::{A, B, C, X, Y, Z};
    let of = |name: &AxisName, directions: &[Direction]| -> Vec<ErrorId> {
        directions.iter().map(|d| ErrorId { axis: name.clone(), location: true, direction: *d }).collect()
    };
    let kind = |kind: AxisKind| machine.axes().iter().filter(move |axis| axis.kind == kind);
    let main = |name: &str, d: Direction| {
        machine.axes().iter().find(|a| a.name.as_str() == name && linear(a)).map(|a| of(&a.name, &[d]))
    };
    let squareness = [main("Y", C), main("Z", B), main("Z", A)].into_iter().flatten().flatten();
    // Of axes that could carry the same squareness the datum X comes last, Y before it.
    let rank = |axis: &&Axis| ["Y", "X"].iter().position(|n| *n == axis.name.as_str()).map_or(0, |i| i + 1);
    let mut slides: Vec<&Axis> = kind(AxisKind::Linear).collect();
    slides.sort_by_key(rank);
    let turns = kind(AxisKind::Rotary).flat_map(|axis| of(&axis.name, &[X, Y, Z, A, B, C]));
    let spindle = machine.chain().spindle().into_iter().flat_map(|name| of(name, &[A, B, C, X, Y, Z]));
    let mut list: Vec<ErrorId> = squareness.collect();
    list.extend(slides.iter().flat_map(|axis| of(&axis.name, &[A, B, C, X, Y, Z])).chain(turns).chain(spindle));
    let mut seen = std::collections::BTreeSet::new();
    list.retain(|id| seen.insert(id.clone()));
    list
}

fn linear(axis: &Axis) -> bool {
    axis.kind == AxisKind::Linear
}

/// What each candidate, and each of the six errors of the set-up, does at all poses: unit columns
/// (a column that does nothing is zero).
struct Columns {
    setup: Vec<Vec<f64>>,
    candidates: Vec<Vec<f64>>,
}

impl Columns {
    fn new(machine: &Machine, candidates: &[ErrorId]) -> Self {
        let mut columns = vec![Vec::new(); candidates.len()];
        let mut setup = vec![Vec::new(); 6];
        let intervals = machine.axes().iter().map(|axis| axis.travel.interval()).collect();
        for pose in Poses::Random(Random::new(intervals, POSES, 0)).iter() {
            let ideal = Ideal::at(machine, &pose).pose;
            let along = ideal.linear * Vector3::new(0.0, 0.0, -LONGER);
            let push = |column: &mut Vec<f64>, d: Vector3<f64>, w: Vector3<f64>| {
                column.extend(d.iter().chain((d + w.cross(&along)).iter()));
            };
            for (column, s) in columns.iter_mut().zip(sensitivities_to(machine, &pose, candidates)) {
                push(column, s.deviation, s.rotation);
            }
            for i in 0..3 {
                let unit = Vector3::ith(i, 1.0);
                push(&mut setup[i], unit, Vector3::zeros());
                push(&mut setup[i + 3], unit.cross(&ideal.translation), unit);
            }
        }
        let unit = |columns: Vec<Vec<f64>>| columns.into_iter().map(unit).collect();
        Self { setup: unit(setup), candidates: unit(columns) }
    }

    /// How many dimensions these candidates add to the set-up.
    fn rank(&self, of: &[usize]) -> usize {
        let columns: Vec<&Vec<f64>> = self.setup.iter().chain(of.iter().map(|i| &self.candidates[*i])).collect();
        let rows = columns[0].len();
        // Only singular values: nalgebra's decomposition with vectors fails on deficient rank (nalgebra#1172).
        let values = DMatrix::from_fn(rows, columns.len(), |i, j| columns[j][i]).singular_values();
        let limit = RANK * values.max();
        values.iter().filter(|value| **value > limit).count().saturating_sub(self.setup.len())
    }
}

/// Rotations act by mm per rad, translations by mm per mm: only the direction counts.
fn unit(column: Vec<f64>) -> Vec<f64> {
    let length = column.iter().map(|x| x * x).sum::<f64>().sqrt();
    let scale = if length > 1e-9 { 1.0 / length } else { 0.0 };
    column.into_iter().map(|x| x * scale).collect()
}
