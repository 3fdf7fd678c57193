//! References of positions that lead back to where they began.

use super::axes::AxisDraft;
use super::context::Context;
use super::positions::PositionDraft;
use crate::diagnostic::{Diagnostic, codes};
use crate::machine::Branch;

/// Refuses references that lead back to where they began, in any arrangement of the axes: each axis takes the side
/// that the reference stands on.
pub fn circles(context: &mut Context<'_>, axes: &[AxisDraft], workpiece: Option<&PositionDraft>) {
    let mut references: Vec<(&str, &PositionDraft)> = Vec::new();
    for axis in axes {
        let blocks = [Branch::Tool, Branch::Workpiece].map(|branch| axis.block(branch).origin.as_ref());
        // Plain keys without effect on either side refer to nothing.
        let plain = axis.plain.origin.as_ref().filter(|_| blocks.iter().any(Option::is_none));
        references.extend(blocks.into_iter().chain([plain]).flatten().map(|position| (axis.name.as_str(), position)));
    }
    references.extend(workpiece.map(|position| ("workpiece", position)));
    let mut reported: Vec<&str> = Vec::new();
    for (start, _) in &references {
        let Some(circle) = path(&references, start, start, &mut Vec::new()) else { continue };
        if circle.iter().any(|(node, _)| reported.contains(node)) {
            continue;
        }
        reported.extend(circle.iter().map(|(node, _)| *node));
        let names: Vec<String> = circle.iter().map(|(node, _)| format!("`{node}`")).collect();
        let message = format!("positions refer to each other in a circle: {}, `{start}`", names.join(", "));
        let places = &context.document.places;
        let refusal = circle.iter().enumerate().fold(Diagnostic::new(codes::E0413, message), |refusal, (i, (_, p))| {
            refusal.at(places.value(&p.entry), if i == 0 { "" } else { "and here" })
        });
        context.diagnostics.push(refusal.help("give one of them from gauge, tip or bed"));
    }
}

/// The references from a node to `end`, each node once.
fn path<'a>(
    references: &[(&'a str, &'a PositionDraft)],
    node: &str,
    end: &str,
    seen: &mut Vec<&'a str>,
) -> Option<Vec<(&'a str, &'a PositionDraft)>> {
    for (from, position) in references.iter().filter(|(from, _)| *from == node) {
        let Some(target) = position.target() else { continue };
        if target == end {
            return Some(vec![(from, position)]);
        }
        if seen.contains(&target) {
            continue;
        }
        seen.push(target);
        if let Some(mut rest) = path(references, target, end, seen) {
            rest.insert(0, (from, position));
            return Some(rest);
        }
    }
    None
}
