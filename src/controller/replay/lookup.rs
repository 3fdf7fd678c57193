//! Look-up in tables over one axis: cells, straight lines, positions outside, single precision.

use crate::controller::manifest::OutsideTable;

/// Returns the period of a table that rolls over: it begins again one step after its last point.
pub(super) fn period(nodes: &[f64]) -> f64 {
    let last = nodes.len() - 1;
    2.0 * nodes[last] - nodes[last - 1] - nodes[0]
}

/// Returns the nodes at both ends of a cell and the weight of the upper one; none where nothing is added. The last
/// point of a table that rolls over is followed by the first one of the next round.
pub(super) fn cell(nodes: &[f64], position: f64, outside: OutsideTable) -> Option<(usize, usize, f64)> {
    let last = nodes.len() - 1;
    let beyond = position < nodes[0] || position > nodes[last];
    if last == 0 {
        return (!(beyond && outside == OutsideTable::Nothing)).then_some((0, 0, 0.0));
    }
    match outside {
        OutsideTable::Nothing if beyond => return None,
        OutsideTable::Extrapolate => {}
        OutsideTable::RollOver if position > nodes[last] => {
            let span = nodes[0] + period(nodes) - nodes[last];
            return Some((last, 0, (position - nodes[last]) / span));
        }
        _ if position <= nodes[0] => return Some((0, 0, 0.0)),
        _ if position >= nodes[last] => return Some((last, last, 0.0)),
        _ => {}
    }
    let low = nodes.partition_point(|node| *node <= position).clamp(1, last) - 1;
    Some((low, low + 1, (position - nodes[low]) / (nodes[low + 1] - nodes[low])))
}

/// Returns the straight line between two nodes, in doubles.
pub(super) fn between(positions: &[f64], values: &[f64], position: f64, outside: OutsideTable) -> f64 {
    match cell(positions, position, outside) {
        None => 0.0,
        Some((low, _, 0.0)) => values[low],
        Some((low, high, fraction)) => values[low] * (1.0 - fraction) + values[high] * fraction,
    }
}

/// Returns the value of a table whose values change in steps, at this fraction of the section between two nodes.
pub(super) fn stepped(nodes: &[f64], values: &[f64], position: f64, outside: OutsideTable, at: f64) -> f64 {
    let (low, high, fraction) = cell(nodes, position, outside).unwrap_or_default();
    values[if fraction > at { high } else { low }]
}

/// Returns the value in LinuxCNC's arithmetic: each entry keeps its trim and the slope to the next entry as `float`;
/// the sum is a `double`. Below the first and above the last entry its value is held.
pub(super) fn single_precision(positions: &[f64], values: &[f64], position: f64) -> f64 {
    let i = positions.partition_point(|node| *node <= position).saturating_sub(1);
    let trim = values[i] as f32;
    if position <= positions[0] || i + 1 >= positions.len() {
        return f64::from(trim);
    }
    let rise = f64::from(values[i + 1] as f32 - trim);
    let slope = (rise / (positions[i + 1] - positions[i])) as f32;
    f64::from(trim) + f64::from(slope) * (position - positions[i])
}
