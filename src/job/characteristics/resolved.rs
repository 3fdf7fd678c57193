//! The tolerances of a job on the points of its features that a machine reaches.

use super::entry::{FeatureTolerance, FeatureTolerances};
use crate::analysis::zone::{Characteristic, CharacteristicRequest, SurfacePoint, Unfit};
use crate::diagnostic::{Diagnostic, codes, did_you_mean, shown};
use crate::job::tool_poses::ReachedToolPoses;
use crate::machine::{Machine, Pose};
use crate::run::{Call, Refused};
use nalgebra::Vector3;
use std::collections::BTreeSet;

/// Maximum number of points of a feature.
const MAX_POINTS: usize = 100_000;

/// The characteristics of a job on a machine.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct JobCharacteristics {
    pub(super) list: Vec<JobCharacteristic>,
    /// The poses of their points (mm, deg).
    pub(super) poses: Vec<Pose>,
}

/// A characteristic of a feature that a machine reaches.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct JobCharacteristic {
    /// The tolerance as it is stated.
    pub stated: FeatureTolerance,
    /// Its points and those of its datum, by index of the pose.
    pub rows: [Vec<usize>; 2],
    /// Number of its points, and those of its datum, out of reach.
    pub unreached: usize,
    /// The characteristic, or what the points in reach lack.
    pub of: Result<Characteristic, Unfit>,
}

impl JobCharacteristic {
    /// Returns the deviations of the feature and of the datum among those of all poses.
    pub fn part(&self, all: &[Vector3<f64>]) -> [Vec<Vector3<f64>>; 2] {
        [0, 1].map(|k| self.rows[k].iter().map(|i| all[*i]).collect())
    }
}

impl JobCharacteristics {
    /// Returns the characteristics on the tool poses that a machine reaches; `None` where the job states none. Points
    /// that do not carry a tolerance although all are reached refuse the job.
    pub(crate) fn of(
        call: &mut Call<'_>,
        machine: &Machine,
        stated: &FeatureTolerances,
        reached: &ReachedToolPoses,
    ) -> Result<Option<Self>, Refused> {
        if stated.0.is_empty() {
            return Ok(None);
        }
        let mut used: BTreeSet<usize> = BTreeSet::new();
        let mut list = Vec::new();
        for tolerance in &stated.0 {
            let names = std::iter::once(&tolerance.feature).chain(&tolerance.datum);
            let known: Result<Vec<_>, _> = names.map(|name| Points::of(reached, name)).collect();
            let known = known.or_else(|refusal| call.refuse(refusal.at(tolerance.written.clone(), "")))?;
            let of = characteristic(machine, tolerance, reached, &known);
            let unreached = known.iter().map(|points| points.unreached).sum();
            if let (Err(unfit), 0) = (&of, unreached) {
                return call.refuse(refused(tolerance, unfit));
            }
            let rows = [0, 1].map(|k| known.get(k).map_or_else(Vec::new, |points| points.rows.clone()));
            rows.iter().for_each(|rows| used.extend(rows));
            list.push(JobCharacteristic { stated: tolerance.clone(), rows, unreached, of });
        }
        let used: Vec<usize> = used.into_iter().collect();
        for rows in list.iter_mut().flat_map(|one| &mut one.rows).flatten() {
            *rows = used.partition_point(|i| *i < *rows);
        }
        let poses = used.iter().map(|i| reached.poses[*i].clone()).collect();
        Ok(Some(Self { list, poses }))
    }
}

/// The points of a feature by index of the reached tool poses.
struct Points {
    rows: Vec<usize>,
    unreached: usize,
}

impl Points {
    fn of(reached: &ReachedToolPoses, name: &str) -> Result<Self, Diagnostic> {
        let is = |feature: &Option<String>| feature.as_deref() == Some(name);
        let lines = reached.lines.iter().enumerate();
        let rows: Vec<usize> = lines.filter(|(_, (_, feature))| is(feature)).map(|(i, _)| i).collect();
        let unreached = reached.rows.iter().filter(|row| is(&row.feature)).count();
        if rows.len() > MAX_POINTS {
            let message = format!("feature `{}` has {} points; {MAX_POINTS} are the most", shown(name), rows.len());
            return Err(Diagnostic::new(codes::E0860, message).help("name fewer tool poses after the feature"));
        }
        if rows.is_empty() && unreached == 0 {
            let all = reached.lines.iter().map(|(_, f)| f).chain(reached.rows.iter().map(|row| &row.feature));
            let known: BTreeSet<&str> = all.filter_map(|feature| feature.as_deref()).collect();
            let known: Vec<&str> = known.into_iter().collect();
            let message = format!("`{}` has no feature `{}`", shown(&reached.file), shown(name));
            let help = match known.as_slice() {
                [] => "its tool poses name no feature: add the column `feature`".to_owned(),
                _ => did_you_mean(name, &known),
            };
            return Err(Diagnostic::new(codes::E0860, message).help(help));
        }
        Ok(Self { rows, unreached })
    }

    fn surface(&self, reached: &ReachedToolPoses) -> Vec<SurfacePoint> {
        self.rows.iter().map(|i| reached.surface[*i]).collect()
    }
}

fn characteristic(
    machine: &Machine,
    tolerance: &FeatureTolerance,
    reached: &ReachedToolPoses,
    known: &[Points],
) -> Result<Characteristic, Unfit> {
    let surfaces: Vec<Vec<SurfacePoint>> = known.iter().map(|points| points.surface(reached)).collect();
    let turned = machine.workpiece_rotation();
    let axis = tolerance.axis.map(|axis| turned.map_or(axis, |rotation| rotation * axis));
    Characteristic::new(CharacteristicRequest {
        kind: tolerance.kind,
        points: surfaces.first().map_or(&[], Vec::as_slice),
        datum: surfaces.get(1).map(Vec::as_slice),
        axis: axis.as_ref(),
        free: tolerance.free,
        fit: tolerance.fit,
    })
}

fn refused(tolerance: &FeatureTolerance, unfit: &Unfit) -> Diagnostic {
    let message = format!("{} of feature `{}`: {unfit}", tolerance.kind.name(), shown(&tolerance.feature));
    let help = "`abbe explain E0860` lists what each kind needs";
    Diagnostic::new(codes::E0860, message).at(tolerance.written.clone(), "").help(help)
}
