//! The reference: the rigid motion g of the part that its set-up takes out of the deviations.
//!
//! g is linear in the deviations of the functional point at some reference points, each with a gain
//! ([`PartReference`]), so it is taken from the effect of every error before any statistic: position d - (t + w x p),
//! orientation deviation - w, with p the place of the functional point on the part. With the exact model g is a finite
//! motion: it is the one whose removal leaves deviations of which the linear g is zero. Vectors are in the unturned
//! workpiece frame, from the workpiece origin.
//!
//! For a minimum zone g is not linear: it is that of all deviations together, and single errors have none
//! ([`PartReference::is_linear`]).

use super::minimum_zone::RigidZone;
use crate::algebra::linear::{Svd, beside};
use crate::algebra::{exp_hat, rotation_vector};
use crate::evaluate::{Batch, Columns, Deviation, Field, Order, Output, error_by_error};
use crate::lower::NominalPose;
use crate::machine::{ErrorId, Machine, OperatingConditions, OperatingPoint, Pose, UnheldMotion};
use nalgebra::{DMatrix, DVector, Matrix3, Matrix6x3, SymmetricEigen, Vector3, Vector6};
use rayon::prelude::*;

/// Below this part of the largest, a direction of the points does not determine a rotation.
const RANK: f64 = 1e-9;

/// Below this ratio of singular values, in units of the size of the part, six datum points do not determine a motion.
const DATUM_RANK: f64 = 1e-4;

/// A finite motion of a minimum zone stands once another lowers the largest deviation by less than this part.
const GAINED: f64 = 1e-9;

/// Maximum number of iterations for a finite motion; errors are small, so three or four do.
const MAX_ITERATIONS: usize = 20;

/// A small rigid motion of the part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidMotion {
    /// Translation t of the workpiece origin, mm.
    pub translation: Vector3<f64>,
    /// Rotation vector w, rad.
    pub rotation: Vector3<f64>,
    /// True if it is a finite motion, false if it is of first order.
    finite: bool,
}

impl RigidMotion {
    fn linear(of: &Vector6<f64>) -> Self {
        let [translation, rotation] = [of.fixed_rows::<3>(0).into_owned(), of.fixed_rows::<3>(3).into_owned()];
        Self { translation, rotation, finite: false }
    }

    /// Returns a deviation (mm, rad) at a place `tip` of the part (mm) without the motion.
    pub fn removed_from(&self, deviation: &Deviation, tip: &Vector3<f64>) -> Deviation {
        let Self { translation, rotation, finite } = *self;
        if !finite {
            let position = deviation.position - translation - rotation.cross(tip);
            return Deviation { position, rotation: deviation.rotation - rotation };
        }
        let back = exp_hat(&(-rotation).into());
        let position = back * (deviation.position - translation) + (back * tip - tip);
        Deviation { position, rotation: rotation_after(&-rotation, &deviation.rotation) }
    }
}

/// Returns the rotation vector of a small rotation that is followed by another.
fn rotation_after(second: &Vector3<f64>, first: &Vector3<f64>) -> Vector3<f64> {
    rotation_vector(&(exp_hat(&(*second).into()) * exp_hat(&(*first).into())))
}

/// A reference point: where deviations of the functional point make the motion.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferencePoint {
    /// The pose of the machine there (mm, deg).
    pub pose: Pose,
    /// The functional point there, mm.
    pub tip: Vector3<f64>,
    /// Translation and rotation of the motion per mm of deviation.
    pub gain: Matrix6x3<f64>,
}

/// The motion that the set-up of a part takes out on a machine: a function of deviations at reference points, linear
/// but for the minimum zone.
#[derive(Debug, Clone, PartialEq)]
pub struct PartReference {
    points: Vec<ReferencePoint>,
    /// The minimum zone over the points, in place of their gains.
    zone: Option<RigidZone>,
}

/// Datum points that do not determine the part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DatumRank {
    /// Number of motions that they determine, fewer than 6.
    pub rank: usize,
}

impl PartReference {
    /// Returns the zero of a part that is probed at one pose (mm, deg): three translations.
    pub fn zero(machine: &Machine, pose: Pose) -> Self {
        let tip = tip_at(machine, &pose);
        let gain = gain(&tip, Matrix3::identity(), Matrix3::zeros());
        Self { points: vec![ReferencePoint { pose, tip, gain }], zone: None }
    }

    /// Returns the zero probed at the first pose with the rotation about an axis (unit vector) that a second point
    /// gives; `None` if the second point lies on the axis through the first.
    pub fn aligned_zero(machine: &Machine, [first, second]: [Pose; 2], axis: &Vector3<f64>) -> Option<Self> {
        let [from, to] = [&first, &second].map(|pose| tip_at(machine, pose));
        let lever = axis.cross(&(to - from));
        let square = lever.norm_squared();
        if square <= f64::EPSILON * (to - from).norm_squared() || square == 0.0 {
            return None;
        }
        let turn = axis * lever.transpose() / square;
        let point = |pose: Pose, tip: Vector3<f64>, translation: Matrix3<f64>, turn: Matrix3<f64>| ReferencePoint {
            pose,
            tip,
            gain: gain(&from, translation, turn),
        };
        let points = vec![point(first, from, Matrix3::identity(), -turn), point(second, to, Matrix3::zeros(), turn)];
        Some(Self { points, zone: None })
    }

    /// Returns the frame of six datum points, 3-2-1, each probed along its normal (unit vector) at a pose (mm, deg).
    pub fn datum(machine: &Machine, poses: Vec<Pose>, normals: &[Vector3<f64>]) -> Result<Self, DatumRank> {
        let tips: Vec<Vector3<f64>> = poses.iter().map(|pose| tip_at(machine, pose)).collect();
        let centre = tips.iter().sum::<Vector3<f64>>() / tips.len().max(1) as f64;
        let size = tips.iter().map(|tip| (tip - centre).norm()).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        let row = |i: usize, k: usize| {
            if k < 3 { normals[i][k] } else { ((tips[i] - centre) / size).cross(&normals[i])[k - 3] }
        };
        let matrix = DMatrix::from_fn(tips.len(), 6, row);
        let sizes = matrix.singular_values();
        let rank = sizes.iter().filter(|size| **size > DATUM_RANK * sizes.max()).count();
        let inverse = (rank == 6 && tips.len() == 6).then(|| matrix.full_piv_lu().try_inverse()).flatten();
        let Some(inverse) = inverse else { return Err(DatumRank { rank: rank.min(5) }) };
        let point = |(i, (pose, tip)): (usize, (Pose, Vector3<f64>))| {
            let column = |first: usize, scale: f64| Vector3::from_fn(|k, _| inverse[(first + k, i)] / scale);
            let normal = normals[i].transpose();
            ReferencePoint { pose, tip, gain: gain(&centre, column(0, 1.0) * normal, column(3, size) * normal) }
        };
        Ok(Self { points: poses.into_iter().zip(tips).enumerate().map(point).collect(), zone: None })
    }

    /// Returns the best fit over poses (mm, deg): the motion that leaves the least sum of squared position deviations.
    /// A rotation that the places do not determine is zero.
    pub fn best_fit(machine: &Machine, poses: &[Pose]) -> Self {
        let tips: Vec<Vector3<f64>> = poses.par_iter().map(|pose| tip_at(machine, pose)).collect();
        let part = 1.0 / tips.len().max(1) as f64;
        let (centre, inertia) = moments(&tips);
        let inverse = pseudo_inverse(inertia);
        let point = |(pose, tip): (&Pose, Vector3<f64>)| {
            let turn = inverse * (tip - centre).cross_matrix();
            ReferencePoint { pose: pose.clone(), tip, gain: gain(&centre, Matrix3::identity() * part, turn) }
        };
        Self { points: poses.iter().zip(tips).map(point).collect(), zone: None }
    }

    /// Returns the part of the best fit over poses (mm, deg) that combines some rigid motions of the workpiece frame.
    /// A combination that the places do not determine is zero.
    pub fn part_of_best_fit(machine: &Machine, motions: &[UnheldMotion], poses: &[Pose]) -> Self {
        let tips: Vec<Vector3<f64>> = poses.par_iter().map(|pose| tip_at(machine, pose)).collect();
        let (centre, inertia) = moments(&tips);
        let size = (inertia.trace() / (2.0 * tips.len().max(1) as f64)).sqrt().max(f64::MIN_POSITIVE);
        let basis = centred_basis(motions, &centre, size);
        // Displacements of a place by each motion of the basis.
        let effect = |tip: &Vector3<f64>| -> DMatrix<f64> {
            let arm = (tip - centre) / size;
            DMatrix::from_fn(3, basis.ncols(), |i, k| {
                let column = basis.column(k);
                column[i] + Vector3::new(column[3], column[4], column[5]).cross(&arm)[i]
            })
        };
        let normal = tips.iter().fold(DMatrix::zeros(basis.ncols(), basis.ncols()), |sum, tip| {
            let effect = effect(tip);
            sum + effect.tr_mul(&effect)
        });
        let svd = Svd::new(&normal);
        let rank = svd.rank(RANK);
        let combined = &basis * svd.root_covariance(rank) * svd.v.columns(0, rank).transpose();
        let point = |(pose, tip): (&Pose, Vector3<f64>)| {
            let motion = &combined * effect(&tip).transpose();
            let three = |first: usize, scale: f64| Matrix3::from_fn(|i, k| motion[(first + i, k)] / scale);
            ReferencePoint { pose: pose.clone(), tip, gain: gain(&centre, three(0, 1.0), three(3, size)) }
        };
        Self { points: poses.iter().zip(tips).map(point).collect(), zone: None }
    }

    /// Returns what this reference, which takes all translations out, leaves of some rigid motions of the workpiece
    /// frame; none of those that it takes out.
    pub fn left_of(&self, motions: &[UnheldMotion]) -> Vec<UnheldMotion> {
        let turn = |of: &Vector6<f64>| of.fixed_rows::<3>(3).norm();
        let left = |motion: &UnheldMotion| {
            let whole = Vector6::from(motion.amounts());
            let left = whole - self.motion_by(&whole);
            // Without a rotation it is a translation, of which rounding is left.
            (turn(&left) > RANK * turn(&whole)).then(|| UnheldMotion::of(left.into()))
        };
        motions.iter().filter_map(left).collect()
    }

    /// Returns this reference and the part of the best fit over poses (mm, deg) that combines some rigid motions of
    /// which it takes nothing out. Applied again it takes nothing out.
    pub fn and_part_of_best_fit(self, machine: &Machine, motions: &[UnheldMotion], poses: &[Pose]) -> Self {
        let fit = Self::part_of_best_fit(machine, motions, poses);
        // The fit is of what is left.
        let own = self.points.into_iter().map(|point| {
            let fitted = [0, 1, 2].map(|k| fit.motion_by(&point.gain.column(k).into()));
            ReferencePoint { gain: point.gain - Matrix6x3::from_columns(&fitted), ..point }
        });
        Self { points: own.chain(fit.points.iter().cloned()).collect(), zone: None }
    }

    /// Returns the motion by a rigid motion of the workpiece frame (mm, rad), both of first order.
    fn motion_by(&self, motion: &Vector6<f64>) -> Vector6<f64> {
        let [translation, rotation] = [0, 3].map(|first| Vector3::from(motion.fixed_rows::<3>(first)));
        let by = |point: &ReferencePoint| point.gain * (translation + rotation.cross(&point.tip));
        self.points.iter().map(by).sum()
    }

    /// Returns the minimum zone over poses (mm, deg): the motion that leaves the smallest largest position deviation.
    /// A rotation that the places do not determine is zero.
    pub fn minimum_zone(machine: &Machine, poses: &[Pose]) -> Self {
        let fit = Self::best_fit(machine, poses);
        let tips: Vec<Vector3<f64>> = fit.points.iter().map(|point| point.tip).collect();
        let (centre, inertia) = moments(&tips);
        let (directions, inverse) = inverse_moments(inertia);
        let roots = directions * Matrix3::from_diagonal(&inverse.map(f64::sqrt));
        Self { zone: Some(RigidZone::new(&tips, centre, &roots)), ..fit }
    }

    /// True if its motion is linear in the deviations, so that effects of single errors have one.
    pub fn is_linear(&self) -> bool {
        self.zone.is_none()
    }

    /// Returns the reference points.
    pub fn points(&self) -> &[ReferencePoint] {
        &self.points
    }

    /// Returns the motion of first order by deviations of the functional point (mm) at the reference points.
    pub fn motion(&self, positions: impl IntoIterator<Item = Vector3<f64>>) -> RigidMotion {
        if let Some(zone) = &self.zone {
            return RigidMotion::linear(&zone.fit(&positions.into_iter().collect::<Vec<_>>()).motion);
        }
        let sum = self.points.iter().zip(positions).fold(Vector6::zeros(), |sum, (point, d)| sum + point.gain * d);
        RigidMotion::linear(&sum)
    }

    /// Returns the finite motion by deviations of the functional point (mm) at the reference points. Of a minimum zone
    /// it is the one after which another would lower the largest deviation by less than a billionth.
    fn finite_motion(&self, positions: &[Vector3<f64>]) -> RigidMotion {
        let mut motion = RigidMotion { finite: true, ..self.motion(positions.iter().copied()) };
        let mut best = (motion, f64::INFINITY);
        for _ in 0..MAX_ITERATIONS {
            let left = self.points.iter().zip(positions).map(|(point, position)| {
                let deviation = Deviation { position: *position, rotation: Vector3::zeros() };
                motion.removed_from(&deviation, &point.tip).position
            });
            let left: Vec<Vector3<f64>> = left.collect();
            if self.zone.is_some() {
                let largest = left.iter().map(Vector3::norm).fold(0.0, f64::max);
                if largest >= best.1 * (1.0 - GAINED) {
                    return best.0;
                }
                best = (motion, largest);
            }
            let RigidMotion { translation, rotation, .. } = self.motion(left);
            // The motion is followed by what is left, on the part.
            motion.translation += exp_hat(&motion.rotation.into()) * translation;
            motion.rotation = rotation_after(&motion.rotation, &rotation);
            if translation.amax() <= 1e-12 && rotation.amax() <= 1e-15 {
                break;
            }
        }
        motion
    }

    /// Returns the motion by a field, finite if its errors are followed exactly.
    pub fn motion_of(&self, field: &dyn Field, order: Order, conditions: OperatingConditions) -> RigidMotion {
        let at = |point: &ReferencePoint| field.deviation(&conditions.at_pose(&point.pose)).position;
        let positions: Vec<Vector3<f64>> = self.points.par_iter().map(at).collect();
        match order {
            Order::Exact => self.finite_motion(&positions),
            Order::Degree(_) => self.motion(positions),
        }
    }
}

/// The effects of errors that have values, to first order, without what the set-up of the part takes out.
pub struct ErrorEffects<'a> {
    machine: &'a Machine,
    conditions: OperatingConditions,
    /// What is taken out of each; empty without a set-up.
    motions: Vec<RigidMotion>,
}

impl<'a> ErrorEffects<'a> {
    /// Returns the effects of the errors of a machine in some conditions; `None` if the motion of the reference is not
    /// linear, as single errors have none then.
    pub fn new(
        machine: &'a Machine,
        conditions: OperatingConditions,
        reference: Option<&PartReference>,
    ) -> Option<Self> {
        if reference.is_some_and(|of| !of.is_linear()) {
            return None;
        }
        let of = |reference: &PartReference| {
            let at = |point: &ReferencePoint| error_by_error(machine, &conditions.at_pose(&point.pose));
            let rows: Vec<_> = reference.points.par_iter().map(at).collect();
            let errors = 0..rows.first().map_or(0, Vec::len);
            errors.map(|i| reference.motion(rows.iter().map(|row| row[i].1.position))).collect()
        };
        Some(Self { machine, conditions, motions: reference.map_or_else(Vec::new, of) })
    }

    /// Returns the effects at a pose (mm, deg), in the order of [`Machine::errors`].
    pub fn at(&self, pose: &[f64]) -> Vec<(ErrorId, Deviation)> {
        let mut effects = error_by_error(self.machine, &self.conditions.at_pose(pose));
        if !self.motions.is_empty() {
            let tip = tip_at(self.machine, pose);
            effects.iter_mut().zip(&self.motions).for_each(|((_, d), motion)| *d = motion.removed_from(d, &tip));
        }
        effects
    }
}

/// Returns the place of the functional point on the part at a pose (mm, deg), unturned workpiece frame.
pub fn tip_at(machine: &Machine, pose: &[f64]) -> Vector3<f64> {
    NominalPose::at(machine, pose).pose.translation
}

/// Returns the gain of a motion that translates a point and turns about it.
fn gain(about: &Vector3<f64>, translation: Matrix3<f64>, turn: Matrix3<f64>) -> Matrix6x3<f64> {
    let at_origin = translation + about.cross_matrix() * turn;
    Matrix6x3::from_fn(|i, k| if i < 3 { at_origin[(i, k)] } else { turn[(i - 3, k)] })
}

/// Returns an orthonormal basis of rigid motions as translations of a point and rotations about it times a length.
fn centred_basis(motions: &[UnheldMotion], centre: &Vector3<f64>, size: f64) -> DMatrix<f64> {
    let mut basis: Vec<DVector<f64>> = Vec::new();
    for motion in motions {
        let rotation = Vector3::from(motion.rotation);
        let translation = Vector3::from(motion.translation) + rotation.cross(centre);
        let column = DVector::from_fn(6, |i, _| if i < 3 { translation[i] } else { rotation[i - 3] * size });
        let rest = beside(column.clone(), &basis);
        if rest.norm() > RANK * column.norm() {
            basis.push(rest.normalize());
        }
    }
    DMatrix::from_fn(6, basis.len(), |i, k| basis[k][i])
}

/// Returns the centre of places and their moment of inertia about it.
fn moments(tips: &[Vector3<f64>]) -> (Vector3<f64>, Matrix3<f64>) {
    let centre = tips.iter().sum::<Vector3<f64>>() * (1.0 / tips.len().max(1) as f64);
    let inertia = tips.iter().fold(Matrix3::zeros(), |sum, tip| {
        let arm = tip - centre;
        sum + Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()
    });
    (centre, inertia)
}

/// Returns the axes of a moment of inertia, and the inverse about each; zero where it does not determine a rotation.
fn inverse_moments(inertia: Matrix3<f64>) -> (Matrix3<f64>, Vector3<f64>) {
    let SymmetricEigen { eigenvectors, eigenvalues } = inertia.symmetric_eigen();
    let least = RANK * eigenvalues.max();
    (eigenvectors, eigenvalues.map(|value| if value > least { 1.0 / value } else { 0.0 }))
}

/// Returns the inverse of a moment of inertia on the axes that it determines.
fn pseudo_inverse(inertia: Matrix3<f64>) -> Matrix3<f64> {
    let (axes, inverse) = inverse_moments(inertia);
    axes * Matrix3::from_diagonal(&inverse) * axes.transpose()
}

/// A field without a motion of the part.
pub struct ReferencedField<'a> {
    field: &'a dyn Field,
    motion: RigidMotion,
}

impl<'a> ReferencedField<'a> {
    /// Returns the field without what the set-up of the part takes out in some conditions.
    pub fn new(field: &'a dyn Field, reference: &PartReference, order: Order, conditions: OperatingConditions) -> Self {
        Self { field, motion: reference.motion_of(field, order, conditions) }
    }
}

impl Field for ReferencedField<'_> {
    fn machine(&self) -> &Machine {
        self.field.machine()
    }

    fn deviation(&self, at: &OperatingPoint<'_>) -> Deviation {
        self.motion.removed_from(&self.field.deviation(at), &tip_at(self.field.machine(), at.axes))
    }

    fn deviations(&self, poses: &Batch<'_>, conditions: OperatingConditions, mut out: Output<'_>) {
        let mut columns = Columns::new(out.len());
        self.field.deviations(poses, conditions, columns.output(out.len()));
        for i in 0..out.len() {
            let tip = tip_at(self.field.machine(), &poses.pose(i));
            out.put(i, &self.motion.removed_from(&columns.get(i), &tip));
        }
    }
}
