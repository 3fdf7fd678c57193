//! The round features of a job with the profile over the angle that a field leaves.

use super::characteristics::FeatureTolerances;
use super::tool_poses::ReachedToolPoses;
use crate::analysis::zone::{RoundProfile, RoundSurface, SurfacePoint};
use crate::evaluate::Field;
use crate::machine::OperatingConditions;
use indexmap::IndexMap;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Maximum number of points of a profile: a picture of more is no help to anybody.
const MAX_POINTS: usize = 20_000;

/// A round feature: its points have normals and lie on circles about one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct RoundFeature {
    /// Its label; empty for rows without.
    pub feature: String,
    /// The profile of the section with the widest zone.
    pub profile: RoundProfile,
    /// The directions, unturned workpiece frame, from which and towards which angles count.
    pub across: [Vector3<f64>; 2],
}

/// Returns the round features among tool poses with normals, by the deviations of a field, in the order of the file.
pub(crate) fn round_features(
    field: &dyn Field,
    conditions: OperatingConditions,
    reached: &ReachedToolPoses,
    tolerances: &FeatureTolerances,
) -> Vec<RoundFeature> {
    let mut groups: IndexMap<&str, Vec<usize>> = IndexMap::new();
    for (i, (_, feature)) in reached.lines.iter().enumerate() {
        groups.entry(feature.as_deref().unwrap_or_default()).or_default().push(i);
    }
    let turned = field.machine().workpiece_rotation();
    let one = |(feature, rows): (&str, Vec<usize>)| {
        let points: Vec<SurfacePoint> = rows.iter().map(|i| reached.surface[*i]).collect();
        if points.len() > MAX_POINTS || points.iter().any(|point| point.normal.is_none()) {
            return None;
        }
        let axis = tolerances.axis(feature).map(|axis| turned.map_or(axis, |rotation| rotation * axis));
        let surface = RoundSurface::new(&points, axis.as_ref()).ok()?;
        let at = |i: &usize| field.deviation(&conditions.at_pose(&reached.poses[*i])).position;
        let deviations: Vec<Vector3<f64>> = rows.par_iter().map(at).collect();
        let (profile, across) = (surface.widest(&deviations)?, surface.across());
        Some(RoundFeature { feature: feature.to_owned(), profile, across })
    };
    groups.into_iter().filter_map(one).collect()
}
