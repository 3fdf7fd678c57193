//! The axis of a file whose table does not name it: from its own first lines, from its positions.

use crate::controller::manifest::{ControllerTarget, FileLayout};
use crate::machine::Machine;

/// The axis whose file, as the target names it, is named in the first line around the columns, and which line that is.
pub(super) fn by_frame(layout: &FileLayout, names: &[(Option<usize>, String)], text: &str) -> Option<(usize, usize)> {
    let FileLayout::AxisColumns { frame, .. } = layout else { return None };
    let said = |line: &str| !line.trim().is_empty() && !line.trim_start().starts_with(&*frame.comment);
    let (line, first) = text.lines().enumerate().find(|(_, line)| said(line))?;
    let words: Vec<&str> = first.split([' ', '.', '\t']).collect();
    let stem = |name: &str| name.split('.').next().unwrap_or_default().to_owned();
    let mut named = names.iter().filter(|(_, name)| words.contains(&&*stem(name)));
    match (named.next(), named.next()) {
        (Some((axis, _)), None) => axis.map(|axis| (line, axis)),
        _ => None,
    }
}

/// True if positions span the travel of an axis from end to end, as tables do.
pub(super) fn spans(target: &ControllerTarget, machine: &Machine, axis: usize, positions: &[f64]) -> bool {
    let continuous = target.manifest.mechanism.iter().next().map_or((0.0, 360.0), |(_, rules)| rules.continuous);
    let (min, max) = if machine.is_continuous(axis) { continuous } else { machine.axes()[axis].travel.interval() };
    let near = |a: f64, b: f64| (a - b).abs() < 1e-3;
    matches!(positions, [first, .., last] if near(*first, min) && near(*last, max))
}
