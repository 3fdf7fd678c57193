//! The certificate: what is left after the controller has applied the files just written.
//!
//! The poses are spread over the volume from a seed and are no table points. Where forward and reverse
//! curves were given the worse of the two directions counts, for single errors too. What is left of one is the
//! 95 % deviation of a machine with that error alone and with tables made for it alone, replayed like
//! the real ones; on a lattice to first order (relative difference about 1e-4).

use crate::compensation::{
    Correction, CorrectionTable, CorrectionTables, Jacobian, Reference, Scope, Spacing, TableRules, own_axis_wanted,
    single_error_tables,
};
use crate::controller::manifest::ControllerTarget;
use crate::controller::replay::{Compensated, Replay};
use crate::evaluate::{
    Bare, Columns, Deviation, Field, Order, PoseColumns, Statistics, Summary, error_by_error, random_poses,
    tool_axis_tilt,
};
use crate::machine::{Approach, Axis, AxisKind, ErrorId, ErrorTerm, Machine, Pose};
use nalgebra::Vector3;
use rayon::prelude::*;

/// How much of one error a target takes away.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Handled {
    /// At most a twentieth of it, or 0.05 um, is left.
    Fully,
    /// Something between.
    Partly,
    /// At least nineteen twentieths of it are left.
    No,
}

/// One error in the certificate.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorLeft {
    /// Which.
    pub error: ErrorId,
    /// How much is taken away.
    pub handled: Handled,
    /// 95 % position deviation with this error alone, uncompensated, um.
    pub alone: f64,
    /// The same after compensation, um.
    pub left: f64,
}

/// What a field comes to over the poses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// Position (um) and orientation (urad).
    pub all: Statistics,
    /// Tilt of the tool axis alone, urad.
    pub tool_axis: Summary,
}

/// What is left, over the volume and error by error.
#[derive(Debug, Clone)]
pub struct Certificate {
    /// Over how many poses.
    pub poses: usize,
    /// The direction of approach that is worse after compensation.
    pub approach: Approach,
    /// Without the files.
    pub uncompensated: Figures,
    /// With them.
    pub compensated: Figures,
    /// Error by error.
    pub errors: Vec<ErrorLeft>,
    /// What is added with all axes at 0, approaching forward and reverse (mm, deg).
    pub at_reference: [Vec<f64>; 2],
    /// What a new reference position would take away besides, where tables must vanish at it.
    pub shifted: Option<ZeroShift>,
    /// What is larger with the files than without them.
    pub raised: Vec<RaisedFigure>,
    /// The entry by which the sign is best tested; none if nothing is corrected.
    pub strongest: Option<Strongest>,
}

/// A figure of the position deviation that the files make worse.
#[derive(Debug, Clone, PartialEq)]
pub struct RaisedFigure {
    /// Approaching from this side.
    pub approach: Approach,
    /// Which.
    pub figure: &'static str,
    /// Without the files, um.
    pub before: f64,
    /// With them, um.
    pub after: f64,
}

/// Below this (um) a deviation is rounding, and a comparison says nothing.
pub const ROUNDING_UM: f64 = 1e-3;

/// Is a deviation (um) larger than another one by more than rounding?
pub(crate) fn is_worse(before: f64, after: f64) -> bool {
    after > before * 1.001 + ROUNDING_UM
}

/// What a set raises of the position deviation, approaching from one side.
pub(crate) fn raised(approach: Approach, before: &Figures, after: &Figures) -> Vec<RaisedFigure> {
    let (before, after) = (before.all.position_um, after.all.position_um);
    let figures = [("95 %", before.p95, after.p95), ("rms", before.rms, after.rms), ("max", before.max, after.max)];
    let worse = figures.into_iter().filter(|(_, before, after)| is_worse(*before, *after));
    worse.map(|(figure, before, after)| RaisedFigure { approach, figure, before, after }).collect()
}

/// Tables that vanish at the reference position leave a constant part of the deviation: a shift of the
/// machine zero takes it away.
#[derive(Debug, Clone, PartialEq)]
pub struct ZeroShift {
    /// What to add to the zero of each axis (mm, deg).
    pub shift: Vec<f64>,
    /// What is then left of the position, um.
    pub position_um: Summary,
    /// What the best shift alone would leave, without tables, um.
    pub alone_um: Summary,
}

impl ZeroShift {
    /// Are the tables worth having where the machine zero is set anew in any case?
    pub fn is_better(&self) -> bool {
        !is_worse(self.alone_um.rms, self.position_um.rms)
    }
}

/// Shifts of the axes' zeros (mm, deg) and what they leave: of a rotary axis against the mean of its own error, of the
/// linear ones the mean of the corrections that are wanted then. `added` is what the controller adds to a command.
fn best_shift(
    field: &dyn Field,
    poses: &[Pose],
    approach: Approach,
    added: impl Fn(&Pose) -> Vec<f64>,
) -> (Vec<f64>, Summary) {
    let machine = field.machine();
    let count = poses.len() as f64;
    let mut shift = vec![0.0; machine.axes().len()];
    for pose in poses {
        for ((axis, q), c) in pose.iter().enumerate().zip(added(pose)) {
            if machine.axes()[axis].kind == AxisKind::Rotary {
                shift[axis] += own_axis_wanted(machine, axis, (q + c, *q), approach) / count;
            }
        }
    }
    let jacobians: Vec<Jacobian> = poses.iter().map(|pose| Jacobian::at(machine, pose)).collect();
    let turned = Correction(shift.clone());
    let left = deviations(field, poses, approach).into_iter().zip(&jacobians);
    let left: Vec<Deviation> =
        left.map(|(d, j)| Deviation { position: d.position + j.displacement(&turned), ..d }).collect();
    let mut moved = Correction::none(machine);
    for (jacobian, deviation) in jacobians.iter().zip(&left) {
        let Correction(wanted) = jacobian.correction(deviation, &Correction::none(machine), Scope::POSITION);
        moved.0.iter_mut().zip(wanted).for_each(|(s, w)| *s += w / count);
    }
    let after: Vec<Vector3<f64>> =
        jacobians.iter().zip(&left).map(|(j, d)| (d.position + j.displacement(&moved)) * 1000.0).collect();
    shift.iter_mut().zip(&moved.0).for_each(|(s, m)| *s += m);
    (shift, Summary::of(&after))
}

/// What is judged.
#[derive(Debug, Clone, Copy)]
pub struct JudgedTables<'a> {
    /// The controller.
    pub target: &'a ControllerTarget,
    /// Its tables.
    pub tables: &'a CorrectionTables,
    /// The tables that were in force when the machine was measured, of the same controller.
    pub installed: Option<&'a CorrectionTables>,
}

/// Compares the machine with and without tables on `count` seeded poses.
pub fn certify(machine: &Machine, judged: JudgedTables, scope: Scope, count: usize, seed: u64) -> Certificate {
    let JudgedTables { target, tables, installed } = judged;
    let mechanisms = &target.manifest.mechanism;
    let poses: Vec<Pose> = random_poses(machine, count, seed);
    let bare = Bare { machine, order: Order::Exact };
    let load = |tables| Replay::new(machine, target, tables);
    let compensated = Compensated { machine, replay: load(tables).over(installed.map(load)) };
    let Judgement { approach, uncompensated, compensated: left, raised } = judge(&bare, &compensated, &poses);
    let zero = vec![0.0; machine.axes().len()];
    let fixed = |rules: &TableRules| rules.reference == Reference::Zero || rules.spacing == Spacing::Line;
    let vanishing = mechanisms.iter().any(|(_, rules)| fixed(rules));
    let shifted = || {
        let (shift, position_um) =
            best_shift(&compensated, &poses, approach, |pose| compensated.replay.added(pose, approach));
        let nothing = |pose: &Pose| vec![0.0; pose.len()];
        ZeroShift { shift, position_um, alone_um: best_shift(&bare, &poses, approach, nothing).1 }
    };
    let replay = load(tables);
    let added = |pose: &Pose, approach: Approach| replay.added(pose, approach);
    let strongest = if tables.errors.is_empty() {
        let peaks: Vec<Pose> = tables.peaks().map(|peak| pose_at(machine, &peak)).collect();
        strongest_of(machine, (&peaks, approaches(machine)), added)
    } else {
        strongest_at(machine, (&poses, approaches(machine)), added)
    };
    let single = Singles { machine, target, poses: &poses[..poses.len().min(MAX_SINGLE_POSES)], scope };
    Certificate {
        poses: count,
        approach,
        uncompensated,
        compensated: left,
        errors: single.errors(tables),
        at_reference: [Approach::Forward, Approach::Reverse].map(|a| load(tables).added(&zero, a)),
        shifted: vanishing.then(shifted),
        raised,
        strongest,
    }
}

/// Without and with a set of files, in the direction of approach that is worse with them, and what they raise in either.
pub(crate) struct Judgement {
    pub approach: Approach,
    pub uncompensated: Figures,
    pub compensated: Figures,
    pub raised: Vec<RaisedFigure>,
}

/// Compares a machine without and with files.
pub(crate) fn judge(bare: &dyn Field, with: &dyn Field, poses: &[Pose]) -> Judgement {
    let one = |approach: Approach| {
        let (uncompensated, compensated) = (figures(bare, poses, approach), figures(with, poses, approach));
        Judgement { approach, raised: raised(approach, &uncompensated, &compensated), uncompensated, compensated }
    };
    let p95 = |judgement: &Judgement| judgement.compensated.all.position_um.p95;
    let (mut worse, mut raised) = (None, Vec::new());
    for mut judgement in approaches(bare.machine()).iter().map(|approach| one(*approach)) {
        raised.append(&mut judgement.raised);
        if worse.as_ref().is_none_or(|known| p95(&judgement) > p95(known)) {
            worse = Some(judgement);
        }
    }
    Judgement { raised, ..worse.unwrap_or_else(|| one(Approach::Mean)) }
}

/// Where the sign is best tested: the largest motion of a linear axis (of any axis if there is none).
#[derive(Debug, Clone, PartialEq)]
pub struct Strongest {
    /// Index of the axis that is moved.
    pub axis: usize,
    /// The pose (mm, deg).
    pub at: Pose,
    /// How it is approached.
    pub approach: Approach,
    /// What is added there in all (mm or deg).
    pub value: f64,
}

/// Below this (mm, deg) what is added is rounding: a kinematics module computes where a table has zeros.
const ROUNDING: f64 = 1e-10;

/// Of some poses and the directions they are approached in, that with the largest motion.
fn strongest_of(
    machine: &Machine,
    (poses, ways): (&[Pose], &[Approach]),
    added: impl Fn(&Pose, Approach) -> Vec<f64>,
) -> Option<Strongest> {
    let linear = |axis: usize| machine.axes()[axis].kind == AxisKind::Linear;
    // Of equal ones the last is taken: one that is approached forward.
    let ways = ways.iter().rev();
    let entries = ways.flat_map(|approach| poses.iter().map(|pose| (*approach, pose))).flat_map(|(approach, at)| {
        let values = added(at, approach).into_iter().enumerate().filter(|(_, value)| value.abs() > ROUNDING);
        values.map(|(axis, value)| Strongest { axis, at: at.clone(), approach, value }).collect::<Vec<_>>()
    });
    let order = |s: &Strongest| (linear(s.axis), s.value.abs());
    entries.max_by(|a, b| order(a).0.cmp(&order(b).0).then(order(a).1.total_cmp(&order(b).1)))
}

/// Of what is not in tables: with the rotary axes at 0, where an instrument along a linear axis reads it, or elsewhere if
/// there is none.
pub(crate) fn strongest_at(
    machine: &Machine,
    (poses, ways): (&[Pose], &[Approach]),
    added: impl Fn(&Pose, Approach) -> Vec<f64>,
) -> Option<Strongest> {
    let linear = |axis: usize| machine.axes()[axis].kind == AxisKind::Linear;
    let level = |pose: &Pose| -> Pose {
        pose.iter().enumerate().map(|(axis, q)| if linear(axis) { *q } else { 0.0 }).collect()
    };
    let within = |pose: &Pose| machine.beyond_travel(pose).next().is_none();
    let with_linear = |found: &Strongest| linear(found.axis);
    let leveled: Vec<Pose> = poses.iter().map(level).filter(within).collect();
    let found = strongest_of(machine, (&leveled, ways), &added).filter(with_linear);
    found.or_else(|| strongest_of(machine, (poses, ways), &added))
}

/// Some axes at positions, the others at 0, or as near to them as they come: tables may reach beyond the travel.
fn pose_at(machine: &Machine, at: &[(usize, f64)]) -> Pose {
    let near = |(i, axis): (usize, &Axis)| {
        let wanted = at.iter().find(|(axis, _)| *axis == i).map_or(0.0, |(_, q)| *q);
        let (min, max) = axis.travel.interval();
        wanted.max(min).min(max)
    };
    machine.axes().iter().enumerate().map(near).collect()
}

/// The directions of approach that can differ.
pub(crate) fn approaches(machine: &Machine) -> &'static [Approach] {
    if machine.is_bidirectional() { &[Approach::Forward, Approach::Reverse] } else { &[Approach::Mean] }
}

/// The 95 % position deviation (um), in the direction of approach where it is larger.
pub(crate) fn worse_p95(machine: &Machine, of: impl Fn(Approach) -> Vec<Deviation>) -> f64 {
    approaches(machine).iter().map(|approach| Statistics::of(&of(*approach)).position_um.p95).fold(0.0, f64::max)
}

/// Poses for the figures of single errors: every one costs a cell of the lattice.
pub(crate) const MAX_SINGLE_POSES: usize = 200;

/// Poses that are evaluated at once.
const BLOCK: usize = 256;

pub(crate) fn deviations(field: &dyn Field, poses: &[Pose], approach: Approach) -> Vec<Deviation> {
    let axes = field.machine().axes().len();
    let block = |poses: &[Pose]| {
        let mut columns = Columns::new(poses.len());
        let at = PoseColumns::of(axes, poses.iter().map(Vec::as_slice));
        field.deviations(&at.batch(), approach, columns.output(poses.len()));
        (0..poses.len()).map(|i| columns.get(i)).collect::<Vec<_>>()
    };
    poses.par_chunks(BLOCK).flat_map_iter(block).collect()
}

pub(crate) fn figures(field: &dyn Field, poses: &[Pose], approach: Approach) -> Figures {
    let deviations = deviations(field, poses, approach);
    let tilt = |(pose, d): (&Pose, &Deviation)| tool_axis_tilt(field.machine(), pose, &d.rotation) * 1e6;
    let tilts: Vec<_> = poses.iter().zip(&deviations).map(tilt).collect();
    Figures { all: Statistics::of(&deviations), tool_axis: Summary::of(&tilts) }
}

/// The deviation of every error alone, before and after compensation.
type EachError = Vec<(Deviation, Deviation)>;

/// The single-error part of a certificate.
struct Singles<'a> {
    machine: &'a Machine,
    target: &'a ControllerTarget,
    poses: &'a [Pose],
    scope: Scope,
}

impl Singles<'_> {
    fn errors(&self, tables: &CorrectionTables) -> Vec<ErrorLeft> {
        match &tables.tables[..] {
            // A lattice over all axes: only the cells around the poses are worth solving.
            [lattice] if self.target.manifest.mechanism.lattice.as_ref().is_some_and(|r| r.inputs.is_empty()) => {
                self.on_lattice(lattice, tables)
            }
            [] if !tables.errors.is_empty() => self.by_model(tables),
            _ => self.by_tables(tables),
        }
    }

    /// Errors with a value (tolerances have none), with their numbers among all.
    fn known(&self) -> impl Iterator<Item = (usize, ErrorId)> {
        let all = self.machine.errors().enumerate();
        all.filter(|(_, (_, term))| !matches!(term, ErrorTerm::Tolerance(_))).map(|(index, (id, _))| (index, id))
    }

    /// Tables for every error alone, replayed on a machine with that error alone.
    fn by_tables(&self, tables: &CorrectionTables) -> Vec<ErrorLeft> {
        let sets = single_error_tables(self.machine, &self.target.manifest.mechanism, tables);
        let known: Vec<(usize, ErrorId)> = self.known().collect();
        known.into_par_iter().map(|(index, error)| self.replayed(error, &sets[index].1)).collect()
    }

    /// The curves of every error alone.
    fn by_model(&self, tables: &CorrectionTables) -> Vec<ErrorLeft> {
        let known: Vec<(usize, ErrorId)> = self.known().collect();
        let alone = |(_, error): (usize, ErrorId)| {
            let errors = tables.errors.iter().filter(|curve| curve.error == error).cloned().collect();
            self.replayed(error, &CorrectionTables { errors, tables: Vec::new() })
        };
        known.into_par_iter().map(alone).collect()
    }

    fn replayed(&self, error: ErrorId, tables: &CorrectionTables) -> ErrorLeft {
        let machine = self.machine.filtered(|id| *id == error);
        let replay = Replay::new(&machine, self.target, tables);
        let compensated = Compensated { machine: &machine, replay };
        let p95 = |field: &dyn Field| worse_p95(&machine, |approach| deviations(field, self.poses, approach));
        verdict(error, p95(&Bare { machine: &machine, order: Order::Exact }), p95(&compensated))
    }

    /// All errors at once: they are independent to first order, and only the cells around the poses count.
    fn on_lattice(&self, lattice: &CorrectionTable, tables: &CorrectionTables) -> Vec<ErrorLeft> {
        let replay = Replay::new(self.machine, self.target, tables);
        let rows: Vec<Vec<EachError>> =
            self.poses.par_iter().map(|pose| self.each_error_left(lattice, &replay, pose)).collect();
        let p95 = |index: usize, pick: fn(&(Deviation, Deviation)) -> Deviation| {
            let columns = 0..approaches(self.machine).len();
            let column = |way: usize| rows.iter().map(|row| pick(&row[way][index])).collect::<Vec<_>>();
            columns.map(|way| Statistics::of(&column(way)).position_um.p95).fold(0.0, f64::max)
        };
        self.known()
            .map(|(index, error)| verdict(error, p95(index, |both| both.0), p95(index, |both| both.1)))
            .collect()
    }

    /// For every direction of approach and every error alone: the deviation at a pose before and after compensation.
    fn each_error_left(&self, lattice: &CorrectionTable, replay: &Replay, pose: &[f64]) -> Vec<EachError> {
        let mut added = vec![vec![0.0; pose.len()]; self.machine.errors().count()];
        let scope = self.scope(lattice);
        for (node, weight) in replay.lattice_corners(pose) {
            let place = lattice.pose(self.machine, node);
            let jacobian = Jacobian::at(self.machine, &place);
            for (sum, (_, deviation)) in added.iter_mut().zip(error_by_error(self.machine, &place, Approach::Mean)) {
                let Correction(step) = jacobian.correction(&deviation, &Correction::none(self.machine), scope);
                lattice.corrected.iter().for_each(|axis| sum[*axis] += weight * step[*axis]);
            }
        }
        let jacobian = Jacobian::at(self.machine, pose);
        let moved: Vec<_> = added.into_iter().map(|added| jacobian.displacement(&Correction(added))).collect();
        let after = |((_, deviation), moved): ((ErrorId, Deviation), &Vector3<f64>)| {
            let position = deviation.position + moved;
            (deviation, Deviation { position, rotation: deviation.rotation })
        };
        let from = |approach: &Approach| {
            error_by_error(self.machine, pose, *approach).into_iter().zip(&moved).map(after).collect()
        };
        approaches(self.machine).iter().map(from).collect()
    }

    /// What the tables correct: without rotary columns, the rotary axes were left alone.
    fn scope(&self, lattice: &CorrectionTable) -> Scope {
        let rotary = lattice.corrected.iter().any(|axis| self.machine.axes()[*axis].kind == AxisKind::Rotary);
        Scope { rotary, ..self.scope }
    }
}

pub(crate) fn verdict(error: ErrorId, alone: f64, left: f64) -> ErrorLeft {
    const NOTHING: f64 = 0.05;
    let handled = if left <= (0.05 * alone).max(NOTHING) {
        Handled::Fully
    } else if left >= 0.95 * alone {
        Handled::No
    } else {
        Handled::Partly
    };
    ErrorLeft { error, handled, alone, left }
}

/// Returns how many um are in a mm, or urad in a deg, and the name of the small unit.
pub fn micro(kind: AxisKind) -> (f64, &'static str) {
    match kind {
        AxisKind::Linear => (1e3, "um"),
        AxisKind::Rotary => (1f64.to_radians() * 1e6, "urad"),
    }
}
