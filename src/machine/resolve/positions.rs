//! Positions: three coordinates, or the same from a named point; their references form no circle.

use super::context::{Context, dotted};
use crate::diagnostic::{codes, did_you_mean, shown};
use crate::machine::{Anchor, AxisName, Branch, Position, Tool};
use crate::syntax::{Keys, PositionEntry, RelativeEntry, below, keys};

/// A position as written, with the keys of its entry.
#[derive(Debug, Clone)]
pub struct PositionDraft {
    from: From,
    at: [f64; 3],
    pub(super) entry: Keys,
}

#[derive(Debug, Clone, PartialEq)]
enum From {
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
        PositionEntry::Point(list) => (Some(From::Bed), context.vector(list, entry)),
        PositionEntry::Relative(RelativeEntry { from, at }) => {
            let from = match from {
                Some(word) => named(context, word, &below(entry, "from")),
                None => {
                    if !context.document.places.is_marred(entry) {
                        let message = format!("`{}` does not say from where", dotted(entry));
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

fn named(context: &mut Context<'_>, word: &str, at: &Keys) -> Option<From> {
    let document = context.document;
    match word {
        "bed" => return Some(From::Bed),
        "gauge" => return Some(From::Gauge),
        "tip" => return Some(From::Tip),
        "workpiece" => return Some(From::Workpiece),
        _ => {}
    }
    if let Some(axis) = AxisName::new(word).filter(|_| document.axes.contains_key(word)) {
        return Some(From::Axis(axis));
    }
    if !document.places.is_lost(&keys(["axes"])) {
        let known: Vec<&str> = POINTS.into_iter().chain(document.axes.keys().map(String::as_str)).collect();
        let message = format!("`{}` is not a point that a position can be relative to", shown(word));
        context.at_value(codes::E0414, at, message, did_you_mean(word, &known));
    }
    None
}

impl PositionDraft {
    /// The position; gauge point and tip are those of the default tool, whichever tool is in use.
    pub fn settled(&self, tool: &Tool) -> Position {
        let from = |base: [f64; 3]| Position::absolute(std::array::from_fn(|i| base[i] + self.at[i]));
        let relative = |from: Anchor| Position { from, at: self.at };
        match &self.from {
            From::Bed => Position::absolute(self.at),
            From::Gauge => from(tool.gauge),
            From::Tip => from(tool.tip),
            From::Workpiece => relative(Anchor::Workpiece),
            From::Axis(axis) => relative(Anchor::Axis(axis.clone())),
        }
    }

    /// The node of the graph of references that it leads to.
    pub(super) fn target(&self) -> Option<&str> {
        match &self.from {
            From::Workpiece => Some("workpiece"),
            From::Axis(axis) => Some(axis.as_str()),
            From::Bed | From::Gauge | From::Tip => None,
        }
    }
}

/// The key of the block of a side.
pub fn block_key(branch: Branch) -> &'static str {
    if branch == Branch::Tool { "on_tool" } else { "on_workpiece" }
}

/// The line to write for an axis whose geometry is not stated, with the position that it has now.
pub fn line_to_write(axis: &AxisName, branch: Branch, origin: [f64; 3], from: (&str, [f64; 3])) -> String {
    let at: Vec<String> = (0..3).map(|i| crate::units::significant(origin[i] - from.1[i], 7)).collect();
    let (key, name) = (block_key(branch), from.0);
    format!("{axis}: {{ {key}: {{ origin: {{ from: {name}, at: [{}] }} }} }}", at.join(", "))
}
