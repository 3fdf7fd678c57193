//! The round features of a job with the profile over the angle that a field leaves, or a machine drawn between bounds.

use super::characteristics::{DrawnRequest, FeatureTolerances};
use super::tool_poses::ReachedToolPoses;
use crate::analysis::budget::{FiguresRequest, draw_figures, drawn_positions, rank};
use crate::analysis::zone::{RoundProfile, RoundSurface, SurfacePoint};
use crate::evaluate::Field;
use crate::machine::{Machine, OperatingConditions, Pose};
use crate::run::{Call, Refused};
use indexmap::IndexMap;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Maximum number of points of a profile: a picture of more is no help to anybody.
const MAX_POINTS: usize = 20_000;

/// The same of machines drawn: each of them has its profile.
const MAX_DRAWN_POINTS: usize = 2000;

/// A round feature: its points have normals and lie on circles about one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct RoundFeature {
    /// Its label; empty for rows without.
    pub feature: String,
    /// The profile of the section with the widest zone.
    pub profile: RoundProfile,
    /// The directions, unturned workpiece frame, from which and towards which angles count.
    pub across: [Vector3<f64>; 2],
    /// True if it is of the machine drawn whose roundness is the 95 % value.
    pub drawn: bool,
}

/// A round surface with its name and the indices of its poses among those that are reached.
struct NamedSurface {
    feature: String,
    rows: Vec<usize>,
    surface: RoundSurface,
}

/// Returns the round surfaces among tool poses with normals, in the order of the file.
fn surfaces(
    machine: &Machine,
    reached: &ReachedToolPoses,
    tolerances: &FeatureTolerances,
    max_points: usize,
) -> Vec<NamedSurface> {
    let mut groups: IndexMap<&str, Vec<usize>> = IndexMap::new();
    for (i, (_, feature)) in reached.lines.iter().enumerate() {
        groups.entry(feature.as_deref().unwrap_or_default()).or_default().push(i);
    }
    let turned = machine.workpiece_rotation();
    let one = |(feature, rows): (&str, Vec<usize>)| {
        let points: Vec<SurfacePoint> = rows.iter().map(|i| reached.surface[*i]).collect();
        if points.len() > max_points || points.iter().any(|point| point.normal.is_none()) {
            return None;
        }
        let axis = tolerances.axis(feature).map(|axis| turned.map_or(axis, |rotation| rotation * axis));
        let surface = RoundSurface::new(&points, axis.as_ref()).ok()?;
        Some(NamedSurface { feature: feature.to_owned(), rows, surface })
    };
    groups.into_iter().filter_map(one).collect()
}

impl NamedSurface {
    /// Returns the feature by the deviations (mm) of its points.
    fn by(self, deviations: &[Vector3<f64>], drawn: bool) -> Option<RoundFeature> {
        let (profile, across) = (self.surface.widest(deviations)?, self.surface.across());
        Some(RoundFeature { feature: self.feature, profile, across, drawn })
    }
}

/// Returns the round features among tool poses with normals, by the deviations of a field, in the order of the file.
pub(crate) fn round_features(
    field: &dyn Field,
    conditions: OperatingConditions,
    reached: &ReachedToolPoses,
    tolerances: &FeatureTolerances,
) -> Vec<RoundFeature> {
    let one = |of: NamedSurface| {
        let at = |i: &usize| field.deviation(&conditions.at_pose(&reached.poses[*i])).position;
        let deviations: Vec<Vector3<f64>> = of.rows.par_iter().map(at).collect();
        of.by(&deviations, false)
    };
    surfaces(field.machine(), reached, tolerances, MAX_POINTS).into_iter().filter_map(one).collect()
}

/// Returns the same of machines drawn between bounds alone: each feature in the machine whose roundness is the 95 %
/// value.
pub(crate) fn drawn_round_features(
    call: &Call<'_>,
    of: DrawnRequest<'_>,
    reached: &ReachedToolPoses,
    tolerances: &FeatureTolerances,
) -> Result<Vec<RoundFeature>, Refused> {
    let DrawnRequest { machine, bounds, removed: reference, draws, samples, .. } = of;
    let one = |of: NamedSurface| {
        let poses: Vec<Pose> = of.rows.iter().map(|i| reached.poses[*i].clone()).collect();
        let width =
            |positions: &[Vector3<f64>]| vec![of.surface.widest(positions).map_or(0.0, |profile| profile.minimum_zone)];
        let no_parts = |_: usize, _: &[Vector3<f64>]| Vec::new();
        let (figures, weights) = (&width, &no_parts);
        let request = FiguresRequest {
            machine,
            bounds,
            poses: &poses,
            constant: &[],
            reference,
            draws,
            samples,
            figures,
            weights,
        };
        let drawn = call.stage("machines drawn", 2 * samples, |advance| draw_figures(request, advance))?;
        let widths = drawn.first().map_or(&[][..], |figure| &figure.values);
        let mut order: Vec<usize> = (0..widths.len()).collect();
        order.sort_by(|a, b| widths[*a].total_cmp(&widths[*b]).then(a.cmp(b)));
        let Some(machine) = rank(order.len(), 95).checked_sub(1).and_then(|i| order.get(i)) else { return Ok(None) };
        let positions = drawn_positions(&request, *machine);
        Ok(of.by(&positions, true))
    };
    let all = surfaces(machine, reached, tolerances, MAX_DRAWN_POINTS).into_iter().map(one);
    Ok(all.collect::<Result<Vec<_>, Refused>>()?.into_iter().flatten().collect())
}
