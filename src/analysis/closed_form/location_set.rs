//! The minimal set of location errors of a machine: complete, and none of them expressible by the
//! others and the workpiece set-up. Found by the rank of sensitivities, for any chain and convention.
//!
//! Observed is the position of the functional point, at two tool lengths if the chain has a spindle
//! whose tilts could explain the difference. The rotation about the tool axis, and with it the
//! spindle's own EC0S, is not.

use crate::evaluate::{Poses, Random};
use crate::lower::{JointError, NominalJoints, NominalPose, Quantity};
use crate::machine::{Axis, AxisKind, AxisName, Direction, ErrorFamily, ErrorId, ErrorTerm, Machine};
use nalgebra::{DMatrix, Vector3};

/// Number of poses at which sensitivities are evaluated: more rows than any chain has location errors.
const POSES: usize = 48;

/// Difference of the two tool lengths, mm.
const LONGER_MM: f64 = 100.0;

/// A singular value below this fraction of the largest is zero.
const RANK_TOLERANCE: f64 = 1e-8;

/// The minimal set, and its state in the machine file.
#[derive(Debug, Clone, PartialEq)]
pub struct LocationSet {
    /// Members in ISO order: squareness, then each rotary axis, then the spindle.
    pub members: Vec<(ErrorId, Status)>,
    /// Location errors that the file gives besides: the members can express them.
    pub besides: Vec<ErrorId>,
}

/// The state of a member of the set in the machine file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// A value is given.
    Given,
    /// Only a tolerance is given.
    Bounded,
    /// Not given, but expressible by the errors that are given.
    Covered,
    /// Not given: taken as zero.
    Missing,
}

impl LocationSet {
    /// Returns the set for a machine's chain, travels and conventions.
    pub fn of(machine: &Machine) -> Self {
        let candidates = candidates(machine, |axis, letter| letter.index() % 3 == nearest(axis));
        let displacements: Vec<Displacement> = candidates.iter().map(Displacement::of).collect();
        let columns = SensitivityColumns::new(machine, &displacements);
        let chosen = columns.independent_candidates();
        let given: Vec<usize> = (0..candidates.len()).filter(|i| term_of(machine, &candidates[*i]).is_some()).collect();
        let covered = |i: usize| columns.rank(&[&given[..], &[i]].concat()) == columns.rank(&given);
        let status = |i: usize| match status_of(machine, &candidates[i]) {
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

/// A displacement of a joint by letters in machine coordinates, mm and rad.
#[derive(Debug, Clone, PartialEq)]
pub struct Displacement {
    /// The joint.
    pub axis: AxisName,
    /// As location error or component error.
    pub family: ErrorFamily,
    /// X, Y, Z, A, B, C.
    pub letters: [f64; 6],
}

impl Displacement {
    fn of(error: &ErrorId) -> Self {
        let letters = std::array::from_fn(|k| f64::from(u8::from(k == error.direction.index())));
        Self { axis: error.axis.clone(), family: error.family, letters }
    }
}

/// Returns the members of a minimal set whose candidates lie along their axes (`along`) or across them, where
/// `displacement` says what each of them is in machine coordinates.
pub fn minimal_set(
    machine: &Machine,
    along: impl Fn(&Axis, Direction) -> bool,
    displacement: impl Fn(&ErrorId) -> Displacement,
) -> Vec<ErrorId> {
    let candidates = candidates(machine, along);
    let columns = SensitivityColumns::new(machine, &candidates.iter().map(displacement).collect::<Vec<_>>());
    columns.independent_candidates().into_iter().map(|i| candidates[i].clone()).collect()
}

fn term_of<'a>(machine: &'a Machine, wanted: &ErrorId) -> Option<&'a ErrorTerm> {
    let joint = match machine.axis_index(wanted.axis.as_str()) {
        Some(axis) => Some(machine.axis_errors(axis)),
        None => machine.spindle_errors(),
    };
    joint?.location[wanted.direction.index()].as_ref()
}

fn status_of(machine: &Machine, error: &ErrorId) -> Option<Status> {
    let bounded =
        |term: &ErrorTerm| if matches!(term, ErrorTerm::Tolerance(_)) { Status::Bounded } else { Status::Given };
    term_of(machine, error).map(bounded)
}

/// Returns every location error of the chain, in the order of preference of ISO 230-1: EC0Y, EB0Z and EA0Z (X is
/// the primary and Y the secondary datum), further linear axes, rotary axes, the spindle's tilts.
/// The rest is for chains whose linear axes bear other names.
fn candidates(machine: &Machine, along: impl Fn(&Axis, Direction) -> bool) -> Vec<ErrorId> {
    use Direction::{A, B, C, X, Y, Z};
    let of = |name: &AxisName, directions: &[Direction]| -> Vec<ErrorId> {
        directions
            .iter()
            .map(|d| ErrorId { axis: name.clone(), family: ErrorFamily::Location, direction: *d })
            .collect()
    };
    let (slides, turns): (Vec<&Axis>, Vec<&Axis>) =
        machine.axes().iter().partition(|axis| axis.kind == AxisKind::Linear);
    let main = |axis: &&&Axis| ["X", "Y", "Z"].contains(&axis.name.as_str());
    let squareness = [("Y", C), ("Z", B), ("Z", A)].into_iter().flat_map(|(name, direction)| {
        slides.iter().filter(move |axis| axis.name.as_str() == name).flat_map(move |axis| of(&axis.name, &[direction]))
    });
    let further = slides.iter().filter(|axis| !main(axis)).flat_map(|axis| of(&axis.name, &[A, B, C]));
    let rotary = turns.iter().flat_map(|axis| of(&axis.name, &across_first(|letter| along(axis, letter))));
    let spindle = machine.chain().spindle().into_iter().flat_map(|name| of(name, &[A, B, C, X, Y, Z]));
    let rest = slides.iter().flat_map(|axis| of(&axis.name, &[A, B, C, X, Y, Z]));
    let mut seen = std::collections::BTreeSet::new();
    let all = squareness.chain(further).chain(rotary).chain(spindle).chain(rest);
    all.filter(|id| seen.insert(id.clone())).collect()
}

/// Returns the six directions with those along the axis last: a motion of the axis along itself has no effect.
fn across_first(along: impl Fn(Direction) -> bool) -> [Direction; 6] {
    let mut directions = Direction::ALL;
    directions.sort_by_key(|d| (along(*d), d.index()));
    directions
}

/// The direction of an oblique axis is the one of its letter, as for an orthogonal one.
fn nearest(axis: &Axis) -> usize {
    let along = |i: usize| axis.direction[i].abs();
    let named = ["A", "B", "C"].iter().position(|name| *name == axis.name.as_str()).filter(|i| along(*i) > 0.1);
    named.unwrap_or_else(|| (1..3).fold(0, |nearest, i| if along(i) > along(nearest) { i } else { nearest }))
}

/// Returns the letters of a candidate that are not zero, with its index.
fn letters_of(machine: &Machine, index: usize, of: &Displacement) -> Vec<(usize, f64, JointError)> {
    let id = |direction| JointError::new(machine, &ErrorId { axis: of.axis.clone(), family: of.family, direction });
    let parts = Direction::ALL.into_iter().zip(of.letters).filter(|(_, factor)| *factor != 0.0);
    parts.map(|(direction, factor)| (index, factor, id(direction))).collect()
}

/// The sensitivities by each candidate, and by each of the six errors of the set-up, at all poses: unit columns (zero
/// without effect).
struct SensitivityColumns {
    setup: Vec<Vec<f64>>,
    candidates: Vec<Vec<f64>>,
}

impl SensitivityColumns {
    fn new(machine: &Machine, candidates: &[Displacement]) -> Self {
        let mut columns = vec![Vec::new(); candidates.len()];
        let letters: Vec<(usize, f64, JointError)> =
            candidates.iter().enumerate().flat_map(|(i, candidate)| letters_of(machine, i, candidate)).collect();
        let mut setup = vec![Vec::new(); 6];
        let intervals = machine.axes().iter().map(|axis| axis.travel.interval()).collect();
        for pose in Poses::Random(Random::new(intervals, POSES, 0)).iter() {
            let nominal = NominalPose::at(machine, &pose).pose;
            // Without a spindle a tilt of the tool has no name: one length is observed, the second is the first.
            let longer = if machine.chain().spindle().is_some() { LONGER_MM } else { 0.0 };
            let along = nominal.linear * Vector3::from(machine.tool().direction) * -longer;
            let push = |column: &mut Vec<f64>, d: Vector3<f64>, w: Vector3<f64>| {
                column.extend(d.iter().chain((d + w.cross(&along)).iter()));
            };
            let mut effects = vec![(Vector3::zeros(), Vector3::zeros()); candidates.len()];
            let joints = NominalJoints::at(machine, &pose);
            for (i, factor, error) in &letters {
                effects[*i].0 += error.effect(&joints, Quantity::Position) * *factor;
                effects[*i].1 += error.effect(&joints, Quantity::Rotation) * *factor;
            }
            columns.iter_mut().zip(effects).for_each(|(column, (d, w))| push(column, d, w));
            for i in 0..3 {
                let unit = Vector3::ith(i, 1.0);
                push(&mut setup[i], unit, Vector3::zeros());
                push(&mut setup[i + 3], unit.cross(&nominal.translation), unit);
            }
        }
        let all: Vec<Vec<f64>> = setup.into_iter().chain(columns).map(unit).collect();
        // The triangle of the decomposition has the same singular values, for any choice of columns, in fewer rows.
        let triangle = DMatrix::from_fn(all[0].len(), all.len(), |i, j| all[j][i]).qr().r();
        let mut columns: Vec<Vec<f64>> =
            triangle.column_iter().map(|column| column.iter().copied().collect()).collect();
        let candidates = columns.split_off(6);
        Self { setup: columns, candidates }
    }

    /// Returns the candidates that add a dimension to those before them.
    fn independent_candidates(&self) -> Vec<usize> {
        let mut chosen: Vec<usize> = Vec::new();
        for candidate in 0..self.candidates.len() {
            let longer = [&chosen[..], &[candidate]].concat();
            if self.rank(&longer) == longer.len() {
                chosen = longer;
            }
        }
        chosen
    }

    /// Returns the number of dimensions that these candidates add to the set-up.
    fn rank(&self, of: &[usize]) -> usize {
        let columns: Vec<&Vec<f64>> = self.setup.iter().chain(of.iter().map(|i| &self.candidates[*i])).collect();
        let rows = columns[0].len();
        // Only singular values: nalgebra's decomposition with vectors fails on deficient rank (nalgebra#1172).
        let values = DMatrix::from_fn(rows, columns.len(), |i, j| columns[j][i]).singular_values();
        let limit = RANK_TOLERANCE * values.max();
        values.iter().filter(|value| **value > limit).count().saturating_sub(self.setup.len())
    }
}

/// Rotations act by mm per rad, translations by mm per mm: only the direction counts.
fn unit(column: Vec<f64>) -> Vec<f64> {
    let length = column.iter().map(|x| x * x).sum::<f64>().sqrt();
    let scale = if length > 1e-9 { 1.0 / length } else { 0.0 };
    column.into_iter().map(|x| x * scale).collect()
}
