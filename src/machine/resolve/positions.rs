//! Positions: three coordinates, or the same from a named point; their references form no circle.

use super::axes::{AxisDraft, block_key};
use super::context::{Context, dotted_path};
use crate::diagnostic::{Diagnostic, codes, did_you_mean, shown};
use crate::machine::{AxisName, Branch, Position, ReferencePoint, Tool};
use crate::syntax::{Keys, PositionEntry, RelativeEntry, below, keys};
use petgraph::algo::{astar, tarjan_scc};
use petgraph::graphmap::DiGraphMap;

/// A position as written, with the keys of its entry.
#[derive(Debug, Clone)]
pub struct PositionDraft {
    from: WrittenReference,
    at: [f64; 3],
    entry: Keys,
}

#[derive(Debug, Clone, PartialEq)]
enum WrittenReference {
    Bed,
    Gauge,
    Tip,
    Workpiece,
    Axis(AxisName),
}

/// The points that are no axis.
const POINTS: [&str; 4] = ["gauge", "tip", "workpiece", "bed"];

/// Reads a position.
pub fn position(context: &mut Context<'_>, written: &PositionEntry, entry: &Keys) -> Option<PositionDraft> {
    let (from, at) = match written {
        PositionEntry::Point(list) => (Some(WrittenReference::Bed), context.vector(list, entry)),
        PositionEntry::Relative(RelativeEntry { from, at }) => {
            let from = match from {
                Some(word) => reference(context, word, &below(entry, "from")),
                None => {
                    if !context.document.places.is_marred(entry) {
                        let message = format!("`{}` does not say from where", dotted_path(entry));
                        let help = "add `from:` with gauge, tip, workpiece, bed or the name of an axis";
                        context.at_key(codes::E0203, entry, message, help);
                    }
                    None
                }
            };
            let at = match at {
                Some(list) => context.vector(list, &below(entry, "at")),
                None => Some([0.0; 3]),
            };
            (from, at)
        }
    };
    Some(PositionDraft { from: from?, at: at?, entry: entry.clone() })
}

fn reference(context: &mut Context<'_>, word: &str, at: &Keys) -> Option<WrittenReference> {
    let document = context.document;
    match word {
        "bed" => return Some(WrittenReference::Bed),
        "gauge" => return Some(WrittenReference::Gauge),
        "tip" => return Some(WrittenReference::Tip),
        "workpiece" => return Some(WrittenReference::Workpiece),
        _ => {}
    }
    if let Some(axis) = AxisName::new(word).filter(|_| document.axes.contains_key(word)) {
        return Some(WrittenReference::Axis(axis));
    }
    if !document.places.is_lost(&keys(["axes"])) {
        let known: Vec<&str> = POINTS.into_iter().chain(document.axes.keys().map(String::as_str)).collect();
        let message = format!("`{}` is not a point that a position can be relative to", shown(word));
        context.at_value(codes::E0414, at, message, did_you_mean(word, &known));
    }
    None
}

impl PositionDraft {
    /// Returns the position; gauge point and tip are those of the default tool, whichever tool is in use.
    pub fn resolve_points(&self, tool: &Tool) -> Position {
        let from = |base: [f64; 3]| Position::absolute(std::array::from_fn(|i| base[i] + self.at[i]));
        let relative = |from: ReferencePoint| Position { from, at: self.at };
        match &self.from {
            WrittenReference::Bed => Position::absolute(self.at),
            WrittenReference::Gauge => from(tool.gauge),
            WrittenReference::Tip => from(tool.tip),
            WrittenReference::Workpiece => relative(ReferencePoint::Workpiece),
            WrittenReference::Axis(axis) => relative(ReferencePoint::Axis(axis.clone())),
        }
    }

    /// Returns the node of the graph of references that it leads to.
    fn target(&self) -> Option<&str> {
        match &self.from {
            WrittenReference::Workpiece => Some("workpiece"),
            WrittenReference::Axis(axis) => Some(axis.as_str()),
            WrittenReference::Bed | WrittenReference::Gauge | WrittenReference::Tip => None,
        }
    }
}

/// Refuses references that lead back to where they began, in any arrangement of the axes: each axis takes the side
/// that the reference stands on.
pub fn circles(context: &mut Context<'_>, axes: &[AxisDraft], workpiece: Option<&PositionDraft>) {
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

/// A point (mm) that positions can be relative to.
pub struct NamedPoint<'a> {
    pub name: &'a str,
    pub point: [f64; 3],
}

/// The line to write for an axis whose geometry is not stated, with the position that it has now.
pub fn line_to_write(axis: &AxisName, branch: Branch, origin: [f64; 3], from: NamedPoint<'_>) -> String {
    let at: Vec<String> = (0..3).map(|i| crate::units::significant(origin[i] - from.point[i], 7)).collect();
    let (key, name) = (block_key(branch), from.name);
    format!("{axis}: {{ {key}: {{ origin: {{ from: {name}, at: [{}] }} }} }}", at.join(", "))
}
