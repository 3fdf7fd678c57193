//! Positions: three coordinates, or the same from a named point; their references form no circle.

use super::context::{Context, dotted_path};
use crate::diagnostic::{codes, did_you_mean, shown};
use crate::machine::{AxisName, Branch, Position, ReferencePoint, Tool};
use crate::syntax::{Keys, PositionEntry, RelativeEntry, below, keys};

/// A position as written, with the keys of its entry.
#[derive(Debug, Clone)]
pub struct PositionDraft {
    from: WrittenReference,
    at: [f64; 3],
    pub(super) entry: Keys,
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
pub fn position(context: &mut Context, written: &PositionEntry, entry: &Keys) -> Option<PositionDraft> {
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

fn reference(context: &mut Context, word: &str, at: &Keys) -> Option<WrittenReference> {
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
    pub(super) fn target(&self) -> Option<&str> {
        match &self.from {
            WrittenReference::Workpiece => Some("workpiece"),
            WrittenReference::Axis(axis) => Some(axis.as_str()),
            WrittenReference::Bed | WrittenReference::Gauge | WrittenReference::Tip => None,
        }
    }
}

/// The key of the block of a side.
pub fn block_key(branch: Branch) -> &'static str {
    if branch == Branch::Tool { "on_tool" } else { "on_workpiece" }
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
