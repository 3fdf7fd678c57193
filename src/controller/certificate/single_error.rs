//! The residual of every error alone with a target's tables.
//!
//! Tables for single errors are handed in. They are replayed like those of the set, on a machine with the one error,
//! and judged by the general algebra.

use super::depth::LatticeSubset;
use super::figures::approaches;
use crate::algebra::Htm;
use crate::compensation::{CorrectionTable, CorrectionTables, LatticeCells, SingleErrorTables, SingleErrors};
use crate::controller::manifest::ControllerTarget;
use crate::controller::replay::Replay;
use crate::evaluate::{Deviation, Statistics, command_deviation};
use crate::lower::NominalPose;
use crate::machine::{ErrorId, Machine, OperatingPoint, Pose};
use rayon::prelude::*;

/// Degree to which a target compensates one error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum CompensationDegree {
    /// The residual is at most a twentieth of the error's effect, or 0.05 um.
    Fully,
    /// The residual is above that, and below nineteen twentieths.
    Partly,
    /// The residual is at least nineteen twentieths.
    No,
}

/// An error in a certificate.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
#[schemars(rename = "CertifiedError")]
pub struct SingleErrorResidual {
    /// The error.
    #[serde(skip)]
    pub error: ErrorId,
    /// Degree to which the files correct it.
    #[serde(rename = "handled")]
    pub degree: CompensationDegree,
    /// 95 % position deviation that the files leave of it alone, um.
    #[serde(rename = "left_um")]
    pub residual_um: f64,
    /// The same without the files, um.
    pub alone_um: f64,
}

/// A pose with the place of the nominal tool at it, which is the same for every single error.
pub(super) struct NominalAt<'a> {
    pub pose: &'a Pose,
    nominal: Htm<f64>,
}

pub(super) fn nominal<'a>(machine: &Machine, poses: &'a [Pose]) -> Vec<NominalAt<'a>> {
    let at = |pose: &'a Pose| NominalAt { pose, nominal: NominalPose::at(machine, pose).pose };
    poses.par_iter().map(at).collect()
}

/// Judges one error: `machine` has no other one, and `added` returns the correction of its controller at a pose, given
/// with its number.
pub(super) fn judge_one(
    error: ErrorId,
    machine: &Machine,
    poses: &[NominalAt],
    added: impl Fn(usize, &OperatingPoint<'_>) -> Vec<f64>,
) -> SingleErrorResidual {
    let (mut alone_um, mut residual_um) = (0.0_f64, 0.0_f64);
    for approach in approaches(machine) {
        let at = |(number, place): (usize, &NominalAt)| {
            let sent = |command: &[f64]| command_deviation(machine, &place.nominal, &approach.at_pose(command));
            let before = sent(place.pose);
            let steps = added(number, &approach.at_pose(place.pose));
            if steps.iter().all(|step| *step == 0.0) {
                return (before, before);
            }
            let command: Vec<f64> = place.pose.iter().zip(&steps).map(|(q, step)| q + step).collect();
            (before, sent(&command))
        };
        let (before, after): (Vec<Deviation>, Vec<Deviation>) = poses.iter().enumerate().map(at).unzip();
        alone_um = alone_um.max(Statistics::of(&before).position_um.p95);
        residual_um = residual_um.max(Statistics::of(&after).position_um.p95);
    }
    verdict(error, alone_um, residual_um)
}

/// A set of tables whose single errors are judged.
#[derive(Clone, Copy)]
pub(super) struct SetOfTables<'a> {
    pub machine: &'a Machine,
    pub target: &'a ControllerTarget,
    pub tables: &'a CorrectionTables,
    pub single_errors: &'a SingleErrors,
    /// The fraction of a section at which tables step; none for straight lines.
    pub step_at: Option<f64>,
}

impl SetOfTables<'_> {
    /// Returns the residual of every error, and the number of poses it is computed on.
    pub fn judge(&self, poses: &[Pose]) -> (Vec<SingleErrorResidual>, usize) {
        match (self.single_errors, &self.tables.tables[..]) {
            (SingleErrors::Lattice(cells), [lattice]) => {
                let replay = Replay::new(self.machine, self.target, self.tables);
                let poses = &poses[..LatticeSubset::of(&replay, poses).poses];
                let cells = ErrorCells { lattice, replay: &replay, cells };
                (cells.judge(self.machine, &nominal(self.machine, poses)), poses.len())
            }
            // Cells of a lattice that the set does not have.
            (SingleErrors::Lattice(_), _) => (Vec::new(), 0),
            (SingleErrors::Tables(sets), _) => {
                let poses = nominal(self.machine, poses);
                (sets.par_iter().map(|set| self.judge_set(set, &poses)).collect(), poses.len())
            }
        }
    }

    fn judge_set(&self, set: &SingleErrorTables, poses: &[NominalAt]) -> SingleErrorResidual {
        let alone = self.machine.filtered(|id| *id == set.error);
        // Nearly all tables of a single error are zero, and add nothing.
        let tables = set.tables.tables.iter().filter(|table| !is_zero(table)).cloned().collect();
        let tables = CorrectionTables { tables, ..set.tables.clone() };
        let replay = Replay::new(&alone, self.target, &tables);
        let replay = self.step_at.into_iter().fold(replay, Replay::stepping_at);
        judge_one(set.error.clone(), &alone, poses, |_, at| replay.addition(at))
    }
}

fn is_zero(table: &CorrectionTable) -> bool {
    table.values.iter().chain(table.reverse.iter().flatten()).all(|value| *value == 0.0)
}

/// Parts of a lattice for single errors.
struct ErrorCells<'a> {
    lattice: &'a CorrectionTable,
    replay: &'a Replay<'a>,
    cells: &'a LatticeCells,
}

/// Corners of a cell: where a node is among those filled, with its weight.
type Corners = Vec<(usize, f64)>;

impl ErrorCells<'_> {
    fn judge(&self, machine: &Machine, poses: &[NominalAt]) -> Vec<SingleErrorResidual> {
        let axes = machine.axes().len();
        let corners: Vec<Corners> = poses.iter().map(|place| self.corners(place.pose)).collect();
        let one = |(error, values): &(ErrorId, Vec<f64>)| {
            let alone = machine.filtered(|id| id == error);
            judge_one(error.clone(), &alone, poses, |number, _| self.addition(axes, &corners[number], values))
        };
        self.cells.errors.par_iter().map(one).collect()
    }

    /// Nodes that nobody filled add nothing: the residual shows it.
    fn corners(&self, pose: &[f64]) -> Corners {
        let place = |(node, weight)| Some((self.cells.nodes.binary_search(&node).ok()?, weight));
        self.replay.lattice_corners(pose).into_iter().filter_map(place).collect()
    }

    fn addition(&self, axes: usize, corners: &Corners, values: &[f64]) -> Vec<f64> {
        let mut added = vec![0.0; axes];
        for (place, weight) in corners {
            let row = &values[place * self.lattice.corrected.len()..];
            self.lattice.corrected.iter().zip(row).for_each(|(axis, value)| added[*axis] += weight * value);
        }
        added
    }
}

impl SingleErrorResidual {
    /// Judges a residual, um.
    pub(in crate::controller) fn new(error: ErrorId, alone_um: f64, residual_um: f64) -> Self {
        verdict(error, alone_um, residual_um)
    }
}

fn verdict(error: ErrorId, alone_um: f64, residual_um: f64) -> SingleErrorResidual {
    const NOTHING: f64 = 0.05;
    let degree = if residual_um <= (0.05 * alone_um).max(NOTHING) {
        CompensationDegree::Fully
    } else if residual_um >= 0.95 * alone_um {
        CompensationDegree::No
    } else {
        CompensationDegree::Partly
    };
    SingleErrorResidual { error, degree, alone_um, residual_um }
}
