//! References of positions that lead back to where they began.

use super::axes::AxisDraft;
use super::context::Context;
use super::positions::PositionDraft;
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::Branch;
use petgraph::algo::{astar, tarjan_scc};
use petgraph::graphmap::DiGraphMap;

/// Refuses references that lead back to where they began, in any arrangement of the axes: each axis takes the side
/// that the reference stands on.
pub fn circles(context: &mut Context, axes: &[AxisDraft], workpiece: Option<&PositionDraft>) {
    let references = references(axes, workpiece);
    let mut components = tarjan_scc(&references);
    for start in references.nodes() {
        // One report for all that hang on each other, from the first of them on.
        let Some(index) = components.iter().position(|component| component.contains(&start)) else { continue };
        let _ = components.swap_remove(index);
        let Some(circle) = circle(&references, start) else { continue };
        let names: Vec<String> = circle.iter().map(|node| format!("`{node}`")).collect();
        let message = format!("positions refer to each other in a circle: {}", names.join(", "));
        let mut refusal = Diagnostic::new(codes::E0413, message);
        for (i, position) in circle.windows(2).filter_map(|two| references.edge_weight(two[0], two[1])).enumerate() {
            let place = context.document.places.value(&position.entry);
            refusal = refusal.at(place, if i == 0 { "" } else { "and here" });
        }
        context.diagnostics.push(refusal.help("give one of them from gauge, tip or bed"));
    }
}

/// Positions by the axis (or the workpiece) whose they are and the one that they are relative to.
type References<'a> = DiGraphMap<&'a str, &'a PositionDraft>;

fn references<'a>(axes: &'a [AxisDraft], workpiece: Option<&'a PositionDraft>) -> References<'a> {
    let mut references = References::new();
    for axis in axes {
        let _ = references.add_node(axis.name.as_str());
    }
    let mut add = |of: &'a str, position: &'a PositionDraft| {
        if let Some(from) = position.target().filter(|from| !references.contains_edge(of, from)) {
            let _ = references.add_edge(of, from, position);
        }
    };
    for axis in axes {
        let blocks = [Branch::Tool, Branch::Workpiece].map(|branch| axis.block(branch).origin.as_ref());
        // Plain keys without effect on either side refer to nothing.
        let plain = axis.plain.origin.as_ref().filter(|_| blocks.iter().any(Option::is_none));
        blocks.into_iter().chain([plain]).flatten().for_each(|position| add(axis.name.as_str(), position));
    }
    workpiece.iter().for_each(|position| add("workpiece", position));
    references
}

/// Returns the shortest circle through a node, from it back to it.
fn circle<'a>(references: &References<'a>, start: &'a str) -> Option<Vec<&'a str>> {
    let back = |next| astar(references, next, |node| node == start, |_| 1, |_| 0);
    let (_, path) = references.neighbors(start).filter_map(back).min_by_key(|(length, _)| *length)?;
    Some([vec![start], path].concat())
}
