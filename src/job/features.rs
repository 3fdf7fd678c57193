//! The features of a work: the largest deviation on each, and the errors that dominate there.

use super::poses::{AxisPositions, axis_positions};
use super::tool_poses::ReachedToolPoses;
use crate::analysis::budget::{Bound, PoseByPose};
use crate::analysis::reference::{ErrorEffects, PartReference};
use crate::analysis::{View, deviation_in};
use crate::evaluate::{Field, quantile_95};
use crate::machine::{ErrorId, ErrorTerm, Machine};
use indexmap::IndexMap;
use rayon::prelude::*;

/// Number of errors named for a feature.
const DOMINATING: usize = 3;

/// A feature of the work: rows of a file with the same label.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct FeatureResult {
    /// Its label; empty for rows without.
    pub feature: String,
    /// Number of its tool poses that are reached.
    pub poses: usize,
    /// Number of those that are not.
    pub unreached: usize,
    /// Largest deviation of the functional point, um; none without a pose.
    pub max_um: Option<f64>,
    /// Deviation below which 95 % of its poses lie, um.
    pub p95_um: Option<f64>,
    /// Line of the file with the largest deviation.
    pub line: Option<usize>,
    /// The pose there, mm and deg.
    pub axes: Option<AxisPositions>,
    /// The errors with the largest parts in that deviation.
    pub errors: Vec<DominatingError>,
}

/// An error in the deviation at a pose.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct DominatingError {
    /// Name of the error.
    pub error: String,
    /// Its part along the deviation, first order, um.
    pub um: f64,
}

/// Returns the features in the order in which the file names them; empty if it names none. Errors are named where the
/// field is the bare machine, without what `removed` takes out of the field; a minimum zone has none.
pub(crate) fn features(
    field: &dyn Field,
    reached: &ReachedToolPoses,
    view: View,
    bare: bool,
    removed: Option<&PartReference>,
) -> Vec<FeatureResult> {
    let um: Vec<f64> =
        reached.poses.par_iter().map(|pose| deviation_in(field, pose, view).position.norm() * 1e3).collect();
    let named = bare && is_named(reached);
    let effects = named.then(|| ErrorEffects::new(field.machine(), view.conditions, removed)).flatten();
    let errors = |pose: &[f64]| effects.as_ref().map_or_else(Vec::new, |of| dominating(field, pose, view, of));
    grouped(field.machine(), reached, &um, &errors)
}

/// True if any tool pose names a feature.
fn is_named(reached: &ReachedToolPoses) -> bool {
    reached.lines.iter().any(|(_, f)| f.is_some()) || reached.rows.iter().any(|row| row.feature.is_some())
}

/// Returns the errors that dominate at a pose.
type Dominating<'a> = &'a dyn Fn(&[f64]) -> Vec<DominatingError>;

/// Returns the features of deviations (um) at the reached poses.
fn grouped(machine: &Machine, reached: &ReachedToolPoses, um: &[f64], errors: Dominating<'_>) -> Vec<FeatureResult> {
    if !is_named(reached) {
        return Vec::new();
    }
    let mut rows: Vec<(usize, &str, Option<usize>)> = Vec::new();
    rows.extend(reached.lines.iter().enumerate().map(|(i, (line, feature))| (*line, label_of(feature), Some(i))));
    rows.extend(reached.rows.iter().map(|row| (row.line, label_of(&row.feature), None)));
    rows.sort_by_key(|(line, ..)| *line);
    let mut groups: IndexMap<&str, Vec<Option<usize>>> = IndexMap::new();
    rows.into_iter().for_each(|(_, feature, pose)| groups.entry(feature).or_default().push(pose));
    groups.into_iter().map(|(feature, rows)| one(machine, reached, (feature, &rows, um), errors)).collect()
}

fn label_of(feature: &Option<String>) -> &str {
    feature.as_deref().unwrap_or_default()
}

fn one(
    machine: &Machine,
    reached: &ReachedToolPoses,
    (feature, rows, um): (&str, &[Option<usize>], &[f64]),
    errors: Dominating<'_>,
) -> FeatureResult {
    let poses: Vec<usize> = rows.iter().flatten().copied().collect();
    let mut lengths: Vec<f64> = poses.iter().map(|i| um[*i]).collect();
    // Of equal ones the first.
    let worst = poses.iter().copied().rev().max_by(|a, b| um[*a].total_cmp(&um[*b]));
    FeatureResult {
        feature: feature.to_owned(),
        poses: poses.len(),
        unreached: rows.len() - poses.len(),
        max_um: worst.map(|i| um[i]),
        p95_um: worst.map(|_| quantile_95(&mut lengths)),
        line: worst.map(|i| reached.lines[i].0),
        axes: worst.map(|i| axis_positions(machine, &reached.poses[i])),
        errors: worst.map_or_else(Vec::new, |i| errors(&reached.poses[i])),
    }
}

/// Returns the effects at a pose (mm, deg) of the bounds by index (mm), largest first.
pub(crate) type BoundEffectsAt<'a> = dyn Fn(&[f64]) -> Vec<(usize, f64)> + 'a;

/// Returns the features where nothing is measured: the deviations are the 95 % values, the errors those with the
/// largest effects alone at their bounds.
pub(crate) fn bounded_features(
    machine: &Machine,
    reached: &ReachedToolPoses,
    bounds: &[Bound],
    found: &PoseByPose,
    effects_at: &BoundEffectsAt<'_>,
) -> Vec<FeatureResult> {
    let um: Vec<f64> = found.poses.iter().map(|pose| pose.position.p95 * 1e3).collect();
    let effects = |pose: &[f64]| {
        let list = effects_at(pose).into_iter().take(DOMINATING);
        list.map(|(i, mm)| DominatingError { error: bounds[i].to_string(), um: mm * 1e3 }).collect()
    };
    grouped(machine, reached, &um, &effects)
}

/// Returns the part of each error with a value along the deviation at a pose, first order, um.
pub(super) fn parts_along(
    field: &dyn Field,
    pose: &[f64],
    view: View,
    effects: &ErrorEffects<'_>,
) -> Vec<(ErrorId, f64)> {
    let machine: &Machine = field.machine();
    let all = field.deviation(&view.conditions.at_pose(pose)).position.try_normalize(0.0).unwrap_or_default();
    let valued = machine.errors().map(|(_, term)| !matches!(term, ErrorTerm::Tolerance(_)));
    let parts = effects.at(pose).into_iter().zip(valued).filter(|(_, valued)| *valued);
    parts.map(|((error, deviation), _)| (error, deviation.position.dot(&all) * 1e3)).collect()
}

/// Returns the errors with the largest parts along the deviation at a pose.
fn dominating(field: &dyn Field, pose: &[f64], view: View, effects: &ErrorEffects<'_>) -> Vec<DominatingError> {
    let part = |(error, um): (ErrorId, f64)| DominatingError { error: error.to_string(), um };
    let parts = parts_along(field, pose, view, effects).into_iter().map(part);
    let mut parts: Vec<DominatingError> = parts.filter(|part| part.um != 0.0).collect();
    parts.sort_by(|a, b| b.um.abs().total_cmp(&a.um.abs()));
    parts.truncate(DOMINATING);
    parts
}
