//! Deviations over the volume of the machine and their derivatives by the unknowns, less the rigid motion of the
//! workpiece frame that takes most of them away: where a workpiece stands is no error of the machine.

use super::prediction::FitModel;
use crate::algebra::linear::{ReducedSystem, Svd, beside};
use crate::diagnostic::{Place, SourceId};
use crate::evaluate::{Frame, Order, Poses, Spread};
use crate::identify::data::{LEVER_MM, Measurement, Reading};
use crate::identify::thresholds::{DESIGN_RANK_TOLERANCE, MAX_CORNER_AXES, MAX_DEPENDENT_MOTION_SHARE, VOLUME_POSES};
use crate::machine::{Approach, Machine, Pose};
use nalgebra::{DMatrix, DVector, DVectorView, Matrix3, Vector3};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Poses over the volume, with every tool and from every side that counts.
pub(crate) struct Volume {
    /// The poses; nothing is measured in them.
    pub rows: Vec<Measurement>,
    /// Actual positions (mm, workpiece frame).
    pub points: Vec<Vector3<f64>>,
    /// Deviations (mm), three of each pose, as they are.
    pub deviations: DVector<f64>,
    /// Derivatives of the deviations by the unknowns, as they are.
    pub jacobian: DMatrix<f64>,
    /// Orthonormal basis of what rigid motions of the workpiece frame do to the deviations.
    rigid: DMatrix<f64>,
}

impl Volume {
    /// Returns the first order of a model, whatever its unknowns are: rigid motions act on the nominal points.
    pub fn first_order(model: &FitModel<'_>, data: &[Measurement]) -> Self {
        let first = model.clone().to_order(Order::Degree(1));
        let theta = vec![0.0; model.parameters().len()];
        let mut volume = Self::of(&first, data, &theta);
        let nominal = |m: &Measurement| crate::lower::NominalPose::in_part(model.machine(m), &m.pose).pose.translation;
        volume.points = volume.rows.iter().map(nominal).collect();
        volume.rigid = orthonormal(&motions(&volume.points));
        volume
    }

    /// Evaluates a model at `theta`, with the tools of the data.
    pub fn of(model: &FitModel<'_>, data: &[Measurement], theta: &[f64]) -> Self {
        let rows = volume_measurements(model, data);
        let one = |m: &Measurement| {
            let deviation = model.prediction(m, theta);
            let nominal = crate::lower::NominalPose::in_part(model.machine(m), &m.pose).pose.translation;
            (deviation, nominal + deviation, model.rows(m, theta).0)
        };
        let evaluated: Vec<_> = rows.par_iter().map(one).collect();
        let points: Vec<Vector3<f64>> = evaluated.iter().map(|(_, point, _)| *point).collect();
        let count = 3 * rows.len();
        let deviations = DVector::from_fn(count, |i, _| evaluated[i / 3].0[i % 3]);
        let jacobian = DMatrix::from_fn(count, theta.len(), |i, j| evaluated[i / 3].2[j][i % 3]);
        Self { rigid: orthonormal(&motions(&points)), rows, points, deviations, jacobian }
    }

    /// Takes the best rigid motion of the workpiece frame off the columns of a matrix.
    pub fn deformation(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        columns - &self.rigid * self.rigid.tr_mul(columns)
    }

    /// Returns the displacements of the points by linear maps of space, over the lever arm: a column for each map.
    pub fn displacements_by(&self, maps: &[nalgebra::Matrix3<f64>]) -> DMatrix<f64> {
        let centre = middle(&self.points);
        DMatrix::from_fn(3 * self.points.len(), maps.len(), |i, k| {
            (maps[k] * (self.points[i / 3] - centre))[i % 3] / LEVER_MM
        })
    }

    /// Returns the rigid motions of the workpiece frame that come nearest to displacements of the points (columns), as
    /// displacements: translations of its origin (mm), then rotations about it times the lever arm, in machine
    /// directions at the zero pose.
    pub fn rigid_motions(&self, columns: &DMatrix<f64>, machine: &Machine) -> DMatrix<f64> {
        let (centre, turn) = (middle(&self.points), machine.workpiece_rotation().unwrap_or_else(Matrix3::identity));
        let svd = Svd::new(&ReducedSystem::of(&self.motions(), &DVector::zeros(3 * self.points.len())).r);
        let rank = svd.rank(DESIGN_RANK_TOLERANCE);
        let right = self.motions().tr_mul(columns);
        // `(R^T R)^+ M^T columns`, with M^T M = R^T R.
        let root = svd.root_covariance(rank);
        let about_centre = &root * root.tr_mul(&right);
        let moved = |column: DVectorView<'_, f64>| {
            let three = |first: usize| Vector3::from_fn(|k, _| column[first + k]);
            let (translation, rotation) = (three(0), three(3));
            let [translation, rotation] =
                [translation - rotation.cross(&centre) / LEVER_MM, rotation].map(|v| turn * v);
            DVector::from_fn(6, |i, _| if i < 3 { translation[i] } else { rotation[i - 3] })
        };
        let all: Vec<DVector<f64>> = about_centre.column_iter().map(moved).collect();
        DMatrix::from_fn(6, all.len(), |i, k| all[k][i])
    }

    /// Returns the displacements of the points by rigid motions of the whole: six columns.
    pub fn motions(&self) -> DMatrix<f64> {
        motions(&self.points)
    }
}

pub(crate) fn middle(points: &[Vector3<f64>]) -> Vector3<f64> {
    points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64
}

/// Displacements of points by translations, and by rotations about the centre: six columns.
fn motions(points: &[Vector3<f64>]) -> DMatrix<f64> {
    let centre = middle(points);
    DMatrix::from_fn(3 * points.len(), 6, |i, k| {
        let axis = Vector3::ith(k % 3, 1.0);
        let displacement = if k < 3 { axis } else { axis.cross(&(points[i / 3] - centre)) / LEVER_MM };
        displacement[i % 3]
    })
}

/// Returns an orthonormal basis of the columns, without columns that depend on the others.
fn orthonormal(columns: &DMatrix<f64>) -> DMatrix<f64> {
    let mut kept: Vec<DVector<f64>> = Vec::new();
    for column in columns.column_iter() {
        let length = column.norm();
        let rest = beside(column.into_owned(), &kept);
        if rest.norm() > MAX_DEPENDENT_MOTION_SHARE * length && length > 0.0 {
            kept.push(rest.normalize());
        }
    }
    DMatrix::from_fn(columns.nrows(), kept.len(), |i, k| kept[k][i])
}

/// Returns the corners of the volume and poses inside as measurements.
fn volume_measurements(model: &FitModel<'_>, data: &[Measurement]) -> Vec<Measurement> {
    let machine = &model.machines()[0];
    measurements(model, data, &[corners(machine), inside(machine)].concat())
}

/// Returns poses spread evenly over the volume, with every tool and direction of approach that counts.
pub(crate) fn volume_poses(model: &FitModel<'_>, data: &[Measurement]) -> Vec<Measurement> {
    measurements(model, data, &inside(&model.machines()[0]))
}

/// Returns deviations at poses, with every tool and direction of approach that counts; nothing is measured in them.
fn measurements(model: &FitModel<'_>, data: &[Measurement], poses: &[Pose]) -> Vec<Measurement> {
    // With each tool, as it was clamped in its first run.
    let mut tools: BTreeMap<usize, Option<String>> = BTreeMap::new();
    for m in data {
        let _ = tools.entry(m.tool).or_insert_with(|| m.run.clone());
    }
    let directed = model.parameters().iter().flat_map(|p| &p.terms).any(|t| t.approach != Approach::Mean);
    let approaches = if directed { vec![Approach::Forward, Approach::Reverse] } else { vec![Approach::Mean] };
    let place = Place { source: SourceId(0), range: 0..0 };
    let reading = Reading::Deviation { values: [Some(0.0); 3], frame: Frame::Workpiece, zero: [None; 3] };
    let blank = |pose: &Pose, tool: usize, run: &Option<String>, approach: Approach| Measurement {
        tool,
        run: run.clone(),
        approach,
        ..Measurement::new(pose.clone(), reading.clone(), place.clone())
    };
    let of_tool = |(tool, run): (usize, Option<String>)| {
        let at = |pose| approaches.iter().map(move |approach| (pose, *approach));
        poses.iter().flat_map(at).map(|(pose, approach)| blank(pose, tool, &run, approach)).collect::<Vec<_>>()
    };
    tools.into_iter().flat_map(of_tool).collect()
}

fn corners(machine: &Machine) -> Vec<Pose> {
    let volume = machine.volume();
    let count = if volume.len() <= MAX_CORNER_AXES { 1_usize << volume.len() } else { 0 };
    let corner =
        |i: usize| volume.iter().enumerate().map(|(k, g)| if i >> k & 1 == 0 { g.min } else { g.max }).collect();
    (0..count).map(corner).collect()
}

fn inside(machine: &Machine) -> Vec<Pose> {
    Poses::Spread(Spread::of(machine, VOLUME_POSES, 0)).iter().collect()
}
