//! The rows of a work one by one, as a path is played: the deviation against the surface, and the axes that make it.

use super::features::parts_along;
use super::tool_poses::ReachedToolPoses;
use crate::analysis::reference::{ErrorEffects, PartReference};
use crate::analysis::{View, unturned_tool_pose};
use crate::evaluate::Field;
use crate::machine::Machine;
use indexmap::IndexMap;
use rayon::prelude::*;

/// A row of a work with its deviation.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct PlayedRow {
    /// Line of the file.
    pub line: usize,
    /// Part of the deviation across the surface, um: positive out of the material.
    pub across_um: f64,
    /// Length of its part along the surface, um.
    pub along_um: f64,
    /// True if the file states the normal of the surface; else the direction of the tool stands for it.
    pub has_normal: bool,
    /// Part of each axis along the deviation, first order, um; the largest first. Empty behind a compensation.
    pub axes: IndexMap<String, f64>,
}

/// Returns the reached rows of a work in the order of the file. Axes are named where the field is the bare machine,
/// without what `removed` takes out of the field.
pub(crate) fn played(
    field: &dyn Field,
    reached: &ReachedToolPoses,
    view: View,
    bare: bool,
    removed: Option<&PartReference>,
) -> Vec<PlayedRow> {
    let machine: &Machine = field.machine();
    let effects = bare.then(|| ErrorEffects::new(machine, view.conditions, removed)).flatten();
    let row = |i: usize| {
        let pose = &reached.poses[i];
        let deviation = field.deviation(&view.conditions.at_pose(pose)).position * 1e3;
        let stated = reached.surface.get(i).and_then(|point| point.normal);
        let normal = stated.unwrap_or_else(|| unturned_tool_pose(machine, pose).direction);
        let across = deviation.dot(&normal);
        let mut axes: IndexMap<String, f64> = IndexMap::new();
        for (error, um) in effects.iter().flat_map(|effects| parts_along(field, pose, view, effects)) {
            *axes.entry(error.axis.to_string()).or_default() += um;
        }
        axes.retain(|_, um| *um != 0.0);
        axes.sort_by(|a, x, b, y| y.abs().total_cmp(&x.abs()).then(a.cmp(b)));
        PlayedRow {
            line: reached.lines[i].0,
            across_um: across,
            along_um: (deviation - normal * across).norm(),
            has_normal: stated.is_some(),
            axes,
        }
    };
    (0..reached.poses.len()).into_par_iter().map(row).collect()
}
